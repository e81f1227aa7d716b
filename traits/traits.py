"""What a plant measures at a time: each organ, and the whole."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from traits.axis import axis_of
from traits.organs import Organ, samples_at
from traits.smooth import noise_of, smoothed
from traits.surface import Surface, surface_of

if TYPE_CHECKING:
    from gclip import Clip

HALVES = 16  # samples of half of an organ's points that tell what its hull still lacks
LACKING = 1.5  # of what half the points lack more: volume falls short by about count^-0.7
INSIDE = 1.0  # of it, what points half of one scan and half of another lack besides
LIFTED = 0.5  # deviations of the noise by which it lifts a hull's faces
ADDED, TAKEN = 0.12, 0.05  # shares of a hull's volume: below both corrections, it is sure
SEEN = 100  # points of an organ of which anything but its height is sure
LONG, SLENDER = 30.0, 0.33  # mean distances, and share of points at a border: lengths are sure
BORDER, LEFT = 0.25, 0.55  # shares, of points at a border and of noise: below them, hulls are sure
ROUGH = 0.3  # share of points at a border and noise in mean distances: below it, areas are sure
SLIGHT = 0.05  # mean distances: noise that hardly matters
MOSTLY = 0.8  # of a plant's area that must be sure, for its area to be
TRAITS = ("height", "length", "area", "hull", "angle")


@dataclass(frozen=True)
class Measurement:
    """One organ, or with track None the whole plant, at one time. Lengths in the clip's unit;
    None where there are too few points to tell, or where a plant has no such thing.

    height: of the highest point above the plant's lowest.
    length: along the axis, from the attachment to the tip.
    area:   of the scanned surface: of a leaf one side, where both were scanned both.
    hull:   volume of the convex hull of the surface, not of its points alone.
    angle:  degrees between the vertical and the first quarter of the axis.
    sure:   the traits that are within 5 % (5 degrees) in nine of ten such cases: of
            organs shown by few points, or with forms finer than what lies between points, others
            are not; of organs that no scan has seen yet, none.
    """

    time: float
    track: int | None
    points: int
    height: float
    length: float | None
    area: float | None
    hull: float | None
    angle: float | None
    sure: frozenset[str] = frozenset(("height",))


def measure(clip: Clip, day: float, only: Collection[int] | None = None) -> list[Measurement]:
    """The whole plant, then its organs by track, at a time.

    Organs that are being lost count as long as they are part of the plant. What was born between
    two scans is a bud at the first of them, which did not see it: there it does not count.

    only: the tracks to measure, without the whole plant; None for all.
    """
    plant = _Plant.of(clip)
    samples = samples_at(clip, day)
    found = [plant.measured(day, sample.organs, only) for sample in samples]
    return _mixed(found, [sample.weight for sample in samples])


@dataclass(frozen=True)
class _Plant:
    """What stays the same all the time."""

    born: dict[int, float]
    parents: dict[int, int | None]
    scans: tuple[float, ...]
    up: NDArray[np.float64]
    floor: float

    @classmethod
    def of(cls, clip: Clip) -> _Plant:
        return cls(
            {track.id: track.born for track in clip.track_table},
            {track.id: track.parent for track in clip.track_table},
            tuple(clip.times),
            _up(clip.up),
            _floor(clip),
        )

    def measured(
        self, day: float, seen: dict[int, Organ], only: Collection[int] | None
    ) -> list[Measurement]:
        wanted = self.born.keys() if only is None else only
        needed = {*wanted, *(self.parents.get(track) for track in wanted)}
        alive = {
            track: organ
            for track, organ in sorted(seen.items())
            if track in needed and (day not in self.scans or self.born[track] <= day)
        }
        noise = noise_of(
            {track: (one.points, one.cloud) for track, one in alive.items()},
            known={track: one.known for track, one in alive.items()},
        )
        smooth = {
            track: smoothed(one.points, one.cloud, noise.of(track)) for track, one in alive.items()
        }
        found, nothing = [], np.zeros((0, 3))
        for track, organ in ((track, organ) for track, organ in alive.items() if track in wanted):
            (points, left), own = smooth[track], noise.of(track)
            parent = self.parents.get(track)
            bearer = nothing if parent not in smooth else smooth[parent].points
            axis = axis_of(points, bearer, self.up)
            surface = surface_of(points, left * own**2, organ.mixed)
            hull = _hull(points, organ.mixed, own)
            length = None if axis is None else axis.length
            sure = _sure(surface, len(points), length or 0.0, own, left)
            sure = sure if hull.sure else sure - {"hull"}
            found.append(
                Measurement(
                    time=day,
                    track=track,
                    points=len(points),
                    height=float((points @ self.up).max()) - self.floor,
                    length=length,
                    area=surface.area or None,
                    hull=hull.volume,
                    angle=None if axis is None else axis.angle(self.up),
                    sure=sure if organ.seen else frozenset(),
                )
            )
        if only is not None or not found:
            return found
        every = np.concatenate([organ.points for organ in smooth.values()])
        mixed = max(organ.mixed for organ in alive.values())
        return [_whole(day, found, every, mixed, noise.usual), *found]


def _whole(
    day: float, organs: list[Measurement], points: NDArray[np.float64], mixed: float, noise: float
) -> Measurement:
    areas = [one.area or 0.0 for one in organs]
    surface, hull = sum(areas), _hull(points, mixed, noise)
    sure = frozenset(TRAITS if hull.sure else set(TRAITS) - {"hull"})
    known = sum(one.area or 0.0 for one in organs if "area" in one.sure)
    return Measurement(
        time=day,
        track=None,
        points=len(points),
        height=max(one.height for one in organs),
        length=None,
        area=surface or None,
        hull=hull.volume,
        angle=None,
        sure=sure if known > MOSTLY * surface else sure & {"height", "hull"},
    )


def _sure(surface: Surface, count: int, length: float, noise: float, left: float) -> frozenset[str]:
    """What can be told of an organ from so many points, with such a share of the noise left: where
    its form is finer than its points are apart, they lie at borders, or can't be freed from noise.
    """
    sure = {"height"}
    spacing = float(np.sqrt(surface.area / max(count, 1)))
    if count >= SEEN and spacing > 0.0:
        sure |= {"angle"}
        if length > LONG * spacing and surface.border < SLENDER:
            sure |= {"length"}
        if left < LEFT or noise < SLIGHT * spacing:
            if surface.border < BORDER:
                sure |= {"hull"}
            if surface.border + noise * np.sqrt(left) / spacing < ROUGH:
                sure |= {"area"}
    return frozenset(sure)


def _mixed(found: list[list[Measurement]], weights: list[float]) -> list[Measurement]:
    """What was measured on two samples of the same plant, weighed; or on the only one."""
    if len(found) == 1:
        return found[0]
    mixed = []
    for one, other in zip(*found, strict=True):
        values = {}
        for trait in TRAITS:
            pair = getattr(one, trait), getattr(other, trait)
            known = [(v, w) for v, w in zip(pair, weights, strict=True) if v is not None]
            total = sum(weight for _, weight in known)
            values[trait] = sum(v * w for v, w in known) / total if known else None
        mixed.append(
            replace(
                one,
                points=max(one.points, other.points),
                sure=one.sure & other.sure,
                **values,
            )
        )
    return mixed


def _floor(clip: Clip) -> float:
    """Height of the root's foot in the first scan: heights of all days are measured from there."""
    first = clip.at(clip.times[0])
    height = first.local.astype(np.float64) @ _up(clip.up)
    root = next((track.id for track in clip.track_table if track.parent is None), 0)
    own = height[first.tracks == root]
    # Few points may be flying below it; that many hundredths of a stem stand between the two.
    low, next_to_low = np.quantile(own if len(own) else height, [0.01, 0.02])
    return float(2.0 * low - next_to_low)


def _up(up: str) -> NDArray[np.float64]:
    direction = np.zeros(3)
    direction["xyz".index(up[-1])] = -1.0 if up.startswith("-") else 1.0
    return direction


class _Hull(NamedTuple):
    """Its volume, None where points lie in one plane or are too few; and whether that is sure."""

    volume: float | None
    sure: bool


def _hull(points: NDArray[np.float64], mixed: float = 0.0, noise: float = 0.0) -> _Hull:
    """The convex hull of what (N, 3) points were scattered on.

    The hull of points falls short of the hull of what they lie on: at faces by count^-1, at borders
    by count^-0.5. How short, the hulls of halves of them tell (Richardson's extrapolation). Points
    half of one scan and half of another lack more: what is outermost in one seldom is in the other.
    Noise lifts faces, for what lies farthest out was moved outward. The larger these corrections
    are, the less sure is what they leave.
    """
    from scipy.spatial import ConvexHull, QhullError

    rng, half = np.random.default_rng(0), len(points) // 2
    parts = [points[rng.permutation(len(points))[:half]] for _ in range(HALVES)]
    try:
        hull = ConvexHull(points)
        lacking = float(hull.volume - np.mean([ConvexHull(part).volume for part in parts]))
    except (QhullError, ValueError):
        return _Hull(None, False)
    volume, taken = float(hull.volume), LIFTED * noise * float(hull.area)
    added = (LACKING + INSIDE * mixed) * lacking
    sure = added < ADDED * volume and taken < TAKEN * volume
    return _Hull(max(volume + added - taken, 0.5 * volume), sure)
