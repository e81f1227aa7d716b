"""When an organ grows: how large it is half-way, by its course through the whole series.

An organ grows slowly, fast, slowly again. Between two scans in which it is small and large it is
smaller half-way than the mean of both, and later on larger. Its size at all scans that show it is
followed by a monotone cubic through the square roots (F. N. Fritsch and J. Butland, A Method for
Constructing Local Monotone Piecewise Cubic Interpolants, SIAM Journal on Scientific and Statistical
Computing 5, 1984): a power, for sizes grow by a factor while young and by an amount later on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from baker.interval import Moved
from baker.match import IntervalOrgans, Match
from baker.segment.hierarchy import NO_PARENT, Hierarchy
from gclip.evaluate import bernstein
from gclip.pack import raised

FEWEST = 3  # scans that tell a course
POWER = 0.5  # of the size, that a cubic follows
SAMPLE = 1000  # points of an organ that tell its size
AT_BASE = 0.02  # share of them that are its base
GROWING = 1.2  # times as large, that an organ becomes where its growth is more than noise
MATTERS = 0.002  # of its size, that an organ is larger or smaller


@dataclass(frozen=True)
class Growth:
    """size: of an organ half-way, as a share of the mean of both scans; base: (3,) half-way."""

    size: float
    base: NDArray[np.float64]


def growths(
    clouds: Sequence[NDArray[np.floating]],
    matches: Sequence[Match],
    organs: Sequence[IntervalOrgans],
    times: Sequence[float],
) -> list[dict[int, Growth]]:
    """For each interval, by segment of its second scan, how organs are grown half-way.

    The root is left out: it grows at its end only.
    """
    scans = [(matches[0].first, organs[0].first)] if matches else []
    scans += [(m.second, named.second) for m, named in zip(matches, organs, strict=True)]
    seen = [
        {
            named[segment]: _measured(cloud, hierarchy, segment)
            for segment in hierarchy.from_the_root()
            if len(hierarchy.segments[segment]) and hierarchy.parents[segment] != NO_PARENT
        }
        for cloud, (hierarchy, named) in zip(clouds, scans, strict=True)
    ]
    ends = [
        {named.second[b]: b for _, b in m.pairs} for m, named in zip(matches, organs, strict=True)
    ]
    found: list[dict[int, Growth]] = [{} for _ in matches]
    for organ in sorted({organ for scan in seen for organ in scan}):
        held = [k for k, scan in enumerate(seen) if organ in scan]
        sizes = np.array([seen[k][organ][0] for k in held])
        halves = half_way_sizes(np.asarray(times, float)[held], sizes)
        for k, later, half in zip(held[:-1], held[1:], halves, strict=True):
            if later == k + 1 and organ in ends[k]:
                base = (seen[k][organ][1] + seen[later][organ][1]) / 2
                found[k][ends[k][organ]] = Growth(float(half), base)
    return found


def half_way_sizes(times: NDArray[np.float64], sizes: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n - 1,) sizes half-way between (n,) successive times, as shares of the mean of their ends.

    Between the sizes at both ends, always. 1 where nothing is known for sure: of few scans, of an
    organ that shrinks or hardly grows, where noise tells as much as growth does, and of one that
    slows down, by what is known of one side only: on real plants a stop is sudden.
    """
    from scipy.interpolate import PchipInterpolator

    if len(times) < FEWEST or not (sizes > 0).all():
        return np.ones(len(times) - 1)
    course = PchipInterpolator(times, sizes**POWER)
    half = course((times[:-1] + times[1:]) / 2) ** (1 / POWER)
    share = half / ((sizes[:-1] + sizes[1:]) / 2)
    share[[0, -1]] = np.minimum(share[[0, -1]], 1.0)
    return np.where(sizes[1:] > GROWING * sizes[:-1], share, 1.0)


def grown(
    tasks: Sequence[Moved], match: Match, organs: IntervalOrgans, growth: Mapping[int, Growth]
) -> list[Moved]:
    """The solved tasks of an interval, organs half-way as large as they are by then.

    An organ keeps its shape and its base, and carries what grows on it.
    """
    carried = _carried(match, growth)
    segments = {organs.second[segment]: segment for segment in carried}
    done = []
    for moved in tasks:
        segment = segments.get(int(moved.movers.tracks[0])) if len(moved.movers) else None
        if segment is None or moved.end_points is None:
            done.append(moved)
            continue
        shift = np.broadcast_to(carried[segment], (len(moved.movers), 3))
        if segment in growth and not moved.born:
            shift = shift + _swelling(moved, growth[segment])
        done.append(_aside_half_way(moved, shift) if shift.any() else moved)
    return done


def _measured(
    cloud: NDArray[np.floating], hierarchy: Hierarchy, segment: int
) -> tuple[float, NDArray[np.float64]]:
    """How far an organ reaches from its base, as a root mean square, and (3,) where that is."""
    from scipy.spatial import cKDTree

    own = cloud[_some(hierarchy.segments[segment])].astype(float)
    bearer = cloud[_some(hierarchy.segments[hierarchy.parents[segment]])]
    if not len(bearer):
        bearer = np.median(cloud, axis=0, keepdims=True)
    apart = cKDTree(bearer).query(own)[0]
    nearest = np.argsort(apart, kind="stable")[: max(1, round(AT_BASE * len(own)))]
    base = own[nearest].mean(axis=0)
    return float(np.sqrt(((own - base) ** 2).sum(axis=1).mean())), base


def _some(members: NDArray[np.intp]) -> NDArray[np.intp]:
    if len(members) <= SAMPLE:
        return members
    return members[np.sort(np.random.default_rng(0).permutation(len(members))[:SAMPLE])]


def _carried(match: Match, growth: Mapping[int, Growth]) -> dict[int, NDArray[np.float64]]:
    """(3,) by segment: how far what bears it takes it aside half-way, where that grows."""
    carried: dict[int, NDArray[np.float64]] = {}
    for segment in match.second.from_the_root():
        parent = match.second.parents[segment]
        carried[segment] = carried.get(parent, np.zeros(3))
        if parent in growth and segment in growth:
            arm = growth[segment].base - growth[parent].base
            carried[segment] = carried[segment] + (growth[parent].size - 1.0) * arm
    return carried


def _swelling(moved: Moved, growth: Growth) -> NDArray[np.float64]:
    """(N, 3) how far an organ's movers are aside half-way for it to have its size by then."""
    if abs(growth.size - 1.0) < MATTERS:
        return np.zeros((len(moved.movers), 3))
    curve = moved.movers.curve
    middle = np.tensordot(bernstein(len(curve) - 1, 0.5), np.stack(curve), axes=1)
    return (growth.size - 1.0) * (middle - growth.base)


def _aside_half_way(moved: Moved, shift: NDArray[np.floating]) -> Moved:
    """Movers whose middle is shifted: the control point of degree 2 counts half there."""
    origin, control, target = raised(moved.movers.curve, 2)
    curve = (origin, (control + 2.0 * shift).astype(np.float32), target)
    return replace(moved, movers=replace(moved.movers, curve=curve))
