"""The report's pictures, rendered by our own player.

The baker does not import the player: it runs the command `play` on the clip or, where only one
interval is shown, on a clip of that alone, so that the camera is as near as that allows.
"""

import base64
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from baker.verdict import Doubt
from gclip import Clip

PLAYER_TIMEOUT = 600.0  # seconds
JPEG_QUALITY = 90  # a tenth of PNG's size, for the ground behind the plant is dithered
PIXELS = 200_000  # of one picture
MIN_ASPECT, MAX_ASPECT = 0.62, 1.5  # of a picture, width by height
MAX_SCANS_PICTURED = 12  # evenly chosen of more
MAX_DOUBTS_PICTURED = 4  # intervals, the most doubtful ones
NEUTRAL_COLOR = (150, 158, 146)  # of organs that a picture is not about

Pictures = list[str]
"""Each as an address that holds all of it."""


class NoPicture(Exception):
    """The player could not draw; the sentence says why."""


def scans_pictured(clip: Clip) -> list[int]:
    """Indices of the scans that the report shows."""
    count = len(clip.scans)
    even = np.linspace(0, count - 1, min(count, MAX_SCANS_PICTURED))
    return [round(index) for index in even.tolist()]


def take_pictures(
    clip: Clip, doubts: Sequence[Sequence[Doubt]], folder: Path | None = None
) -> dict[str, Pictures]:
    """Render the pictures of a report; `doubts` by interval, the most doubtful one first.

    Returns
    -------
    dict
        `scans`: those of `scans_pictured`, from one camera. `films` and `errors`: the clip at the
        time of each scan left out, and how far from it (the paper's Figure 13). `doubt-0`, ...:
        both scans of an interval and half-way, with the organs in doubt in their colours.

    Raises
    ------
    NoPicture
        Where the player can't draw, for example without EGL.
    """
    with TemporaryDirectory(dir=folder) as drafts:
        path = Path(drafts, "pictures.gclip")
        shown = [clip.times[k] for k in scans_pictured(clip)]
        held = [scan.time for scan in clip.held_out]
        pictures = _render(clip, path, [*shown, *held], "--color=track", "--scale-bar")
        found = {"scans": pictures[: len(shown)], "films": pictures[len(shown) :]}
        if held:
            found["errors"] = _render(clip, path, held, "--color=error", "--legend")
        for k, own in enumerate(doubts[:MAX_DOUBTS_PICTURED]):
            start, end = own[0].start, own[0].end
            days = [start, (start + end) / 2, end]
            found[f"doubt-{k}"] = _render(_about(clip, own), path, days, "--color=track")
        return found


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


def _render(clip: Clip, path: Path, days: Sequence[float], *options: str) -> Pictures:
    """The clip, written to `path`, at these times."""
    import imageio.v3 as iio

    clip.save(path)
    command = [sys.executable, "-m", "player", str(path), "--ground=light", "--quiet", *options]
    command += [f"--export={path.parent}/%d.png", f"--size={_picture_size(clip)}"]
    command += [f"--day={day!r}" for day in days]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=PLAYER_TIMEOUT)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NoPicture(f"the player did not answer ({type(error).__name__})") from None
    if done.returncode:
        raise NoPicture((done.stderr.strip() or "the player said nothing").splitlines()[-1])
    jpeg: Any = {"extension": ".jpg", "quality": JPEG_QUALITY, "subsampling": 0, "optimize": True}
    images = [iio.imread(path.with_name(f"{number}.png")) for number in range(len(days))]
    files = [iio.imwrite("<bytes>", image, plugin="pillow", **jpeg) for image in images]
    return ["data:image/jpeg;base64," + base64.b64encode(file).decode() for file in files]


def _picture_size(clip: Clip) -> str:
    """`PIXELS` pixels, as wide by as high as what is to be seen."""
    sides = np.ptp(clip.bounds, axis=0)
    up = "xyz".index(clip.up[-1])
    aspect = np.delete(sides, up).max() / max(sides[up], 1e-9)
    aspect = float(np.clip(aspect, MIN_ASPECT, MAX_ASPECT))
    return f"{2 * round((PIXELS * aspect) ** 0.5 / 2)}x{2 * round((PIXELS / aspect) ** 0.5 / 2)}"
