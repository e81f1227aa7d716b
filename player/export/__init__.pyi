from .film import Film
from .formats import FORMATS, check_look, export, format_of

__all__ = ["FORMATS", "Film", "check_look", "export", "format_of"]
