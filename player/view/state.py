"""Everything that the window shows and does, as one frozen value: equal scenes, equal pictures."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Self

from corrections import Place
from gclip import Clip
from player.view.camera import Camera
from player.view.camera_animation import CameraPath
from player.view.choices import Compare, Edits, Output, Wish
from player.view.playback import Timeline
from player.view.style import ColorMode, Style
from traits.curves import curve_names


@dataclass(frozen=True)
class Exporting:
    """An export: its file's name, steps done of all; `ended` with a sentence once it is over."""

    name: str
    done: int = 0
    total: int = 0
    ended: str = ""


@dataclass(frozen=True)
class Scene:
    """What the user has chosen so far; keys, mouse and buttons each turn it into a new one."""

    timeline: Timeline
    camera: Camera
    home: Camera  #: the camera that shows the whole plant in the window's present shape
    style: Style
    #: those that are shown, 1 or 2; the first one's organs have the names that they were given,
    #: and where those change, `edits` do
    clips: tuple[Clip, ...] = field(compare=False)
    other_home: Camera | None = None  #: that shows the second clip as `home` shows the first one
    chosen: tuple[Place, ...] = ()  #: where the picked organs were clicked, two at most
    edits: Edits | None = None  #: what was put right about organs; None for clips from no file
    turning: bool = False  #: the camera goes round the plant by itself
    following: bool = False  #: the camera goes along its path
    path: CameraPath = field(default_factory=CameraPath)
    compare: Compare = Compare.OFF
    wipe: float = 0.5  #: share of the width where the wipe's line stands
    output: Output = field(default_factory=Output)
    panel: bool = False
    guides: bool = True  #: scale bar and axes
    legend: bool = True  #: what the colours mean
    curve: str = "length"  #: the trait that is plotted of the picked organ; "" for none
    help: bool = False
    fullscreen: bool = False
    notice: str = ""  #: a passing sentence for the user
    wish: Wish | None = None
    exporting: Exporting | None = None  #: an export under way
    closed: bool = False

    @property
    def clip(self) -> Clip:
        return self.clips[0]

    @property
    def curves(self) -> list[str]:
        """What may be plotted of an organ."""
        return curve_names(self.clip)

    @property
    def color_mode(self) -> ColorMode:
        """The colouring on screen."""
        return self.style.color_mode(self.clip)

    @property
    def color_modes(self) -> list[ColorMode]:
        """What can be chosen, also where the clip lacks it: the answer tells how to get it."""
        without = (ColorMode.AUTO,) if self.clip.has_colors else (ColorMode.AUTO, ColorMode.SCAN)
        return [mode for mode in ColorMode if mode not in without]

    def with_timeline(self, move: Callable[[Timeline], Timeline]) -> Self:
        return replace(self, timeline=move(self.timeline))

    def with_camera(self, move: Callable[[Camera], Camera]) -> Self:
        """Move the camera, away from any path that it was following."""
        return replace(self, camera=move(self.camera), following=False)

    def with_style(self, notice: str = "", **changes: object) -> Self:
        return replace(self, style=replace(self.style, **changes), notice=notice)  # type: ignore[arg-type]

    def changed(self, field: str, value: object, notice: str = "") -> Self:
        """Change a field, also of a part: "curve", "style.ground"."""
        part, _, name = field.rpartition(".")
        changes = {part: replace(getattr(self, part), **{name: value})} if part else {name: value}
        return replace(self, **{"notice": notice, **changes})

    def with_notice(self, notice: str) -> Self:
        return replace(self, notice=notice)


def reopened(scene: Scene, clips: tuple[Clip, ...], fresh: bool) -> Scene:
    """The scene with other clips (fresh), or with the same ones as they were baked anew: then on
    the same day, and with the same camera path. What these clips don't have is no longer shown,
    picked or compared with.
    """
    clip, style, path = clips[0], scene.style, CameraPath() if fresh else scene.path
    timeline = replace(scene.timeline, times=tuple(clip.times))
    if len(clip.track_table) != len(scene.clip.track_table):
        style = replace(style, picked=None, second=None, alone=None, hidden=frozenset())
    if ColorMode(style.color_by).lacking(clip):
        style = replace(style, color_by=ColorMode.AUTO)
    compare = scene.compare
    if len(clips) != len(scene.clips):
        compare = Compare.BESIDE if len(clips) > 1 else Compare.OFF
    return replace(
        scene,
        clips=clips,
        camera=scene.home if fresh else scene.camera,
        timeline=timeline.at(clip.times[0] if fresh else timeline.day),
        style=style,
        compare=compare,
        chosen=(),
        edits=None if fresh else scene.edits,
        path=path,
        following=bool(path and scene.following),
        curve=scene.curve if scene.curve in (*curve_names(clip), "") else "length",
    )
