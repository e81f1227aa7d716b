"""Everything that the window shows and does, as one frozen value: equal scenes, equal pictures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from player.camera import Camera
from player.style import Style
from player.timeline import Timeline


@dataclass(frozen=True)
class Scene:
    """What the user has chosen so far; keys, mouse and buttons each turn it into a new one.

    home:           the camera that shows the whole plant in the window's present shape.
    has_colors:     whether the clip carries the scans' own colours.
    turning:        the camera goes round the plant by itself.
    notice:         a passing sentence for the user.
    wants_picture:  a screenshot is to be saved of the next picture.
    """

    timeline: Timeline
    camera: Camera
    home: Camera
    style: Style
    has_colors: bool
    turning: bool = False
    help: bool = False
    fullscreen: bool = False
    notice: str = ""
    wants_picture: bool = False
    closed: bool = False

    @property
    def color_by(self) -> str:
        """The colouring on screen: "scan" or "track"."""
        if self.style.color_by == "track" or not self.has_colors:
            return "track"
        return "scan"

    def clock(self, move: Callable[[Timeline], Timeline]) -> Scene:
        return replace(self, timeline=move(self.timeline))

    def seen(self, move: Callable[[Camera], Camera]) -> Scene:
        return replace(self, camera=move(self.camera))

    def styled(self, notice: str = "", **changes: object) -> Scene:
        return replace(self, style=replace(self.style, **changes), notice=notice)  # type: ignore[arg-type]
