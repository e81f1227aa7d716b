"""The spanning tree finds the true bifurcations of a thin tree (the preset tree1)."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from baker.alignment.stem_base import base_point
from baker.geometry.neighbors import point_spacing
from baker.geometry.up_axis import Vertical
from baker.segmentation.from_spanning_tree import hierarchy_from_spanning_tree
from grow import plant

SHORTEST = 4  # edges: a branch of more is a branch


def found_bifurcations(points: np.ndarray, threshold: int) -> np.ndarray:
    """(F, 3) where segments meet: each segment's point nearest to the one it grows from."""
    root = base_point(points, Vertical.named("z"))
    hierarchy = hierarchy_from_spanning_tree(points, root, threshold=threshold)
    bifurcations = []
    for segment, parent in enumerate(hierarchy.parents):
        if parent >= 0:
            own, other = points[hierarchy.segments[segment]], points[hierarchy.segments[parent]]
            distance, nearest = cKDTree(other).query(own)
            bifurcations.append(other[nearest[np.argmin(distance)]])
    return np.array(bifurcations)


@pytest.mark.parametrize("seed", [0, 1])
def test_true_bifurcations_are_found(seed):
    tree = plant("tree1", seed=seed)
    precise, recalled = [], []
    for day in tree.default_days:
        cloud = tree.cloud(day)
        points = cloud.points.astype(float)
        near = 6 * point_spacing(points)
        seen = set(cloud.labels.tolist())
        truth = [o.base for o in tree.organs(day) if o.parent >= 0 and o.label in seen]
        bifurcations = found_bifurcations(points, SHORTEST)
        precise += (cKDTree(truth).query(bifurcations)[0] < near).tolist()
        recalled += (cKDTree(bifurcations).query(truth)[0] < near).tolist()
    assert np.mean(precise) >= 0.9
    assert np.mean(recalled) >= 0.9
