"""The shapes of a scan's organs: where they are attached, coordinates along and across each.

A leaf whose tip hangs against the stem touches it at its base and at its tip. Through a series an
attachment moves little; tips don't stay.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.interpolation.spine import (
    MIN_POINTS_FOR_SPINE,
    Points,
    Spine,
    fit_spine,
    path_lengths,
    sampled,
)
from baker.matching import Match
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy

Cloud = NDArray[np.floating]
Attachments = dict[int, Cloud]
"""By organ, the points (c, 3) by which it touches its parent."""

CONTACT_RADIUS = 2.0  # spacings of the sample beyond the smallest gap that still touch the parent
MAX_STEP = 3.0  # spacings between neighbouring points of one contact


def organ_attachments(
    clouds: Sequence[Cloud],
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
    cloud: Cloud, spacing: float, hierarchy: Hierarchy, organs: set[int]
) -> dict[int, list[Cloud]]:
    """Of each of these organs the connected groups of its points that touch its parent."""
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    trees: dict[int, KDTree] = {}
    contacts: dict[int, list[Cloud]] = {}
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


def _least_moving(choices: Sequence[Sequence[Cloud]]) -> list[Cloud]:
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


@dataclass(frozen=True)
class OrganShape:
    """A segment of a scan: a sample of its points, and the spine through it."""

    points: Points  # (n, 3), at most MAX_SAMPLE
    spine: Spine
    attachment: Points  # (3,)
    lengths: NDArray[np.float64]  # (n,), geodesic distances from the plant base
    # by child organ, which of these points it is attached at
    nodes: dict[int, int] = field(default_factory=dict)

    @property
    def length(self) -> float:
        """Of the spine."""
        return float(np.linalg.norm(np.diff(self.spine.nodes, axis=0), axis=1).sum())


def organ_shapes(
    points: Cloud,
    hierarchy: Hierarchy,
    base: Cloud,
    attachments: Attachments,
    segments: Iterable[int],
) -> dict[int, OrganShape]:
    """The shapes of organs of a scan, (N, 3), that have enough points and an attachment, by organ.

    Geodesics run through the parents, from the plant base, (3,): an organ that leaves its parent
    over a long contact, as a grass leaf does its whorl, is measured from where it leaves it first.
    segments: those whose shapes, and whose ancestors', are wanted.
    """
    from scipy.spatial import KDTree

    shapes: dict[int, OrganShape] = {}
    needed = {above for segment in segments for above in (segment, *hierarchy.ancestors(segment))}
    for segment in hierarchy.from_the_root():
        members, parent = hierarchy.segments[segment], hierarchy.parents[segment]
        organ = hierarchy.organs[segment]
        above = None if parent == NO_PARENT else shapes.get(hierarchy.organs[parent])
        if segment not in needed or len(members) < MIN_POINTS_FOR_SPINE:
            continue
        contact = base[None] if parent == NO_PARENT else attachments.get(organ)
        if contact is None:
            continue
        sample = points[sampled(members)].astype(np.float64)
        seeds = np.unique(KDTree(sample).query(contact)[1])
        offsets = np.zeros(len(seeds))
        if above is not None:
            gaps, touched = KDTree(above.points).query(sample[seeds])
            offsets = above.lengths[touched] + gaps
            above.nodes[organ] = int(touched[np.argmin(offsets)])
        lengths = path_lengths(sample, seeds, offsets)
        attachment = sample[seeds[np.argmin(offsets)]]
        spine = fit_spine(sample, lengths)
        shapes[organ] = OrganShape(sample, spine, attachment, offsets.min() + lengths)
    return shapes
