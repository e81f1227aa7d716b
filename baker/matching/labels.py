"""Decide whether the labels of the scans are consistent, and make them so by tracking organs.

Organs are tracked through the series (`baker.matching.tracking`) where labels are independent in
each scan, or where scans have no labels.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError
from baker.matching.borders import align_borders
from baker.matching.corrections import Labels, PointCorrection
from baker.matching.merging import merge_parts
from baker.matching.tracking import track_organs
from baker.scans.scan import Finding, Series
from baker.segmentation.hierarchy import split_by_label

Points = NDArray[np.floating]

# A scan with more labels is refused: they are not organs, and matching them would take hours.
MAX_ORGANS = 1000
# Labels are consistent if they agree so much beyond chance. In twenty series with consistent
# labels the agreement is 0.86 or more; with their labels shuffled -0.6 to 0.5.
MIN_AGREEMENT = 0.5
DOUBTFUL_AGREEMENT = (0.3, 0.75)  # range in which the user is asked to check
MIN_SHARED = 0.5  # share of labels that two successive scans have in common, if consistent


@dataclass(frozen=True)
class LabelUse:
    """The labels to bake with, and how they are used."""

    labels: tuple[Labels | None, ...]  # (N,) of each scan, None where it has no labels
    consistent: bool  # whether an organ has the same label in all scans
    findings: tuple[Finding, ...] = ()
    renamed: bool = False  # whether labels are track numbers, not those of the scans
    unlabelled: bool = False  # whether all organs were found without labels
    names: Mapping[int, PointCorrection] = field(default_factory=dict)  # by label, see organ_names

    @property
    def are_names(self) -> bool:
        """Whether the labels in the files identify organs."""
        return self.consistent and not self.renamed

    @property
    def available(self) -> list[Labels]:
        """(N,) labels of the scans that have labels."""
        return [organs for organs in self.labels if organs is not None]


def label_policy(
    series: Series, clouds: Sequence[Points], root_points: Sequence[int], requested: str
) -> LabelUse:
    """Decide how the labels of the scans are used.

    clouds, root_points: (N, 3) points of each aligned scan, and the index of that at the plant
    base. requested: "auto", "consistent", "independent" or "ignore"; with "auto", labels are
    consistent if their `label_agreement` is high. Independent labels are left unchanged;
    `with_tracked_labels` makes them consistent.

    Raises InputError if labels are requested but no scan has any, or a scan has more than
    `MAX_ORGANS`.
    """
    labels = [scan.labels for scan in series.scans]
    labelled_scans = [k for k, organs in enumerate(labels) if organs is not None]
    if not labelled_scans and requested in ("consistent", "independent"):
        raise InputError(f"The scans have no labels; --labels {requested} needs them.")
    if not labelled_scans or requested == "ignore":
        absent = "none; organs are found and followed by their shapes"
        finding = Finding("labels", "not used, as asked" if requested == "ignore" else absent)
        return LabelUse((None,) * len(labels), False, (finding,))
    present = [np.asarray(labels[k]) for k in labelled_scans]
    counts = [len(np.unique(organs)) for organs in present]
    for k, count in zip(labelled_scans, counts, strict=True):
        if count > MAX_ORGANS:
            raise InputError(
                f"'{series.scans[k].name}' has {count} different labels, but at most {MAX_ORGANS} "
                "can be organs of a plant; choose another field with --label-field, or read the "
                "scans without labels (--labels ignore)."
            )
    consistent, doubt, option = requested == "consistent", "", ""
    if requested == "auto":
        bases = [root_points[k] for k in labelled_scans]
        agreement = label_agreement([clouds[k] for k in labelled_scans], present, bases)
        consistent = agreement >= MIN_AGREEMENT
        if DOUBTFUL_AGREEMENT[0] < agreement < DOUBTFUL_AGREEMENT[1]:
            doubt = f"their organs keep their places only in part ({agreement:.0%} beyond chance)"
            option = f"--labels {'independent' if consistent else 'consistent'}"
    few, many = min(counts), max(counts)
    description = f"'{series.label_field}', " if series.label_field else ""
    description += f"{few} to {many} organs" if many > few else f"{few} organ{'s' * (few > 1)}"
    description += ", the same ones in all scans" if consistent else ", numbered anew in every scan"
    description += ", as asked" if requested != "auto" else ""
    if missing := len(labels) - len(labelled_scans):
        description += f"; found by shape in {missing} of {len(labels)} scans, without labels"
    return LabelUse(tuple(labels), consistent, (Finding("labels", description, doubt, option),))


def with_tracked_labels(
    use: LabelUse,
    clouds: Sequence[Points],
    organs: Sequence[Labels],
    root_points: Sequence[int],
    corrections: Sequence[PointCorrection] = (),
) -> LabelUse:
    """Make labels consistent by tracking the organs of all scans; see `track_organs`.

    Returns `use` with the track number of every point; parts of an organ that only one scan
    divides are merged, and the borders of organs found by shape are made alike in all scans. If
    labels are consistent and only missing in some scans, an organ in such a scan gets the label of
    its track in the nearest scan with labels.
    """
    unlabelled = not use.available
    tracks = track_organs(clouds, organs, root_points, corrections)
    if use.consistent:
        labelled = {k: organs[k] for k, labels in enumerate(use.labels) if labels is not None}
        return replace(use, labels=tuple(_complete_labels(labelled, tracks)))
    places = [place for correction in corrections for place in correction.places]
    corrected = {(scan, int(tracks[scan][point])) for scan, point in places}
    if unlabelled:
        tracks = align_borders(clouds, tracks, root_points, corrected)
    else:
        merged = merge_parts(clouds, tracks, {track for _, track in corrected})
        if any(map(np.any, map(np.not_equal, merged, tracks))):
            # A part may have been linked to another organ of the next scan.
            tracks = track_organs(clouds, merged, root_points, corrections)
    return replace(use, labels=tuple(tracks), consistent=True, renamed=True, unlabelled=unlabelled)


def _complete_labels(labelled: Mapping[int, Labels], tracks: Sequence[Labels]) -> list[Labels]:
    """Label the scans that are not in `labelled`, (N,) labels by the scan's index, by tracks."""
    unused = 1 + max(int(organs.max()) for organs in labelled.values())
    completed = dict(labelled)
    for k in set(range(len(tracks))) - labelled.keys():
        names: dict[int, int] = {}
        for scan in sorted(labelled, key=lambda scan: -abs(scan - k)):  # the nearest last
            names |= zip(tracks[scan].tolist(), labelled[scan].tolist(), strict=True)
        completed[k] = np.array([names.get(n, unused + n) for n in tracks[k].tolist()])
    return [completed[k] for k in range(len(tracks))]


def label_agreement(
    clouds: Sequence[Points], labels: Sequence[NDArray[np.integer]], root_points: Sequence[int]
) -> float:
    """Agreement of labels from scan to scan beyond chance, by the distances of organs' centroids.

    It is (chance - observed) / (chance - best) for the sum of the distances between organs of the
    same label in successive scans, its mean for random labels, and its minimum, as Cohen's kappa
    counts agreement. The stem is left out if it has the same label in most scans: that is often 0
    even if the labels of other organs are random. The agreement is 0 if successive scans have too
    few labels in common.
    """
    from scipy.optimize import linear_sum_assignment
    from scipy.spatial.distance import cdist

    at_base = [int(organs[root]) for organs, root in zip(labels, root_points, strict=True)]
    values, counts = np.unique(at_base, return_counts=True)
    stem = {int(values[np.argmax(counts)])} if 2 * counts.max() > len(labels) else set()
    scans = []
    for cloud, organs in zip(clouds, labels, strict=True):
        distinct, members = split_by_label(organs)
        centroids = (cloud.take(indices, axis=0).mean(axis=0) for indices in members)
        scans.append(dict(zip(distinct, centroids, strict=True)))
    observed = chance = best = 0.0
    shared = possible = 0
    for first, second in pairwise(scans):
        common = sorted((first.keys() & second.keys()) - stem)
        shared += len(common)
        possible += min(len(scan.keys() - stem) for scan in (first, second))
        if common:
            distances = cdist([first[name] for name in common], [second[name] for name in common])
            observed += float(np.trace(distances))
            chance += float(distances.mean()) * len(common)
            best += float(distances[linear_sum_assignment(distances)].sum())
    if shared < MIN_SHARED * possible:
        return 0.0
    return (chance - observed) / (chance - best) if chance > best else 1.0
