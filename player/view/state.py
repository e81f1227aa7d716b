"""Everything that the window shows and does, as one frozen value: equal scenes, equal pictures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

from player.view.camera import Camera
from player.view.camera_animation import CameraPath
from player.view.choices import Compare, Output, Wish
from player.view.playback import Timeline
from player.view.style import ColorMode, Style


@dataclass(frozen=True)
class Scene:
    """What the user has chosen so far; keys, mouse and buttons each turn it into a new one.

    home:       the camera that shows the whole plant in the window's present shape.
    has_colors: whether the clip carries the scans' own colours.
    has_errors: whether it carries scans that were left out, to compare with.
    organs:     how many tracks the clip has.
    clips:      how many are shown, 1 or 2.
    turning:    the camera goes round the plant by itself; following: along its path.
    guides:     scale bar and axes; legend: what the colours mean.
    wipe:       share of the width where the wipe's line stands.
    kiosk:      nothing but the plant and the date.
    notice:     a passing sentence for the user.
    """

    timeline: Timeline
    camera: Camera
    home: Camera
    style: Style
    has_colors: bool
    has_errors: bool = False
    organs: int = 0
    clips: int = 1
    turning: bool = False
    following: bool = False
    path: CameraPath = field(default_factory=CameraPath)
    compare: Compare = Compare.OFF
    wipe: float = 0.5
    output: Output = field(default_factory=Output)
    panel: bool = False
    guides: bool = True
    legend: bool = True
    help: bool = False
    fullscreen: bool = False
    kiosk: bool = False
    notice: str = ""
    wish: Wish | None = None
    closed: bool = False

    @property
    def color_mode(self) -> ColorMode:
        """The colouring on screen."""
        return ColorMode(self.style.color_by).resolved(self.has_colors)

    @property
    def color_modes(self) -> tuple[ColorMode, ...]:
        """What can be chosen."""
        absent = {ColorMode.AUTO}
        absent |= set() if self.has_colors else {ColorMode.SCAN}
        absent |= set() if self.has_errors else {ColorMode.ERROR}
        return tuple(mode for mode in ColorMode if mode not in absent)

    def clock(self, move: Callable[[Timeline], Timeline]) -> Scene:
        return replace(self, timeline=move(self.timeline))

    def seen(self, move: Callable[[Camera], Camera]) -> Scene:
        """Move the camera, away from any path that it was following."""
        return replace(self, camera=move(self.camera), following=False)

    def styled(self, notice: str = "", **changes: object) -> Scene:
        return replace(self, style=replace(self.style, **changes), notice=notice)  # type: ignore[arg-type]

    def switched(self, name: str) -> Scene:
        """Turn the switch of this name."""
        change: dict[str, Any] = {name: not getattr(self, name)}
        return replace(self, **change)

    def told(self, notice: str) -> Scene:
        return replace(self, notice=notice)
