"""Every scan of a series split into segments and hung into a hierarchy."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.geometry.contacts import Gaps
from baker.geometry.workers import ALONE, Crew, Done
from baker.segmentation.from_labels import (
    hierarchy_from_labels,
    touching_segments,
    under_virtual_root,
)
from baker.segmentation.from_spanning_tree import segment_thin
from baker.segmentation.hierarchy import Hierarchy, whole
from baker.segmentation.parents import agreed_gaps

MANY = 8  # labelled scans that are worth sharing out once it is known what touches in them


def whole_hierarchies(clouds: Sequence[NDArray[np.floating]], done: Done) -> list[Hierarchy]:
    """No segments: each cloud is one (the paper's Figure 3)."""
    hierarchies = [whole(cloud) for cloud in clouds]
    done(len(hierarchies))
    return hierarchies


def thin_hierarchies(
    clouds: Sequence[NDArray[np.floating]],
    bases: Sequence[int],
    neighbors: int,
    threshold: int | None,
    done: Done,
    crew: Crew = ALONE,
) -> list[Hierarchy]:
    """Segments without labels, each cloud cut at its forks (section 3.2.2)."""

    def cut(scan: int) -> Hierarchy:
        return segment_thin(clouds[scan], bases[scan], neighbors, threshold).hierarchy

    return crew.map(cut, range(len(clouds)), done=done)


def labelled_hierarchies(
    clouds: Sequence[NDArray[np.floating]],
    labels: Sequence[NDArray[np.integer]],
    bases: Sequence[int],
    *,
    consistent: bool,
    agreeing: bool,
    virtual_root: bool,
    spacings: Sequence[float],
    touching: Sequence[Gaps] | None = None,
    done: Done,
    crew: Crew = ALONE,
) -> list[Hierarchy]:
    """Segments by label (section 3.2.1).

    consistent: labels name organs, so the scans elect one root between them.
    agreeing: and they agree on who grows from whom.
    virtual_root: no label is a stem; all hang under an empty root.
    spacings: each cloud's point spacing.
    touching: how far what touches is apart in each, where that is known.
    """

    def touch(scan: int) -> Gaps:
        return touching_segments(clouds[scan], labels[scan], spacings[scan], threads)

    def hang(scan: int) -> Hierarchy:
        names = labels[scan]
        root = _elected_root(labels, bases, scan) if consistent else int(names[bases[scan]])
        return hierarchy_from_labels(
            clouds[scan], names, root, spacings[scan], threads, gaps[scan], agreed
        )

    if virtual_root:
        done(len(clouds))
        return [under_virtual_root(names) for names in labels]
    threads = crew.beside(len(clouds))
    gaps = touching or crew.map(touch, range(len(clouds)))
    agreed = agreed_gaps(labels, gaps, spacings) if consistent and agreeing else None
    return crew.map(hang, range(len(clouds)), done=done, fewest=MANY)


def _elected_root(labels: Sequence[NDArray[np.integer]], bases: Sequence[int], scan: int) -> int:
    """The label that most scans have at their base, or the scan's own where it lacks that one.

    In a late scan a drooping leaf may hang lower than the stem's foot.
    """
    at_base = [int(names[base]) for names, base in zip(labels, bases, strict=True)]
    values, votes = np.unique(at_base, return_counts=True)
    elected = int(values[np.argmax(votes)])
    return elected if (labels[scan] == elected).any() else at_base[scan]
