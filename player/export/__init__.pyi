from .film import Film, FrameProgress
from .formats import FORMATS, check_look, export, format_of

__all__ = ["FORMATS", "Film", "FrameProgress", "check_look", "export", "format_of"]
