"""Traits of a plant and its organs at a time: height, length, area, convex hull, angle."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from traits.axis import axis_of
from traits.organs import Organ, samples_at
from traits.smooth import fit_patches, noise_of, smoothed
from traits.surface import Surface, surface_of

if TYPE_CHECKING:
    from gclip import Clip

HULL_SUBSAMPLES = 4  # random halves of an organ's points, to extrapolate the volume of its hull
HULL_EXTRAPOLATION = 1.5  # times the difference to half the points: the deficit falls as count^-0.7
MIXING_DEFICIT = 1.0  # likewise, of points that come half from one scan and half from another
HULL_NOISE_LIFT = 0.5  # standard deviations of the noise by which it moves the hull outwards
# A hull is sure where both corrections are below these shares of its volume.
MAX_HULL_EXTRAPOLATION, MAX_HULL_NOISE = 0.12, 0.05
MIN_POINTS_FOR_SURE = 100
# Lengths are sure from this many mean point distances on, and up to this share of border points.
MIN_SURE_LENGTH, MAX_BORDER_FOR_LENGTH = 30.0, 0.33
MAX_BORDER_FOR_HULL, MAX_NOISE_LEFT = 0.25, 0.55
MAX_AREA_DOUBT = 0.3  # share of border points plus noise in mean point distances
NEGLIGIBLE_NOISE = 0.05  # mean point distances
MIN_SURE_AREA_SHARE = 0.8  # of the organs' area, for the plant's area to be sure
TRAITS = ("height", "length", "area", "hull", "angle")


@dataclass(frozen=True)
class Measurement:
    """Traits of one organ, or of the whole plant, at one time.

    Lengths are in the clip's unit. A trait is None where there are too few points, or where a plant
    has no such trait.

    Attributes
    ----------
    track : int or None
        Track id of the organ; None for the whole plant.
    height : float
        Of the highest point above the plant base.
    length : float or None
        Along the medial axis, from the attachment point to the tip.
    area : float or None
        Of the scanned surface: one side of a leaf, or both where both were scanned.
    hull : float or None
        Volume of the convex hull of the surface that the points were sampled from.
    angle : float or None
        Between the vertical and the first quarter of the axis, in degrees.
    sure : frozenset of str
        The traits that are within 5 % (5 degrees) of the truth in nine of ten such cases, measured
        on grown plants. Excluded are organs of few points, organs with detail finer than the point
        spacing, and organs that no scan has shown yet.
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
    """Measure the plant and its organs at a time.

    Lost organs count as long as they are part of the plant. An organ that is born between two scans
    does not count at the first of them, which does not show it.

    Parameters
    ----------
    clip : gclip.Clip
    day : float
        Time, in the clip's unit.
    only : collection of int, optional
        Track ids to measure, without the whole plant.

    Returns
    -------
    list of Measurement
        The whole plant, then its organs by track id.
    """
    plant = _Plant.of(clip)
    samples = samples_at(clip, day)
    found = [plant.measured(day, sample.organs, only) for sample in samples]
    return _weighted_mean(found, [sample.weight for sample in samples])


@dataclass(frozen=True)
class _Plant:
    """Facts of a clip that do not change in time."""

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
            up_vector(clip.up),
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
        patches = {track: fit_patches(one.points, one.cloud) for track, one in alive.items()}
        noise = noise_of(patches, known={track: one.known for track, one in alive.items()})
        smooth = {track: smoothed(fits, noise.of(track)) for track, fits in patches.items()}
        found, nothing = [], np.zeros((0, 3))
        for track, organ in ((track, organ) for track, organ in alive.items() if track in wanted):
            (points, left), own = smooth[track], noise.of(track)
            parent = self.parents.get(track)
            parent_points = nothing if parent not in smooth else smooth[parent].points
            axis = axis_of(points, parent_points, self.up)
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
        sure=sure if known > MIN_SURE_AREA_SHARE * surface else sure & {"height", "hull"},
    )


def _sure(surface: Surface, count: int, length: float, noise: float, left: float) -> frozenset[str]:
    """Traits of an organ that are likely within 5 % of the truth.

    Many border points, and noise that smoothing can't remove, tell of detail finer than the points.
    """
    sure = {"height"}
    spacing = float(np.sqrt(surface.area / max(count, 1)))
    if count >= MIN_POINTS_FOR_SURE and spacing > 0.0:
        sure |= {"angle"}
        if length > MIN_SURE_LENGTH * spacing and surface.border < MAX_BORDER_FOR_LENGTH:
            sure |= {"length"}
        if left < MAX_NOISE_LEFT or noise < NEGLIGIBLE_NOISE * spacing:
            if surface.border < MAX_BORDER_FOR_HULL:
                sure |= {"hull"}
            if surface.border + noise * np.sqrt(left) / spacing < MAX_AREA_DOUBT:
                sure |= {"area"}
    return frozenset(sure)


def _weighted_mean(found: list[list[Measurement]], weights: list[float]) -> list[Measurement]:
    """Weighted mean of the measurements on two samples of the plant; or those of the only one."""
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
    """Height of the plant base in the first scan, from which all heights are measured."""
    first = clip.at(clip.times[0])
    height = first.local.astype(np.float64) @ up_vector(clip.up)
    root = next((track.id for track in clip.track_table if track.parent is None), 0)
    own = height[first.tracks == root]
    # Quantiles, since a few outliers may float below; extrapolated by as much as lies between them.
    low, next_to_low = np.quantile(own if len(own) else height, [0.01, 0.02])
    return float(2.0 * low - next_to_low)


def up_vector(up: str) -> NDArray[np.float64]:
    """(3,) unit vector of an axis such as "-z"."""
    direction = np.zeros(3)
    direction["xyz".index(up[-1])] = -1.0 if up.startswith("-") else 1.0
    return direction


class _Hull(NamedTuple):
    """Volume, None for coplanar or too few points; and whether it is likely within 5 %."""

    volume: float | None
    sure: bool


def _hull(points: NDArray[np.float64], mixed: float = 0.0, noise: float = 0.0) -> _Hull:
    """Convex hull of the surface that (N, 3) points were sampled from.

    The hull of a sample is smaller than that of its surface: by count^-1 at faces, by count^-0.5 at
    borders. Richardson extrapolation from random halves of the points estimates the deficit. It is
    larger for half-way states of two scans, since extreme points of one seldom move to extreme
    points of the other. Noise moves the hull outwards, since the outermost points are those that
    noise moved out. The result is sure where both corrections are small.
    """
    from scipy.spatial import ConvexHull, QhullError

    rng = np.random.default_rng(0)
    orders = [rng.permutation(len(points)) for _ in range(HULL_SUBSAMPLES // 2)]
    parts = [half for order in orders for half in np.array_split(order, 2)]
    try:
        hull = ConvexHull(points)
        deficit = float(hull.volume - np.mean([ConvexHull(points[half]).volume for half in parts]))
    except (QhullError, ValueError):
        return _Hull(None, False)
    volume, taken = float(hull.volume), HULL_NOISE_LIFT * noise * float(hull.area)
    added = (HULL_EXTRAPOLATION + MIXING_DEFICIT * mixed) * deficit
    sure = added < MAX_HULL_EXTRAPOLATION * volume and taken < MAX_HULL_NOISE * volume
    return _Hull(max(volume + added - taken, 0.5 * volume), sure)
