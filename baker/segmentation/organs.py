"""Organs of scans without labels: stem with petioles, leaf blades, bare branches.

The scans are cut from the last one back, and what the next one shows at the same place counts too:
a leaf that is plain on day 9 tells what was unfolding on day 5. What the scan before shows would be
no help: where the tip of a new leaf is, it has at best a stem.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.parallel import MapLike
from baker.segmentation.merging import join_touching
from baker.segmentation.organ_classification import STEM, blade_likeness, organs_of_nodes
from baker.segmentation.reeb_graph import LevelTree, level_tree
from baker.segmentation.voxel_sampling import EvenSample, even_sample

FEWEST = 30  # points of a sample that shows organs
NEIGHBORS = 10  # of the graph that ways along the plant follow
NEAR = 2.0  # how far off the next scan still tells something, in stem diameters
TRUST = 0.5  # in what the next scan tells, against what is seen in the scan itself
TINY = np.finfo(np.float64).tiny


@dataclass(frozen=True)
class _Plant:
    """A scan, ready to be cut into organs; tree None where it shows none."""

    sample: EvenSample
    tree: LevelTree | None
    likeness: NDArray[np.float64]

    def organs(self, told: NDArray[np.float64] | None) -> NDArray[np.intp]:
        """(n,) organ of each point of the sample; told: what the next scan tells of each."""
        if self.tree is None:
            return np.zeros(len(self.sample.points), np.intp)
        node = self.tree.node
        likeness = self.likeness if told is None else self.likeness + told
        return join_touching(self.sample, organs_of_nodes(self.sample, self.tree, likeness)[node])


def segment_organs(
    clouds: Sequence[NDArray[np.floating]],
    roots: Sequence[int],
    map: MapLike = map,
) -> list[NDArray[np.int64]]:
    """(N,) the organ of each point of each aligned (N, 3) cloud, 0 for stem and petioles.

    roots: the point at each stem's base. map: maps a function over scans. The numbers of one scan
    mean nothing in another, but 0.
    """
    plants = list(map(_seen, clouds, roots))
    numbers, told = [], None
    for plant, earlier in zip(reversed(plants), [*reversed(plants[:-1]), None], strict=True):
        organ = plant.organs(told)
        numbers.append(organ[plant.sample.nearest].astype(np.int64))
        told = _told(earlier, plant, organ) if earlier else None
    return numbers[::-1]


def _seen(cloud: NDArray[np.floating], root: int) -> _Plant:
    sample = even_sample(cloud, root, NEIGHBORS)
    if sample.diameter == 0.0 or len(sample.points) < FEWEST:
        return _Plant(sample, None, np.zeros(len(sample.points)))
    return _Plant(sample, level_tree(sample), blade_likeness(sample))


def _told(plant: _Plant, later: _Plant, organ: NDArray[np.intp]) -> NDArray[np.float64] | None:
    """(n,) what a later scan, with its organs, tells of a plant's points: blade or stem."""
    from scipy.spatial import cKDTree

    if later.tree is None:
        return None
    apart, nearest = cKDTree(later.sample.points).query(plant.sample.points)
    near = max(NEAR * plant.sample.diameter, TINY)
    trust = TRUST * (1.0 - np.minimum(apart, near) / near)
    return np.where(organ[nearest] == STEM, -trust, trust)
