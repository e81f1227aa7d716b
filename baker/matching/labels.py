"""What the scans' labels mean: the same organs in all scans, or numbers given anew in each.

Labels that are not consistent are made so by following the organs through the series
(`baker.matching.tracking`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError
from baker.matching.assignment import assign_with_dummies
from baker.matching.descriptors import size_from_parent
from baker.matching.tracking import track_organs
from baker.scans.finding import Finding
from baker.segmentation.hierarchy import Hierarchy, split_by_label

if TYPE_CHECKING:
    from scipy.spatial import KDTree

Points = NDArray[np.floating]
Labels = NDArray[np.int64]

# Labels of a scan, above which they number something else than organs: matching each with each of
# the next scan's would take hours.
MOST_ORGANS = 1000
MIN_AGREEMENT = 0.5  # share of organs whose labels and shapes agree, above which labels are names
SAMPLE_SIZE = 400  # points of an organ that covering distances are measured with
# Cost of leaving an organ unmatched, as a share of its distance from its attachment point.
LOSS_COST, BIRTH_COST = 0.4, 0.75


@dataclass(frozen=True)
class LabelUse:
    """The labels to bake with."""

    labels: tuple[Labels, ...] | None  # (N,) of each scan; None where segmented without labels
    consistent: bool  # the same organ has the same label in all scans
    sentence: str  # how the labels came about, for the user
    renamed: bool = False  # they are track numbers, not the scans' own labels
    found: bool = False  # the organs themselves were found without labels
    findings: tuple[Finding, ...] = ()  # what was decided about the labels


def label_policy(
    labels: Sequence[Labels | None],
    names: Sequence[str],
    clouds: Sequence[Points],
    root_points: Sequence[int],
    requested: str,
) -> LabelUse:
    """Decide how the scans' labels are used.

    Parameters
    ----------
    labels : sequence of (N,) int64 ndarray or None
        The labels of each scan, as they were read.
    names : sequence of str
        The scans' names, for messages.
    clouds : sequence of (N, 3) float ndarray
        The aligned scans.
    root_points : sequence of int
        Point of each scan at the plant base.
    requested : {"auto", "consistent", "independent", "ignore"}
        ``auto`` takes labels as consistent where most organs match, by what they cover, the organ
        of the same label in the next scan.

    Returns
    -------
    LabelUse
        Labels that are independent are left as they are; `follow_labels` makes them consistent.

    Raises
    ------
    InputError
        Labels are asked for and a scan has none, or a scan has more than `MOST_ORGANS`.
    """
    if requested == "ignore":
        return LabelUse(None, False, "labels ignored, as asked")
    given = [own for own in labels if own is not None]
    if len(given) < len(labels):
        if requested != "auto":
            without = next(name for name, own in zip(names, labels, strict=True) if own is None)
            raise InputError(f"{without} has no labels; --labels {requested} needs them.")
        return LabelUse(None, False, "the scans have no labels")
    for name, own in zip(names, given, strict=True):
        if (count := len(np.unique(own))) > MOST_ORGANS:
            raise InputError(
                f"'{name}' has {count} different labels, but at most {MOST_ORGANS} can be "
                "organs of a plant; choose another field with --label-field, or read the scans "
                "without labels (--labels ignore)."
            )
    share = label_agreement(clouds, given, root_points) if requested == "auto" else 0.0
    consistent = requested == "consistent" or share > MIN_AGREEMENT
    what = "name the same organs in all scans" if consistent else "are numbered anew in every scan"
    match = f"{share:.0%} of the organs match by shape"
    why = f"{match} too" if consistent else f"only {match}"
    why = why if requested == "auto" else "as asked"
    return LabelUse(tuple(given), consistent, f"labels {what}: {why}")


def follow_labels(
    use: LabelUse,
    clouds: Sequence[Points],
    hierarchies: Sequence[Hierarchy],
    root_points: Sequence[int],
) -> LabelUse:
    """Consistent labels from independent ones, or from organs that were found without labels.

    Parameters
    ----------
    use : LabelUse
        What `label_policy` decided; its labels are None where the organs were found.
    clouds, hierarchies, root_points
        Of each scan, as in `baker.matching.tracking.track_organs`.

    Returns
    -------
    LabelUse
        The track number of every point, from 0 by first appearance.
    """
    found = use.labels is None
    tracks = track_organs(clouds, hierarchies, root_points, stem=found)
    sentence = f"{use.sentence}: organs found and matched by shape" if found else use.sentence
    return replace(
        use, labels=tuple(tracks), consistent=True, sentence=sentence, renamed=True, found=found
    )


def label_agreement(
    clouds: Sequence[Points], labels: Sequence[NDArray[np.integer]], root_points: Sequence[int]
) -> float:
    """Share of organs that match the organ of the same label in the next scan, of those it has.

    Organs are matched by the mean distance of the younger organ's points from the older organ:
    what grows covers what it was.
    """
    scans = [_Organs.of(c, n, r) for c, n, r in zip(clouds, labels, root_points, strict=True)]
    same = [
        first.labels[i] == second.labels[j]
        for first, second in pairwise(scans)
        for i, j in _matched(first, second)
        if first.labels[i] in second.labels
    ]
    return float(np.mean(same)) if same else 0.0


@dataclass(frozen=True)
class _Organs:
    """A scan's organs: labels, samples of their points, and their root mean square sizes."""

    labels: list[int]
    samples: list[Points]
    trees: list[KDTree]
    sizes: NDArray[np.float64]

    @classmethod
    def of(cls, cloud: Points, labels: NDArray[np.integer], root_point: int) -> _Organs:
        from scipy.spatial import KDTree

        names, members = split_by_label(labels)
        samples = [cloud[own[:: -(-len(own) // SAMPLE_SIZE)]] for own in members]
        trees = [KDTree(sample) for sample in samples]
        stem = trees[names.index(int(labels[root_point]))]
        sizes = [size_from_parent(sample, stem) for sample in samples]
        return cls(names, samples, trees, np.array(sizes))


def _matched(first: _Organs, second: _Organs) -> list[tuple[int, int]]:
    """Pairs of organs, by index; all others are born or lost."""
    lost, born = LOSS_COST * first.sizes, BIRTH_COST * second.sizes
    costs = _box_gaps(first.samples, second.samples)  # lower bounds of the covering distances
    # A pair that costs more than a loss and a birth is never assigned, whatever it costs.
    for i, j in np.argwhere(costs < lost[:, None] + born):
        costs[i, j] = second.trees[j].query(first.samples[i])[0].mean()
    return assign_with_dummies(costs, lost, born)


def _box_gaps(first: Sequence[Points], second: Sequence[Points]) -> NDArray[np.float64]:
    """Distances between the bounding boxes of (n, 3) clouds, for all pairs."""
    low, high = (np.array([edge(s, axis=0) for s in first]) for edge in (np.min, np.max))
    next_low, next_high = (np.array([edge(s, axis=0) for s in second]) for edge in (np.min, np.max))
    gaps = np.maximum(next_low - high[:, None], low[:, None] - next_high)
    return np.linalg.norm(np.maximum(gaps, 0.0), axis=2)
