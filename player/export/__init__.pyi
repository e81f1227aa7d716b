from .film import Film
from .formats import FORMATS, check_look, export, format_of
from .progress import FrameProgress

__all__ = ["FORMATS", "Film", "FrameProgress", "check_look", "export", "format_of"]
