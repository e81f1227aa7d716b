"""Organs stay on what bears them: between two scans no base comes farther off than at the scans.

Transport takes points of a base to points farther on, and the bearer bends in its own way, so that
half-way the base itself may be away from its bearer. First the organ is drawn to it, what is near
the base as far as the base, the rest the less the farther it is. A path of low degree can't follow
every way. What gap is left is spanned by two movers more: one of the organ, from where it touches
its bearer at the first scan to where it does at the second, and one of the bearer along with it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.interval import Moved
from baker.match import IntervalOrgans, Match
from baker.motion.meeting import Curve, Organ, Tie, on_curve
from baker.segment.hierarchy import NO_PARENT
from baker.workers import ALONE, Crew
from gclip.pack import raised

FEWEST, TOGETHER = 4, 8  # groups that are worth sharing out; organs in one

Pair = tuple[int, int]  # an organ and what bears it, by their places among the tasks


def attached(
    tasks: Sequence[Moved],
    match: Match,
    organs: IntervalOrgans,
    spacing: float,
    bend: bool = True,
    crew: Crew = ALONE,
) -> list[Moved]:
    """The solved tasks of an interval, organs' bases kept by what bears them.

    spacing: the point spacing, which no gap may widen by.
    bend:    whether paths may be bent for it; straight ones are only tied.
    crew:    who shares the work.
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
    waves = _waves(meetings) if bend else []
    last = {own: number for number, wave in enumerate(waves) for own, _ in wave}
    ties: dict[Pair, Tie | None] = {}

    def meet(pairs: Sequence[Pair], draw: bool) -> Iterator[tuple[Pair, Curve | None, Tie | None]]:
        groups = _of_one_bearer(pairs)
        found = crew.map(partial(_meet, done, spacing, draw), groups, fewest=FEWEST)
        for group, results in zip(groups, found, strict=True):
            for pair, (curve, tie) in zip(group, results, strict=True):
                yield pair, curve, tie

    for number, wave in enumerate(waves):
        for (own, bearer), curve, tie in [*meet(wave, draw=True)]:
            if curve is not None:
                done[own] = on_curve(done[own], curve)
            if last[own] == number > last.get(bearer, -1):
                ties[own, bearer] = tie
    # One of the others was drawn once more after they had met.
    others = [pair for pair in meetings if pair not in ties]
    ties.update((pair, tie) for pair, _, tie in meet(others, draw=False))
    for own, bearer in meetings:
        tie = ties[own, bearer]
        if tie is not None:
            done[own], done[bearer] = _joined(done[own], tie[0]), _joined(done[bearer], tie[1])
    return done


def _meet(
    moving: Sequence[Moved], spacing: float, draw: bool, group: Sequence[Pair]
) -> list[tuple[Curve | None, Tie | None]]:
    """For each organ that one bearer bears: its paths where they are drawn to it, and its tie."""
    bearer = Organ.of(moving[group[0][1]])
    meetings = [bearer.met_by(Organ.of(moving[own]), spacing) for own, _ in group]
    return [meeting.settled(draw) if meeting else (None, None) for meeting in meetings]


def _of_one_bearer(pairs: Sequence[Pair]) -> list[list[Pair]]:
    """The pairs of an organ and its bearer, up to `TOGETHER` of a bearer in a group."""
    of_bearer: dict[int, list[Pair]] = {}
    for pair in pairs:
        of_bearer.setdefault(pair[1], []).append(pair)
    return [
        group[first : first + TOGETHER]
        for group in of_bearer.values()
        for first in range(0, len(group), TOGETHER)
    ]


def _waves(meetings: Sequence[Pair]) -> list[list[Pair]]:
    """Meetings in groups, one after the other; those of a group don't depend on each other.

    A bearer is drawn to what bears it before anything is drawn to it, as far as it comes first.
    """
    waves: list[list[Pair]] = []
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
