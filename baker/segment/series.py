"""Every scan of a series split into segments and hung into a hierarchy."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from baker.segment.given import hierarchy_from_labels, under_virtual_root
from baker.segment.hierarchy import Hierarchy, whole
from baker.segment.thin import segment_thin


def whole_hierarchies(
    clouds: Sequence[NDArray[np.floating]], done: Callable[[int], None]
) -> list[Hierarchy]:
    """No segments: each cloud is one (the paper's Figure 3)."""
    hierarchies = [whole(cloud) for cloud in clouds]
    done(len(hierarchies))
    return hierarchies


def thin_hierarchies(
    clouds: Sequence[NDArray[np.floating]],
    bases: Sequence[int],
    neighbors: int,
    threshold: int | None,
    done: Callable[[int], None],
) -> list[Hierarchy]:
    """Segments without labels, each cloud cut at its forks (section 3.2.2)."""
    hierarchies = []
    for k, (cloud, base) in enumerate(zip(clouds, bases, strict=True)):
        hierarchies.append(segment_thin(cloud, base, neighbors, threshold).hierarchy)
        done(k + 1)
    return hierarchies


def labelled_hierarchies(
    clouds: Sequence[NDArray[np.floating]],
    labels: Sequence[NDArray[np.integer]],
    bases: Sequence[int],
    *,
    consistent: bool,
    virtual_root: bool,
    done: Callable[[int], None],
) -> list[Hierarchy]:
    """Segments by label (section 3.2.1).

    consistent: labels name organs, so the scans elect one root between them.
    virtual_root: no label is a stem; all hang under an empty root.
    """
    hierarchies = []
    for k, (cloud, names) in enumerate(zip(clouds, labels, strict=True)):
        if virtual_root:
            hierarchies.append(under_virtual_root(names))
        else:
            root = _elected_root(labels, bases, k) if consistent else int(names[bases[k]])
            hierarchies.append(hierarchy_from_labels(cloud, names, root))
        done(k + 1)
    return hierarchies


def _elected_root(labels: Sequence[NDArray[np.integer]], bases: Sequence[int], scan: int) -> int:
    """The label that most scans have at their base, or the scan's own where it lacks that one.

    In a late scan a drooping leaf may hang lower than the stem's foot.
    """
    at_base = [int(names[base]) for names, base in zip(labels, bases, strict=True)]
    values, votes = np.unique(at_base, return_counts=True)
    elected = int(values[np.argmax(votes)])
    return elected if (labels[scan] == elected).any() else at_base[scan]
