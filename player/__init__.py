"""The player: a clip becomes light, in a window, a picture or a film.

from player import render
picture = render(gclip.open("plant.gclip"), day=12.5, size=(1280, 720))   # (720, 1280, 4) uint8
"""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from player.rendering.headless import render

__all__ = ["render"]


def __getattr__(name: str) -> Any:
    """Load the graphics libraries only when a picture is wanted: `--help` stays instant."""
    if name != "render":
        raise AttributeError(f"module 'player' has no attribute {name!r}")
    from player.rendering.headless import render

    return render
