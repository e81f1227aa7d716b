from .export.formats import film
from .export.web.page import iframe
from .rendering.headless import render
from .window.launch import show

__all__ = ["film", "iframe", "render", "show"]
