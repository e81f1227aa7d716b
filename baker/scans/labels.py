"""Choose the field of a series that labels its organs, and drop the points of unwanted labels.

The choice is made for all scans together. A field that is constant or holds fractions does not
label organs, nor does one whose values each occur in several separate places: they are classes
(stem, leaf), heights or intensities. A field of unknown name is used only if no other is found.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain, compress

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError, excerpt
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
SAMPLED_SCANS = 3  # scans of a series in which the places of labels are counted
NEIGHBORS, MIN_SAMPLE, MAX_SAMPLE = 8, 100, 10_000  # nearest neighbours; points of each scan
# In 23 real series an organ's label is in 1.04 places at most (in 22 of 23 up to 1.25, where one
# point in ten has a random label); stem and leaf in 1.13 to 5, in 19 of 20 more than 1.25; heights
# and other coordinates in steps in 1.39 or more, random numbers in 30 or more.
MAX_PLACES = 1.25


def label_rank(name: str) -> int | None:
    """Rank a field by its name: the lower, the likelier it labels organs; None if it does not."""
    words = re.findall("[a-z]+", re.sub("(?<=[a-z])(?=[A-Z])", " ", name).lower())
    known = RANKS.keys() | NEUTRAL_WORDS
    words = [w if w in known else re.sub("(?<=.)(id|number|(?<!s)s)$", "", w) for w in words]
    ranks = [RANKS[word] for word in words if word in RANKS]
    if not ranks or not known >= set(words):
        return None
    is_class = max(ranks) >= CLASS and INSTANCE not in ranks  # "organ class" ranks as a class
    return max(ranks) if is_class else min(ranks)


def choose_labels(
    scans: Sequence[Scan], is_asked: bool = False, are_needed: bool = False, map: MapLike = map
) -> tuple[list[Scan], str, dict[int, str], tuple[Finding, ...]]:
    """Take the labels of each scan from the likeliest of its fields.

    `is_asked`: the user named the field, which is used whatever its values look like. `are_needed`:
    the user said that there are labels; a field with a known name is then not doubted. `map` maps
    over the scans, in threads.

    Returns the scans, the names of the fields used ("" where there are no labels), the word for
    each label where the fields hold words, and why other fields were not used. Raises InputError if
    the field that the user named holds neither whole numbers nor words.
    """
    names: list[str] = []
    findings: list[Finding] = []
    for name in sorted({name for scan in scans for name in scan.fields}, key=_order):
        having = [scan for scan in scans if name in scan.fields]
        is_known = label_rank(name) is not None
        if is_asked:
            if found := _first_fraction(name, having):
                raise InputError(
                    f"'{found[0].path}': the field '{excerpt(name)}' holds {found[1]:g}, but "
                    "labels must be whole numbers or words; choose another field with "
                    "--label-field, or read the scans without labels (--labels ignore)."
                )
        elif not is_known and (names or min(map(len, having)) < MIN_SAMPLE):
            continue
        elif objection := _objection(name, having, is_known and are_needed, map):
            findings += [objection] if is_known and not names else []
            continue
        elif not is_known:
            reason = "is taken for labels: each of its values is in one place, as an organ is"
            findings.append(_finding(name, reason, "its name does not say so", "--labels ignore"))
        names.append(name)
    chosen = [next((name for name in names if name in scan.fields), "") for scan in scans]
    values = {k: scans[k].fields[name] for k, name in enumerate(chosen) if name}
    numbers, words = _numbered(values if is_asked else _without_unlabelled(values))
    labelled = list(scans)
    for k, labels in numbers.items():
        labelled[k] = replace(scans[k], labels=labels)
    used = ", ".join(excerpt(name) for name in names if name in chosen)
    kept = [finding for finding in findings if finding.doubt or not used]
    return labelled, used, words, tuple(kept)


def drop_labels(
    scans: Sequence[Scan], words: dict[int, str], dropped: str, keep_ground: bool
) -> tuple[list[Scan], tuple[Finding, ...]]:
    """Remove the points of the labels that the user drops, and of soil, pots and the like.

    `scans` and `words` are those of `choose_labels`, `dropped` lists labels, separated by commas;
    with `keep_ground` labels of `GROUND_WORDS` stay. Raises InputError if no scan has a label of
    `dropped`, or a scan has no other labels.
    """
    asked = set(filter(None, dropped.lower().split(",")))
    ground = set() if keep_ground else GROUND_WORDS
    found, removed, remaining = set[str](), set[str](), []
    for scan in scans:
        labels = [] if scan.labels is None else [scan.labels]
        fields_of_words = (field for field in scan.fields.values() if field.dtype.kind == "U")
        is_removed = np.zeros(len(scan), bool)
        for values in (*labels, *fields_of_words):
            distinct, index = np.unique(values, return_inverse=True)
            texts = [words.get(label, str(label)).lower() for label in distinct.tolist()]
            is_unwanted = [t in asked or bool(ground & {*re.findall("[a-z]+", t)}) for t in texts]
            is_removed |= np.array(is_unwanted, bool)[index]
            found.update(texts)
            removed.update(compress(texts, is_unwanted))
        if is_removed.all():
            raise InputError(f"'{scan.path}': without the labels to drop no points are left.")
        remaining.append(scan.take(np.flatnonzero(~is_removed)) if is_removed.any() else scan)
    if missing := sorted(asked - found):
        listed = excerpt(", ".join(sorted(found, key=natural_key))) or "none"
        raise InputError(f"--drop-label {missing[0]}: no scan has such a label; found: {listed}.")
    if not removed:
        return list(scans), ()
    count = sum(map(len, scans)) - sum(map(len, remaining))
    listed = ", ".join(f"'{excerpt(text)}'" for text in sorted(removed, key=natural_key))
    return remaining, (Finding("labels", f"{listed}, {count:,} points, taken out"),)


def _order(name: str) -> tuple[int, str]:
    rank = label_rank(name)
    return (len(RANKS) if rank is None else rank), name


def _first_fraction(name: str, scans: Sequence[Scan]) -> tuple[Scan, float] | None:
    """The first number of a field that can't be a label, with its scan; None if all can."""
    for scan in scans:
        values = scan.fields[name]
        if values.dtype.kind not in "iU":
            with np.errstate(invalid="ignore"):
                is_whole = (values == np.rint(values)) & (np.abs(values) < 2.0**63)
            is_label = is_whole | np.isnan(values)
            if not is_label.all():
                return scan, float(values[~is_label][0])
    return None


def _objection(name: str, scans: Sequence[Scan], is_trusted: bool, map: MapLike) -> Finding | None:
    """The reason why a field can't or does not seem to label organs; None if there is none.

    is_trusted: whether it labels organs if it can.
    """
    if found := _first_fraction(name, scans):
        return _finding(name, f"is not used, as it holds {found[1]:g}, which is no whole number")
    values = [scan.fields[name] for scan in scans]
    distinct = [np.unique(labels) for labels in values]
    if len(np.unique(np.concatenate(distinct))) == 1:
        value = str(distinct[0][0]).strip().lower().removesuffix(".0")
        return _finding(name, f"is not used, as it is {value} everywhere")
    if max(map(len, distinct)) == 1:
        return _finding(name, "is not used, as it is one number in each scan")
    if is_trusted:
        return None
    step = -(-len(scans) // SAMPLED_SCANS)
    places = map(_places, [scan.points for scan in scans[::-step]], values[::-step])
    if (mean := float(np.mean(list(places)))) <= MAX_PLACES:
        return None
    doubt = f"its values are in {mean:.1f} places each, as kinds of organs (stem, leaf) are"
    return _finding(name, "is not used", doubt, f"--label-field '{name}'")


def _places(points: NDArray[np.floating], labels: NDArray) -> float:
    """The number of connected components of a point's label in the kNN graph, on average.

    The number is effective (the inverse Simpson index), so that small components count little.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    step = -(-len(points) // MAX_SAMPLE)
    points = points[::step]
    _, label, count = np.unique(labels[::step], return_inverse=True, return_counts=True)
    if len(points) < MIN_SAMPLE or len(count) == 1:
        return 1.0
    neighbors = nearest_neighbors(points, NEIGHBORS).indices
    source, k = np.nonzero(label[neighbors] == label[:, None])
    graph = csr_array((np.ones(len(source)), (source, neighbors[source, k])), (len(points),) * 2)
    _, component = connected_components(graph, directed=False)
    _, first, size = np.unique(component, return_index=True, return_counts=True)
    places = count**2 / np.bincount(label[first], size.astype(float) ** 2)
    return float(np.average(places, weights=count))


def _finding(name: str, predicate: str, doubt: str = "", option: str = "") -> Finding:
    return Finding("labels", f"'{excerpt(name)}' {predicate}", doubt, option)


def _numbered(
    values: Mapping[int, NDArray],
) -> tuple[dict[int, NDArray[np.int64]], dict[int, str]]:
    """The labels of each scan as integers, -1 for none, and the words that they stand for."""
    if not any(labels.dtype.kind == "U" for labels in values.values()):
        numbers = {k: np.nan_to_num(labels, nan=-1) for k, labels in values.items()}
        return {k: labels.astype(np.int64) for k, labels in numbers.items()}, {}
    coded = {k: np.unique(labels, return_inverse=True) for k, labels in values.items()}
    texts = {k: [str(label).strip() for label in coded[k][0].tolist()] for k in coded}
    spelling: dict[str, str] = {}  # lower case -> the first spelling
    for text in sorted(set(chain(*texts.values())), key=lambda text: (natural_key(text), text)):
        if text.lower() not in NO_LABEL:
            spelling.setdefault(text.lower(), text)
    number = {word: n for n, word in enumerate(spelling)}
    numbers = {
        k: np.array([number.get(text.lower(), -1) for text in texts[k]])[index]
        for k, (_, index) in coded.items()
    }
    return numbers, dict(enumerate(spelling.values()))


def _without_unlabelled(values: Mapping[int, NDArray]) -> dict[int, NDArray]:
    """Leave out the scans whose labels are one number that means "no labels".

    That is a number that no scan with several labels has, or that follows such a scan.
    """
    distinct = {k: {*np.unique(labels).tolist()} for k, labels in values.items()}
    several = [k for k, names in distinct.items() if len(names) > 1]
    known = {name for k in several for name in distinct[k]}
    return {
        k: labels
        for k, labels in values.items()
        if k in several or not several or (k < several[0] and distinct[k] <= known)
    }
