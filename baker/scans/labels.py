"""Which field of a series is that of its labels, and what the labels are called.

All scans decide together: a field that is the same everywhere, holds fractions or, without a name
of its own, numbers that neighbours do not share, says nothing of organs.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError, excerpt
from baker.scans.cloud import Cloud
from baker.scans.finding import Finding
from baker.scans.times import natural_key

# What fields of labels are called: first those that tell organs apart, then those that tell their
# kinds, at last columns of texts without a header.
LABEL_WORDS = (
    "instance inst ins", "organ", "leaf leaflet", "label labels", "segment segmentation cluster",
    "class category type", "semantic semantics sem", "classification", "column",
)  # fmt: skip
INSTANCE, CLASS = 0, 5  # of these words
RANKS = {word: rank for rank, words in enumerate(LABEL_WORDS) for word in words.split()}
WORDS_BESIDE = {"scalar", "field", "id", "ids", "index", "number", "gt", "pred", "preds", "true"}
GROUND_WORDS = {"soil", "ground", "pot", "background", "floor", "table", "tray", "turntable"}
MIN_SHARED = 0.5  # of the points have the label of their nearest neighbour
SCANS_TO_ASK = 3  # of the series
MIN_SAMPLE, MAX_SAMPLE = 100, 10_000  # points among which neighbours are looked for


def label_rank(name: str) -> int | None:
    """How early a field of this name counts as labels; None where it never does."""
    words = re.findall("[a-z]+", re.sub("(?<=[a-z])(?=[A-Z])", " ", name).lower())
    words = [word.removesuffix("id") or word for word in words]
    ranks = [RANKS[word] for word in words if word in RANKS]
    if not ranks or not set(words) <= RANKS.keys() | WORDS_BESIDE:
        return None
    tells_kinds = max(ranks) >= CLASS and INSTANCE not in ranks  # an organ's class, not the organ
    return max(ranks) if tells_kinds else min(ranks)


def choose_labels(
    clouds: Sequence[Cloud], paths: Sequence[Path], is_asked: bool = False
) -> tuple[list[Cloud], str, dict[int, str], tuple[Finding, ...]]:
    """Take the labels of each scan from the likeliest of its fields.

    Returned with the scans: where labels are from ("" where there are none), what they are called
    where it is by words, and which fields were passed over; none where they are what the user
    asked for. Raises InputError where such a field holds neither whole numbers nor words.
    """
    names = sorted({name for cloud in clouds for name in cloud.fields}, key=_order)
    findings: list[Finding] = []
    for name in [*names]:
        having = [k for k, cloud in enumerate(clouds) if name in cloud.fields]
        bad = [(k, value) for k in having for value in _not_whole(clouds[k].fields[name])[:1]]
        if bad and is_asked:
            raise InputError(
                f"'{paths[bad[0][0]]}': the field '{excerpt(name)}' holds {bad[0][1]:g}, but "
                "labels must be whole numbers or words; choose another field with --label-field, "
                "or read the scans without labels (--labels ignore)."
            )
        objection = _objection(name, [clouds[k] for k in having], [v for _, v in bad])
        if objection and not is_asked:
            names.remove(name)
            findings.append(objection)
    chosen = [next((name for name in names if name in cloud.fields), "") for cloud in clouds]
    used = sorted(set(chosen) - {""}, key=_order)
    values = [cloud.fields.get(name) for cloud, name in zip(clouds, chosen, strict=True)]
    numbers, words = _numbered(values)
    labelled = [
        cloud if own is None else replace(cloud, labels=own, fields={})
        for cloud, own in zip(clouds, numbers, strict=True)
    ]
    kept = [finding for finding in findings if finding.doubt or not used]
    return labelled, ", ".join(map(excerpt, used)), words, tuple(kept)


def drop_labels(
    clouds: Sequence[Cloud],
    paths: Sequence[Path],
    words: dict[int, str],
    dropped: str,
    keep_ground: bool,
) -> tuple[list[Cloud], tuple[Finding, ...]]:
    """The scans without the points of some labels: those that are asked for, soil, pots and such.

    Raises InputError where no scan has a label that is asked for, or a scan has no other one.
    """
    names: dict[int, str] = {}
    for cloud in clouds:
        for label in np.unique(cloud.labels).tolist() if cloud.labels is not None else ():
            names[label] = words.get(label, str(label)).lower()
    out = set()
    for name in filter(None, dropped.lower().split(",")):
        if name not in names.values():
            found = excerpt(", ".join(sorted(names.values(), key=natural_key))) or "none"
            raise InputError(f"--drop-label {name}: no scan has such a label; found: {found}.")
        out |= {label for label, own in names.items() if own == name}
    if not keep_ground:
        kinds = {label: set(re.findall("[a-z]+", name)) for label, name in names.items()}
        out |= {label for label, kind in kinds.items() if kind & GROUND_WORDS}
    if not out:
        return list(clouds), ()
    left = []
    for cloud, path in zip(clouds, paths, strict=True):
        if cloud.labels is not None:
            kept = np.flatnonzero(~np.isin(cloud.labels, list(out)))
            if not len(kept):
                raise InputError(f"'{path}': without the labels to drop no points are left.")
            cloud = cloud.take(kept)
        left.append(cloud)
    count = sum(map(len, clouds)) - sum(map(len, left))
    listed = ", ".join(sorted({f"'{excerpt(names[label])}'" for label in out}))
    return left, (Finding("labels", f"{listed}, {count:,} points, taken out"),)


def _order(name: str) -> tuple[int, str]:
    rank = label_rank(name)
    return (-1 if rank is None else rank), name


def _not_whole(values: NDArray) -> NDArray:
    """Those of the numbers that can't be labels."""
    if values.dtype.kind in "iU":
        return values[:0]
    with np.errstate(invalid="ignore"):
        return values[~((values == np.rint(values)) & (np.abs(values) < 2.0**63))]


def _objection(name: str, clouds: Sequence[Cloud], bad: Sequence[float]) -> Finding | None:
    """Why a field is none of labels, if it isn't."""
    quoted = f"'{excerpt(name)}' is not used"
    if bad:
        return Finding("labels", f"{quoted}, as it holds {bad[0]:g}, which is no whole number")
    values = [cloud.fields[name] for cloud in clouds]
    distinct = np.unique(np.concatenate([np.unique(own) for own in values]))
    if len(distinct) == 1:
        return Finding("labels", f"{quoted}, as it is {distinct[0]} everywhere")
    if name.startswith("column "):
        some = clouds[:: -(-len(clouds) // SCANS_TO_ASK)]
        shared = [_share_with_neighbor(cloud.points, cloud.fields[name]) for cloud in some]
        if np.median(shared) < MIN_SHARED:
            mixed = f"its {len(distinct)} values are mixed among neighbours, as an intensity's are"
            return Finding("labels", quoted, mixed, f"--label-field '{name}'")
    return None


def _share_with_neighbor(points: NDArray[np.floating], labels: NDArray) -> float:
    from scipy.spatial import KDTree

    step = -(-len(points) // MAX_SAMPLE)
    points, labels = points[::step], labels[::step]
    if len(points) < MIN_SAMPLE:
        return 1.0
    return float(np.mean(labels[KDTree(points).query(points, k=2)[1][:, 1]] == labels))


def _numbered(
    values: Sequence[NDArray | None],
) -> tuple[list[NDArray[np.int64] | None], dict[int, str]]:
    """Labels as numbers, and the words that they stand for, where there are any."""
    if not any(own is not None and own.dtype.kind == "U" for own in values):
        return [None if own is None else own.astype(np.int64) for own in values], {}
    texts = [None if own is None else own.astype(str) for own in values]
    vocabulary = sorted(
        {str(w) for own in texts if own is not None for w in np.unique(own)}, key=natural_key
    )
    in_order = np.array(vocabulary)
    sorter = np.argsort(in_order)
    numbers = [
        None if own is None else sorter[np.searchsorted(in_order, own, sorter=sorter)]
        for own in texts
    ]
    return numbers, dict(enumerate(vocabulary))
