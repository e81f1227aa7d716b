"""Classify the nodes of a plant's Reeb graph as stem and petioles, blades, or bare branches.

Within one stem diameter of a point, the points of a stem or petiole form a rod, those of a blade a
flat sheet; and sections of blades are wider than the stem. On every path from the base to a tip,
the stem ends and a blade starts at most once. The starts that fit the points best, for all paths
together, are found by dynamic programming from the tips down.
"""

import numpy as np
from numpy.typing import NDArray

from baker.segmentation.reeb_graph import PlantSample, ReebTree

BALL_RADIUS = 1.0  # of the neighbourhood, in stem diameters
MIN_ROD_FLATNESS = 0.55  # ratio of the least two axes of a neighbourhood, above which it is a rod
FLATNESS_RANGE = 0.3  # distance from that ratio at which the score is 1
WIDTH_WEIGHT = 0.6  # of the logarithm of a section's width in stem diameters
MIN_BLADE_AREA = 0.7  # in squared stem diameters
MIN_SLENDERNESS = 2.0  # length : width, above which a branch of a blade is a separate blade
MIN_BARE_LENGTH = 2.0  # of a branch without blades that is an organ, in stem diameters
STEM = 0


def blade_scores(sample: PlantSample, tree: ReebTree) -> NDArray[np.float64]:
    """(n,) score of each point of the sample, from -1 (on stem or petiole) to 1 (on a blade)."""
    flat = (MIN_ROD_FLATNESS - flatness(sample)) / FLATNESS_RANGE
    wide = np.log(np.clip(tree.width / sample.diameter, 1.0 / np.e, np.e))
    return np.clip(flat + WIDTH_WEIGHT * wide[tree.node], -1.0, 1.0)


def organs_of_nodes(
    sample: PlantSample, tree: ReebTree, scores: NDArray[np.float64]
) -> NDArray[np.intp]:
    """Find the organ of each node of a Reeb tree.

    Parameters
    ----------
    sample : PlantSample
        Of n points.
    tree : ReebTree
        With m nodes.
    scores : (n,) float64
        As `blade_scores` returns them.

    Returns
    -------
    (m,) intp
        0 for stem and petioles; blades and bare branches are numbered from 1 on.
    """
    node_score = np.bincount(tree.node, scores, len(tree.parent)).astype(np.float64)
    min_points = MIN_BLADE_AREA * (sample.diameter / sample.spacing) ** 2
    starts = _blade_starts(tree, tree.subtree_sums(node_score) - min_points)
    return _add_bare_branches(sample, tree, _label_blades(sample, tree, starts, min_points))


def flatness(sample: PlantSample) -> NDArray[np.float64]:
    """(n,) ratio of the least two axes of each ball of points: 1 in a rod, 0 on a flat sheet."""
    from scipy.sparse import csr_matrix, identity
    from scipy.spatial import cKDTree

    points, count = sample.points, len(sample.points)
    pairs = cKDTree(points).query_pairs(BALL_RADIUS * sample.diameter, output_type="ndarray")
    half = csr_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), (count, count))
    within = half + half.T + identity(count, format="csr")
    number = within @ np.ones(count)
    mean = (within @ points) / number[:, None]
    covariance = np.empty((count, 3, 3))
    for a in range(3):
        for b in range(a + 1):
            product = within @ (points[:, a] * points[:, b]) / number
            covariance[:, a, b] = covariance[:, b, a] = product - mean[:, a] * mean[:, b]
    axes = np.sqrt(np.maximum(np.linalg.eigvalsh(covariance), 0.0))
    return np.asarray(axes[:, 0] / np.maximum(axes[:, 1], np.finfo(float).tiny))


def _blade_starts(tree: ReebTree, blade_score: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(m,) whether a subtree scores higher as one blade than with blades that start further out.

    blade_score: (m,) score of the subtree of each node as one blade.
    """
    best, starts = np.zeros(len(blade_score)), np.zeros(len(blade_score), bool)
    for node in range(len(blade_score) - 1, -1, -1):
        of_children = sum(best[child] for child in tree.children[node])
        starts[node] = blade_score[node] > max(of_children, 0.0)
        best[node] = blade_score[node] if starts[node] else of_children
    return starts


def _label_blades(
    sample: PlantSample, tree: ReebTree, starts: NDArray[np.bool_], min_points: float
) -> NDArray[np.intp]:
    """(m,) number of each node's blade, from 1 on, or 0.

    Where a blade forks into slender branches, each is a blade; the largest one includes the part
    below the fork.
    """
    organ, count = np.zeros(len(tree.parent), np.intp), 0
    size = tree.subtree_sums(tree.count)
    for node, parent in enumerate(tree.parent):
        if parent >= 0 and organ[parent] and not organ[node]:
            organ[node] = organ[parent]
        elif starts[node] and not organ[node]:
            count += 1
            organ[node] = count
        if organ[node] and len(tree.children[node]) > 1:
            slender = [
                child
                for child in sorted(tree.children[node], key=lambda child: -size[child])
                if size[child] > min_points and _is_slender(sample, tree, size, child)
            ]
            for child in slender[1:]:
                count += 1
                organ[child] = count
    return organ


def _is_slender(
    sample: PlantSample, tree: ReebTree, size: NDArray[np.float64], branch: int
) -> bool:
    """Whether a branch is long compared to its width, over its first stem diameter of length."""
    node, length, widths = branch, sample.thickness, [tree.width[branch]]
    while length < sample.diameter and tree.children[node]:
        node = max(tree.children[node], key=lambda child: size[child])
        widths.append(tree.width[node])
        length += sample.thickness
    neck = max(float(np.median(widths)), 0.5 * sample.diameter)
    return bool(tree.reach[branch] >= MIN_SLENDERNESS * neck)


def _add_bare_branches(
    sample: PlantSample, tree: ReebTree, organ: NDArray[np.intp]
) -> NDArray[np.intp]:
    """(m,) the organs, with long branches of the stem without blades (rolled leaves, twigs) added.

    Where a bare branch forks, it continues in its longest branch.
    """
    organ, count = organ.copy(), int(organ.max())
    has_blades = tree.subtree_sums((organ > STEM).astype(np.float64)) > 0
    is_long = tree.reach >= MIN_BARE_LENGTH * sample.diameter
    for node, parent in enumerate(tree.parent):
        if parent < 0 or has_blades[node]:
            continue
        starts = bool(is_long[node])
        if not has_blades[parent]:
            organ[node] = organ[parent]
            siblings = [child for child in tree.children[parent] if is_long[child]]
            main = max(siblings, key=lambda child: tree.reach[child], default=node)
            starts = starts and node != main
        if starts:
            count += 1
            organ[node] = count
    return organ
