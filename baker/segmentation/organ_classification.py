"""Organs on a plant's skeleton: blades told from stem and petioles, and bare branches.

A ball of the stem's diameter sees a round rod where there is stem or petiole, and a flat sheet
where there is a blade; and sections of blades are wider than the stem. On every path from the base
to a tip the stem ends once, where the blade begins; where that is best for all paths together is
found exactly, from the tips down.
"""

import numpy as np
from numpy.typing import NDArray

from baker.segmentation.reeb_graph import PlantSample, ReebTree

BALL_RADIUS = 1.0  # radius of the ball, in stem diameters
MIN_ROD_FLATNESS = 0.55  # from this ratio of the ball's least two axes on, what it sees is round
FLATNESS_RANGE = 0.3  # further from it than this, nothing gets clearer
WIDTH_WEIGHT = 0.6  # of the logarithm of a section's width over the stem's diameter
MIN_BLADE_AREA = 0.7  # a blade is larger than this, in squares of the stem's diameter
MIN_SLENDERNESS = 2.0  # a branch of a blade this many times as long as wide is a blade of its own
MIN_BARE_LENGTH = 2.0  # a branch without blades is an organ from this length on, in stem diameters
STEM = 0


def blade_scores(sample: PlantSample, tree: ReebTree) -> NDArray[np.float64]:
    """(n,) how surely each point lies on a blade: from -1, on stem or petiole, to 1."""
    flat = (MIN_ROD_FLATNESS - flatness(sample)) / FLATNESS_RANGE
    wide = np.log(np.clip(tree.width / sample.diameter, 1.0 / np.e, np.e))
    return np.clip(flat + WIDTH_WEIGHT * wide[tree.node], -1.0, 1.0)


def organs_of_nodes(
    sample: PlantSample, tree: ReebTree, scores: NDArray[np.float64]
) -> NDArray[np.intp]:
    """(m,) the organ of each node: 0 for stem and petioles, blades and bare branches from 1 on.

    scores: (n,) how surely each point of the sample lies on a blade, not on stem or petiole.
    """
    gain = np.bincount(tree.node, scores, len(tree.parent)).astype(np.float64)
    least = MIN_BLADE_AREA * (sample.diameter / sample.spacing) ** 2
    organ = _blades(sample, tree, _begins_blade(tree, tree.subtree_sums(gain) - least), least)
    return _with_bare_branches(sample, tree, organ)


def flatness(sample: PlantSample) -> NDArray[np.float64]:
    """(n,) ratio of the least two axes of what is within a ball: 1 in a rod, 0 on a flat sheet."""
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


def _begins_blade(tree: ReebTree, whole: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(m,) whether all from a node on gains more as one blade than as blades further out.

    whole: (m,) gain of all from each node on as one blade.
    """
    best, begins = np.zeros(len(whole)), np.zeros(len(whole), bool)
    for node in range(len(whole) - 1, -1, -1):
        further = sum(best[child] for child in tree.children[node])
        begins[node] = whole[node] > max(further, 0.0)
        best[node] = whole[node] if begins[node] else further
    return begins


def _blades(
    sample: PlantSample, tree: ReebTree, begins: NDArray[np.bool_], least: float
) -> NDArray[np.intp]:
    """(m,) blades from 1 on. Where one forks into slender branches, each of them is a blade, the
    largest one together with what lies below the fork."""
    organ, born = np.zeros(len(tree.parent), np.intp), 0
    size = tree.subtree_sums(tree.count)
    for node, parent in enumerate(tree.parent):
        if parent >= 0 and organ[parent] and not organ[node]:
            organ[node] = organ[parent]
        elif begins[node] and not organ[node]:
            born += 1
            organ[node] = born
        if organ[node] and len(tree.children[node]) > 1:
            slender = [
                child
                for child in sorted(tree.children[node], key=lambda child: -size[child])
                if size[child] > least and _is_slender(sample, tree, size, child)
            ]
            for child in slender[1:]:
                born += 1
                organ[child] = born
    return organ


def _is_slender(
    sample: PlantSample, tree: ReebTree, size: NDArray[np.float64], branch: int
) -> bool:
    """Whether a branch is long for the width it begins with, over the first stem diameter."""
    node, length, widths = branch, sample.thickness, [tree.width[branch]]
    while length < sample.diameter and tree.children[node]:
        node = max(tree.children[node], key=lambda child: size[child])
        widths.append(tree.width[node])
        length += sample.thickness
    neck = max(float(np.median(widths)), 0.5 * sample.diameter)
    return bool(tree.reach[branch] >= MIN_SLENDERNESS * neck)


def _with_bare_branches(
    sample: PlantSample, tree: ReebTree, organ: NDArray[np.intp]
) -> NDArray[np.intp]:
    """The organs and, further ones, long branches of the stem that bear no blades.

    A leaf still rolled up, or a twig. Where a bare branch forks again, its longest branch goes on.
    """
    organ, born = organ.copy(), int(organ.max())
    bears = tree.subtree_sums((organ > STEM).astype(np.float64)) > 0
    long = tree.reach >= MIN_BARE_LENGTH * sample.diameter
    for node, parent in enumerate(tree.parent):
        if parent < 0 or bears[node]:
            continue
        if bears[parent]:
            begins = bool(long[node])
        else:
            organ[node] = organ[parent]
            rivals = [child for child in tree.children[parent] if long[child]]
            main = max(rivals, key=lambda child: tree.reach[child], default=node)
            begins = bool(long[node]) and node != main
        if begins:
            born += 1
            organ[node] = born
    return organ
