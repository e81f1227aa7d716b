"""Find the attachments of organs and fit their spines.

A leaf whose tip hangs against the stem touches it at both ends. Its attachment is the contact with
the parent that moves least through the series.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import chain, pairwise, repeat

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import best_path, edge_components
from baker.interpolation.spine import (
    MIN_POINTS_FOR_SPINE,
    Points,
    Spine,
    fit_spine,
    interpolate_nodes,
    path_lengths,
    sample_members,
)
from baker.matching.match import Match
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy, split_by_label

Cloud = NDArray[np.floating]
Attachments = dict[int, Cloud]
"""Track id of an organ -> (c, 3) points by which it touches its parent."""

# docs/method.md, "Motion of organs"; both in point spacings.
CONTACT_RADIUS = 2.0  # distance of touching points from the parent, beyond that of the nearest one
MAX_STEP = 3.0  # distance of neighbouring points of one contact


def organ_attachments(
    clouds: Sequence[Cloud], spacings: Sequence[float], matches: Sequence[Match]
) -> list[Attachments]:
    """Find the attachments of the matched organs in each scan.

    One contact of an organ with its parent is chosen in each scan, so that the sum of their
    distances from scan to scan is least: a shortest path through the scans.

    clouds, spacings: (N, 3) points and point spacing of each scan. matches: of each interval.
    """
    from scipy.spatial.distance import cdist

    hierarchies = [match.first for match in matches] + [matches[-1].second]
    matched = {match.second.organs[b] for match in matches for _, b in match.pairs}
    contacts = list(map(_contacts, clouds, spacings, hierarchies, repeat(matched)))
    chosen: list[Attachments] = [{} for _ in clouds]
    for organ in set().union(*contacts):
        present = [scan for scan in range(len(clouds)) if organ in contacts[scan]]
        candidates = [contacts[scan][organ] for scan in present]
        path = best_path(
            np.array([[-cdist(a, b).min() for b in after] for a in before])
            for before, after in pairwise(candidates)
        )
        for scan, k in zip(present, path, strict=True):
            chosen[scan][organ] = contacts[scan][organ][k]
    return chosen


def _contacts(
    cloud: Cloud, spacing: float, hierarchy: Hierarchy, organs: set[int]
) -> dict[int, list[Cloud]]:
    """The contacts of organs with their parents: connected components of the touching points."""
    from scipy.spatial import cKDTree

    trees: dict[int, cKDTree] = {}
    contacts: dict[int, list[Cloud]] = {}
    for members, organ, parent in zip(
        hierarchy.segments, hierarchy.organs, hierarchy.parents, strict=True
    ):
        is_attached = parent != NO_PARENT and len(hierarchy.segments[parent])
        if organ not in organs or not is_attached or len(members) < MIN_POINTS_FOR_SPINE:
            continue
        if parent not in trees:
            trees[parent] = cKDTree(cloud[sample_members(hierarchy.segments[parent])])
        sample = cloud[sample_members(members)].astype(np.float64)
        step = spacing * (len(members) / len(sample)) ** 0.5  # the spacing of the sample
        gap = trees[parent].query(sample)[0]
        touching = sample[gap <= gap.min() + CONTACT_RADIUS * step]
        pairs = cKDTree(touching).query_pairs(MAX_STEP * step, output_type="ndarray")
        _, parts = split_by_label(edge_components(pairs.T, len(touching)))
        contacts[organ] = [touching[part] for part in parts]
    return contacts


@dataclass(frozen=True)
class OrganShape:
    """A sample of the points of a segment, and the spine through them."""

    points: Points  # (n, 3), n <= MAX_SAMPLE
    spine: Spine
    attachment: Points  # (3,)
    lengths: NDArray[np.float64]  # (n,) geodesic distances from the plant base
    # organ that grows from it -> index of the point where it does
    nodes: dict[int, int] = field(default_factory=dict)

    @property
    def length(self) -> float:
        """Length of the spine."""
        return float(np.linalg.norm(np.diff(self.spine.nodes, axis=0), axis=1).sum())

    @property
    def elongation(self) -> float:
        """Length of the spine, in root mean square distances of the points from it."""
        offsets = self.points - interpolate_nodes(self.spine.nodes, self.spine.along)
        return self.length / max(float(np.sqrt((offsets**2).sum(axis=1).mean())), 1e-30)


def common_nodes(
    source: OrganShape, target: OrganShape
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Indices of the points of an organ, in two scans, at which the same others grow from it."""
    organs = sorted(source.nodes.keys() & target.nodes.keys())
    first, second = (np.array([s.nodes[n] for n in organs], np.intp) for s in (source, target))
    return first, second


def organ_shapes(
    points: Cloud,
    hierarchy: Hierarchy,
    base: Cloud,
    attachments: Attachments,
    segments: Iterable[int],
) -> dict[int, OrganShape]:
    """Fit the spines of segments and of their ancestors, as far as they have an attachment.

    Geodesic distances are measured from the (3,) plant base through the parents. So the spine of an
    organ with a long contact, like a leaf of grass in its whorl, starts at the contact's lowest
    point. Returns the shapes by track id.
    """
    from scipy.spatial import cKDTree

    shapes: dict[int, OrganShape] = {}
    lineages = ((segment, *hierarchy.ancestors(segment)) for segment in segments)
    needed = set(chain.from_iterable(lineages))
    for segment in hierarchy.parents_first():
        members, parent = hierarchy.segments[segment], hierarchy.parents[segment]
        organ = hierarchy.organs[segment]
        contact = base[None] if parent == NO_PARENT else attachments.get(organ)
        if segment not in needed or len(members) < MIN_POINTS_FOR_SPINE or contact is None:
            continue
        parent_shape = None if parent == NO_PARENT else shapes.get(hierarchy.organs[parent])
        sample = points[sample_members(members)].astype(np.float64)
        seeds = np.unique(cKDTree(sample).query(contact)[1])
        offsets = np.zeros(len(seeds))
        if parent_shape is not None:
            gaps, touched = cKDTree(parent_shape.points).query(sample[seeds])
            offsets = parent_shape.lengths[touched] + gaps
            parent_shape.nodes[organ] = int(touched[np.argmin(offsets)])
        lengths = path_lengths(sample, seeds, offsets)
        attachment = sample[seeds[np.argmin(offsets)]]
        spine = fit_spine(sample, lengths)
        shapes[organ] = OrganShape(sample, spine, attachment, offsets.min() + lengths)
    return shapes
