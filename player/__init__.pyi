from .rendering.headless import render

__all__ = ["render"]
