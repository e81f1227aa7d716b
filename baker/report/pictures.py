"""Pictures of point clouds, all from one camera, rendered by our own player.

The baker does not import the player: it writes a clip in which each picture is an interval of its
own without motion, and runs the command `play` on it. So all pictures share one camera, and the
metadata of each says where a point of the plant is in it.
"""

from __future__ import annotations

import base64
import json
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Motion, ScanMark, Track
from gclip.pack import Movers, pack_interval

PLAYER_TIMEOUT = 600.0  # seconds
JPEG_QUALITY = 90  # a tenth of PNG's size, for the ground behind the plant is dithered
PIXELS = 400_000  # of one picture
MARGIN, MIN_WINDOW = 1.2, 0.35  # of a part that is shown: a share of the plant, of the picture
MIN_ASPECT, MAX_ASPECT = 0.62, 1.5  # of a picture, width by height


class NoPicture(Exception):
    """The player could not draw; the sentence says why."""


class PictureRequest(NamedTuple):
    """What one picture shows."""

    points: NDArray[np.float32]  #: (N, 3) about the clip's origin
    colors: NDArray[np.uint8]  #: (N, 3) sRGB


@dataclass(frozen=True)
class Picture:
    """A rendered picture."""

    jpeg: bytes  #: the file
    size: tuple[int, int]  #: width and height in pixels
    view: NDArray[np.float64]  #: (4, 4) from local to OpenGL's clip coordinates, M @ column

    @property
    def uri(self) -> str:
        """The picture as an address that holds all of it."""
        return "data:image/jpeg;base64," + base64.b64encode(self.jpeg).decode("ascii")

    def project(self, points: NDArray[np.floating]) -> NDArray[np.float64]:
        """(N, 2) pixels from the top left corner at which (N, 3) local positions appear."""
        seen = np.column_stack([points, np.ones(len(points))]) @ self.view.T
        return np.asarray(self.size) * (1 + seen[:, :2] / seen[:, 3:] * [1, -1]) / 2

    def window(self, points: NDArray[np.floating]) -> tuple[float, float, float, float]:
        """The part of the picture, x, y, width and height, that shows (N, 3) local positions."""
        pixels, size = self.project(points), np.array(self.size, float)
        low, high = pixels.min(axis=0), pixels.max(axis=0)
        extent = size * min(max((MARGIN * (high - low) / size).max(), MIN_WINDOW), 1.0)
        x, y = np.clip((low + high - extent) / 2, 0.0, size - extent).round(1).tolist()
        return x, y, *extent.round(1).tolist()


def take_pictures(
    requests: Mapping[str, PictureRequest], like: Clip, folder: Path | None = None
) -> dict[str, Picture]:
    """Render pictures, by name, from the one camera that shows everything on any of them.

    Parameters
    ----------
    requests : mapping of str to PictureRequest
    like : Clip
        Whose up axis and point spacing hold for them.
    folder : Path, optional
        For temporary files; the system's by default.

    Raises
    ------
    NoPicture
        Where the player can't draw, for example without EGL.
    """
    with TemporaryDirectory(dir=folder) as drafts:
        path, clip = Path(drafts) / "pictures.gclip", _clip_of(list(requests.values()), like)
        clip.save(path)
        width, height = size = _picture_size(clip)
        command = [sys.executable, "-m", "player", str(path), "--export", f"{drafts}/%d.png"]
        command += [f"--size={width}x{height}", "--color=scan", "--ground=light", "--quiet"]
        command += [f"--day={number}" for number in range(len(requests))]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=PLAYER_TIMEOUT)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise NoPicture(f"the player did not answer ({type(error).__name__})") from None
        if done.returncode:
            raise NoPicture((done.stderr.strip() or "the player said nothing").splitlines()[-1])
        return {name: _read(Path(drafts, f"{n}.png"), size) for n, name in enumerate(requests)}


def _clip_of(requests: Sequence[PictureRequest], like: Clip) -> Clip:
    """A clip whose intervals, each of length 1, show the requested points at rest."""
    intervals = []
    for number, request in enumerate(requests):
        colors = np.insert(request.colors, 3, 255, axis=1)
        tracks = np.zeros(len(colors), np.uint16)
        movers = Movers(Motion.MOVE, (request.points, request.points), tracks, colors, colors)
        intervals.append(pack_interval(number, number + 1, [movers], spacing=like.spacing))
    return Clip(
        scans=tuple(ScanMark("", float(k), "", 0) for k in range(len(requests) + 1)),
        intervals=tuple(intervals),
        track_table=(Track(0, "", (0, 0, 0), kind="root"),),
        up=like.up,
        time_unit="scans",
        floor=like.floor,
        spacing=like.spacing,
    )


def _picture_size(clip: Clip) -> tuple[int, int]:
    """`PIXELS` pixels, as wide by as high as what is to be seen."""
    sides = np.ptp(clip.bounds, axis=0)
    up = "xyz".index(clip.up[-1])
    aspect = np.delete(sides, up).max() / max(sides[up], 1e-9)
    aspect = float(np.clip(aspect, MIN_ASPECT, MAX_ASPECT))
    return 2 * round((PIXELS * aspect) ** 0.5 / 2), 2 * round((PIXELS / aspect) ** 0.5 / 2)


def _read(path: Path, size: tuple[int, int]) -> Picture:
    import imageio.v3 as iio

    jpeg: Any = {"extension": ".jpg", "quality": JPEG_QUALITY, "subsampling": 0, "optimize": True}
    content = iio.imwrite("<bytes>", iio.imread(path), plugin="pillow", **jpeg)
    return Picture(content, size, np.array(json.loads(iio.immeta(path)["view"])))
