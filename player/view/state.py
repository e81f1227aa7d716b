"""Everything that the window shows and does, as one frozen value: equal scenes, equal pictures."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Self

from gclip import Clip
from gclip.corrections import Place
from player.view.camera import Camera
from player.view.camera_animation import CameraPath
from player.view.choices import Compare, Edits, Output, Wish
from player.view.playback import Timeline
from player.view.style import ColorMode, Style
from traits.curves import PLOTTED, plotted


@dataclass(frozen=True)
class Scene:
    """What the user has chosen so far; keys, mouse and buttons each turn it into a new one."""

    timeline: Timeline
    camera: Camera
    home: Camera  #: the camera that shows the whole plant in the window's present shape
    style: Style
    has_colors: bool  #: whether the clip carries the scans' own colours
    has_errors: bool = False  #: whether it carries scans that were left out, to compare with
    fields: tuple[str, ...] = ()  #: names of the clip's fields
    curves: tuple[str, ...] = tuple(PLOTTED)  #: what may be plotted of an organ
    organs: int = 0  #: how many tracks the clip has
    clips: int = 1  #: how many are shown, 1 or 2
    chosen: tuple[Place, ...] = ()  #: where the picked organs were clicked, two at most
    edits: Edits | None = None  #: what was put right about organs; None for clips from no file
    turning: bool = False  #: the camera goes round the plant by itself
    following: bool = False  #: the camera goes along its path
    path: CameraPath = field(default_factory=CameraPath)
    compare: Compare = Compare.OFF
    wipe: float = 0.5  #: share of the width where the wipe's line stands
    output: Output = field(default_factory=Output)
    formats: tuple[str, ...] = (Output.example,)  #: what can be exported, by an example's name
    panel: bool = False
    guides: bool = True  #: scale bar and axes
    legend: bool = True  #: what the colours mean
    curve: str = "length"  #: the one of `curves` that is plotted of the picked organ; "" for none
    help: bool = False
    fullscreen: bool = False
    kiosk: bool = False  #: nothing but the plant and the date
    notice: str = ""  #: a passing sentence for the user
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
        absent |= set() if self.fields else {ColorMode.FIELD}
        return tuple(mode for mode in ColorMode if mode not in absent)

    def with_timeline(self, move: Callable[[Timeline], Timeline]) -> Self:
        return replace(self, timeline=move(self.timeline))

    def with_camera(self, move: Callable[[Camera], Camera]) -> Self:
        """Move the camera, away from any path that it was following."""
        return replace(self, camera=move(self.camera), following=False)

    def with_style(self, notice: str = "", **changes: object) -> Self:
        return replace(self, style=replace(self.style, **changes), notice=notice)  # type: ignore[arg-type]

    def with_output(self, notice: str, **changes: object) -> Self:
        """Change what the next picture or export is to be."""
        return replace(self, output=replace(self.output, **changes), notice=notice)  # type: ignore[arg-type]

    def with_notice(self, notice: str) -> Self:
        return replace(self, notice=notice)


@dataclass(frozen=True)
class Exporting:
    """An export: its file's name, steps done of all; `ended` with a sentence once it is over."""

    name: str
    done: int = 0
    total: int = 0
    ended: str = ""


def clamped(scene: Scene, clips: Sequence[Clip]) -> Scene:
    """What these clips don't have is no longer shown, picked or compared with."""
    clip, style = clips[0], scene.style
    organs, compare, curves = len(clip.track_table), scene.compare, tuple(plotted(clip))
    if scene.organs != organs and style.marked:
        scene = scene.with_style(scene.notice, picked=None, second=None, alone=None)
        scene = replace(scene.with_style(scene.notice, hidden=frozenset()), chosen=())
    lacks = {"error": not clip.held_out, "field": not clip.fields}
    if lacks.get(style.color_by):
        scene = scene.with_style(scene.notice, color_by=ColorMode.AUTO)
    if len(clips) != scene.clips:
        compare = Compare.BESIDE if len(clips) > 1 else Compare.OFF
    return replace(
        scene,
        has_colors=clip.has_colors,
        has_errors=bool(clip.held_out),
        fields=tuple(field.name for field in clip.fields),
        curves=curves,
        curve=scene.curve if scene.curve in (*curves, "") else curves[0],
        organs=organs,
        clips=len(clips),
        compare=compare,
    )


def reopened(scene: Scene, clips: Sequence[Clip], fresh: bool) -> Scene:
    """The scene with other clips (fresh), or with the same ones as they were baked anew: then on
    the same day, and with the same camera path.
    """
    times = tuple(clips[0].times)
    timeline = replace(scene.timeline, times=times, begin=None, end=None)
    timeline = timeline.at(times[0] if fresh else timeline.day)
    path = CameraPath() if fresh else scene.path
    following = bool(path and scene.following)
    scene = replace(scene, chosen=(), edits=None if fresh else scene.edits)
    return clamped(replace(scene, timeline=timeline, path=path, following=following), clips)
