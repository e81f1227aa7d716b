"""Build hierarchies from labelled segments by nearest neighbour searches (section 3.2.1).

The paper leaves some choices open. Here, segments are adjacent if the connected kNN graph has an
edge between them, and the smallest gap is bridged first. If the root segment is more than ten point
spacings away from all others, none of the labels is the stem, and all segments become children of a
virtual, empty root.

Where organs were found by shape, shortest paths take the place of gaps (`organ_entries.py`).
"""

from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from functools import partial
from heapq import heappop, heappush

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import Gaps, segment_gaps
from baker.geometry.neighbors import Neighbors, Points
from baker.geometry.parallel import MapLike
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy, split_by_label
from baker.segmentation.organ_entries import organ_entries

Labels = NDArray[np.integer]
Ranks = Mapping[tuple[int, int], tuple[bool, float]]
"""(organ, possible parent) -> whether the parent is younger, and their mean gap"""

# docs/method.md, row 13.
MAX_ROOT_GAP = 10.0  # point spacings from the root segment to the nearest segment
MAX_GAP = 3.0  # point spacings between segments that touch


def labelled_hierarchies(
    clouds: Sequence[Points],
    labels: Sequence[Labels],
    bases: Sequence[int],
    neighbors: Sequence[Neighbors],
    *,
    consistent: bool,
    same_parents: bool,
    found: bool,
    virtual_root: bool,
    map: MapLike = map,
) -> list[Hierarchy]:
    """Build the hierarchy of each scan from the labels of its points (section 3.2.1 of the paper).

    clouds, labels, bases, neighbors: for each scan (N, 3) points, (N,) labels, the point at the
    plant base, `Neighbors`. consistent: whether an organ has the same label in all scans; they then
    have the same root. same_parents: whether it has the same parent in all scans, too. found:
    whether organs were found by shape; their parents are then those from which the shortest paths
    from the plant base enter them, since their borders are not precise enough for gaps.
    virtual_root: whether no label is the stem: all segments become children of an empty root.
    map: maps over the scans.
    """
    if virtual_root:
        return [under_virtual_root(scan_labels) for scan_labels in labels]
    gaps = list(map(segment_gaps, clouds, labels, neighbors))
    distances = list(map(entry_distances, clouds, labels, bases)) if found else gaps
    ranks = parent_ranks(labels, distances) if consistent and same_parents else None
    roots = [int(scan_labels[base]) for scan_labels, base in zip(labels, bases, strict=True)]
    if consistent:  # in a late scan, a drooping leaf may hang lower than the base of the stem
        usual = Counter(roots).most_common(1)[0][0]
        pairs = zip(labels, roots, strict=True)
        roots = [usual if usual in organs else own for organs, own in pairs]
    return list(map(partial(hierarchy_from_labels, ranks=ranks), labels, roots, gaps))


def entry_distances(cloud: Points, labels: Labels, base: int) -> Gaps:
    """Share of the shortest paths to an organ that do not enter it from a possible parent.

    cloud, labels, base: (N, 3) points, (N,) labels, the point at the plant base. Returns it for
    each pair (organ, possible parent) of labels for which it is less than 1. In `parent_ranks`,
    a scan in which it is 1 counts as one in which the organs are not adjacent.
    """
    entries = organ_entries(cloud, labels, base)
    shares = entries.shares()
    pairs, names = np.argwhere(shares > 0.0).tolist(), entries.labels
    return {(names[a], names[b]): 1.0 - float(shares[a, b]) for a, b in pairs if a != b}


def parent_ranks(labels: Sequence[Labels], gaps: Sequence[Gaps]) -> Ranks:
    """Rank the possible parents of organs by their mean gap over all scans that show both organs.

    In a dense crown, leaves touch branches that they don't grow from, and may be nearer to them in
    a single scan than to their parent. But an organ touches its parent in every scan, and is not
    older than it. In a scan in which they are not adjacent, the gap counts as `MAX_GAP`.
    """
    present = [set(np.unique(scan_labels).tolist()) for scan_labels in labels]
    first = {label: scan for scan in reversed(range(len(present))) for label in present[scan]}
    ranks = {}
    for pair in {pair for scan_gaps in gaps for pair in scan_gaps}:
        scans = zip(gaps, present, strict=True)
        pair_gaps = [g.get(pair, MAX_GAP) for g, organs in scans if organs.issuperset(pair)]
        ranks[pair] = first[pair[1]] > first[pair[0]], float(np.mean(pair_gaps))
    return ranks


def hierarchy_from_labels(
    labels: Labels, root_label: int, gaps: Gaps, ranks: Ranks | None = None
) -> Hierarchy:
    """Build the hierarchy of one scan from the (N,) labels of its points, by Prim's algorithm.

    gaps: as `segment_gaps` returns them. ranks: as `parent_ranks` returns them, to be used instead
    of the gaps of this scan.
    """
    distinct, segments = split_by_label(labels)
    root_gaps = [gap for (label, _), gap in gaps.items() if label == root_label]
    if len(segments) > 2 and min(root_gaps) > MAX_ROOT_GAP:
        return under_virtual_root(labels)
    # By the smallest gap where no shortest path enters an organ, as that at the plant base.
    last = {pair: (True, MAX_GAP + gap) for pair, gap in gaps.items()}
    ranks = {**last, **(ranks or {pair: (False, gap) for pair, gap in gaps.items()})}
    number = {label: index for index, label in enumerate(distinct)}
    edges = defaultdict(list)
    for (child, parent), rank in ranks.items():
        if child in number and parent in number:
            edges[parent].append((rank, child, parent))
    parents, notes = dict[int, int](), []
    frontier = [((False, 0.0), root_label, root_label)]
    while frontier:
        _, child, parent = heappop(frontier)
        if child in parents:
            continue
        parents[child] = parent
        for edge in edges[child]:
            heappush(frontier, edge)
        if (gap := gaps.get((child, parent), 0.0)) > MAX_GAP:
            notes.append(
                f"segment {child} touches no other one; it was hung on segment {parent} "
                f"across a gap of {gap:.3g} point spacings"
            )
    root, numbers = number[root_label], [number[parents[label]] for label in distinct]
    numbers[root] = NO_PARENT
    return Hierarchy(tuple(segments), tuple(distinct), tuple(numbers), root, tuple(notes))


def under_virtual_root(labels: Labels) -> Hierarchy:
    """Make all segments children of a virtual, empty root (Komatsuna in section 4 of the paper)."""
    distinct, segments = split_by_label(labels)
    virtual = len(segments)
    return Hierarchy(
        segments=(*segments, np.empty(0, np.intp)),
        labels=(*distinct, None),
        parents=(*[virtual] * virtual, NO_PARENT),
        root=virtual,
        notes=("no segment is the others' stem; all hang under a virtual, empty root",),
    )
