"""Predict where organs are on their paths at mid-interval, from the intervals before and after.

Growth slows down, so at mid-interval an organ is usually beyond the middle of its path. This can be
estimated from the neighbouring intervals if the organ keeps its direction of motion. Organs that
sway change their direction from scan to scan, and are assumed to move evenly.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.matching.match import Match

# Cosine of an organ's displacements in two intervals: below the first, its speeds are not related,
# at the second they are (docs/method.md, "Motion of organs").
MIN_COSINE, FULL_COSINE = 0.9, 1.0
# The median of all organs: below it the plant sways, and organs keep their direction by chance. It
# is a threshold and not a weight, so that another scan does not change all intervals.
MIN_MEDIAN_COSINE = 0.95
MAX_OFFSET = 0.25  # in displacements; with more, a curve of degree 2 would turn back
MIN_DISPLACEMENT = 1.0  # in point spacings, of organs that have a direction of motion
MIN_SHIFT = 0.1  # in point spacings; smaller shifts are not visible
MIN_POINTS_FOR_RADIUS = 20  # of an organ whose growth is measured

Floats = NDArray[np.float64]
Clouds = Sequence[NDArray[np.floating]]


@dataclass(frozen=True)
class Timing:
    """How far beyond the middle of its path an organ is at mid-interval."""

    displacement: Floats  # (3,) of the organ's centroid
    offset: float  # of the centroid, as a share of its displacement
    radial_offset: float  # of growth about the centroid, as a share of the relative displacement

    def shift(self, start: NDArray[np.floating], end: NDArray[np.floating]) -> Floats:
        """(N, 3) offsets of movers between these points from the middle of their paths."""
        relative = np.asarray(end, float) - start - self.displacement
        return np.asarray(self.offset * self.displacement + self.radial_offset * relative)


def organ_timings(
    clouds: Clouds, matches: Sequence[Match], times: Sequence[float], spacing: float
) -> list[dict[int, Timing]]:
    """Estimate how far organs are beyond the middle of their paths at mid-interval.

    clouds, times, spacing: (N, 3) points and day of each scan, and their point spacing. matches: of
    each interval. Returns the timings of each interval by organ, without organs that move evenly.

    References
    ----------
    F. N. Fritsch and J. Butland (1984), A Method for Constructing Local Monotone Piecewise Cubic
    Interpolants: the speed at a scan is a weighted harmonic mean of the speeds before and after.
    """
    moved, grown = _changes(clouds, matches)
    length, spans = np.linalg.norm(moved, axis=2), np.diff(times)
    has_direction = np.minimum(length[:-1], length[1:]) > MIN_DISPLACEMENT * spacing
    cosines = _cosines(moved)[has_direction]
    if not len(cosines) or np.median(cosines) < MIN_MEDIAN_COSINE:
        return [{} for _ in matches]
    offsets, radial = _offsets(moved, spans, np.inf), _offsets(grown, spans, 0.0)
    shift = np.fmax(np.abs(offsets) * length, np.abs(radial * grown[:, :, 0]))
    return [
        {
            organ: Timing(moved[k, organ], float(offsets[k, organ]), float(radial[k, organ]))
            for organ in np.flatnonzero(shift[k] > MIN_SHIFT * spacing).tolist()
        }
        for k in range(len(matches))
    ]


def _changes(clouds: Clouds, matches: Sequence[Match]) -> tuple[Floats, Floats]:
    """(K, M, 3) displacements of the centroids and (K, M, 1) increases of the radii of M organs.

    They are NaN in intervals in which an organ is not matched or too small.
    """
    organs = 1 + max(organ for match in matches for organ in match.second.organs)
    moved = np.full((len(matches), organs, 3), np.nan)
    grown = np.full((len(matches), organs, 1), np.nan)
    for k, match in enumerate(matches):
        for a, b in match.pairs:
            start = clouds[k][match.first.segments[a]].astype(float)
            end = clouds[k + 1][match.second.segments[b]].astype(float)
            organ, count = match.second.organs[b], min(len(start), len(end))
            if count:
                moved[k, organ] = end.mean(axis=0) - start.mean(axis=0)
            if count >= MIN_POINTS_FOR_RADIUS:
                radii = [np.sqrt(points.var(axis=0).sum()) for points in (start, end)]
                grown[k, organ] = np.diff(radii)
    return moved, grown


def _offsets(changes: Floats, spans: Floats, limit: float) -> Floats:
    """(K, M) offset of organs beyond half of their (K, M, d) changes, as a share of the change.

    A cubic path from 0 to 1 is at 1/2 + (v - w) / 8 in the middle, with speeds v and w at its ends.
    At the ends of the series, the acceleration is continued from the other scan of the interval, up
    to `limit`. The offset is 0 where no speed is known.

    spans: (K,) durations of the intervals in days.
    """
    speed, span = np.linalg.norm(changes, axis=2) / spans[:, None], spans[:, None]
    weight, next_weight = span[:-1] + 2 * span[1:], 2 * span[:-1] + span[1:]
    trust = np.interp(_cosines(changes), (MIN_COSINE, FULL_COSINE), (0.0, 1.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        mean = (weight + next_weight) / (weight / speed[:-1] + next_weight / speed[1:])
        # Relative to the speed in the interval before, and in the one after the scan.
        before, after = (
            np.where(speed[:-1] * speed[1:] == 0, 0.0, trust * (mean / adjacent - 1))
            for adjacent in (speed[:-1], speed[1:])
        )
    unknown = np.full((1, speed.shape[1]), np.nan)
    first, last = np.concatenate([unknown, after]), np.concatenate([before, unknown])
    first, last = (
        np.where(np.isnan(first), np.minimum(-last, limit), first),
        np.where(np.isnan(last), np.minimum(-first, limit), last),
    )
    return np.clip(np.nan_to_num(first - last) / 8, -MAX_OFFSET, MAX_OFFSET)


def _cosines(changes: Floats) -> Floats:
    """(K - 1, M) cosines between (K, M, d) changes in successive intervals; 0 if one is 0."""
    length = np.linalg.norm(changes, axis=2)
    product = length[:-1] * length[1:]
    cosines = np.einsum("kmd,kmd->km", changes[:-1], changes[1:]) / np.where(product, product, 1.0)
    return np.asarray(cosines)
