from .film import Film
from .formats import FORMATS, check_export, export, format_of

__all__ = ["FORMATS", "Film", "check_export", "export", "format_of"]
