"""Find the plant base, where the stem leaves the ground, in the scans of a series."""

from collections import Counter
from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import EvenSample, surface_graph
from baker.errors import InputError
from baker.geometry.graph import MIN_LENGTH, segment_gaps
from baker.geometry.neighbors import NEIGHBORS_FOR_RADIUS, Neighbors, nearest_neighbors
from baker.geometry.parallel import MapLike
from baker.geometry.up_axis import Vertical
from baker.scans.scan import Scan

CLOSE_SCORE = 0.4  # margin by which the usual label may score less than the best one of a scan
LOW_SHARE = 0.1  # of the height: the slab in which the base is searched for
MIN_PART_SHARE = 0.1  # of the largest component of that slab; smaller ones are noise
BASE_SHARE = 0.04  # of the height: the part of the stem whose centroid is the base
MAX_BASE_OFFSET = 0.06  # of the plant's largest size, between bases that are in one place

Points = NDArray[np.float64]


def stem_labels(samples: Sequence[EvenSample], vertical: Vertical, map: MapLike = map) -> list[int]:
    """The label of the stem in each scan: a low organ that is adjacent to many others.

    A hanging leaf may reach lower, but it is adjacent to few others, and most of it is high up. The
    label of the stem in two thirds of the scans is used in the others, too, if it scores well.
    """
    scores = list(map(partial(_stem_scores, vertical=vertical), samples))
    best_labels = [max(scan_scores, key=scan_scores.__getitem__) for scan_scores in scores]
    usual_label, count = Counter(best_labels).most_common(1)[0]
    margin = CLOSE_SCORE if 3 * count >= 2 * len(scores) else 0.0
    return [
        usual_label if scan_scores.get(usual_label, -np.inf) >= scan_scores[best] - margin else best
        for scan_scores, best in zip(scores, best_labels, strict=True)
    ]


def _stem_scores(sample: EvenSample, vertical: Vertical) -> dict[int, float]:
    """Score of each label as that of the stem, by the number of adjacent organs and the height."""
    labels, heights = sample.pool_labels, vertical.height(sample.pool)
    adjacent = Counter(label for label, _ in segment_gaps(sample.pool, labels))
    most_adjacent = max(adjacent.values(), default=1)
    heights = (heights - heights.min()) / max(np.ptp(heights), np.finfo(float).tiny)
    scores = {}
    for label in np.unique(labels).tolist():
        values = heights[labels == label]
        scores[label] = adjacent[label] / most_adjacent - float(values.min() + np.median(values))
    return scores


def common_base(
    samples: Sequence[EvenSample], stems: Sequence[int | None], vertical: Vertical
) -> tuple[Points, NDArray[np.bool_]]:
    """Find the plant bases, where possible in the one position on which most scans agree.

    A scan agrees with a position if its lowest points near the vertical through the position are
    there; a leaf that hangs lower is elsewhere. Of a scan with labels, only the stem is considered.

    stems: the label of the stem in each scan, None without labels. Returns the (S, 3) bases in the
    coordinates of each scan, and whether they are in that position, False for all if there is none
    on which two thirds of the scans agree.
    """
    clouds = [
        sample.points if stem is None else sample.pool[sample.pool_labels == stem]
        for sample, stem in zip(samples, stems, strict=True)
    ]
    bases = np.array([_likely_base(cloud, vertical) for cloud in clouds])
    radius = MAX_BASE_OFFSET * max(float(np.ptp(s.points, axis=0).max()) for s in samples)
    common = np.full_like(bases, np.nan)
    for base, sample in zip(bases, samples, strict=True):
        candidates = np.array(
            [
                _base_near(base + sample.offset - target.offset, cloud, radius, vertical)
                for target, cloud in zip(samples, clouds, strict=True)
            ]
        )
        if np.isnan(candidates).sum() < np.isnan(common).sum():
            common = candidates
    in_place = ~np.isnan(common[:, 0])
    if 3 * in_place.sum() < 2 * len(samples):
        in_place[:] = False
    return np.where(in_place[:, None], common, bases), in_place


def _base_near(position: Points, points: Points, radius: float, vertical: Vertical) -> Points:
    """(3,) base at the lowest points near the vertical through a position; NaN if far from it."""
    nearby = points[np.linalg.norm(vertical.at_height(points - position, 0.0), axis=1) <= radius]
    if not len(nearby) or abs(vertical.height(nearby - position).min()) > radius:
        return np.full(3, np.nan)
    return _lowest(nearby, vertical, np.ptp(vertical.height(points)))


def _likely_base(points: Points, vertical: Vertical) -> Points:
    """(3,) the likely plant base of a scan by itself, from (n, 3) points.

    The tip of a hanging leaf may be as low as the plant base. But the paths from the tip to other
    points first lead up the leaf and then down again, and are longer. So the base is the low
    component with the least sum of the longest path from it and of the mean descent on all paths.
    It is right in all 8 of 166 real scans that have several low components.
    """
    from scipy.sparse.csgraph import connected_components, dijkstra

    graph, heights = surface_graph(points), vertical.height(points)
    height = np.ptp(heights)
    low = np.flatnonzero(heights <= heights.min() + LOW_SHARE * height)
    _, component = connected_components(graph[low][:, low], directed=False)
    sizes = np.bincount(component)
    parts = [low[component == n] for n in np.flatnonzero(sizes >= MIN_PART_SHARE * sizes.max())]
    lowest = [part[np.argmin(heights[part])] for part in parts]
    longest = dijkstra(graph, indices=lowest).max(axis=1)
    starts, ends = graph.nonzero()
    graph.data = np.maximum(heights[starts] - heights[ends], MIN_LENGTH)
    descent = dijkstra(graph, indices=lowest).mean(axis=1)
    return _lowest(points[parts[np.argmin(longest + descent)]], vertical, height)


def _lowest(points: Points, vertical: Vertical, height: float) -> Points:
    """(3,) centroid of the lowest points of a stem of this height, at that of the lowest one."""
    heights = vertical.height(points)
    low = points[heights <= heights.min() + BASE_SHARE * height]
    return vertical.at_height(low.mean(axis=0)[None], heights.min())[0]


def base_point(
    points: NDArray[np.floating],
    vertical: Vertical,
    neighbors: Neighbors | None = None,
    near: NDArray[np.floating] | None = None,
) -> int:
    """Index of the point of a scan that is the base of the plant.

    It is the one nearest to `near`, the (3,) plant base, and by default the lowest one. Outliers
    among the (N, 3) points, as their `neighbors` tell, are ignored.
    """
    neighbors = neighbors or nearest_neighbors(points, NEIGHBORS_FOR_RADIUS)
    distance = vertical.height(points) if near is None else ((points - near) ** 2).sum(axis=1)
    return int(np.argmin(np.where(neighbors.inliers, distance, np.inf)))


def named_base(place: Sequence[float], scan: Scan) -> NDArray[np.float64]:
    """Convert the plant base that the user named to the (3,) local coordinates of the first scan.

    Raises InputError if it is farther from the scan than this is large.
    """
    base = np.asarray(place, float) - scan.origin
    distance = float(np.linalg.norm(scan.points - base, axis=1).min())
    size = float(np.ptp(scan.points, axis=0).max())
    if distance > size:
        raise InputError(
            f"--root is {distance:.3g} from '{scan.name}', which is {size:.3g} across; a place on "
            "the plant is needed."
        )
    return base
