"""The state of the window as one immutable value: equal scenes are drawn as equal pictures."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Self

from corrections import Place
from corrections.history import Edits
from gclip import Clip
from player.view.camera import Camera
from player.view.camera_animation import CameraPath
from player.view.choices import Compare, Output, Request
from player.view.playback import Timeline
from player.view.style import ColorMode, Style
from traits.curves import curve_names


@dataclass(frozen=True)
class ExportProgress:
    """Progress of an export."""

    name: str  #: of the exported file
    done: int = 0  #: steps done so far, of `total`
    total: int = 0
    ended: str = ""  #: once the export has ended: a sentence for the user about its result


@dataclass(frozen=True)
class Scene:
    """Immutable state of the window; every user action replaces it by a new scene."""

    timeline: Timeline
    camera: Camera
    home: Camera  #: shows the whole first clip in a window of the current size
    style: Style
    #: one or two clips that are shown; not compared, since only names of organs change in them, and
    #: those change together with `edits`
    clips: tuple[Clip, ...] = field(compare=False)
    second_home: Camera | None = None  #: shows the whole second clip, if there is one
    clicked_places: tuple[Place, ...] = ()  #: points clicked on picked organs, at most two
    edits: Edits | None = None  #: corrections of organs; None for clips that come from no file
    turning: bool = False  #: whether the camera turns about the plant
    following: bool = False  #: whether the camera follows `path`
    path: CameraPath = field(default_factory=CameraPath)
    compare: Compare = Compare.OFF
    wipe: float = 0.5  #: position of the dividing line in `Compare.WIPE`, as a share of the width
    output: Output = field(default_factory=Output)
    panel: bool = False  #: whether the side panel is open
    guides: bool = True  #: whether scale bar and axes are shown
    legend: bool = True  #: whether the meaning of the colours is shown
    curve: str = "length"  #: trait of the picked organ that is plotted; "" for none
    help: bool = False  #: whether the help is open
    fullscreen: bool = False
    notice: str = ""  #: sentence for the user that disappears after a while
    request: Request | None = None
    exporting: ExportProgress | None = None
    closed: bool = False  #: whether the window is to be closed

    @property
    def clip(self) -> Clip:
        """The first clip."""
        return self.clips[0]

    @property
    def curves(self) -> list[str]:
        """Names of the traits that can be plotted."""
        return curve_names(self.clip)

    @property
    def color_mode(self) -> ColorMode:
        """The colour mode of the first clip, never `ColorMode.AUTO`."""
        return self.style.color_mode(self.clip)

    @property
    def color_modes(self) -> list[ColorMode]:
        """Modes to choose from, also unavailable ones, which explain how to make them available."""
        excluded = (ColorMode.AUTO,) if self.clip.has_colors else (ColorMode.AUTO, ColorMode.SCAN)
        return [mode for mode in ColorMode if mode not in excluded]

    def with_timeline(self, move: Callable[[Timeline], Timeline]) -> Self:
        return replace(self, timeline=move(self.timeline))

    def with_camera(self, move: Callable[[Camera], Camera]) -> Self:
        """Move the camera, and stop following the camera path."""
        return replace(self, camera=move(self.camera), following=False)

    def with_style(self, notice: str = "", **changes: object) -> Self:
        return replace(self, style=replace(self.style, **changes), notice=notice)  # type: ignore[arg-type]

    def changed(self, field: str, value: object, notice: str = "") -> Self:
        """Change a field by name, or a field of a field, such as "style.ground"."""
        part, _, name = field.rpartition(".")
        changes = {part: replace(getattr(self, part), **{name: value})} if part else {name: value}
        return replace(self, **{"notice": notice, **changes})

    def with_notice(self, notice: str) -> Self:
        return replace(self, notice=notice)


def with_clips(scene: Scene, clips: tuple[Clip, ...], reset: bool) -> Scene:
    """Replace the clips of a scene, and reset what they do not contain.

    reset: whether the clips are unrelated to the previous ones, so that day, camera, camera path
           and corrections are reset, too; if not, they are the same clips, baked again.
    """
    clip, style, path = clips[0], scene.style, CameraPath() if reset else scene.path
    timeline = replace(scene.timeline, times=tuple(clip.times))
    if len(clip.track_table) != len(scene.clip.track_table):
        style = replace(style, picked=None, second=None, isolated=None, hidden=frozenset())
    if ColorMode(style.color_by).quantity.why_unavailable(clip):
        style = replace(style, color_by=ColorMode.AUTO)
    compare = scene.compare
    if len(clips) != len(scene.clips):
        compare = Compare.BESIDE if len(clips) > 1 else Compare.OFF
    return replace(
        scene,
        clips=clips,
        camera=scene.home if reset else scene.camera,
        timeline=timeline.at(clip.times[0] if reset else timeline.day),
        style=style,
        compare=compare,
        clicked_places=(),
        edits=None if reset else scene.edits,
        path=path,
        following=bool(path and scene.following),
        curve=scene.curve if scene.curve in (*curve_names(clip), "") else "length",
    )
