"""Segment scans without labels into organs: stem with petioles, leaf blades, bare branches.

The scans are segmented from the last one to the first, and the organs of the next scan at the same
place are taken into account: a leaf that is unfolded on day 9 shows what the bud of day 5 is. The
previous scan would not help, since it has a stem or nothing at the place of a new leaf.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.parallel import MapLike
from baker.segmentation.organ_classification import STEM, blade_scores, organs_of_nodes
from baker.segmentation.reeb_graph import PlantSample, ReebTree, reeb_tree, sample_plant

MIN_POINTS = 30  # of a sample that is segmented
NEIGHBORS = 10  # of the kNN graph
MAX_DISTANCE = 2.0  # from a point to the next scan's, in stem diameters, where its weight is 0
NEXT_WEIGHT = 0.5  # greatest weight of the next scan; that of the scan itself is 1
MIN_TOUCHING_SHARE = 0.4  # of the points of a strip, except for its base, that touch its organ
MAX_GAP = 3.0  # between points that touch, in point spacings
BASE_LENGTH = 2.0  # of an organ's base, in level sets
TINY = np.finfo(np.float64).tiny


@dataclass(frozen=True)
class _Plant:
    """The sample, Reeb tree and blade scores of a scan; the tree is None if it is too small."""

    sample: PlantSample
    tree: ReebTree | None
    scores: NDArray[np.float64]

    def organs(self, next_scores: NDArray[np.float64] | None) -> NDArray[np.intp]:
        """(n,) organ of each point of the sample; next_scores: from the next scan, to be added."""
        if self.tree is None:
            return np.zeros(len(self.sample.points), np.intp)
        scores = self.scores if next_scores is None else self.scores + next_scores
        of_node = organs_of_nodes(self.sample, self.tree, scores)
        return merge_strips(self.sample, of_node[self.tree.node])


def segment_organs(
    clouds: Sequence[NDArray[np.floating]], bases: Sequence[int], map: MapLike = map
) -> list[NDArray[np.int64]]:
    """Segment the scans of a plant into organs.

    Parameters
    ----------
    clouds : sequence of (N, 3) float
        Aligned scans.
    bases : sequence of int
        Index of the point at the plant base, for each scan.
    map : map-like callable
        Maps over the scans.

    Returns
    -------
    list of (N,) int64
        The organ of each point, 0 for stem and petioles. Other organs are numbered independently in
        each scan.
    """
    plants = list(map(_prepare, clouds, bases))
    numbers, next_scores = [], None
    for plant, previous in zip(reversed(plants), [*reversed(plants[:-1]), None], strict=True):
        organ = plant.organs(next_scores)
        numbers.append(organ[plant.sample.nearest].astype(np.int64))
        next_scores = _scores_from_next(previous, plant, organ) if previous else None
    return numbers[::-1]


def _prepare(cloud: NDArray[np.floating], base: int) -> _Plant:
    sample = sample_plant(cloud, base, NEIGHBORS)
    if sample.diameter == 0.0 or len(sample.points) < MIN_POINTS:
        return _Plant(sample, None, np.zeros(len(sample.points)))
    tree = reeb_tree(sample)
    return _Plant(sample, tree, blade_scores(sample, tree))


def _scores_from_next(
    plant: _Plant, following: _Plant, organ: NDArray[np.intp]
) -> NDArray[np.float64] | None:
    """(n,) blade scores of the points of a scan, from the organs of the following scan there."""
    from scipy.spatial import KDTree

    if following.tree is None:
        return None
    distance, nearest = KDTree(following.sample.points).query(plant.sample.points)
    largest = max(MAX_DISTANCE * plant.sample.diameter, TINY)
    weight = NEXT_WEIGHT * (1.0 - np.minimum(distance, largest) / largest)
    return np.where(organ[nearest] == STEM, -weight, weight)


def merge_strips(sample: PlantSample, organ: NDArray[np.intp]) -> NDArray[np.intp]:
    """Merge organs that touch another one along most of their length, the smallest first.

    Such organs are strips of the other one: in sparse scans, a blade or stem with a gap seems to
    fork there. Other organs touch their parent only at the base.

    Parameters
    ----------
    sample : PlantSample
    organ : (n,) intp
        The organ of each point of the sample; 0 is the stem.

    Returns
    -------
    (n,) intp
    """
    edges = sample.graph.tocoo()
    is_close = edges.data <= MAX_GAP * sample.spacing
    i, j = edges.row[is_close], edges.col[is_close]
    ends = np.concatenate([[i, j], [j, i]], axis=1)
    organ = organ.copy()
    while True:
        base = np.full(organ.max() + 1, np.inf)
        np.minimum.at(base, organ, sample.distance)
        is_beyond = sample.distance > base[organ] + BASE_LENGTH * sample.thickness
        beyond = np.bincount(organ[is_beyond], minlength=len(base))
        touching = ends[:, is_beyond[ends[0]] & (organ[ends[0]] != organ[ends[1]])]
        contacts = np.unique(np.stack([touching[0], organ[touching[1]]]), axis=1)
        pairs, counts = np.unique(
            np.stack([organ[contacts[0]], contacts[1]]), axis=1, return_counts=True
        )
        is_strip = counts > MIN_TOUCHING_SHARE * beyond[pairs[0]]
        is_strip &= beyond[pairs[0]] <= np.bincount(organ, minlength=len(base))[pairs[1]]
        is_strip &= pairs[0] != STEM
        if not is_strip.any():
            return organ
        smallest = np.flatnonzero(is_strip)[np.argmin(beyond[pairs[0, is_strip]])]
        organ[organ == pairs[0, smallest]] = pairs[1, smallest]
