"""What an interval depends on, and nothing else: the key under which it is kept."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from baker.batch.cache.digest import digest, program_digest
from baker.batch.interval_job import IntervalJob
from baker.matching import IntervalOrgans
from baker.segmentation.hierarchy import Hierarchy
from baker.transport.problem import Method, TransportOptions
from gclip import Interval, Motion

NUMBERED = (0.0, 1.0)  # the times that a kept interval has


@dataclass(frozen=True)
class Key:
    """Under which an interval is kept, and what it is called in its own series.

    digest: of what it is worked out from.
    organs: by the number that the kept interval calls it, what each organ is called in the series.
    """

    digest: str
    organs: tuple[int, ...]

    def kept(self, interval: Interval) -> Interval:
        """The interval without the names of its series: its times and its organs' numbers."""
        numbers = {organ: number for number, organ in enumerate(self.organs)}
        table = np.zeros(max(self.organs, default=0) + 1, np.int64)
        table[list(self.organs)] = np.arange(len(self.organs))
        return _named(interval, NUMBERED, table, numbers)

    def restored(self, interval: Interval, times: tuple[float, float]) -> Interval:
        """The kept interval as its series calls it."""
        return _named(interval, times, np.asarray(self.organs), dict(enumerate(self.organs)))


def key_of(job: IntervalJob) -> Key:
    """The key of a job's interval.

    When the interval is, and which numbers its organs have in the series, doesn't matter. Colours
    don't either: see `baker.batch.cache.colors`.
    """
    organs = _organs(job)
    return Key(digest(program_digest(), _renumbered(_bare(job), organs)), organs)


def _organs(job: IntervalJob) -> tuple[int, ...]:
    """The interval's organs in the order of its segments."""
    second = [job.organs.second[segment] for segment in sorted(job.organs.second)]
    first = [job.organs.first[segment] for segment in sorted(job.organs.first)]
    return tuple(dict.fromkeys(second + first))


def _renumbered(job: IntervalJob, organs: tuple[int, ...]) -> IntervalJob:
    numbers = {organ: number for number, organ in enumerate(organs)}
    first = {segment: numbers[organ] for segment, organ in job.organs.first.items()}
    second = {segment: numbers[organ] for segment, organ in job.organs.second.items()}
    return replace(
        job,
        organs=IntervalOrgans(first, second),
        tasks=tuple(replace(task, organ=numbers[task.organ]) for task in job.tasks),
        timings={numbers[organ]: timing for organ, timing in job.timings.items()},
    )


def _bare(job: IntervalJob) -> IntervalJob:
    """The job without what its movers do not depend on."""
    match = job.match
    lost = any(task.event == "loss" for task in job.tasks)
    falls = lost and job.decay is Motion.FALL
    return replace(
        job,
        times=NUMBERED,
        match=replace(
            match,
            first=_unlabelled(match.first),
            second=_unlabelled(match.second),
            notes=(),
            merges=(),
        ),
        floor=job.floor if falls else 0.0,
        decay=job.decay if lost else Motion.FALL,
        transport=_plain(job.transport),
        start=replace(job.start, colors=None),
        end=replace(job.end, colors=None),
        series_spacing=0.0,  # decides only how it is packed: see `packed_alike`
    )


def _plain(transport: TransportOptions) -> TransportOptions:
    """Without what this method does not read."""
    if transport.method == Method.SINKHORN:
        return replace(transport, workers=1)
    return TransportOptions(Method.EXACT, transport.power, seed=transport.seed)


def _unlabelled(hierarchy: Hierarchy) -> Hierarchy:
    return replace(hierarchy, labels=(), notes=())


def _named(
    interval: Interval,
    times: tuple[float, float],
    table: np.ndarray,
    numbers: dict[int, int],
) -> Interval:
    tracks = table[interval.tracks]
    return replace(
        interval,
        start=times[0],
        end=times[1],
        tracks=tracks.astype(np.uint16 if tracks.max() <= 0xFFFF else np.uint32),
        segments=tuple(replace(s, track=numbers[s.track]) for s in interval.segments),
    )
