from .film import Film
from .formats import FORMATS, export, format_of
from .progress import FrameProgress

__all__ = ["FORMATS", "Film", "FrameProgress", "export", "format_of"]
