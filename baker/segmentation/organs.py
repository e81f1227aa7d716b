"""Organs of scans without labels: stem with petioles, leaf blades, bare branches.

The scans are segmented from the last one back, and what the next one shows at the same place counts
too: a leaf that is plain on day 9 tells what was unfolding on day 5. What the scan before shows
would be no help: where the tip of a new leaf is, it has at best a stem.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.parallel import MapLike
from baker.segmentation.organ_classification import STEM, blade_scores, organs_of_nodes
from baker.segmentation.reeb_graph import PlantSample, ReebTree, reeb_tree, sample_plant

MIN_POINTS = 30  # points of a sample that shows organs
NEIGHBORS = 10  # of a point in the graph that geodesic distances follow
MAX_DISTANCE = 2.0  # of what the next scan shows of a point, in stem diameters
NEXT_WEIGHT = 0.5  # of what the next scan shows, against what is seen in the scan itself
MIN_TOUCHING_SHARE = 0.4  # of an organ's points beyond its base, that touch what it is part of
MAX_GAP = 3.0  # between points that touch, in point spacings
BASE_LENGTH = 2.0  # where any organ touches another, in level sets
TINY = np.finfo(np.float64).tiny


@dataclass(frozen=True)
class _Plant:
    """A scan, ready to be cut into organs; tree None where it shows none."""

    sample: PlantSample
    tree: ReebTree | None
    scores: NDArray[np.float64]

    def organs(self, from_later: NDArray[np.float64] | None) -> NDArray[np.intp]:
        """(n,) organ of each point of the sample; from_later: scores added by the next scan."""
        if self.tree is None:
            return np.zeros(len(self.sample.points), np.intp)
        node = self.tree.node
        scores = self.scores if from_later is None else self.scores + from_later
        return merge_strips(self.sample, organs_of_nodes(self.sample, self.tree, scores)[node])


def segment_organs(
    clouds: Sequence[NDArray[np.floating]], bases: Sequence[int], map: MapLike = map
) -> list[NDArray[np.int64]]:
    """Segment the scans of a plant into organs.

    Parameters
    ----------
    clouds : sequence of (N, 3) float
        Aligned scans.
    bases : sequence of int
        The point of each at the plant base.
    map : MapLike
        Maps a function over scans.

    Returns
    -------
    list of (N,) int64
        The organ of each point, 0 for stem and petioles. Other numbers of one scan mean nothing in
        another.
    """
    plants = list(map(_plant, clouds, bases))
    numbers, from_later = [], None
    for plant, earlier in zip(reversed(plants), [*reversed(plants[:-1]), None], strict=True):
        organ = plant.organs(from_later)
        numbers.append(organ[plant.sample.nearest].astype(np.int64))
        from_later = _scores_from(earlier, plant, organ) if earlier else None
    return numbers[::-1]


def _plant(cloud: NDArray[np.floating], base: int) -> _Plant:
    sample = sample_plant(cloud, base, NEIGHBORS)
    if sample.diameter == 0.0 or len(sample.points) < MIN_POINTS:
        return _Plant(sample, None, np.zeros(len(sample.points)))
    tree = reeb_tree(sample)
    return _Plant(sample, tree, blade_scores(sample, tree))


def _scores_from(
    plant: _Plant, later: _Plant, organ: NDArray[np.intp]
) -> NDArray[np.float64] | None:
    """(n,) blade scores of a plant's points by the organs of a later scan at the same place."""
    from scipy.spatial import KDTree

    if later.tree is None:
        return None
    distance, nearest = KDTree(later.sample.points).query(plant.sample.points)
    largest = max(MAX_DISTANCE * plant.sample.diameter, TINY)
    weight = NEXT_WEIGHT * (1.0 - np.minimum(distance, largest) / largest)
    return np.where(organ[nearest] == STEM, -weight, weight)


def merge_strips(sample: PlantSample, organ: NDArray[np.intp]) -> NDArray[np.intp]:
    """Merge organs that touch another one along most of their length, the smallest first.

    An organ touches its parent at its base, and others here and there. What touches one all along
    is a strip of it: sparse or patchy scans let a blade or stem look forked where it has a gap.

    organ: (n,) numbers from 0, the stem, on.
    """
    edges = sample.graph.tocoo()
    close = edges.data <= MAX_GAP * sample.spacing
    one, other = edges.row[close], edges.col[close]
    ends = np.concatenate([[one, other], [other, one]], axis=1)
    organ = organ.copy()
    while True:
        begin = np.full(organ.max() + 1, np.inf)
        np.minimum.at(begin, organ, sample.distance)
        far = sample.distance > begin[organ] + BASE_LENGTH * sample.thickness
        beyond = np.bincount(organ[far], minlength=len(begin))
        touching = ends[:, far[ends[0]] & (organ[ends[0]] != organ[ends[1]])]
        points = np.unique(np.stack([touching[0], organ[touching[1]]]), axis=1)
        pairs, counts = np.unique(
            np.stack([organ[points[0]], points[1]]), axis=1, return_counts=True
        )
        strips = counts > MIN_TOUCHING_SHARE * beyond[pairs[0]]
        strips &= beyond[pairs[0]] <= np.bincount(organ, minlength=len(begin))[pairs[1]]
        strips &= pairs[0] != 0
        if not strips.any():
            return organ
        smallest = np.flatnonzero(strips)[np.argmin(beyond[pairs[0, strips]])]
        organ[organ == pairs[0, smallest]] = pairs[1, smallest]
