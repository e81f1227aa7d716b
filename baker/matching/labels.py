"""What the scans' labels are good for: names of organs, or numbers given anew in every scan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError
from baker.geometry.contacts import MOST_ORGANS
from baker.matching.glimpses import without_glimpses
from baker.matching.pieces import agreement, consistent_pieces
from baker.matching.tracking import track_organs
from baker.scans.scan import Scan
from baker.segmentation.hierarchy import Hierarchy


@dataclass(frozen=True)
class LabelUse:
    """The labels to bake with.

    labels:     for each scan (N,) int64; None where the scans are segmented without labels.
    consistent: the same organ has the same label in all scans.
    sentence:   how they came about, for the user.
    renamed:    they are numbers of ours, not the scans' own.
    found:      the organs themselves are our finding.
    """

    labels: tuple[NDArray[np.int64], ...] | None
    consistent: bool
    sentence: str
    renamed: bool = False
    found: bool = False


def use_of_labels(
    scans: Sequence[Scan],
    clouds: Sequence[NDArray[np.floating]],
    root_points: Sequence[int],
    wanted: str,
    match_by_shape: bool,
) -> LabelUse:
    """Decide how labels are used; `wanted` is auto, consistent, independent or ignore.

    clouds: aligned positions, (N, 3) each. root_points: each scan's stem base.

    match_by_shape: give organs that are numbered anew consistent labels at once; else leave them as
    they are, to be matched down the hierarchies.

    auto takes labels as names where most organs match the one of the same label in the next scan.
    Raises InputError where labels are asked for and a scan has none, or more than `MOST_ORGANS`.
    """
    if wanted == "ignore":
        return LabelUse(None, False, "labels ignored, as asked")
    labels = [scan.labels for scan in scans if scan.labels is not None]
    if len(labels) < len(scans):
        if wanted != "auto":
            without = next(scan.name for scan in scans if scan.labels is None)
            raise InputError(f"{without} has no labels; --labels {wanted} needs them.")
        return LabelUse(None, False, "the scans have no labels")
    for scan, names in zip(scans, labels, strict=True):
        if (count := len(np.unique(names))) > MOST_ORGANS:
            raise InputError(
                f"'{scan.name}' has {count} different labels, but at most {MOST_ORGANS} can be "
                "organs of a plant; choose another field with --label-field, or read the scans "
                "without labels (--labels ignore)."
            )
    share = agreement(clouds, labels, root_points) if wanted == "auto" else 0.0
    if wanted == "consistent" or share > 0.5:
        found = "as asked" if wanted != "auto" else f"{share:.0%} of the organs match by shape too"
        return LabelUse(tuple(labels), True, f"labels name the same organs in all scans: {found}")
    found = "as asked" if wanted != "auto" else f"only {share:.0%} of the organs match by shape"
    if match_by_shape:
        labels = track_organs(clouds, labels, root_points)
    sentence = f"labels are numbered anew in every scan: {found}"
    return LabelUse(tuple(labels), match_by_shape, sentence, renamed=match_by_shape)


def labels_of_organs(
    clouds: Sequence[NDArray[np.floating]],
    numbers: Sequence[NDArray[np.int64]],
    root_points: Sequence[int],
    origin: str,
) -> LabelUse:
    """Organs that were found without labels, named the same in all scans.

    numbers: (N,) of each scan. origin: why there were no labels, for the sentence.
    """
    named = without_glimpses(clouds, track_organs(clouds, numbers, root_points, stem=True))
    sentence = f"{origin}: organs found and matched by shape"
    return LabelUse(tuple(named), True, sentence, renamed=True, found=True)


def labels_of_pieces(
    clouds: Sequence[NDArray[np.floating]],
    hierarchies: Sequence[Hierarchy],
    root_points: Sequence[int],
    origin: str,
) -> LabelUse:
    """Organs from segments that were found without labels, named the same in all scans.

    origin: why there were no labels, for the sentence.
    """
    pieces = [hierarchy.numbers() for hierarchy in hierarchies]
    named = consistent_pieces(clouds, pieces, root_points)
    sentence = f"{origin}: segmented at the forks, organs matched by shape"
    return LabelUse(tuple(named), True, sentence, renamed=True)
