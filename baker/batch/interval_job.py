"""One interval's work as a unit that any thread, process or machine can do on its own."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from baker.geometry.parallel import MapLike
from baker.geometry.up_axis import Vertical
from baker.interpolation import Bend, Bending
from baker.interpolation.attachment import attached, attachment_finder
from baker.interpolation.births import births
from baker.interpolation.movers import Keyframe, Moved, solve_task
from baker.interpolation.resampling import with_even_density
from baker.interpolation.timing import Timing
from baker.matching import IntervalOrgans, Match
from baker.transport.problem import TransportOptions
from baker.transport.tasks import Task
from gclip import Interval, Motion
from gclip.pack import pack_interval


@dataclass(frozen=True)
class IntervalJob:
    """All that an interval's movers are worked out from: arrays, numbers and small dataclasses.

    What spans intervals is settled before: alignment, segments, which organ is which (`match`,
    `organs`), how growth is timed, the series' `floor` and `series_spacing`.

    times:    of the two scans, whose points are `start` and `end`.
    bases:    (3,) each, where the plant leaves the ground.
    timings:  by organ, where it doesn't move evenly.
    transport: `workers` in it does not count.
    limbs:    whether an organ's limbs are paired and moved one by one.
    decay:    how lost organs leave.
    curved:   whether organs deform along curved paths and stay attached to their parents, or
              move in straight lines.
    spacing:  the point spacing of the two scans, which says what gaps and bows matter.
    series_spacing: that of all scans, which says how fine the clip's positions have to be.
    even, precision: as in the options.
    """

    times: tuple[float, float]
    start: Keyframe
    end: Keyframe
    match: Match
    organs: IntervalOrgans
    bases: tuple[NDArray[np.floating], NDArray[np.floating]]
    tasks: tuple[Task, ...]
    timings: Mapping[int, Timing]
    vertical: Vertical
    floor: float
    spacing: float
    series_spacing: float
    transport: TransportOptions
    limbs: bool
    decay: Motion
    curved: bool
    even: float
    precision: str

    def __len__(self) -> int:
        """How many tasks there are: the steps of its progress."""
        return len(self.tasks)


def solve_interval(
    job: IntervalJob,
    map: MapLike = map,
    workers: int = 1,
    done: Callable[[int], None] = lambda steps: None,
) -> Interval:
    """The interval, ready for the clip. Deterministic, whatever the workers.

    map: maps a function over organs, by `workers` threads.
    done: called, in any thread, with how many more of the job's tasks are done.
    """
    return packed_interval(job, move_interval(job, map, workers, done), map)


def move_interval(
    job: IntervalJob,
    map: MapLike = map,
    workers: int = 1,
    done: Callable[[int], None] = lambda steps: None,
) -> list[Moved]:
    """Each task's movers on their paths; arguments as those of `solve_interval`."""
    total = sum(map(_size, job.tasks))
    clouds = job.start.positions, job.end.positions
    attachment = attachment_finder(clouds, job.match, job.organs)
    born = births(clouds[1], job.match, job.organs, job.timings) if job.curved else {}
    bending = Bending(clouds, job.match, job.organs, job.bases, job.spacing) if job.curved else None

    def solve(task: Task) -> tuple[Moved, Bend | None]:
        # Only what is more than one's share of the work is shared out itself.
        threads = workers if _size(task) * workers > total else 1
        moved = solve_task(
            task,
            job.start,
            job.end,
            transport=replace(job.transport, workers=threads),
            decay=job.decay,
            vertical=job.vertical,
            floor=job.floor,
            foot=attachment(task) if job.limbs else None,
            birth=born.get(task.organ) if task.event == "birth" else None,
            timing=job.timings.get(task.organ) if task.event == "match" else None,
        )
        bend = bending.of(moved) if bending else None
        done(1)
        return moved, bend

    # The largest first: none is left to a single thread in the end.
    order = sorted(range(len(job)), key=lambda k: -_size(job.tasks[k]))
    found = list(map(solve, [job.tasks[k] for k in order]))
    moved, bends = zip(*(found[k] for k in np.argsort(order)), strict=True)
    return bending.curved(moved, bends) if bending else [*moved]


def packed_interval(job: IntervalJob, solved: list[Moved], map: MapLike = map) -> Interval:
    """The interval's movers kept attached, made even and packed for the clip."""
    if job.curved:
        solved = attached(solved, job.match, job.organs, job.spacing)
    return pack_interval(
        *job.times,
        with_even_density(solved, job.even),
        spacing=job.series_spacing,
        precision=job.precision,
        segments=tuple(m.pair for m in solved),
    )


def _size(task: Task) -> int:
    return len(task.start) + len(task.end)
