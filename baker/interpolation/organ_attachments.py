"""Where organs are attached to their parents: in one scan, and through a whole series.

In one scan that is where they are nearest. But a leaf whose tip hangs against the stem touches it
at its base and at its tip. Through a series an attachment moves little; tips don't stay.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.spine import MIN_POINTS_FOR_SPINE, sampled
from baker.matching import Match
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

Points = NDArray[np.floating]
Attachments = dict[int, Points]
"""By organ, the points (c, 3) by which it touches its parent."""

SAMPLE_SIZE = 50  # points of an organ that bound its distance from its parent
ROUGHNESS = 10.0  # relative error of that bound
TINY = 1e-30
CONTACT_RADIUS = 2.0  # spacings of the sample beyond the smallest gap that still touch the parent
MAX_STEP = 3.0  # spacings between neighbouring points of one contact


class Attachment(NamedTuple):
    """Where an organ touches its parent."""

    nearest: int  # index of the organ's point that is nearest to its parent
    gap: float  # the distance between the two


def attachment(organ: NDArray[np.floating], parent: cKDTree) -> Attachment:
    """Find where an organ, (n, 3) points, is attached.

    Searches far from the points of a tree are slow. So a sample bounds the distance, by any of the
    parent's points that are not much farther than the nearest ones.
    """
    sample = organ[:: max(1, len(organ) // SAMPLE_SIZE)]
    # What is found is nearer than the bound, by its square.
    bound = max(1.000001 * parent.query(sample, eps=ROUGHNESS)[0].min(), TINY)
    distances = parent.query(organ, distance_upper_bound=bound)[0]
    return Attachment(int(np.argmin(distances)), float(distances.min()))


def attachments(cloud: NDArray[np.floating], hierarchy: Hierarchy) -> dict[int, Attachment]:
    """Where each segment of a scan, (N, 3) points, is attached: if it has points and a parent."""
    from scipy.spatial import cKDTree

    @cache
    def tree(segment: int) -> cKDTree:
        return cKDTree(cloud.take(hierarchy.segments[segment], axis=0), balanced_tree=False)

    return {
        segment: attachment(cloud.take(members, axis=0), tree(parent))
        for segment, (members, parent) in enumerate(
            zip(hierarchy.segments, hierarchy.parents, strict=True)
        )
        if parent != NO_PARENT and len(members) and len(hierarchy.segments[parent])
    }


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
