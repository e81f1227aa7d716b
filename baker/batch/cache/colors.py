"""Colours left out of what is kept: a kept interval says which points its movers take them from.

Colours only ride along, no path depends on them. So the same movers serve whatever `--colors` asks.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.batch.interval_job import IntervalJob
from gclip import Interval

NUMBER = np.dtype("<u4")
OF_END = NUMBER.type(1 << 31)  # set in the number of a point of the interval's second scan


def numbered(job: IntervalJob) -> IntervalJob:
    """The job with points that carry, as their colours, their numbers."""
    return replace(
        job,
        start=replace(job.start, colors=_numbers(len(job.start.positions), NUMBER.type(0))),
        end=replace(job.end, colors=_numbers(len(job.end.positions), OF_END)),
    )


def colored(interval: Interval, job: IntervalJob) -> Interval:
    """The interval of a numbered job in the colours of the job as it is."""
    return replace(
        interval,
        start_colors=_looked_up(interval.start_colors, job),
        end_colors=_looked_up(interval.end_colors, job),
    )


def _numbers(count: int, flag: np.unsignedinteger) -> NDArray[np.uint8]:
    """(count, 4) bytes."""
    return (np.arange(count, dtype=NUMBER) | flag).view(np.uint8).reshape(count, 4)


def _looked_up(numbers: NDArray[np.uint8] | None, job: IntervalJob) -> NDArray[np.uint8] | None:
    start, end = job.start.colors, job.end.colors
    if numbers is None or start is None or end is None:
        return None
    point = np.ascontiguousarray(numbers).view(NUMBER)[:, 0]
    of_end = point >= OF_END
    point = np.where(of_end, point - OF_END, point)
    found = np.empty_like(numbers)
    found[of_end] = end[point[of_end]]
    found[~of_end] = start[point[~of_end]]
    return found
