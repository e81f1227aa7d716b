"""What becomes of the parts of organs that a later scan lacks: they leave, or are filled in.

A part that the organ has again later was hidden from the scanner; one that never comes back was cut
off. Hidden parts fade, or are carried on through the scans that lack them; cut ones leave as lost
organs do.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.missing import Part, Rest, missing_part
from baker.interpolation.movers import Keyframe
from baker.interpolation.resampling import point_surface
from baker.matching import IntervalOrgans, Match
from baker.options import Missing
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy
from gclip.clip import Motion

AGAIN = 0.9  # an organ that later has this share of its former surface was hidden, not cut
WILTED = 0.95  # share of its surface below which a plant has shrunk as a whole
SAMPLED = 20_000  # points of an organ, and of what it grows from, that tell where it is attached


@dataclass(frozen=True)
class Completed:
    """The series with hidden parts filled in, and per interval what leaves."""

    keyframes: list[Keyframe]
    matches: list[Match]
    parts: list[list[Part]]


def completed(
    keyframes: Sequence[Keyframe],
    matches: Sequence[Match],
    organs: Sequence[IntervalOrgans],
    names: Sequence[str],
    missing: str,
    decay: Motion,
) -> Completed:
    """Find the missing parts of matched organs, scan after scan, and settle them.

    names: of the scans; missing: a value of `Missing`; decay: how cut parts leave.
    """
    series = Completed(list(keyframes), list(matches), [[] for _ in matches])
    if missing == Missing.shrink:
        return series
    surfaces = [
        point_surface(frame.positions) if frame.surface is None else frame.surface
        for frame in keyframes
    ]
    later = _surfaces_of_organs(surfaces, matches, organs)
    for k in range(len(matches)):
        for a, b in series.matches[k].pairs:
            organ, match = organs[k].second[b], series.matches[k]
            rest = _rest(series.keyframes, surfaces, match, k, a, b)
            if rest is None or _others_shrink(surfaces[k], surfaces[k + 1], match, (a, b)):
                continue
            whole = surfaces[k][match.first.segments[a]].sum()
            hidden = any(own.get(organ, 0.0) >= AGAIN * whole for own in later[k + 2 :])
            points = match.first.segments[a][rest.missing]
            share = f"{surfaces[k][points].sum() / whole:.0%} of it"
            if hidden and missing == Missing.fill:
                surfaces[k + 1] = np.concatenate([surfaces[k + 1], surfaces[k][points]])
                _fill_in(series, k, b, points, rest)
                continue
            leaves = Motion.FADE if hidden else decay
            why = f"hidden in {names[k + 1]}" if hidden else f"cut off by {names[k + 1]}"
            series.parts[k].append(Part(organ, points, leaves, f"{share} is {why}"))
    return series


def _rest(
    keyframes: Sequence[Keyframe],
    surfaces: Sequence[NDArray[np.floating]],
    match: Match,
    k: int,
    a: int,
    b: int,
) -> Rest | None:
    before, after = match.first.segments[a], match.second.segments[b]
    if not len(before) or not len(after) or match.first.parents[a] == NO_PARENT:
        return None
    start, end = keyframes[k].positions, keyframes[k + 1].positions
    return missing_part(
        start.take(before, axis=0),
        end.take(after, axis=0),
        surfaces[k][before],
        surfaces[k + 1][after],
        lambda: (_base(start, match.first, a), _base(end, match.second, b)),
    )


def _base(points: NDArray[np.floating], hierarchy: Hierarchy, segment: int) -> NDArray[np.floating]:
    """The segment's point that is nearest to what it grows from."""
    from scipy.spatial import cKDTree

    own = points[_some(hierarchy.segments[segment])]
    bearer = _some(hierarchy.segments[hierarchy.parents[segment]])
    if not len(bearer):
        return own.mean(axis=0)
    return own[np.argmin(cKDTree(points[bearer]).query(own)[0])]


def _some(members: NDArray[np.intp]) -> NDArray[np.intp]:
    """At most SAMPLED of them, evenly: one bearer may have hundreds of organs to look for."""
    return members[:: -(-len(members) // SAMPLED) or 1]


def _others_shrink(
    before: NDArray[np.floating], after: NDArray[np.floating], match: Match, pair: tuple[int, int]
) -> bool:
    """Whether the rest of the plant shrinks as well: it wilts, or the series runs backwards."""
    others = [(a, b) for a, b in match.pairs if (a, b) != pair]
    had = sum(float(before[match.first.segments[a]].sum()) for a, _ in others)
    has = sum(float(after[match.second.segments[b]].sum()) for _, b in others)
    return has < WILTED * had


def _surfaces_of_organs(
    surfaces: Sequence[NDArray[np.floating]],
    matches: Sequence[Match],
    organs: Sequence[IntervalOrgans],
) -> list[dict[int, float]]:
    """For each scan the surface of each organ in it."""
    found: list[dict[int, float]] = [{}]
    for surface, match, named in zip(surfaces[1:], matches, organs, strict=True):
        segments = match.second.segments
        found.append(
            {organ: float(surface[segments[s]].sum()) for s, organ in named.second.items()}
        )
    return found


def _fill_in(series: Completed, k: int, segment: int, points: NDArray[np.intp], rest: Rest) -> None:
    """Give the next scan the points that it lacks, where the organ has taken them."""
    start, end = series.keyframes[k], series.keyframes[k + 1]
    carried = start.positions[points] @ rest.rotation.T + rest.shift
    added = np.arange(len(end.positions), len(end.positions) + len(points))
    series.keyframes[k + 1] = replace(
        end,
        positions=np.concatenate([end.positions, carried.astype(np.float32)]),
        colors=None
        if end.colors is None or start.colors is None
        else np.concatenate([end.colors, start.colors[points]]),
        surface=None
        if end.surface is None or start.surface is None
        else np.concatenate([end.surface, start.surface[points]]),
    )
    match = series.matches[k]
    series.matches[k] = replace(match, second=_with_points(match.second, segment, added))
    if k + 1 < len(series.matches):
        following = series.matches[k + 1]
        home = _same_segment(match.second, segment, following.first)
        series.matches[k + 1] = replace(following, first=_with_points(following.first, home, added))


def _with_points(hierarchy: Hierarchy, segment: int, added: NDArray[np.intp]) -> Hierarchy:
    segments = list(hierarchy.segments)
    segments[segment] = np.concatenate([segments[segment], added])
    return replace(hierarchy, segments=tuple(segments))


def _same_segment(before: Hierarchy, segment: int, after: Hierarchy) -> int:
    """The segment in which most of another hierarchy's segment of the same scan lies."""
    members = before.segments[segment]
    shared = [np.isin(members, other, assume_unique=True).sum() for other in after.segments]
    return int(np.argmax(shared))
