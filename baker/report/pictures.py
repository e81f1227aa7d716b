"""Render the pictures of a report with the player.

The baker does not import the player, but runs its command `play` on the clip. A picture of one
interval is rendered from a clip of that interval alone, so that the camera is close to it.
"""

import base64
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from baker.geometry.parallel import worker_count
from gclip import Clip, ClipError
from traits.doubts import Doubt

PLAYER_TIMEOUT = 600.0  # seconds
SIZE = "300x300"  # of one picture
MAX_SCANS_PICTURED = 12  # number of scans that are shown
MAX_DOUBTS_PICTURED = 3  # number of the most doubtful intervals that are shown
NEUTRAL_COLOR = (150, 158, 146)  # of organs that are not in doubt

Job = tuple[Clip, Sequence[float], Sequence[str]]
"""The work of one player process: a clip, the times to render, and further options of `play`."""


class NoPicture(Exception):
    """The player could not render; the message is the reason."""


def scans_pictured(clip: Clip) -> list[int]:
    """Indices of the scans that the report shows: all, or evenly chosen ones."""
    count = len(clip.scans)
    even = np.linspace(0, count - 1, min(count, MAX_SCANS_PICTURED))
    return [round(index) for index in even.tolist()]


@dataclass(frozen=True)
class Pictures:
    """The pictures of a report, as data URLs."""

    scans: list[str]  #: those of `scans_pictured`, from one camera
    errors: list[str]  #: distance of the clip from each scan left out (the paper's Figure 13)
    doubts: list[list[str]]  #: start, middle and end of the most doubtful intervals


def take_pictures(
    clip: Clip, doubts: Sequence[Sequence[Doubt]], folder: Path | None = None, workers: int = 0
) -> Pictures:
    """Render the pictures of a report, with temporary files in `folder`.

    doubts: grouped by interval, the most doubtful one first. workers: number of players that render
    at the same time, 0 for the number of cores. Raises NoPicture if the player can't render, for
    example without EGL.
    """
    times_shown = [clip.times[k] for k in scans_pictured(clip)]
    held_out_times = [scan.time for scan in clip.held_out]
    jobs: list[Job] = [(clip, times_shown, ["--color=track", "--scale-bar"])]
    jobs += [(clip, held_out_times, ["--color=error", "--legend"])] if held_out_times else []
    for group in doubts[:MAX_DOUBTS_PICTURED]:
        start, end = group[0].start, group[0].end
        times = [start, (start + end) / 2, end]
        jobs.append((_doubtful_clip(clip, group), times, ["--color=track"]))
    with (
        TemporaryDirectory(dir=folder) as drafts,
        ThreadPoolExecutor(worker_count(workers)) as executor,
    ):
        paths = [Path(drafts, f"{number}.gclip") for number in range(len(jobs))]
        scans, *groups = executor.map(_render, jobs, paths)
    return Pictures(scans, errors=groups.pop(0) if held_out_times else [], doubts=groups)


def _doubtful_clip(clip: Clip, doubts: Sequence[Doubt]) -> Clip:
    """A clip of one interval, in which only the organs in doubt have colours."""
    k = clip.times.index(doubts[0].start)
    tracks = {doubt.track for doubt in doubts}
    table = tuple(
        track if track.id in tracks else replace(track, color=NEUTRAL_COLOR)
        for track in clip.track_table
    )
    scans, intervals = clip.scans[k : k + 2], clip.intervals[k : k + 1]
    return replace(clip, scans=scans, intervals=intervals, track_table=table, held_out=())


def _render(job: Job, path: Path) -> list[str]:
    """Write the clip to `path` and render it at its times; return the pictures as data URLs."""
    clip, times, options = job
    folder = path.with_suffix("")
    command = [sys.executable, "-m", "player", str(path), "--ground=light", "--quiet", *options]
    command += [f"--export={folder}/%d.jpg", f"--size={SIZE}", *(f"--day={t!r}" for t in times)]
    try:
        clip.save(path)
        result = subprocess.run(command, capture_output=True, text=True, timeout=PLAYER_TIMEOUT)
    except ClipError:
        raise NoPicture("there is no room for the clip that they are drawn from") from None
    except (OSError, subprocess.TimeoutExpired) as error:
        raise NoPicture(f"the player did not answer ({type(error).__name__})") from None
    if result.returncode:
        raise NoPicture((result.stderr.strip() or "the player said nothing").splitlines()[-1])
    files = [(folder / f"{number}.jpg").read_bytes() for number in range(len(times))]
    return ["data:image/jpeg;base64," + base64.b64encode(file).decode() for file in files]
