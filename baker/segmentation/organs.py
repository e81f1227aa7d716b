"""Segment scans without labels into organs: stem with petioles, leaf blades, bare branches.

The scans are segmented from the last one to the first, and the organs of the next scan at the same
position are taken into account: a leaf that is unfolded on day 9 identifies its bud of day 5. The
previous scan would not help, since a new leaf has no organ, or the stem, in its position there.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.geometry.parallel import MapLike
from baker.segmentation.organ_classification import STEM, blade_scores, organs_of_nodes
from baker.segmentation.reeb_graph import PlantSample, ReebTree, reeb_tree, sample_plant

Points = NDArray[np.floating]
Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

# docs/method.md, "Organs without labels".
MAX_DISTANCE = 2.0  # stem diameters to the next scan, at which its weight is 0
NEXT_WEIGHT = 0.5  # greatest weight of the next scan; that of the scan itself is 1
MIN_TOUCHING_SHARE = 0.4  # of the points of a strip, except for its base, that touch its organ
MAX_GAP = 3.0  # point spacings between points that touch
BASE_LENGTH = 2.0  # of an organ, where it touches its parent; in thicknesses of a level set


def segment_organs(
    clouds: Sequence[Points], bases: Sequence[int], map: MapLike = map
) -> list[NDArray[np.int64]]:
    """Segment the scans of a plant into organs by their shape.

    Parameters
    ----------
    clouds, bases : sequences
        For each aligned scan: (N, 3) points, the index of the one at the plant base.
    map : map-like callable
        Maps over the scans.

    Returns
    -------
    list of (N,) int64
        The organ of each point, 0 for stem and petioles. Other organs are numbered independently in
        each scan.
    """
    numbers, following = [], None
    for sample, tree, scores in reversed(list(map(_prepare, clouds, bases))):
        organ = np.zeros(len(sample.points), np.intp)
        if tree is not None:
            if following is not None:
                scores = scores + _scores_from_next(sample, *following)
            organ = merge_strips(sample, organs_of_nodes(sample, tree, scores)[tree.node])
        following = None if tree is None else (sample, organ)
        numbers.append(organ[sample.nearest].astype(np.int64))
    return numbers[::-1]


def _prepare(cloud: Points, base: int) -> tuple[PlantSample, ReebTree | None, Floats | float]:
    """The sample, Reeb tree and blade scores of a scan; no tree if the scan is too small."""
    sample = sample_plant(cloud, base)
    tree = reeb_tree(sample) if sample.diameter > 0.0 else None
    return sample, tree, 0.0 if tree is None else blade_scores(sample, tree)


def _scores_from_next(sample: PlantSample, following: PlantSample, organ: Indices) -> Floats:
    """(n,) blade scores of the points of a scan, from the nearest organs of the following scan."""
    from scipy.spatial import cKDTree

    distance, nearest = cKDTree(following.points).query(sample.points)
    weight = np.maximum(1.0 - distance / (MAX_DISTANCE * sample.diameter), 0.0)
    return NEXT_WEIGHT * np.where(organ[nearest] == STEM, -weight, weight)


def merge_strips(sample: PlantSample, organ: Indices) -> Indices:
    """Merge organs that touch another organ along most of their length, the smallest first.

    Such an organ is a strip of the one it touches: in sparse scans, a blade or stem with a gap
    seems to fork there. Separate organs touch their parent only at the base.

    organ: (n,) of each point of the sample; 0 is the stem.
    """
    from scipy.sparse import csr_matrix

    adjacency, organ = sample.graph.copy(), organ.copy()
    row_starts = np.arange(len(organ) + 1)  # one entry in each row
    adjacency.data = (adjacency.data <= MAX_GAP * sample.spacing).astype(np.float64)
    adjacency = adjacency + adjacency.T
    while True:
        m = organ.max() + 1
        # (n, m) indicators of m organs
        is_of = csr_matrix((np.ones(len(organ)), organ, row_starts), (len(organ), m))
        base = np.full(m, np.inf)
        np.minimum.at(base, organ, sample.distance)
        is_beyond = sample.distance > base[organ] + BASE_LENGTH * sample.thickness
        size, beyond_size = (np.bincount(part, minlength=m) for part in (organ, organ[is_beyond]))
        # (m, m) number of points of the row's organ that touch the column's
        touching = (is_of[is_beyond].T @ (adjacency @ is_of > 0.0)[is_beyond]).toarray()
        is_smaller = beyond_size[:, None] <= size
        is_strip = is_smaller & (touching > MIN_TOUCHING_SHARE * beyond_size[:, None])
        is_strip[STEM] = False
        np.fill_diagonal(is_strip, False)
        if not is_strip.any():
            return organ
        smallest = np.where(is_strip.any(axis=1), beyond_size, np.inf).argmin()
        organ[organ == smallest] = is_strip[smallest].argmax()
