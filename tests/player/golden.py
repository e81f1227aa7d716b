"""Golden pictures: what Mesa's software renderer drew when someone last looked hard at it.

`python -m tests.player.golden` draws all of them anew, with names behind it some; look at every one
before you commit it. `--clips` grows and bakes the small plants besides that they show: clips that
stay, so that a picture changes only when the player does.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import gclip
from gclip import Clip
from player.export.film import Film
from player.gl.context import headless
from player.rendering.headless import Offscreen
from player.ui.gui import Gui
from player.ui.interface import Interface
from player.view.annotations import Annotations
from player.view.camera import Camera
from player.view.camera_animation import CameraPath
from player.view.choices import Compare
from player.view.playback import Timeline
from player.view.split_view import panes_of
from player.view.state import Scene
from player.view.style import Style
from player.window.dynamic_resolution import Detail
from player.window.viewports import Viewports, home_camera
from tests.player.drawn import drawn, read_pixels

FOLDER = Path(__file__).parent / "pictures"
SIZE = (240, 160)
WINDOW, DENSITY = (900, 520), 0.5  # in units of 1/96 inch, and pixels in one
PLAIN = 10  # levels of 255 that anybody sees
KEPT = 0xFC  # bits of a colour: the last two are dither, and would fill most of the files

# Of each kind: seed, days between its two scans, points of each.
PLANTS = {"maize": (0, 9, 2200), "tomato": (1, 6, 2200), "tree": (0, 30, 1800)}
LOST = "3"  # label of the tomato's leaf that its last scan lacks

Picture = NDArray[np.uint8]


@dataclass(frozen=True)
class Difference:
    """How far a picture is from the golden one, both softened a little, in levels of 255.

    mean:  of the absolute differences; lean: the largest mean difference of a channel, which
           rounding leaves alone and light, colours and a missing organ do not.
    share: of the pixels that differ by more than PLAIN.
    """

    mean: float
    lean: float
    share: float

    def within(self, most: Difference) -> bool:
        return self.mean <= most.mean and self.lean <= most.lean and self.share <= most.share

    @classmethod
    def between(cls, found: Picture, wanted: Picture) -> Difference:
        off = difference(found, wanted)
        return cls(
            mean=float(np.abs(off).mean()),
            lean=float(np.abs(off.mean(axis=(0, 1))).max()),
            share=float((np.abs(off).max(axis=2) > PLAIN).mean()),
        )


@dataclass(frozen=True)
class Golden:
    """One picture in the folder, and each way that has to lead to it.

    loose: whether something is written in it, which other versions of the libraries for fonts and
           panels may write a little otherwise; or rounding decides which discs make a surface.
    """

    name: str
    loose: bool
    ways: tuple[Callable[[], Picture], ...]

    @property
    def file(self) -> Path:
        return FOLDER / f"{self.name}.png"

    @property
    def most(self) -> Difference:
        """What other versions of Mesa may differ by; its other renderer, softpipe, does by less."""
        if self.loose:
            return Difference(mean=0.4, lean=0.12, share=0.01)
        return Difference(mean=0.06, lean=0.05, share=0.0004)


def _still(
    plant: str,
    day: float,
    style: Style,
    look: Callable[[Camera], Camera] | None = None,
    **film: Any,
) -> Callable[[], Picture]:
    """As `play --export still.png` draws it."""

    def draw() -> Picture:
        clip = clip_of(plant)
        path = None
        if look is not None:
            path = CameraPath(((day, look(Camera.home(clip, SIZE[0] / SIZE[1]))),))
        still = Film(SIZE, style=style, at=(day,), path=path, **film)
        with Offscreen(clip, SIZE) as offscreen:
            return next(iter(still.frames(clip, offscreen)))

    return draw


def _drawn(
    plant: str,
    day: float,
    style: Style,
    **options: Any,
) -> Callable[[], Picture]:
    """By a renderer with options of its own."""

    def draw() -> Picture:
        clip = clip_of(plant)
        camera = Camera.home(clip, SIZE[0] / SIZE[1])
        context = headless()
        pixels = drawn(context, clip, day, camera, SIZE, style, **options)
        context.release()
        return pixels[::-1].astype(np.uint8)

    return draw


def _window(plant: str, day: float, style: Style, **scene: Any) -> Callable[[], Picture]:
    """As the window shows it, with all that lies over the plant."""

    def draw() -> Picture:
        clip = clip_of(plant)
        size = (round(WINDOW[0] * DENSITY), round(WINDOW[1] * DENSITY))
        camera = home_camera(clip, WINDOW)
        plain = Scene(Timeline.of(clip.times).at(day), camera, camera, style, (clip,))
        shown = replace(plain, **scene)
        panes = panes_of(shown, [plant])
        context = headless()
        screen = context.simple_framebuffer(size, 3)
        stage, gui = Viewports(context, [clip]), Gui()
        interface = Interface(gui, stage.colors[0], plant)
        for _ in range(3):  # a panel learns its sizes as it is drawn
            stage.draw(size, panes, style, Detail(), None)
            stage.blit(screen)
            interface.draw(screen, shown, WINDOW, DENSITY, panes)
        pixels = read_pixels(screen)[::-1].astype(np.uint8)
        interface.organs.release()
        gui.release()
        stage.release()
        context.release()
        return pixels

    return draw


def _closer(camera: Camera) -> Camera:
    return camera.zoom_at(6.0, 0.0, 0.1)


TRACK = Style(color_by="track")
FINE, COARSE = Style(point_size=0.3), Style(point_size=1.5)
LEGEND = Annotations(legend=True)
DATE_AND_SCALE = Annotations(date=True, scale_bar=True)

LOOSE = ("splats", "light", "tracks", "age", "speed", "height", "window", "wipe")
GOLDEN = tuple(
    Golden(name, name in LOOSE, tuple(ways))
    for name, *ways in (
        ("splats", _drawn("tomato", 5.0, COARSE)),
        ("points", *(_drawn("tomato", 4.0, FINE, compute=way) for way in (False, True))),
        ("few", _drawn("tomato", 6.0, FINE, stride=40)),  # each single mover counts
        ("unshaded", _still("tree", 22.0, Style(shading=0.0, depth_cue=False, floor=False))),
        ("shaded", _still("tree", 22.0, Style(shading=2.0))),
        ("light", _still("tree", 28.0, Style(ground="light"), annotations=DATE_AND_SCALE)),
        ("tracks", _still("maize", 9.0, TRACK, title="Maize", annotations=LEGEND)),
        ("age", _still("maize", 9.0, Style(color_by="age"), annotations=LEGEND)),
        ("speed", _still("tomato", 2.0, Style(color_by="speed"), annotations=LEGEND)),
        ("height", _still("tree", 30.0, Style(color_by="height"), annotations=LEGEND)),
        ("close", _still("maize", 9.0, Style(), _closer)),
        ("orthographic", _still("tree", 15.0, TRACK, lambda view: view.with_orthographic(True))),
        ("transparent", _still("tomato", 6.0, Style(), transparent=True)),
        ("birth", _still("maize", 2.0, TRACK)),
        ("lost", _still("tomato", 3.0, TRACK)),
        ("picked", _drawn("tomato", 4.0, Style(picked=2, hidden=frozenset({1})))),
        ("window", _window("maize", 7.0, Style(color_by="height"), panel=True)),
        ("wipe", _window("tomato", 2.4, Style(ground="light"), compare=Compare.WIPE, wipe=0.53)),
    )
)


def clip_of(plant: str) -> Clip:
    return gclip.open(FOLDER / f"{plant}.gclip")


def kept(picture: Picture) -> Picture:
    """(height, width, 4) of a picture with 3 channels or 4: what is kept in the file."""
    alpha = picture[..., 3:] if picture.shape[2] == 4 else np.full_like(picture[..., :1], 255)
    return np.dstack([picture[..., :3] & np.uint8(KEPT), alpha])


def difference(found: Picture, wanted: Picture) -> NDArray[np.float32]:
    """(height, width, 3 or 4) float32, found less wanted, where alpha counts too."""
    return _softened(found) - _softened(wanted)


def _softened(picture: Picture) -> NDArray[np.float32]:
    """Colours times opacity, and opacity, each a mean of nine pixels: edges may fall anew."""
    soft = np.dstack([picture[..., :3] * (picture[..., 3:] / 255.0), picture[..., 3]])
    soft = soft.astype(np.float32)
    for axis in (0, 1):
        wide = np.pad(soft, [(1, 1) if axis == a else (0, 0) for a in range(3)], mode="edge")
        last = soft.shape[axis]
        soft = sum(wide.take(range(i, i + last), axis=axis) for i in range(3)) / 3.0
    return soft


def save(picture: Picture, file: Path) -> None:
    from PIL import Image

    opaque = bool((picture[..., 3] == 255).all())
    Image.fromarray(picture[..., :3] if opaque else picture).save(file, optimize=True)


def load(file: Path) -> Picture:
    """(height, width, 4)."""
    from PIL import Image

    return np.asarray(Image.open(file).convert("RGBA"))


def _grow(plant: str) -> None:
    """Scans of a small plant, baked."""
    from baker import Options, bake
    from grow.series import Plan, write_series

    seed, days, count = PLANTS[plant]
    plan = Plan(plant, seed=seed, scans=2, days=days, points=(count, count), suffix="txt")
    with tempfile.TemporaryDirectory() as folder:
        write_series(plan, Path(folder) / "scans")
        if plant == "tomato":
            last = sorted(Path(folder, "scans").glob("*.txt"))[-1]
            lines = last.read_text().splitlines(keepends=True)
            last.write_text("".join(line for line in lines if line.split()[-1] != LOST))
        options = Options(align="none", up="z", labels="consistent", unit="mm", workers=1)
        bake([Path(folder) / "scans"], options).save(FOLDER / f"{plant}.gclip")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help="which pictures; all of them if none is named")
    parser.add_argument("--clips", action="store_true", help="grow and bake their plants anew")
    args = parser.parse_args()
    FOLDER.mkdir(exist_ok=True)
    for plant in PLANTS if args.clips else ():
        _grow(plant)
    for golden in GOLDEN:
        if not args.names or golden.name in args.names:
            save(kept(golden.ways[0]()), golden.file)
            print(f"{golden.file.name:20}{golden.file.stat().st_size:8,}")


if __name__ == "__main__":
    main()
