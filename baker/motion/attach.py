"""Organs stay on what bears them: between two scans no base comes farther off than at the scans.

Transport takes points of a base to points farther on, and the bearer bends in its own way, so that
half-way the base itself may be away from its bearer. First the organ is drawn to it, what is near
the base as far as the base, the rest the less the farther it is. A path of low degree can't follow
every way. What gap is left is spanned by two movers more: one of the organ, from where it touches
its bearer at the first scan to where it does at the second, and one of the bearer along with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.interval import Moved
from baker.match import IntervalOrgans, Match
from baker.motion.meeting import Meeting, Organ
from baker.segment.hierarchy import NO_PARENT
from baker.workers import in_parallel
from gclip.pack import raised


def attached(
    tasks: Sequence[Moved],
    match: Match,
    organs: IntervalOrgans,
    spacing: float,
    bend: bool = True,
    workers: int = 1,
    pool: Executor | None = None,
) -> list[Moved]:
    """The solved tasks of an interval, organs' bases kept by what bears them.

    spacing: the point spacing, which no gap may widen by.
    bend:    whether paths may be bent for it; straight ones are only tied.
    workers: threads to use; pool: where to run them, one of its own by default.
    """
    done = list(tasks)
    place = {
        int(moved.movers.tracks[0]): index
        for index, moved in enumerate(tasks)
        if len(moved.movers) and moved.end_points is not None
    }
    meetings = [
        (place[organ], place[bearer])
        for organ, found in _bearers(match, organs).items()
        for bearer in found
        if organ in place and bearer in place and organ != bearer
    ]
    known: dict[int, Organ] = {}
    met: dict[tuple[int, int], Meeting] = {}

    def meet(pairs: Sequence[tuple[int, int]]) -> None:
        """See where the organs of these pairs come near each other, as they are now."""
        new = {i for pair in pairs for i in pair if i not in known or known[i].moved is not done[i]}
        looked = in_parallel(Organ.of, [done[i] for i in sorted(new)], workers, pool)
        known.update(zip(sorted(new), looked, strict=True))
        found = in_parallel(
            lambda p: known[p[1]].met_by(known[p[0]], spacing), pairs, workers, pool
        )
        met.update(zip(pairs, found, strict=True))

    for wave in _waves(meetings) if bend else ():
        meet(wave)
        drawn = in_parallel(lambda pair: met[pair].drawn(done[pair[0]]), wave, workers, pool)
        for (own, _), moved in zip(wave, drawn, strict=True):
            done[own] = moved
    # A bearer may have been drawn after what it bears.
    meet([pair for pair in meetings if pair not in met or met[pair].bearer is not done[pair[1]]])
    ties = in_parallel(lambda pair: met[pair].tied(done[pair[0]]), meetings, workers, pool)
    for (own, bearer), tie in zip(meetings, ties, strict=True):
        if tie is not None:
            done[own], done[bearer] = _joined(done[own], tie[0]), _joined(done[bearer], tie[1])
    return done


def _waves(meetings: Sequence[tuple[int, int]]) -> list[list[tuple[int, int]]]:
    """Meetings in groups, one after the other; those of a group don't depend on each other.

    A bearer is drawn to what bears it before anything is drawn to it, as far as it comes first.
    """
    waves: list[list[tuple[int, int]]] = []
    drawn_in: dict[int, int] = {}
    for own, bearer in meetings:
        wave = max(drawn_in.get(own, -1), drawn_in.get(bearer, -1)) + 1
        waves += [[]] * (wave == len(waves))
        waves[wave] = [*waves[wave], (own, bearer)]
        drawn_in[own] = wave
    return waves


def _bearers(match: Match, organs: IntervalOrgans) -> dict[int, list[int]]:
    """What each organ grows from, parents first: in the second scan, and when it was seen first."""
    bearers: dict[int, list[int]] = {}
    for segment in match.second.from_the_root():
        organ, parent = organs.second[segment], match.second.parents[segment]
        found = [organs.second[parent]] if parent != NO_PARENT else []
        first = organs.bearers.get(organ)
        if first is not None and first not in found:
            found.append(first)
        bearers[organ] = found
    return bearers


def _joined(moved: Moved, tie: Moved) -> Moved:
    """The movers of both."""
    degree = max(len(moved.movers.curve), len(tie.movers.curve)) - 1
    ours, more = (raised(m.movers.curve, degree) for m in (moved, tie))
    return replace(
        moved,
        movers=replace(
            moved.movers,
            curve=tuple(np.concatenate(points) for points in zip(ours, more, strict=True)),
            tracks=np.concatenate([moved.movers.tracks, tie.movers.tracks]),
            start_colors=_both(moved.movers.start_colors, tie.movers.start_colors),
            end_colors=_both(moved.movers.end_colors, tie.movers.end_colors),
        ),
        surface=_both(moved.surface, tie.surface),
        start_points=_both(moved.start_points, tie.start_points),
        end_points=_both(moved.end_points, tie.end_points),
    )


def _both(ours: NDArray[Any] | None, more: NDArray[Any] | None) -> NDArray[Any] | None:
    return None if ours is None or more is None else np.concatenate([ours, more])
