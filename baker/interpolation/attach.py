"""Organs stay on what bears them: between two scans no base comes farther off than at the scans.

Transport takes points of a base to points farther on, and the bearer bends in its own way, so that
half-way the base itself may be away from its bearer. First the organ is drawn to it, what is near
the base as far as the base, the rest the less the farther it is. A path of low degree can't follow
every way. What gap is left is spanned by two movers more: one of the organ, from where it touches
its bearer at the first scan to where it does at the second, and one of the bearer along with it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.geometry.parallel import MapLike
from baker.interpolation.meeting import Curve, Organ, Tie, on_curve
from baker.interpolation.movers import Moved
from baker.matching import IntervalOrgans, Match
from baker.segmentation.hierarchy import NO_PARENT
from gclip.pack import raised

Bearers = Mapping[int, Sequence[int]]  # of each organ, all by their places among the tasks
Settled = tuple[Curve | None, list[Tie | None]]  # an organ's paths if drawn; its tie to each bearer


def attached(
    tasks: Sequence[Moved],
    match: Match,
    organs: IntervalOrgans,
    spacing: float,
    bend: bool = True,
    map: MapLike = map,
) -> list[Moved]:
    """The solved tasks of an interval, organs' bases kept by what bears them.

    spacing: the point spacing, which no gap may widen by.
    bend:    whether paths may be bent for it; straight ones are only tied.
    map:     maps a function over organs.
    """
    place = {
        int(moved.movers.tracks[0]): index
        for index, moved in enumerate(tasks)
        if len(moved.movers) and moved.end_points is not None
    }
    bearers = {
        place[organ]: [place[b] for b in found if b in place and b != organ]
        for organ, found in _bearers(match, organs).items()
        if organ in place
    }
    meetings = _Meetings(tasks, bearers, spacing, bend)
    order = _along_branches(bearers)
    settled = dict(zip(order, map(meetings.of, order), strict=True))
    done = list(tasks)
    movers: dict[int, list[Moved]] = {}
    for own, borne_by in bearers.items():
        curve, ties = settled.get(own, (None, []))
        if curve is not None:
            done[own] = on_curve(done[own], curve)
        for bearer, tie in zip(borne_by, ties, strict=True):
            if tie is not None:
                movers.setdefault(own, []).append(tie[0])
                movers.setdefault(bearer, []).append(tie[1])
    for index, more in movers.items():
        done[index] = _joined(done[index], *more)
    return done


def _along_branches(bearers: Bearers) -> list[int]:
    """The organs that have a bearer, each followed by what it bears: they need the same turns."""
    borne: dict[int, list[int]] = {}
    for own, found in bearers.items():
        for bearer in found[:1]:
            borne.setdefault(bearer, []).append(own)
    reached: dict[int, None] = {}
    for first in bearers:
        following = [first]
        while following:
            own = following.pop()
            if own not in reached:
                reached[own] = None
                following += reversed(borne.get(own, []))
    return [own for own in reached if bearers[own]]


@dataclass(frozen=True)
class _Turn:
    """When an organ is drawn to one of its bearers.

    wave: it comes after both have been drawn in smaller waves, and does not depend on larger ones.
    """

    own: int
    bearer: int
    wave: int


class _Meetings:
    """Draws organs to what bears them, any of them first and from any thread.

    What bears an organ has been drawn before. That is worked out wherever it is needed: organs are
    shared out without waiting for one another.
    """

    def __init__(
        self, tasks: Sequence[Moved], bearers: Bearers, spacing: float, bend: bool
    ) -> None:
        self._tasks, self._bearers, self._spacing = tasks, bearers, spacing
        self._turns = _turns(bearers) if bend else {}
        self._met: dict[_Turn, tuple[Moved, Tie | None]] = {}
        self._bearing: dict[tuple[int, _Turn | None], Organ] = {}

    def of(self, own: int) -> Settled:
        """One organ's paths and ties."""
        for turn in self._missing(own, *self._bearers[own]):
            self._met[turn] = self._drawn(turn)
        moved = self._moved(own)
        ties = [self._tie(own, bearer) for bearer in self._bearers[own]]
        return None if moved is self._tasks[own] else moved.movers.curve, ties

    def _missing(self, *organs: int) -> list[_Turn]:
        """Organs' turns and all that these depend on, in their order, as far as not yet met."""
        found: set[_Turn] = set()
        asked: list[tuple[int, int | None]] = [(organ, None) for organ in organs]
        while asked:
            for turn in self._until(*asked.pop()):
                if turn not in found and turn not in self._met:
                    found.add(turn)
                    asked.append((turn.bearer, turn.wave))
        return sorted(found, key=lambda turn: turn.wave)

    def _until(self, organ: int, wave: int | None = None) -> list[_Turn]:
        """An organ's turns before a wave, or all of them."""
        turns = self._turns.get(organ, [])
        return [turn for turn in turns if wave is None or turn.wave < wave]

    def _drawn(self, turn: _Turn) -> tuple[Moved, Tie | None]:
        """The organ after its turn, and what ties it to its bearer then."""
        moved = self._moved(turn.own, turn.wave)
        meeting = self._bearer(turn.bearer, turn.wave).met_by(Organ.of(moved), self._spacing)
        curve, tie = meeting.settled(draw=True) if meeting else (None, None)
        return moved if curve is None else on_curve(moved, curve), tie

    def _tie(self, own: int, bearer: int) -> Tie | None:
        mine, theirs = self._until(own), self._until(bearer)
        if mine and mine[-1].bearer == bearer and not (theirs and theirs[-1].wave > mine[-1].wave):
            return self._met[mine[-1]][1]
        # One of them was drawn once more after they had met.
        meeting = self._bearer(bearer).met_by(Organ.of(self._moved(own)), self._spacing)
        return meeting.settled(draw=False)[1] if meeting else None

    def _moved(self, organ: int, wave: int | None = None) -> Moved:
        """As it moves before a wave, or in the end."""
        turns = self._until(organ, wave)
        return self._met[turns[-1]][0] if turns else self._tasks[organ]

    def _bearer(self, organ: int, wave: int | None = None) -> Organ:
        """Ready to be met: many may grow from one."""
        key = organ, next(reversed(self._until(organ, wave)), None)
        if key not in self._bearing:
            self._bearing[key] = Organ.of(self._moved(organ, wave))
        return self._bearing[key]


def _turns(bearers: Bearers) -> dict[int, list[_Turn]]:
    """Each organ's turns, one after the other; a bearer comes first, if it can."""
    turns: dict[int, list[_Turn]] = {}
    last: dict[int, int] = {}
    for own, found in bearers.items():
        for bearer in found:
            last[own] = max(last.get(own, -1), last.get(bearer, -1)) + 1
            turns.setdefault(own, []).append(_Turn(own, bearer, last[own]))
    return turns


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


def _joined(moved: Moved, *ties: Moved) -> Moved:
    """The movers of all of them."""
    every = (moved, *ties)
    degree = max(len(one.movers.curve) for one in every) - 1
    curves = [raised(one.movers.curve, degree) for one in every]
    return replace(
        moved,
        movers=replace(
            moved.movers,
            curve=tuple(np.concatenate(points) for points in zip(*curves, strict=True)),
            tracks=np.concatenate([one.movers.tracks for one in every]),
            start_colors=_all([one.movers.start_colors for one in every]),
            end_colors=_all([one.movers.end_colors for one in every]),
        ),
        surface=_all([one.surface for one in every]),
        start_points=_all([one.start_points for one in every]),
        end_points=_all([one.end_points for one in every]),
        reach=_all([one.reach for one in every]),
    )


def _all(arrays: Sequence[NDArray[Any] | None]) -> NDArray[Any] | None:
    """One after the other; None where one is missing."""
    there = [array for array in arrays if array is not None]
    return np.concatenate(there) if len(there) == len(arrays) else None
