"""What the scans' labels mean: the same organs in all scans, or numbers given anew in each.

Labels that are not consistent are made so by following the organs through the series
(`baker.matching.tracking`), and so are the organs of scans that have no labels.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError
from baker.matching.corrections import PointCorrection
from baker.matching.merging import merge_parts
from baker.matching.tracking import track_organs
from baker.scans.scan import Finding
from baker.segmentation.from_labels import coarse_hierarchies
from baker.segmentation.hierarchy import Hierarchy, split_by_label

Points = NDArray[np.floating]
Labels = NDArray[np.int64]

# Labels of a scan, above which they number something else than organs: matching each with each of
# the next scan's would take hours.
MOST_ORGANS = 1000
# Agreement of labels beyond chance, above which they are names. In twenty series with the same
# labels in all scans it is 0.86 or more; with their labels shuffled -0.6 to 0.5.
MIN_AGREEMENT = 0.5
DOUBTFUL_AGREEMENT = (0.3, 0.75)
MIN_SHARED = 0.5  # of the labels of a scan that the next one needs for them to be names


@dataclass(frozen=True)
class LabelUse:
    """The labels to bake with."""

    labels: tuple[Labels | None, ...]  # (N,) of each scan, None where its organs are to be found
    consistent: bool  # the same organ has the same label in all scans
    findings: tuple[Finding, ...] = ()  # what was decided about the labels
    renamed: bool = False  # they are track numbers, not the scans' own labels
    unlabelled: bool = False  # the organs themselves were found without labels
    names: Mapping[int, PointCorrection] = field(default_factory=dict)  # by label, given by hand

    @property
    def are_names(self) -> bool:
        """Whether the scans' own labels name organs."""
        return self.consistent and not self.renamed

    @property
    def given(self) -> list[Labels]:
        """The labels of the scans that have any."""
        return [own for own in self.labels if own is not None]

    def with_given(self, corrected: Sequence[Labels]) -> "LabelUse":
        """The same, with other labels for those scans that have any."""
        pairs = zip(self.labels, corrected, strict=True)
        return replace(self, labels=tuple(None if own is None else new for own, new in pairs))


def label_policy(
    labels: Sequence[Labels | None],
    names: Sequence[str],
    clouds: Sequence[Points],
    root_points: Sequence[int],
    requested: str,
    field: str = "",
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
        ``auto`` takes labels as consistent unless organs of the same label lie as chance has it.
    field : str
        What the labels are called in the scans.

    Returns
    -------
    LabelUse
        Labels that are independent are left as they are; `follow_labels` makes them consistent.

    Raises
    ------
    InputError
        Labels are asked for and no scan has any, or a scan has more than `MOST_ORGANS`.
    """
    if requested == "ignore":
        return LabelUse((None,) * len(labels), False, (Finding("labels", "not used, as asked"),))
    given = [k for k, own in enumerate(labels) if own is not None]
    if not given:
        if requested != "auto":
            raise InputError(f"The scans have no labels; --labels {requested} needs them.")
        said = "none; organs are found and followed by their shapes"
        return LabelUse((None,) * len(labels), False, (Finding("labels", said),))
    own = [np.asarray(labels[k]) for k in given]
    counts = [len(np.unique(numbers)) for numbers in own]
    for k, count in zip(given, counts, strict=True):
        if count > MOST_ORGANS:
            raise InputError(
                f"'{names[k]}' has {count} different labels, but at most {MOST_ORGANS} can be "
                "organs of a plant; choose another field with --label-field, or read the scans "
                "without labels (--labels ignore)."
            )
    if requested != "auto":
        consistent = requested == "consistent"
        said = _said(field, counts, len(labels), consistent, is_asked=True)
        return LabelUse(tuple(labels), consistent, (Finding("labels", said),))
    places = [clouds[k] for k in given], own, [root_points[k] for k in given]
    agreement = label_agreement(*places)
    consistent = agreement >= MIN_AGREEMENT
    said = _said(field, counts, len(labels), consistent, is_asked=False)
    finding = Finding("labels", said)
    low, high = DOUBTFUL_AGREEMENT
    if low < agreement < high:
        doubt = f"their organs keep their places only in part ({agreement:.0%} beyond chance)"
        option = f"--labels {'independent' if consistent else 'consistent'}"
        finding = replace(finding, doubt=doubt, option=option)
    return LabelUse(tuple(labels), consistent, (finding,))


def _said(field: str, counts: Sequence[int], scans: int, consistent: bool, is_asked: bool) -> str:
    few, many = min(counts), max(counts)
    organs = f"{few} to {many} organs" if many > few else f"{few} organ{'s' * (few > 1)}"
    meaning = "the same ones in all scans" if consistent else "numbered anew in every scan"
    name = f"'{field}', " if field else ""
    said = f"{name}{organs}, {meaning}{', as asked' * is_asked}"
    if len(counts) < scans:
        said += f"; found by shape in {scans - len(counts)} of {scans} scans, without labels"
    return said


def follow_labels(
    use: LabelUse,
    clouds: Sequence[Points],
    hierarchies: Sequence[Hierarchy],
    root_points: Sequence[int],
    corrections: Sequence[PointCorrection] = (),
) -> LabelUse:
    """Consistent labels from independent ones, or from organs that were found without labels.

    Parameters
    ----------
    use : LabelUse
        What `label_policy` decided.
    clouds, hierarchies, root_points, corrections
        As in `baker.matching.tracking.track_organs`.

    Returns
    -------
    LabelUse
        The track number of every point, by first appearance; an organ that one scan cuts finer than
        its neighbors is one organ again. Where labels are consistent but some scans have none,
        these get them by the tracks, from the nearest scan that has them.
    """
    unlabelled = not use.given
    tracks = track_organs(clouds, hierarchies, root_points, unlabelled, corrections)
    if use.consistent:
        return replace(use, labels=tuple(_completed(use.labels, tracks)))
    if not unlabelled:
        places = [place for correction in corrections for place in correction.places]
        merged = merge_parts(clouds, tracks, {int(tracks[scan][point]) for scan, point in places})
        if any(map(np.any, map(np.not_equal, merged, tracks))):
            # A part may have taken the place of another organ in the next scan.
            hierarchies = coarse_hierarchies(clouds, merged, root_points)
            tracks = track_organs(clouds, hierarchies, root_points, corrections=corrections)
    return replace(use, labels=tuple(tracks), consistent=True, renamed=True, unlabelled=unlabelled)


def _completed(labels: Sequence[Labels | None], tracks: Sequence[Labels]) -> list[Labels]:
    given = [(scan, own) for scan, own in enumerate(labels) if own is not None]
    unused = 1 + max(int(own.max()) for _, own in given)
    completed = []
    for k, (wanted, track) in enumerate(zip(labels, tracks, strict=True)):
        names: dict[int, int] = {}
        for scan, own in sorted(given, key=lambda one: -abs(one[0] - k)):  # the nearest comes last
            names |= zip(tracks[scan].tolist(), own.tolist(), strict=True)
        named = np.array([names.get(number, unused + number) for number in track.tolist()])
        completed.append(named if wanted is None else wanted)
    return completed


def label_agreement(
    clouds: Sequence[Points], labels: Sequence[NDArray[np.integer]], root_points: Sequence[int]
) -> float:
    """How much nearer organs of the same label are than chance has it, from scan to scan.

    1 where no other choice of labels would bring the organs' centers nearer to those in the next
    scan, 0 where they are as far as with labels at random (as Cohen's kappa counts agreement). The
    stem counts only where its label changes: many who number organs at random begin with the stem.
    """
    from scipy.optimize import linear_sum_assignment
    from scipy.spatial.distance import cdist

    at_base = [int(own[root]) for own, root in zip(labels, root_points, strict=True)]
    values, counts = np.unique(at_base, return_counts=True)
    stem = {int(values[np.argmax(counts)])} if 2 * counts.max() > len(labels) else set()
    scans = []
    for cloud, own in zip(clouds, labels, strict=True):
        names, organs = split_by_label(own)
        centers = (cloud.take(members, axis=0).mean(axis=0) for members in organs)
        scans.append(dict(zip(names, centers, strict=True)))
    given = chance = best = 0.0
    shared = possible = 0
    for first, second in pairwise(scans):
        both = sorted((first.keys() & second.keys()) - stem)
        shared += len(both)
        possible += min(len(scan.keys() - stem) for scan in (first, second))
        if both:
            distances = cdist([first[name] for name in both], [second[name] for name in both])
            given += float(np.trace(distances))
            chance += float(distances.mean()) * len(both)
            best += float(distances[linear_sum_assignment(distances)].sum())
    if shared < MIN_SHARED * possible:
        return 0.0
    return (chance - given) / (chance - best) if chance > best else 1.0
