from .export.formats import film
from .export.web.notebook import iframe
from .rendering.headless import render

__all__ = ["film", "iframe", "render"]
