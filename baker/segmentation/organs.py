"""Segment a scan without labels into organs by shape: stem with petioles, blades, bare branches."""

import numpy as np
from numpy.typing import NDArray

from baker.segmentation.organ_classification import STEM, blade_scores, organs_of_nodes
from baker.segmentation.reeb_graph import PlantSample, ReebTree, reeb_tree, sample_plant

Indices = NDArray[np.intp]

# docs/method.md, "Organs without labels".
MIN_BASE_SCORE = -0.7  # mean score of a node below a blade, up to the next fork, that belongs to it
FORK_PENALTY = 0.4  # of a blade, as a share of the area of what branches off
MIN_TOUCHING_SHARE = 0.6  # of the length of a strip, except for its base, that touches its organ
MAX_GAP = 3.0  # point spacings between points that touch
BASE_LENGTH = 3.0  # of an organ, where it touches its parent; in thicknesses of a level set
MAX_BASE_SHARE = 0.5  # of the base in an organ's length, so that short ones have points beyond it
MIN_REACH = 1.3  # of the point of an organ farthest from all other organs, in stem diameters


def find_organs(cloud: NDArray[np.floating], base: int) -> NDArray[np.int64]:
    """Find the (N,) organ of every point of a scan by shape, 0 for stem and petioles.

    cloud: (N, 3) points of the aligned scan. base: index of the point at the plant base.
    """
    sample = sample_plant(cloud, base)
    if sample.diameter == 0.0:
        return np.zeros(len(cloud), np.int64)
    tree = reeb_tree(sample)
    scores, area = blade_scores(sample, tree), sample.spacing**2 * np.bincount(tree.node)
    node_scores = sample.spacing**2 * np.bincount(tree.node, np.clip(scores, -1.0, 1.0))
    is_base = node_scores > MIN_BASE_SCORE * area
    node_scores -= fork_penalties(sample, tree, organs_of_nodes(sample, tree, node_scores))
    nodes = organs_of_nodes(sample, tree, node_scores)
    # The neighbourhoods at the base of a blade are half of stem: a lower score is enough there.
    for node in range(len(nodes) - 1, -1, -1):
        if nodes[node] == STEM and is_base[node] and len(tree.children[node]) == 1:
            nodes[node] = nodes[tree.children[node][0]]
    organ = merge_specks(sample, merge_strips(sample, nodes[tree.node]))
    return organ[sample.nearest].astype(np.int64)


def fork_penalties(sample: PlantSample, tree: ReebTree, organ: Indices) -> NDArray[np.floating]:
    """(m,) penalties for blades that contain a node from which another organ branches off.

    For what carries several organs is rather a stem. organ: (m,) of each node, strips not merged.
    """
    numbers, first = np.unique(organ, return_index=True)
    forks = first[(first > 0) & np.isin(numbers, merge_strips(sample, organ[tree.node]))]
    area = tree.subtree_sums(sample.spacing**2 * np.bincount(tree.node))[forks]
    return FORK_PENALTY * np.bincount(np.array(tree.parent)[forks], area, minlength=len(organ))


def merge_strips(sample: PlantSample, organ: Indices) -> Indices:
    """Merge organs that touch another organ along most of their length, the smallest first.

    Such an organ is a strip of the one it touches: in sparse scans, a blade or stem with a gap
    seems to fork there. Separate organs touch their parent only at the base. Lengths are numbers
    of level sets.

    organ: (n,) of each point of the sample; 0 is the stem.
    """
    from scipy.ndimage import extrema
    from scipy.sparse import csr_matrix, identity

    adjacency = sample.graph.copy()
    adjacency.data = (adjacency.data <= MAX_GAP * sample.spacing).astype(np.float64)
    adjacency = adjacency + adjacency.T + identity(len(organ), format="csr")
    while True:
        m = organ.max() + 1
        is_of = csr_matrix((np.ones(len(organ)), organ, np.arange(len(organ) + 1)))  # (n, m)
        base, tip, *_ = extrema(sample.distance, organ, np.arange(m))
        base_length = np.minimum(BASE_LENGTH * sample.thickness, MAX_BASE_SHARE * (tip - base))
        beyond = np.flatnonzero(sample.distance > (base + base_length)[organ])
        size, beyond_size = (np.bincount(part, minlength=m) for part in (organ, organ[beyond]))
        row, other = (adjacency @ is_of)[beyond].nonzero()
        own, level = organ[beyond[row]], sample.level[beyond[row]]
        levels = sample.level.max() + 1
        # The length along which the row's organ, beyond its base, touches the column's.
        pairs = np.unique((own * m + other) * levels + level) // levels
        touching = np.bincount(pairs, minlength=m * m).reshape(m, m)
        is_smaller = beyond_size[:, None] <= size
        is_strip = is_smaller & (touching > MIN_TOUCHING_SHARE * touching.diagonal()[:, None])
        is_strip[STEM] = False
        np.fill_diagonal(is_strip, False)
        if not is_strip.any():
            return organ
        strips = np.flatnonzero(is_strip.any(axis=1))
        merged, has_grown = np.arange(m), np.zeros(m, bool)
        for strip in strips[np.argsort(beyond_size[strips], kind="stable")]:
            other = is_strip[strip].argmax()
            if merged[other] == other and not has_grown[strip]:  # or else in the next round
                merged[strip], has_grown[other] = other, True
        organ = merged[organ]


def merge_specks(sample: PlantSample, organ: Indices) -> Indices:
    """Merge organs of which every point is near another organ, the smallest first.

    They are fragments of a surface, or strips beside a hole in the stem. Each becomes part of the
    organ that it grows from. organ: (n,) of each point of the sample; 0 is the stem.
    """
    from scipy.spatial import cKDTree

    organ, tree, reach = organ.copy(), cKDTree(sample.points), MIN_REACH * sample.diameter
    for number in np.argsort(np.bincount(organ), kind="stable"):
        members = np.flatnonzero(organ == number)
        # The farthest first, since the tips of most organs are near no other one.
        members = members[np.argsort(-sample.distance[members], kind="stable")]
        before = sample.predecessor[members[-1:]]  # on the shortest path to the first one
        balls = (tree.query_ball_point(point, reach) for point in sample.points[members])
        if (before >= 0).all() and all((organ[ball] != number).any() for ball in balls):
            organ[members] = organ[before]
    return organ
