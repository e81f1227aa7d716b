"""Pictures and films of a clip, drawn without a screen."""

from player.export.film import Film
from player.export.formats import export, format_of

__all__ = ["Film", "export", "format_of"]
