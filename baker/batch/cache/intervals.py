"""A folder of finished intervals, each a growth clip of its own."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from baker.batch.cache.key import NUMBERED, Key
from baker.batch.interval_job import IntervalJob
from baker.errors import InputError
from gclip import Clip, Interval, ScanMark, Track
from gclip.errors import ClipError
from gclip.pack import LEVELS, MAX_STEP


class IntervalCache:
    """Finished intervals in a folder, by their keys; many bakes may share it at once.

    An entry is a growth clip of one interval, so it is written whole or not at all, carries
    checksums, and runs no code when it is read. What is missing, damaged or somebody else's is
    not found, and so solved again. The folder may be deleted at any time.

    found:   how many intervals came from the folder; solved: how many did not.
    trouble: why intervals could not be kept, "" where they all were.
    """

    def __init__(self, folder: str | Path) -> None:
        """Raises InputError where the folder can't be made."""
        self.folder = Path(folder)
        self.found = self.solved = 0
        self.trouble = ""
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                f"{self.folder} can't be a cache: {error.strerror or error}."
            ) from None

    def get(self, key: Key, job: IntervalJob) -> Interval | None:
        """The job's interval if it is there and whole, else None."""
        interval = _read(self._path(key), key.digest)
        if interval is None or not packed_alike(interval, job.series_spacing, job.precision):
            return None
        self.found += 1
        return key.restored(interval, job.times)

    def put(self, key: Key, interval: Interval) -> None:
        """Keep an interval; a folder that can't take it is no reason to stop."""
        self.solved += 1
        path = self._path(key)
        kept = key.kept(interval)
        try:
            path.parent.mkdir(exist_ok=True)
            _clip_of(kept, key).save(path)
        except (OSError, ClipError) as error:
            self.trouble = self.trouble or str(error).rstrip(".")

    def told(self) -> str:
        """For people: how many intervals came from the folder, and what it did not take."""
        told = f"{self.found} of {self.found + self.solved} intervals"
        return f"{told}; not all others could be kept: {self.trouble}" if self.trouble else told

    def _path(self, key: Key) -> Path:
        return self.folder / key.digest[:2] / f"{key.digest}.gclip"


def _clip_of(interval: Interval, key: Key) -> Clip:
    return Clip(
        scans=tuple(ScanMark(name, time, "", 0) for name, time in zip("ab", NUMBERED, strict=True)),
        intervals=(interval,),
        track_table=tuple(Track(k, f"organ {k}", (0, 0, 0)) for k in range(len(key.organs))),
        provenance={"interval": key.digest},
    )


def _read(path: Path, name: str) -> Interval | None:
    import gclip
    from gclip.check import check

    if not path.exists() or not check(path).whole:
        return None
    try:
        clip = gclip.open(path)
    except ClipError:
        return None
    if clip.provenance.get("interval") != name or len(clip.intervals) != 1:
        return None
    # Copied, because a file that is mapped can be cut short by others.
    interval = clip.intervals[0]
    start, *control, end = (np.array(points) for points in interval.curve)
    colors = [
        None if c is None else np.array(c) for c in (interval.start_colors, interval.end_colors)
    ]
    return replace(
        interval,
        start_positions=start,
        end_positions=end,
        control_positions=tuple(control),
        start_colors=colors[0],
        end_colors=colors[1],
    )


def packed_alike(interval: Interval, spacing: float, precision: str) -> bool:
    """Whether packing the same movers with this point spacing gives this interval.

    False where that is a matter of rounding.
    """
    if precision == "float32":
        return interval.box is None
    step, finest = float(np.subtract(*interval.bounds[::-1]).max()) / LEVELS, MAX_STEP * spacing
    return abs(step - finest) > 1e-6 * finest and (interval.box is not None) == (step <= finest)
