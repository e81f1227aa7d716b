"""Measure traits of a plant and its organs at a time: height, length, area, hull, angle."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from traits.axis import axis_of
from traits.neighbors import nearest_neighbors
from traits.organs import Organ, samples_at
from traits.smooth import fit_patches, noise_of, smoothed
from traits.surface import Surface, surface_of
from traits.upright import upright_axes

if TYPE_CHECKING:
    from gclip import Clip

HULL_SUBSAMPLES = 4  # number of random halves of an organ's points by which its hull is corrected
HULL_EXTRAPOLATION = 1.5  # deficit of the hull : that of half of the points, if it is count^-0.7
MIXING_DEFICIT = 1.0  # added to that ratio if half of the points are from either scan
HULL_NOISE_LIFT = 0.5  # outward displacement of the hull, in standard deviations of the noise
# Thresholds of the traits that are sure, in which mean point distances are the unit of length
# (docs/traits.md). Both corrections of the hull are relative to its volume.
MAX_HULL_EXTRAPOLATION, MAX_HULL_NOISE = 0.12, 0.05
MIN_POINTS_FOR_SURE = 100  # of an organ
MIN_SURE_LENGTH, MAX_BORDER_FOR_LENGTH = 30.0, 0.33  # least length; greatest share of border points
MAX_BORDER_FOR_HULL = 0.25  # share of border points
MAX_REMAINING_NOISE = 0.55  # share of the noise variance that smoothing leaves
MAX_AREA_DOUBT = 0.3  # share of border points plus the remaining noise
NEGLIGIBLE_NOISE = 0.05  # standard deviation
MIN_SURE_AREA_SHARE = 0.8  # of the plant's area that must be sure for the sum to be sure
TRAITS = ("height", "length", "area", "hull", "angle")


@dataclass(frozen=True)
class Measurement:
    """Traits of one organ, or of the whole plant, at one time.

    Lengths are in the clip's unit. A trait is None if there are too few points, or if it does not
    exist for the whole plant.

    Attributes
    ----------
    track : int or None
        Track id of the organ; None for the whole plant.
    height : float
        Height of the highest point above the plant base.
    length : float or None
        Along the medial axis, from the attachment point to the tip.
    area : float or None
        Area of the scanned surface: one side of a leaf, or both if both were scanned.
    hull : float or None
        Volume of the convex hull of the surface that the points were sampled from.
    angle : float or None
        Angle between the vertical and the first quarter of the axis, in degrees.
    sure : frozenset of str
        The traits whose error is below 5 % (5 degrees) in nine of ten such cases, measured on
        procedural plants. Excluded are organs with few points, with detail finer than the point
        spacing, or without any scan so far.
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

    Lost organs are measured as long as they are part of the plant. An organ that is born between
    two scans is not measured at the first of them.

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
    samples, floor = samples_at(clip, day), _floor(clip)
    measured = [_measure_sample(clip, day, sample.organs, only, floor) for sample in samples]
    return _weighted_mean(measured, [sample.weight for sample in samples])


def _measure_sample(
    clip: Clip,
    day: float,
    sampled: dict[int, Organ],
    only: Collection[int] | None,
    floor: float,
) -> list[Measurement]:
    """Measure the plant and its organs, or `only` some organs, on one sample of their points."""
    up, tracks = upright_axes(clip.up)[2], clip.track_table
    wanted = range(len(tracks)) if only is None else only
    needed = {*wanted, *(tracks[track].parent for track in wanted)}
    organs = {
        track: organ
        for track, organ in sorted(sampled.items())
        if day not in clip.times or tracks[track].born <= day
    }
    # The noise is estimated from all organs: an organ has the same traits whichever are wanted.
    patches = {track: fit_patches(o.points, o.cloud) for track, o in organs.items()}
    weights = {track: organ.noise_weight for track, organ in organs.items()}
    noise = noise_of(patches, weights)
    smooth = {
        track: smoothed(fits, noise.of(track)) for track, fits in patches.items() if track in needed
    }
    measured, no_points = [], np.zeros((0, 3))
    for track in (track for track in organs if track in wanted):
        organ, deviation, (points, remaining) = organs[track], noise.of(track), smooth[track]
        parent = tracks[track].parent
        parent_points = no_points if parent not in smooth else smooth[parent].points
        neighbors = nearest_neighbors(points)
        axis = axis_of(points, neighbors, parent_points, up)
        surface = surface_of(points, neighbors, remaining * deviation**2, organ.mixed)
        hull = _hull(points, organ.mixed, deviation)
        length = None if axis is None else axis.length
        sure = _sure_traits(surface, len(points), length or 0.0, deviation, remaining)
        sure = sure if hull.sure else sure - {"hull"}
        measured.append(
            Measurement(
                time=day,
                track=track,
                points=len(points),
                height=float((points @ up).max()) - floor,
                length=length,
                area=surface.area or None,
                hull=hull.volume,
                angle=None if axis is None else axis.angle(up),
                sure=sure if organ.in_previous_scan else frozenset(),
            )
        )
    if only is not None or not measured:
        return measured
    points = np.concatenate([organ.points for organ in smooth.values()])
    mixed = max(organ.mixed for organ in organs.values())
    return [_measure_whole(day, measured, points, mixed, noise.plant), *measured]


def _measure_whole(
    day: float, organs: list[Measurement], points: NDArray[np.float64], mixed: float, noise: float
) -> Measurement:
    """The traits of the whole plant, from those of its organs and all (N, 3) points."""
    hull = _hull(points, mixed, noise)
    area = sum(organ.area or 0.0 for organ in organs)
    sure_area = sum(organ.area or 0.0 for organ in organs if "area" in organ.sure)
    sure = frozenset(TRAITS if hull.sure else set(TRAITS) - {"hull"})
    return Measurement(
        time=day,
        track=None,
        points=len(points),
        height=max(organ.height for organ in organs),
        length=None,
        area=area or None,
        hull=hull.volume,
        angle=None,
        sure=sure if sure_area > MIN_SURE_AREA_SHARE * area else sure & {"height", "hull"},
    )


def _sure_traits(
    surface: Surface, count: int, length: float, noise: float, remaining: float
) -> frozenset[str]:
    """The traits of an organ whose error is likely below 5 %.

    Many border points, and noise that smoothing can't remove, indicate detail finer than the point
    spacing.
    """
    sure = {"height"}
    spacing = float(np.sqrt(surface.area / max(count, 1)))
    if count >= MIN_POINTS_FOR_SURE and spacing > 0.0:
        sure |= {"angle"}
        if length > MIN_SURE_LENGTH * spacing and surface.border < MAX_BORDER_FOR_LENGTH:
            sure |= {"length"}
        if remaining < MAX_REMAINING_NOISE or noise < NEGLIGIBLE_NOISE * spacing:
            if surface.border < MAX_BORDER_FOR_HULL:
                sure |= {"hull"}
            if surface.border + noise * np.sqrt(remaining) / spacing < MAX_AREA_DOUBT:
                sure |= {"area"}
    return frozenset(sure)


def _weighted_mean(measured: list[list[Measurement]], weights: list[float]) -> list[Measurement]:
    """The weighted mean of the measurements on one or two samples of the plant."""
    if len(measured) == 1:
        return measured[0]
    means = []
    for first, second in zip(*measured, strict=True):
        values = {}
        for trait in TRAITS:
            pair = getattr(first, trait), getattr(second, trait)
            available = [(v, w) for v, w in zip(pair, weights, strict=True) if v is not None]
            total = sum(weight for _, weight in available)
            values[trait] = sum(v * w for v, w in available) / total if available else None
        points, sure = max(first.points, second.points), first.sure & second.sure
        means.append(replace(first, points=points, sure=sure, **values))
    return means


def _floor(clip: Clip) -> float:
    """Height of the plant base in the first scan, from which all heights are measured."""
    first = clip.at(clip.times[0])
    height = first.local.astype(np.float64) @ upright_axes(clip.up)[2]
    root = next((track.id for track in clip.track_table if track.parent is None), 0)
    root_heights = height[first.tracks == root]
    # Extrapolated from two quantiles, since a few outliers may be below the plant.
    low, higher = np.quantile(root_heights if len(root_heights) else height, [0.01, 0.02])
    return float(2.0 * low - higher)


class _Hull(NamedTuple):
    """A convex hull."""

    volume: float | None  # None for coplanar or too few points
    sure: bool  # whether the error of the volume is likely below 5 %


def _hull(points: NDArray[np.float64], mixed: float = 0.0, noise: float = 0.0) -> _Hull:
    """Convex hull of the surface from which (N, 3) points were sampled.

    The hull of a sample is smaller than that of the surface: by count^-1 at faces, by count^-0.5 at
    borders. The deficit is estimated by Richardson extrapolation from random halves of the points.
    It is larger half-way between two scans, since extreme points of one rarely move to extreme
    points of the other. Noise moves the hull outwards, since the outermost points are those that it
    moved outwards. The result is sure if both corrections are small.

    mixed: as in `Organ`. noise: standard deviation, in the unit of the points.
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
    volume, noise_volume = float(hull.volume), HULL_NOISE_LIFT * noise * float(hull.area)
    missing = (HULL_EXTRAPOLATION + MIXING_DEFICIT * mixed) * deficit
    sure = missing < MAX_HULL_EXTRAPOLATION * volume and noise_volume < MAX_HULL_NOISE * volume
    return _Hull(max(volume + missing - noise_volume, 0.5 * volume), sure)
