"""Classify the nodes of a plant's Reeb graph as stem and petioles, blades, or bare branches.

Within one stem diameter of a point, the points of a stem or petiole form a rod, those of a blade a
flat sheet; and blades are wider than the stem, in their sections and within three diameters. On
every path from the base to a tip, the stem ends and a blade starts at most once. The starts that
fit the points best, for all paths together, are found by dynamic programming from the tips down.
"""

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import principal_spreads
from baker.geometry.sampling import voxel_downsample
from baker.segmentation.reeb_graph import PlantSample, ReebTree

# docs/method.md, "Organs without labels".
BALL_RADIUS, WIDE_RADIUS = 1.0, 3.0  # of the neighbourhoods of a point, in stem diameters
WIDE_SPACING = 0.6  # voxel size of the sample of which the larger ones consist, in stem diameters
# The coefficients of a score are those of a logistic regression on twenty real series, divided by
# 2.3. The flatness is the ratio of the least two axes of a neighbourhood. The score is 0 where that
# is `MIN_ROD_FLATNESS` and the widths are those of the stem, and 1 if it is `FLATNESS_RANGE` less.
MIN_ROD_FLATNESS, FLATNESS_RANGE = 0.4, 0.3
# Weights of the logarithms of the widths in stem diameters: of sections and of neighbourhoods.
SECTION_WEIGHT, WIDTH_WEIGHT = 0.6, 0.85
MIN_BLADE_AREA = 0.7  # in squared stem diameters
MIN_SLENDERNESS = 1.25  # least ratio of squared length to area of a separate blade
MIN_BARE_LENGTH = 2.0  # of a branch without blades that is an organ, in stem diameters
STEM = 0  # the organ of stem and petioles


def blade_scores(sample: PlantSample, tree: ReebTree) -> NDArray[np.float64]:
    """(n,) scores of the points of a sample, negative on stem or petiole, positive on a blade.

    They depend on the flatness around the point, and on the widths there and of its section.
    """
    from scipy.spatial import cKDTree

    flat = (MIN_ROD_FLATNESS - flatness(sample)) / FLATNESS_RANGE
    section = np.log(np.clip(tree.width / sample.diameter, 1.0 / np.e, np.e))
    coarse = sample.points[voxel_downsample(sample.points, WIDE_SPACING * sample.diameter)]
    spreads = principal_spreads(coarse, WIDE_RADIUS * sample.diameter)
    # The root mean square width of the wider neighbourhoods, along the middle axis.
    widths = 2.0 * spreads[cKDTree(coarse).query(sample.points)[1], 1]
    width = np.log(np.maximum(widths / sample.diameter, np.finfo(float).tiny))
    return flat + SECTION_WEIGHT * section[tree.node] + WIDTH_WEIGHT * width


def organs_of_nodes(
    sample: PlantSample, tree: ReebTree, scores: NDArray[np.floating]
) -> NDArray[np.intp]:
    """(m,) organ of each node: 0 for stem and petioles, from 1 on for blades and bare branches.

    scores: (m,) of each node, its area times a factor from -1 (stem or petiole) to 1 (blade).
    """
    area = tree.subtree_sums(sample.spacing**2 * np.bincount(tree.node))
    min_area = MIN_BLADE_AREA * sample.diameter**2
    starts = _blade_starts(tree, tree.subtree_sums(scores) - min_area)
    has_blades = tree.subtree_sums(starts) > 0
    is_slender = (area > min_area) & (tree.tip_distance**2 >= MIN_SLENDERNESS * area)
    is_bare = (tree.tip_distance >= MIN_BARE_LENGTH * sample.diameter) & ~has_blades
    organ, in_blade = np.zeros(len(starts), np.intp), np.zeros(len(starts), bool)
    for node, children in enumerate(tree.children):
        if starts[node]:
            organ[node] = organ.max() + 1
        in_blade[node] |= starts[node] and has_blades[node]
        organ[children], in_blade[children] = organ[node], in_blade[node]
        if in_blade[node]:
            starts[children] = False
        may_start = is_slender if in_blade[node] else is_bare
        branches = sorted((c for c in children if may_start[c]), key=lambda c: -area[c])
        # A blade or a bare branch that forks continues in its largest branch.
        starts[branches[int(in_blade[node] or is_bare[node]) :]] = True
    return organ


def flatness(sample: PlantSample) -> NDArray[np.float64]:
    """(n,) ratio of the two smaller principal axes around points: 1 in a rod, 0 on a flat sheet."""
    spreads = principal_spreads(sample.points, BALL_RADIUS * sample.diameter)
    return spreads[:, 0] / np.maximum(spreads[:, 1], np.finfo(float).tiny)


def _blade_starts(tree: ReebTree, blade_score: NDArray[np.float64]) -> NDArray[np.bool_]:
    """(m,) whether a node's subtree scores higher as one blade than with blades nearer to its tips.

    blade_score: (m,) score of the subtree of each node if it is one blade.
    """
    best, starts = np.zeros(len(blade_score)), np.zeros(len(blade_score), bool)
    for node in range(len(blade_score) - 1, -1, -1):
        children_score = sum(best[child] for child in tree.children[node])
        starts[node] = blade_score[node] > max(children_score, 0.0)
        best[node] = blade_score[node] if starts[node] else children_score
    return starts
