"""Where organs are attached to their parents.

A leaf whose tip hangs against the stem touches it at its base and at its tip. Through a series an
attachment moves little; tips don't stay.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.spine import MIN_POINTS_FOR_SPINE, sampled
from baker.matching import Match
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy

Points = NDArray[np.floating]
Attachments = dict[int, Points]
"""By organ, the points (c, 3) by which it touches its parent."""

CONTACT_RADIUS = 2.0  # spacings of the sample beyond the smallest gap that still touch the parent
MAX_STEP = 3.0  # spacings between neighbouring points of one contact


def organ_attachments(
    clouds: Sequence[Points],
    spacings: Sequence[float],
    matches: Sequence[Match],
) -> list[tuple[Attachments, Attachments]]:
    """Find where the matched organs of each interval are attached, in both of its scans.

    Of all places at which an organ touches its parent in each scan, (N, 3) points of these
    spacings, those are chosen that move least through the series, by a shortest path through the
    scans.
    """
    hierarchies = [match.first for match in matches] + [matches[-1].second]
    matched = {match.second.organs[b] for match in matches for _, b in match.pairs}
    scans = zip(clouds, spacings, hierarchies, strict=True)
    contacts = [_contacts(*scan, matched) for scan in scans]
    chosen: list[Attachments] = [{} for _ in clouds]
    for organ in matched:
        places = [scan for scan, found in enumerate(contacts) if organ in found]
        choices = [contacts[scan][organ] for scan in places]
        for scan, contact in zip(places, _least_moving(choices), strict=True):
            chosen[scan][organ] = contact
    return list(pairwise(chosen))


def _contacts(
    cloud: Points, spacing: float, hierarchy: Hierarchy, organs: set[int]
) -> dict[int, list[Points]]:
    """Of each of these organs the connected groups of its points that touch its parent."""
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    trees: dict[int, KDTree] = {}
    contacts: dict[int, list[Points]] = {}
    for segment, members in enumerate(hierarchy.segments):
        organ, parent = hierarchy.organs[segment], hierarchy.parents[segment]
        if organ not in organs or parent == NO_PARENT or len(members) < MIN_POINTS_FOR_SPINE:
            continue
        if not len(hierarchy.segments[parent]):
            continue
        if parent not in trees:
            trees[parent] = KDTree(cloud[sampled(hierarchy.segments[parent])])
        own = cloud[sampled(members)].astype(np.float64)
        step = spacing * (len(members) / len(own)) ** 0.5  # the spacing of the sample
        gap = trees[parent].query(own)[0]
        near = own[gap <= gap.min() + CONTACT_RADIUS * step]
        pairs = KDTree(near).query_pairs(MAX_STEP * step, output_type="ndarray")
        graph = csr_matrix((np.ones(len(pairs)), pairs.T), (len(near), len(near)))
        count, group = connected_components(graph, directed=False)
        contacts[organ] = [near[group == k] for k in range(count)]
    return contacts


def _least_moving(choices: Sequence[Sequence[Points]]) -> list[Points]:
    """One choice a scan, so that the distances between successive ones have the smallest sum."""
    from scipy.spatial.distance import cdist

    if not choices:
        return []
    cost, steps = np.zeros(len(choices[0])), []
    for before, after in pairwise(choices):
        through = np.array([[cdist(a, b).min() for a in before] for b in after]) + cost
        steps.append(through.argmin(axis=1))
        cost = through.min(axis=1)
    picked = [int(cost.argmin())]
    for step in reversed(steps):
        picked.append(int(step[picked[-1]]))
    return [groups[k] for groups, k in zip(choices, reversed(picked), strict=True)]
