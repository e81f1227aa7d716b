"""Find scans that may not show the same plant as the others, or not while it grows."""

from collections.abc import Iterable, Sequence
from itertools import combinations, compress, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.alignment.icp import nearest_pairs
from baker.alignment.sample import EvenSample
from baker.geometry.graph import edge_components
from baker.geometry.neighbors import principal_spreads
from baker.geometry.parallel import MapLike
from baker.scans.scan import Finding

SCANS_AROUND = 2  # number of scans before and after a scan that it is compared with
# Dissimilarity of a scan to its neighbours in time, minus that of these to each other. It is
# exceeded by 2 % of 177 scans of 20 real series, by 92 % of scans of another species put into them,
# and by 59 % of those of another plant of the same species; in series of two by 3, 80 and 44 %.
MAX_EXCESS = 0.085
USUAL_DISSIMILARITY = 0.115  # of neighbours in time; used in a series of two scans
SLENDERNESS_WEIGHT = 0.75  # of the difference in slenderness, in sizes of the plant
PART_RADIUS = 0.16  # of neighbourhoods whose slenderness is compared, in sizes of the plant
MIN_SIZE = 1e-3  # of a scan, in sizes of the largest; of a neighbourhood, in sizes of the scan
LEAST_GROWTH = 0.92  # ratio of root mean square radii of successive scans; 0.96 in 20 real series
PART_GAP, PART_SHARE = 0.12, 0.05  # width in sizes of the scan, and share of the separate part


def same_plant_findings(
    samples: Sequence[EvenSample], transforms: NDArray[np.float64], map: MapLike = map
) -> list[Finding]:
    """Report scans that a single plant would hardly give while it grows, in at most one finding.

    transforms: (S, 4, 4) from the coordinates of each scan to those of the first one.
    """
    names = [sample.name for sample in samples]
    radii = np.sqrt([sample.points.var(axis=0).sum() for sample in samples])
    is_unlike = _excess_dissimilarities(samples, transforms, map) > MAX_EXCESS
    is_copy = [np.array_equal(a.points, b.points) for a, b in pairwise(samples)]
    is_smaller = radii[1:] < LEAST_GROWTH * radii[:-1]
    doubts: dict[str, Iterable[Any]] = {
        "of another plant or day, fallen or upside down: leave it out if so": is_unlike,
        "a copy of the scan before": [False, *is_copy],
        "incomplete, or of another day or scale, as plants hardly shrink": [False, *is_smaller],
        "several plants, as parts are far from each other": [*map(_is_in_parts, samples)],
    }
    doubted = {what: ", ".join(compress(names, which)) for what, which in doubts.items()}
    doubt = "; ".join(f"{named} may be {what}" for what, named in doubted.items() if named)
    return [Finding("plant", "taken for the same one in all scans", doubt)] if doubt else []


def _excess_dissimilarities(
    samples: Sequence[EvenSample], transforms: NDArray[np.float64], map: MapLike
) -> NDArray[np.float64]:
    """(S,) dissimilarity of scans to their neighbours in time, minus that of these to each other.

    The dissimilarity of two scans is the root mean square distance of their `nearest_pairs` in
    sizes of the plant, plus their weighted difference in slenderness. The neighbours of an unlike
    scan have an excess, too, but a smaller one, and are given 0.
    """
    count = len(samples)
    sizes = np.array([np.ptp(sample.points, axis=0).max() for sample in samples])
    sizes = np.maximum(sizes, MIN_SIZE * sizes.max() or 1.0)
    slenderness = list(map(_slenderness, samples, sizes))
    pairs = [(i, j) for i, j in combinations(range(count), 2) if j - i <= SCANS_AROUND]

    def compare(pair: tuple[int, int]) -> float:
        i, j = pair
        step = np.linalg.inv(transforms[i]) @ transforms[j]
        distance, _, _ = nearest_pairs(samples[i], samples[j], step)
        relative = distance / (np.sqrt(sizes[i]) * np.sqrt(sizes[j]))
        return relative + SLENDERNESS_WEIGHT * abs(slenderness[i] - slenderness[j])

    dissimilarity = np.full((count, count), np.nan)
    for (i, j), value in zip(pairs, map(compare, pairs), strict=True):
        dissimilarity[i, j] = dissimilarity[j, i] = value
    excess = np.zeros(count)
    for k in range(int(count == 2), count):
        adjacent = [j for j in range(count) if 0 < abs(j - k) <= SCANS_AROUND]
        among = dissimilarity[np.ix_(adjacent, adjacent)]
        usual = np.nanmean(among) if count > 2 else USUAL_DISSIMILARITY
        excess[k] = dissimilarity[k, adjacent].mean() - usual
    is_peak = [excess[k] == excess[max(k - 1, 0) : k + 2].max() for k in range(count)]
    return np.where(is_peak, excess, 0.0)


def _is_in_parts(sample: EvenSample) -> bool:
    """Whether a large part of a scan is far from the rest."""
    from scipy.spatial import cKDTree

    gap = PART_GAP * np.ptp(sample.points, axis=0).max()
    edges = cKDTree(sample.points).query_pairs(gap, output_type="ndarray").T
    sizes = np.bincount(edge_components(edges, len(sample.points)))
    return bool(len(sample.points) - sizes.max() > PART_SHARE * len(sample.points))


def _slenderness(sample: EvenSample, size: float) -> float:
    """Mean relative difference of length and width of neighbourhoods, from 0 to 1.

    It is large for grasses and small for leaflets, and hardly depends on growth and pose.
    """
    _, width, length = principal_spreads(sample.points, PART_RADIUS * size).T
    return float(np.mean((length - width) / np.maximum(length, MIN_SIZE * size)))
