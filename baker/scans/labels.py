"""Choose the field that labels the organs of a series, and drop labels that are not the plant's.

The choice is made for all scans together. A field that is constant or holds fractions does not
label organs; one whose values each have several connected components labels classes (stem, leaf)
instead. A field of unknown name is used only if there is no field of a known name, and if its
values agree among neighbouring points as labels of organs do.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import compress

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError, excerpt
from baker.geometry.graph import edge_components
from baker.geometry.neighbors import nearest_neighbors
from baker.geometry.parallel import MapLike
from baker.scans.scan import Finding, Scan
from baker.scans.times.schedule import natural_key

# Words in the names of label fields, in the order of preference: first those of single organs, then
# those of classes of organs, at last the columns of text files without a header.
LABEL_WORDS = (
    "instance inst ins", "organ", "leaf leaflet", "label annotation", "part object",
    "segment seg segmentation cluster", "class category type", "semantic sem", "classification",
    "column",
)  # fmt: skip
INSTANCE, CLASS = 0, 6  # ranks of the words of single organs, and of the first words of classes
RANKS = {word: rank for rank, words in enumerate(LABEL_WORDS) for word in words.split()}
NEUTRAL_WORDS = {"scalar", "field", "id", "index", "number", "no", "name", "gt", "pred", "true"}
NEUTRAL_WORDS |= {"plant"}
GROUND_WORDS = {"soil", "ground", "pot", "background", "floor", "table", "tray", "turntable"}
NO_LABEL = {"", "nan", "none", "null", "na", "unlabelled", "unlabeled", "unclassified", "noise"}
CLASSES = {"leaf", "leaves", "leaflet", "leaflets", "petiole", "petioles"}  # a plant has several
SAMPLED_SCANS = 3  # number of scans of a series whose neighbourhoods are examined
NEIGHBORS = 8  # of a point in the kNN graph of a sample
MIN_SAMPLE, MAX_SAMPLE = 100, 10_000  # number of points of a scan that are examined
MIN_POINTS_OF_LABEL = 30  # the components of smaller labels are not counted
# In 20 real series, neighbours agree on the labels by 0.9 or more, and a label has 1.1 connected
# components at most; classes (stem, leaf) have 1.2 (two grasses) to 5, heights in steps 1.5 to 4.
MIN_AGREEMENT = 0.5  # Cohen's kappa of nearest neighbours
MAX_COMPONENTS, MAX_COMPONENTS_OF_FEW, FEW_VALUES = 2.0, 1.25, 3  # few: so many values or fewer
MAX_STEPS = 0.9  # share of unlike neighbours that differ by one; heights or scan lines have more


def label_rank(name: str) -> int | None:
    """Rank a field by its name; lower ranks are more likely to label organs, None is unknown."""
    words = re.findall("[a-z]+", re.sub("(?<=[a-z])(?=[A-Z])", " ", name).lower())
    known_words = RANKS.keys() | NEUTRAL_WORDS
    words = [w if w in known_words else re.sub("(?<=.)(id|number|(?<!s)s)$", "", w) for w in words]
    ranks = [RANKS[word] for word in words if word in RANKS]
    if not ranks or not known_words >= set(words):
        return None
    is_class = max(ranks) >= CLASS and INSTANCE not in ranks  # "organ class" ranks as a class
    return max(ranks) if is_class else min(ranks)


def choose_labels(
    scans: Sequence[Scan], is_requested: bool = False, is_labelled: bool = False, map: MapLike = map
) -> tuple[list[Scan], str, dict[int, str], tuple[Finding, ...]]:
    """Take the labels of each scan from the field that most likely labels its organs.

    is_requested: whether the user named the field; it is used whatever its values are, and
    InputError is raised if it holds neither whole numbers nor words. is_labelled: whether the user
    said that there are labels; a field with a known name is then not doubted.

    Also returns the names of the fields used, "" where there are no labels; the words that labels
    stand for, where the fields hold words; and findings about fields that were not used.
    """
    names: list[str] = []
    findings: list[Finding] = []
    ranks = {name: label_rank(name) for scan in scans for name in scan.fields}
    for name in sorted(ranks, key=lambda name: (ranks[name] is None, ranks[name] or 0, name)):
        candidates = [scan for scan in scans if name in scan.fields]
        is_known = is_requested or ranks[name] is not None
        if not is_known and (names or min(len(scan) for scan in candidates) < MIN_SAMPLE):
            continue
        objection = _objection(name, candidates, is_requested, is_known and is_labelled, map)
        if objection is None:
            names.append(name)
            if not is_known:
                reason = "is taken for labels: its values lie together as those of organs do"
                doubt = "its name does not say so"
                findings.append(_finding(name, reason, doubt, "--labels ignore"))
        elif is_known and not names:
            findings.append(objection)
    used_names = [next((name for name in names if name in scan.fields), "") for scan in scans]
    values = {k: scans[k].fields[name] for k, name in enumerate(used_names) if name}
    numbers, words = _as_integers(values if is_requested else _without_unlabelled(values))
    labelled = [
        replace(scan, labels=numbers[k]) if k in numbers else scan for k, scan in enumerate(scans)
    ]
    used = ", ".join(excerpt(name) for name in names if name in used_names)
    reported = [finding for finding in findings if finding.doubt or not used]
    return labelled, used, words, tuple(reported)


def drop_labels(
    scans: Sequence[Scan], words: dict[int, str], dropped: str, keep_ground: bool
) -> tuple[list[Scan], tuple[Finding, ...]]:
    """Remove the points of the labels that the user drops, and of soil, pots and the like.

    scans, words: as `choose_labels` returns them. dropped: labels, separated by commas.
    keep_ground: whether labels of `GROUND_WORDS` stay. Raises InputError if no scan has a label of
    `dropped`, or a scan has no other labels.
    """
    drops = set(filter(None, dropped.lower().split(",")))
    ground = set() if keep_ground else GROUND_WORDS
    all_texts, removed, remaining = set[str](), set[str](), []
    for scan in scans:
        labels = [] if scan.labels is None else [scan.labels]
        fields_of_words = (field for field in scan.fields.values() if field.dtype.kind == "U")
        is_removed = np.zeros(len(scan), bool)
        for values in (*labels, *fields_of_words):
            distinct, index = np.unique(values, return_inverse=True)
            texts = [words.get(label, str(label)).lower() for label in distinct.tolist()]
            is_unwanted = [t in drops or bool(ground & {*re.findall("[a-z]+", t)}) for t in texts]
            is_removed |= np.array(is_unwanted, bool)[index]
            all_texts.update(texts)
            removed.update(compress(texts, is_unwanted))
        if is_removed.all():
            raise InputError(f"'{scan.path}': without the labels to drop no points are left.")
        remaining.append(scan.take(np.flatnonzero(~is_removed)) if is_removed.any() else scan)
    if missing := sorted(drops - all_texts):
        listed = excerpt(", ".join(sorted(all_texts, key=natural_key))) or "none"
        raise InputError(f"--drop-label {missing[0]}: no scan has such a label; found: {listed}.")
    if not removed:
        return list(scans), ()
    count = sum(map(len, scans)) - sum(map(len, remaining))
    listed = ", ".join(f"'{excerpt(text)}'" for text in sorted(removed, key=natural_key))
    return remaining, (Finding("labels", f"{listed}, {count:,} points, taken out"),)


def _fraction(values: NDArray) -> float | None:
    """The first number that can't be a label; None if all values can."""
    if values.dtype.kind in "iU":
        return None
    with np.errstate(invalid="ignore"):
        is_whole = (values == np.rint(values)) & (np.abs(values) < 2.0**63)
    is_label = is_whole | np.isnan(values)
    return None if is_label.all() else float(values[~is_label][0])


def _objection(
    name: str, scans: Sequence[Scan], is_requested: bool, is_trusted: bool, map: MapLike
) -> Finding | None:
    """The reason why a field is not taken for labels of organs; None if it is.

    is_requested: whether the user named it. is_trusted: whether it is taken however its values are
    distributed. Raises InputError if the field that the user named holds a number that is no label.
    """
    values = [scan.fields[name] for scan in scans]
    for scan, labels in zip(scans, values, strict=True):
        if (fraction := _fraction(labels)) is not None:
            description = f"holds {fraction:g}"
            if not is_requested:
                return _finding(name, f"is not used, as it {description}, which is no whole number")
            raise InputError(
                f"'{scan.path}': the field '{excerpt(name)}' {description}, but labels must be "
                "whole numbers or words; choose another field with --label-field, or read the "
                "scans without labels (--labels ignore)."
            )
    distinct_of_scan = [np.unique(labels) for labels in values]
    if not is_requested and max(len(distinct) for distinct in distinct_of_scan) == 1:
        return _finding(name, "is not used, as it is the same everywhere in a scan")
    if is_requested or is_trusted:
        return None
    distinct = np.unique(np.concatenate(distinct_of_scan))
    texts = [str(value).strip().lower() for value in distinct]
    sampled = np.unique(np.linspace(0, len(scans) - 1, SAMPLED_SCANS).astype(int))
    samples = [scans[k].points for k in sampled], [values[k] for k in sampled]
    agreement, components, steps = np.mean(list(map(label_statistics, *samples)), axis=0)
    are_kinds = bool(CLASSES & {*texts}) and not re.search(r"\d", "".join(texts))
    max_components = MAX_COMPONENTS_OF_FEW if len(distinct) <= FEW_VALUES else MAX_COMPONENTS
    if agreement < MIN_AGREEMENT:
        doubt = f"its {len(distinct)} values are mixed among neighbours, as an intensity's are"
    elif steps > MAX_STEPS:
        doubt = "its values change by one from point to point, as heights or scan lines do"
    elif components > max_components or are_kinds:
        doubt = "it seems to tell kinds of organs (stem, leaf) and not one organ from another"
    else:
        return None
    return _finding(name, "is not used", doubt, f"--label-field '{name}'")


def _finding(name: str, predicate: str, doubt: str = "", option: str = "") -> Finding:
    return Finding("labels", f"'{excerpt(name)}' {predicate}", doubt, option)


def _as_integers(
    values: Mapping[int, NDArray],
) -> tuple[dict[int, NDArray[np.int64]], dict[int, str]]:
    """The labels of each scan as integers, -1 for none, and the words that they stand for."""
    if not any(labels.dtype.kind == "U" for labels in values.values()):
        numbers = {k: np.nan_to_num(labels, nan=-1) for k, labels in values.items()}
        return {k: labels.astype(np.int64) for k, labels in numbers.items()}, {}
    coded = {k: np.unique(v.astype(str), return_inverse=True) for k, v in values.items()}
    texts = {text.strip() for distinct, _ in coded.values() for text in distinct.tolist()}
    spelling: dict[str, str] = {}  # lower case -> the first spelling
    for text in sorted(texts, key=lambda text: (natural_key(text), text)):
        if text.lower() not in NO_LABEL:
            spelling.setdefault(text.lower(), text)
    number = {word: n for n, word in enumerate(spelling)}
    numbers = {
        k: np.array([number.get(text.strip().lower(), -1) for text in distinct.tolist()])[index]
        for k, (distinct, index) in coded.items()
    }
    return numbers, dict(enumerate(spelling.values()))


def _without_unlabelled(values: Mapping[int, NDArray]) -> dict[int, NDArray]:
    """Leave out the scans whose only label is a number that means "no labels".

    It does, unless all scans have only one label, or the scan precedes all scans with several
    labels and one of these has the label, too: a seedling that is only a stem.
    """
    distinct = {k: {*np.unique(labels).tolist()} for k, labels in values.items()}
    with_several = [k for k, names in distinct.items() if len(names) > 1]
    earlier = {name for k in with_several for name in distinct[k]}
    return {
        k: labels
        for k, labels in values.items()
        if k in with_several or not with_several or (k < with_several[0] and distinct[k] <= earlier)
    }


def label_statistics(points: NDArray[np.floating], labels: NDArray) -> tuple[float, float, float]:
    """Measure how the (N,) labels of a scan, numbers or words, are distributed on its kNN graph.

    Returns Cohen's kappa of the labels of nearest neighbours; the median effective number of
    connected components of a label (the inverse Simpson index, in which small components count
    little); and, of the nearest neighbours whose labels differ, the share whose labels differ by
    one, 0 if there are few labels.
    """
    step = -(-len(points) // MAX_SAMPLE)
    points = points[::step]
    distinct, label = np.unique(labels[::step], return_inverse=True)
    if len(points) < MIN_SAMPLE or len(distinct) == 1:
        return 1.0, 1.0, 0.0
    neighbors = nearest_neighbors(points, NEIGHBORS).indices
    same = label[neighbors] == label[:, None]
    counts = np.bincount(label)
    by_chance = float(((counts / len(label)) ** 2).sum())
    agreement = (same[:, 0].mean() - by_chance) / (1.0 - by_chance)

    source, k = np.nonzero(same)
    component = edge_components(np.stack([source, neighbors[source, k]]), len(points))
    _, first, size = np.unique(component, return_index=True, return_counts=True)
    components = counts**2 / np.bincount(label[first], size.astype(float) ** 2)
    is_large = counts >= MIN_POINTS_OF_LABEL  # a few points are separate by chance
    median = 1.0
    if is_large.any():  # over labels, or over points if that is more
        point_components = np.repeat(components[is_large], counts[is_large])
        median = max(np.median(components[is_large]), np.median(point_components))

    steps = 0.0
    if len(distinct) > NEIGHBORS and not same[:, 0].all():
        differences = np.abs(label[neighbors[:, 0]] - label)[~same[:, 0]]
        steps = float((differences == 1).mean())
    return float(agreement), float(median), steps
