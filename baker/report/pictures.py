"""The report's pictures, rendered by our own player.

The baker does not import the player: it runs the command `play` on the clip or, where only one
interval is shown, on a clip of that alone, so that the camera is as near as that allows.
"""

import base64
import json
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from math import floor, log10
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.geometry.parallel import worker_count
from baker.verdict import Doubt
from gclip import Clip, ClipError

PLAYER_TIMEOUT = 600.0  # seconds
JPEG_QUALITY = 90  # a tenth of PNG's size, for the ground behind the plant is dithered
PIXELS = 90_000  # of one picture
MIN_ASPECT, MAX_ASPECT = 0.62, 1.5  # of a picture, width by height
MAX_SCANS_PICTURED = 12  # evenly chosen of more
MAX_DOUBTS_PICTURED = 3  # intervals, the most doubtful ones
MAX_BAR = 0.3  # of a picture's width
NEUTRAL_COLOR = (150, 158, 146)  # of organs that a picture is not about

Job = tuple[Clip, Sequence[float], str]
"""What one player draws: a clip, at these times, in the colours of this name."""


class NoPicture(Exception):
    """The player could not draw; the sentence says why."""


def scans_pictured(clip: Clip) -> list[int]:
    """Indices of the scans that the report shows."""
    count = len(clip.scans)
    even = np.linspace(0, count - 1, min(count, MAX_SCANS_PICTURED))
    return [round(index) for index in even.tolist()]


@dataclass(frozen=True)
class ScaleBar:
    """What the pictures of the scans have in common: their scale."""

    length: float  #: in the clip's unit; round
    share: float  #: of a picture's width that it takes


@dataclass(frozen=True)
class Pictures:
    """The pictures of a report, each as an address that holds all of it."""

    scans: list[str]  #: those of `scans_pictured`, from one camera
    scale_bar: ScaleBar
    errors: list[str]  #: the clip's distance from each scan left out (the paper's Figure 13)
    #: Of the most doubtful intervals: both scans and half-way, in colours the organs in doubt.
    doubts: list[list[str]]


def take_pictures(
    clip: Clip,
    doubts: Sequence[Sequence[Doubt]],
    folder: Path | None = None,
    workers: int = 0,
) -> Pictures:
    """Render the pictures of a report. Raises NoPicture where that can't be, as without EGL.

    doubts: by interval, the most doubtful one first. folder: where the player's files may lie
    meanwhile. workers: players that draw at a time; as many as there are cores if 0.
    """
    shown = [clip.times[k] for k in scans_pictured(clip)]
    held = [scan.time for scan in clip.held_out]
    jobs: list[Job] = [(clip, shown, "track")]
    jobs += [(clip, held, "error")] if held else []
    for own in doubts[:MAX_DOUBTS_PICTURED]:
        start, end = own[0].start, own[0].end
        jobs.append((_about(clip, own), [start, (start + end) / 2, end], "track"))
    with (
        TemporaryDirectory(dir=folder) as drafts,
        ThreadPoolExecutor(worker_count(workers)) as players,
    ):
        paths = [Path(drafts, f"{number}.gclip") for number in range(len(jobs))]
        drawn = list(players.map(_render, jobs, paths))
    (scans, view), *others = drawn
    rest = [pictures for pictures, _ in others]
    errors = rest.pop(0) if held else []
    return Pictures(scans, _scale_bar(clip, view), errors, doubts=rest)


def round_length(most: float) -> float:
    """The largest of 1, 2, 5, 10, ... that is no more than this."""
    power = 10.0 ** floor(log10(most))
    return max(digit * power for digit in (1.0, 2.0, 5.0) if digit * power <= most)


def _scale_bar(clip: Clip, view: NDArray[np.float64]) -> ScaleBar:
    """A round length at the depth of the plant's middle, from the (4, 4) matrix of the camera."""
    x, _, _, depth = view @ [*np.mean(clip.bounds, axis=0), 1.0]
    share = float(np.linalg.norm(view[0, :3] - x / depth * view[3, :3]) / depth / 2)
    length = round_length(MAX_BAR / share)
    return ScaleBar(length, length * share)


def _about(clip: Clip, doubts: Sequence[Doubt]) -> Clip:
    """The interval of the doubts alone, in colours only what they are about."""
    k = clip.times.index(doubts[0].start)
    tracks = {doubt.track for doubt in doubts}
    table = tuple(
        track if track.id in tracks else replace(track, color=NEUTRAL_COLOR)
        for track in clip.track_table
    )
    scans, intervals = clip.scans[k : k + 2], clip.intervals[k : k + 1]
    return replace(clip, scans=scans, intervals=intervals, track_table=table, held_out=())


def _render(job: Job, path: Path) -> tuple[list[str], NDArray[np.float64]]:
    """The clip, written to `path`, at these times; and the (4, 4) matrix of the camera."""
    import imageio.v3 as iio

    clip, days, color = job
    folder = path.with_suffix("")
    command = [sys.executable, "-m", "player", str(path), "--ground=light", "--quiet"]
    command += [f"--color={color}", f"--export={folder}/%d.png", f"--size={_picture_size(clip)}"]
    command += ["--legend"] if color == "error" else []
    command += [f"--day={day!r}" for day in days]
    try:
        clip.save(path)
        done = subprocess.run(command, capture_output=True, text=True, timeout=PLAYER_TIMEOUT)
    except ClipError:
        raise NoPicture("there is no room for the clip that they are drawn from") from None
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NoPicture(f"the player did not answer ({type(error).__name__})") from None
    if done.returncode:
        raise NoPicture((done.stderr.strip() or "the player said nothing").splitlines()[-1])
    jpeg: Any = {"extension": ".jpg", "quality": JPEG_QUALITY, "subsampling": 0, "optimize": True}
    names = [folder / f"{number}.png" for number in range(len(days))]
    files = [iio.imwrite("<bytes>", iio.imread(name), plugin="pillow", **jpeg) for name in names]
    view = np.array(json.loads(iio.immeta(names[0], plugin="pillow")["view"]))
    return ["data:image/jpeg;base64," + base64.b64encode(file).decode() for file in files], view


def _picture_size(clip: Clip) -> str:
    """`PIXELS` pixels, as wide by as high as what is to be seen."""
    sides = np.ptp(clip.bounds, axis=0)
    up = "xyz".index(clip.up[-1])
    aspect = np.delete(sides, up).max() / max(sides[up], 1e-9)
    aspect = float(np.clip(aspect, MIN_ASPECT, MAX_ASPECT))
    return f"{2 * round((PIXELS * aspect) ** 0.5 / 2)}x{2 * round((PIXELS / aspect) ** 0.5 / 2)}"
