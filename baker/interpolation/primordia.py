"""Find the points of a scan that become a new organ in the next one (section 3.3.1).

A young leaf at the tip of a shoot counts as stem until it is labelled, or found, as an organ of its
own. Its primordium neither shrinks into the stem nor unfolds a second time: it grows into the leaf.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baker.alignment.keyframes import AlignedSeries
from baker.geometry.graph import connected_knn_graph, geodesic_distances
from baker.interpolation.deformation import register_nonrigid
from baker.interpolation.organ_shapes import (
    Attachments,
    Cloud,
    OrganShape,
    common_nodes,
    organ_attachments,
    organ_shapes,
)
from baker.interpolation.pose import MIN_NODES, moved_with_attachments
from baker.interpolation.spine import MIN_POINTS_FOR_SPINE, NEIGHBORS, Points
from baker.matching.match import Match

Scan = tuple[Cloud, Cloud, Attachments]
"""(N, 3) points of a scan, (3,) plant base and attachments of organs."""

MAX_DETOUR = 0.02  # of points that carry another organ: share by which the way to it is longer


def with_primordia(series: AlignedSeries, matches: Sequence[Match]) -> list[Match]:
    """Split primordia off the segments that they are part of, and match them with the new organs.

    These stay among the births. The first scan of an interval then has more segments than the same
    scan as the second one of the interval before.
    """
    attachments = organ_attachments(series.clouds, series.spacings, matches)
    scans = [*zip(series.clouds, series.base_points, attachments, strict=True)]
    return [_split(match, scans[k : k + 2]) for k, match in enumerate(matches)]


def _split(match: Match, scans: Sequence[Scan]) -> Match:
    """Split the primordia of one interval off, and match them with the new organs."""
    first = match.first
    # New segment of the second scan -> segment of the first scan with its primordium, (n,) points.
    found: dict[int, tuple[int, NDArray[np.intp]]] = {}
    for pair in match.pairs:
        found |= _primordia(match, pair, scans)
    if not found:
        return match
    origins, primordia = zip(*found.values(), strict=True)
    taken, count = np.concatenate(primordia), len(first.segments)
    kept = [members[~np.isin(members, taken, kind="table")] for members in first.segments]
    first = replace(
        first,
        segments=(*kept, *primordia),
        labels=(*first.labels, *(None for _ in found)),
        parents=(*first.parents, *origins),
        organs=(*first.organs, *(match.second.organs[segment] for segment in found)),
    )
    pairs = *match.pairs, *((count + k, segment) for k, segment in enumerate(found))
    return replace(match, first=first, pairs=pairs)


def _primordia(
    match: Match, pair: tuple[int, int], scans: Sequence[Scan]
) -> dict[int, tuple[int, NDArray[np.intp]]]:
    """The primordia in a pair of segments, which must carry other organs in both scans.

    Returns new segment of the second scan -> segment of the first scan, (n,) points of that.
    """
    from scipy.spatial import cKDTree

    segment, later = pair
    born = [child for child in match.second.children(later) if child in match.births]
    if not born:
        return {}
    before, after = (
        organ_shapes(cloud, side, base, contacts, [k, *side.children(k)]).get(side.organs[k])
        for k, side, (cloud, base, contacts) in zip(
            pair, (match.first, match.second), scans, strict=True
        )
    )
    if before is None or after is None or len(common_nodes(before, after)[0]) < MIN_NODES:
        return {}
    clouds = [cloud for cloud, _, _ in scans]
    # The new organs are sampled as densely as the segment that they grow on.
    step = max(1, len(match.second.segments[later]) // len(after.points))
    new = [clouds[1][match.second.segments[child][::step]].astype(np.float64) for child in born]
    sample, members = _destinations(before, after, new), match.first.segments[segment]
    destinations = sample[cKDTree(before.points).query(clouds[0][members])[1]]
    return {
        child: (segment, members[destinations == k])
        for k, child in enumerate(born)
        if (sample == k).sum() >= MIN_POINTS_FOR_SPINE
    }


def _destinations(
    before: OrganShape, after: OrganShape, new: Sequence[Points]
) -> NDArray[np.integer]:
    """(n,) index of the new organ that each point of an organ becomes, or -1 if it stays.

    The organ is registered with itself in the second scan, of which it has to cover all, and with
    the new organs, of which it may cover any part. A point becomes what is then nearest to it,
    unless it carries another organ.
    """
    from scipy.spatial import cKDTree

    nodes, later_nodes = common_nodes(before, after)
    points = np.concatenate(new)
    moved = moved_with_attachments(before, after, (nodes, later_nodes))
    deformed = register_nonrigid(moved, after.points, (nodes, later_nodes), points)
    distance, nearest = cKDTree(points).query(deformed)
    becomes = np.repeat(np.arange(len(new)), [len(organ) for organ in new])[nearest]
    becomes[distance >= cKDTree(after.points).query(deformed)[0]] = -1
    graph = connected_knn_graph(before.points, NEIGHBORS)
    for k in range(len(nodes)):
        way: Any = before.lengths + geodesic_distances(graph, nodes[k : k + 1])
        becomes[way < (1.0 + MAX_DETOUR) * way.min()] = -1
    return becomes
