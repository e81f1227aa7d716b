"""Pictures of point clouds, all from one camera, taken by our own player.

The baker does not import the player: it writes a storyboard, a clip in which each picture is a
still interval of its own, and runs the command `play` on it. So all pictures share one camera,
and the metadata of each says where a point of the plant is in it.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Motion, ScanMark, Track
from gclip.pack import Movers, pack_interval

PATIENCE = 600.0  # seconds for one batch
BATCH = 6  # pictures a run of the player at least: its start takes as long as five of them
RUNS = 4  # of the player for each worker, where there are many pictures
QUALITY = 90  # of JPEG: a tenth of PNG's size, for the ground behind the plant is dithered
PIXELS = 500_000  # of one picture
MARGIN = 0.1  # about a plant in its part of the picture, as a share of the plant
CLOSEST = 0.42  # smallest part of a picture that is shown, as a share of its sides
SQUAT, SLENDER = 1.5, 0.62  # widest and narrowest picture, width by height


class NoPicture(Exception):
    """The player could not draw; the sentence says why."""


@dataclass(frozen=True)
class Plate:
    """What one picture shows: (N, 3) positions about the clip's origin, (N, 3) uint8 sRGB."""

    points: NDArray[np.float32]
    colors: NDArray[np.uint8]


@dataclass(frozen=True)
class Window:
    """A part of a picture, in pixels from its top left corner."""

    x: float
    y: float
    width: float
    height: float

    @property
    def box(self) -> str:
        """As SVG's viewBox."""
        return f"{self.x} {self.y} {self.width} {self.height}"


@dataclass(frozen=True)
class Picture:
    """A picture taken.

    jpeg: the picture's file; size: (width, height) in pixels.
    view: (4, 4) from local coordinates to OpenGL's clip coordinates, M @ column.
    """

    jpeg: bytes
    size: tuple[int, int]
    view: NDArray[np.float64]

    def place(self, points: NDArray[np.floating]) -> NDArray[np.float64]:
        """(N, 2) pixels from the top left corner at which (N, 3) local positions appear."""
        seen = np.column_stack([points, np.ones(len(points))]) @ self.view.T
        across, along = (seen[:, :2] / seen[:, 3:]).T
        width, height = self.size
        return np.column_stack([width * (1 + across) / 2, height * (1 - along) / 2])

    def window(self, points: NDArray[np.floating]) -> Window:
        """The part of the picture that shows (N, 3) local positions, in the picture's shape."""
        places, size = self.place(points), np.array(self.size, float)
        low, high = places.min(axis=0), places.max(axis=0)
        share = max(((1 + 2 * MARGIN) * (high - low) / size).max(), CLOSEST)
        extent = min(share, 1.0) * size
        corner = np.clip((low + high - extent) / 2, 0.0, size - extent)
        x, y, width, height = np.round([*corner, *extent], 1).tolist()
        return Window(x, y, width, height)


def take_pictures(
    plates: Sequence[Plate],
    like: Clip,
    workers: int,
    done: Callable[[int], None] = lambda count: None,
    pixels: int = PIXELS,
    folder: Path | None = None,
) -> list[Picture]:
    """One picture a plate, all from the camera that shows everything on any of them.

    like:   the clip whose up axis and point spacing the plates share.
    folder: for temporary files; None leaves that to the system.

    Raises NoPicture where the player can't draw, for example without EGL.
    """
    if not plates:
        return []
    with TemporaryDirectory(dir=folder) as drafts:
        path = Path(drafts) / "storyboard.gclip"
        storyboard = _storyboard(plates, like)
        storyboard.save(path)
        size = _size(storyboard, pixels)
        batch = max(BATCH, -(-len(plates) // (RUNS * workers)))
        batches = [range(k, min(k + batch, len(plates))) for k in range(0, len(plates), batch)]
        pictures: list[Picture] = []
        executor = ThreadPoolExecutor(workers)
        try:
            for job in [executor.submit(_take, path, batch, size) for batch in batches]:
                pictures += job.result()
                done(len(pictures))
        finally:
            executor.shutdown(cancel_futures=True)
    return pictures


def _storyboard(plates: Sequence[Plate], like: Clip) -> Clip:
    intervals = []
    for number, plate in enumerate(plates):
        opaque = np.full((len(plate.points), 1), 255, np.uint8)
        colors = np.hstack([plate.colors, opaque])
        tracks = np.zeros(len(plate.points), np.uint16)
        movers = Movers(Motion.MOVE, (plate.points, plate.points), tracks, colors, colors)
        intervals.append(pack_interval(number, number + 1, [movers], spacing=like.spacing))
    return Clip(
        scans=tuple(ScanMark("", float(k), "", 0) for k in range(len(plates) + 1)),
        intervals=tuple(intervals),
        track_table=(Track(0, "", (0, 0, 0), kind="root"),),
        up=like.up,
        time_unit="scans",
        floor=like.floor,
        spacing=like.spacing,
    )


def _size(storyboard: Clip, pixels: int) -> tuple[int, int]:
    """As many pixels, as wide by as high as what is to be seen."""
    low, high = storyboard.bounds
    up = "xyz".index(storyboard.up[-1])
    height = float((high - low)[up])
    width = float(np.delete(high - low, up).max())
    aspect = min(max(width / max(height, 1e-9), SLENDER), SQUAT)
    return 2 * round((pixels * aspect) ** 0.5 / 2), 2 * round((pixels / aspect) ** 0.5 / 2)


def _take(storyboard: Path, numbers: range, size: tuple[int, int]) -> list[Picture]:
    folder = storyboard.with_name(f"from-{numbers.start}")
    folder.mkdir()
    command = [sys.executable, "-m", "player", str(storyboard), "--export", f"{folder}/%d.png"]
    options = [f"--size={size[0]}x{size[1]}", "--color=scan", "--ground=light", "--quiet"]
    days = [f"--day={number}" for number in numbers]
    try:
        finished = subprocess.run(
            [*command, *options, *days], capture_output=True, text=True, timeout=PATIENCE
        )
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NoPicture(f"the player did not answer ({type(error).__name__})") from None
    if finished.returncode:
        said = finished.stderr.strip().splitlines() or ["the player said nothing"]
        raise NoPicture(said[-1])
    return [_read(folder / f"{index}.png", size) for index in range(len(numbers))]


def _read(path: Path, size: tuple[int, int]) -> Picture:
    import imageio.v3 as iio

    small = iio.imwrite(
        "<bytes>", iio.imread(path), extension=".jpg", plugin="pillow",
        quality=QUALITY, subsampling=0, optimize=True,
    )  # fmt: skip
    return Picture(small, size, np.array(json.loads(iio.immeta(path)["view"])))
