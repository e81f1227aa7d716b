from .export.formats import film
from .rendering.headless import render

__all__ = ["film", "render"]
