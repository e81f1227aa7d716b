"""Choose the field of a series that labels its organs, and drop the points of unwanted labels.

The choice is made for all scans together. A field that is constant or holds fractions does not
label organs; one whose values each occur in several separate places labels classes (stem, leaf),
not organs. A field of unknown name is used only if no other is found, and if neighbouring points
share its values as they share organs.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import compress

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError, excerpt
from baker.geometry.neighbors import nearest_neighbors
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
SAMPLED_SCANS = 3  # scans of a series of which the neighbourhoods are examined
NEIGHBORS, MIN_SAMPLE, MAX_SAMPLE = 8, 100, 10_000  # nearest neighbours; points of each scan
# In 20 real series, neighbours agree on the labels by 0.9 or more, and a label has 1.1 connected
# components at most; classes (stem, leaf) have 1.2 (two grasses) to 5, heights in steps 1.5 to 4.
MIN_AGREEMENT = 0.5  # Cohen's kappa of nearest neighbours
MAX_COMPONENTS, MAX_COMPONENTS_OF_FEW, FEW_VALUES = 2.0, 1.25, 3  # few: so many values or fewer
MIN_POINTS_OF_LABEL = 30  # the components of smaller labels are not counted
MAX_STEPS = 0.9  # share of unlike neighbours that differ by one; heights or scan lines have more


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
    scans: Sequence[Scan], is_asked: bool = False, are_needed: bool = False
) -> tuple[list[Scan], str, dict[int, str], tuple[Finding, ...]]:
    """Take the labels of each scan from the likeliest of its fields.

    Parameters
    ----------
    scans : sequence of Scan
    is_asked : bool
        Whether the user named the field; it is used whatever its values look like.
    are_needed : bool
        Whether the user said that there are labels; a field with a known name is then not doubted.

    Returns
    -------
    scans : list of Scan
    fields : str
        The names of the fields used, "" where there are no labels.
    words : dict
        Label -> word, where the fields hold words.
    findings : tuple of Finding
        The fields that were not used, and why.

    Raises
    ------
    InputError
        If the field that the user named holds neither whole numbers nor words.
    """
    names: list[str] = []
    findings: list[Finding] = []
    for name in sorted({name for scan in scans for name in scan.fields}, key=_order):
        is_known = is_asked or label_rank(name) is not None
        having = [scan for scan in scans if name in scan.fields]
        if not is_known and (names or min(map(len, having)) < MIN_SAMPLE):
            continue
        bad = [(scan.path, v) for scan in having for v in _not_whole(scan.fields[name])[:1]]
        if bad and is_asked:
            path, value = bad[0]
            raise InputError(
                f"'{path}': the field '{excerpt(name)}' holds {value:g}, but "
                "labels must be whole numbers or words; choose another field with --label-field, "
                "or read the scans without labels (--labels ignore)."
            )
        objection = _objection(name, having, [v for _, v in bad])
        is_overruled = are_needed and is_known and objection and objection.doubt
        if is_asked or not objection or is_overruled:
            names.append(name)
            if not is_known:
                reason = "is taken for labels: its values lie together as those of organs do"
                doubt = "its name does not say so"
                findings.append(_finding(name, reason, doubt, "--labels ignore"))
        elif is_known and not names:
            findings.append(objection)
    chosen = [next((name for name in names if name in scan.fields), "") for scan in scans]
    used = sorted(set(chosen) - {""}, key=_order)
    values = [scan.fields.get(name) for scan, name in zip(scans, chosen, strict=True)]
    numbers, words = _numbered(values if is_asked else _without_unlabelled(values))
    labelled = [
        scan if labels is None else replace(scan, labels=labels)
        for scan, labels in zip(scans, numbers, strict=True)
    ]
    kept = [finding for finding in findings if finding.doubt or not used]
    return labelled, ", ".join(map(excerpt, used)), words, tuple(kept)


def drop_labels(
    scans: Sequence[Scan], words: dict[int, str], dropped: str, keep_ground: bool
) -> tuple[list[Scan], tuple[Finding, ...]]:
    """Remove the points of the labels that the user drops, and of soil, pots and the like.

    Parameters
    ----------
    scans, words
        As `choose_labels` returns them.
    dropped : str
        Labels to drop, separated by commas.
    keep_ground : bool
        Whether labels of `GROUND_WORDS` stay.

    Raises
    ------
    InputError
        If no scan has a label of `dropped`, or a scan has no other labels.
    """
    asked = set(filter(None, dropped.lower().split(",")))
    found, removed, remaining = set[str](), set[str](), []
    for scan in scans:
        is_removed = np.zeros(len(scan), bool)
        for texts, index in _label_texts(scan, words):
            names = [text.lower() for text in texts]
            ground = set() if keep_ground else GROUND_WORDS
            matches = [t in asked or bool(ground & {*re.findall("[a-z]+", t)}) for t in names]
            is_removed |= np.array(matches, bool)[index]
            found |= {*names}
            removed |= {*compress(names, matches)}
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


def _label_texts(scan: Scan, words: dict[int, str]) -> Iterator[tuple[list[str], NDArray[np.intp]]]:
    """The distinct labels as texts, with the (N,) index of each point's; then fields of words."""
    if scan.labels is not None:
        numbers, index = np.unique(scan.labels, return_inverse=True)
        yield [words.get(number, str(number)) for number in numbers.tolist()], index
    for values in (field for field in scan.fields.values() if field.dtype.kind == "U"):
        texts, index = np.unique(values, return_inverse=True)
        yield texts.tolist(), index


def _order(name: str) -> tuple[int, str]:
    rank = label_rank(name)
    return (len(RANKS) if rank is None else rank), name


def _not_whole(values: NDArray) -> NDArray:
    """The numbers that can't be labels."""
    if values.dtype.kind in "iU":
        return values[:0]
    with np.errstate(invalid="ignore"):
        is_whole = (values == np.rint(values)) & (np.abs(values) < 2.0**63)
        return values[~(is_whole | np.isnan(values))]


def _objection(name: str, scans: Sequence[Scan], bad: Sequence[float]) -> Finding | None:
    """The reason why a field does not label organs; None if it seems to."""
    if bad:
        return _finding(name, f"is not used, as it holds {bad[0]:g}, which is no whole number")
    values = [scan.fields[name] for scan in scans]
    distinct_of_scan = list(map(np.unique, values))
    distinct = np.unique(np.concatenate(distinct_of_scan))
    texts = [str(value).strip().lower() for value in distinct]
    if len(distinct) == 1:
        return _finding(name, f"is not used, as it is {texts[0].removesuffix('.0')} everywhere")
    if max(map(len, distinct_of_scan)) == 1:
        return _finding(name, "is not used, as it is one number in each scan")
    sampled = np.unique(np.linspace(0, len(scans) - 1, SAMPLED_SCANS).astype(int))
    statistics = [_neighborhood_statistics(scans[k].points, values[k]) for k in sampled]
    agreement, components, steps = np.mean(statistics, axis=0)
    max_components = MAX_COMPONENTS_OF_FEW if len(distinct) <= FEW_VALUES else MAX_COMPONENTS
    doubt = ""
    if agreement < MIN_AGREEMENT:
        doubt = f"its {len(distinct)} values are mixed among neighbours, as an intensity's are"
    elif steps > MAX_STEPS:
        doubt = "its values change by one from point to point, as heights or scan lines do"
    elif components > max_components or (
        CLASSES & {*texts} and not re.search(r"\d", "".join(texts))
    ):
        doubt = "it seems to tell kinds of organs (stem, leaf) and not one organ from another"
    return _finding(name, "is not used", doubt, f"--label-field '{name}'") if doubt else None


def _finding(name: str, predicate: str, doubt: str = "", option: str = "") -> Finding:
    return Finding("labels", f"'{excerpt(name)}' {predicate}", doubt, option)


def _neighborhood_statistics(
    points: NDArray[np.floating], labels: NDArray
) -> tuple[float, float, float]:
    """Measure how the labels are spread over the kNN graph.

    Returns Cohen's kappa of nearest neighbours' labels; the median number of connected components
    of a label, effective (inverse Simpson index, so small ones count little); and the share of
    nearest neighbours that differ by one, of those that differ (0 where labels are few).
    """
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import connected_components

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
    edges = np.ones(len(source)), (source, neighbors[source, k])
    _, component = connected_components(csr_matrix(edges, shape=(len(points),) * 2), directed=False)
    _, first, size = np.unique(component, return_index=True, return_counts=True)
    components = counts**2 / np.bincount(label[first], size.astype(float) ** 2)
    is_large = counts >= MIN_POINTS_OF_LABEL  # a few points are separate by chance
    median = 1.0
    if is_large.any():  # over labels, or over points if that is more
        of_points = np.repeat(components[is_large], counts[is_large])
        median = max(np.median(components[is_large]), np.median(of_points))
    differences = np.abs(label[neighbors[:, 0]] - label)[~same[:, 0]]
    are_many = len(differences) and len(distinct) > NEIGHBORS
    steps = float((differences == 1).mean()) if are_many else 0.0
    return float(agreement), float(median), steps


def _numbered(
    values: Sequence[NDArray | None],
) -> tuple[list[NDArray[np.int64] | None], dict[int, str]]:
    """The labels of each scan as integers, -1 for none, and the words that they stand for."""
    if not any(labels is not None and labels.dtype.kind == "U" for labels in values):
        whole = [None if labels is None else np.nan_to_num(labels, nan=-1) for labels in values]
        return [None if labels is None else labels.astype(np.int64) for labels in whole], {}
    distinct = partial(np.unique, return_inverse=True)
    texts = [None if labels is None else distinct(labels.astype(str)) for labels in values]
    found = {str(word).strip() for text in texts if text for word in text[0]}
    spelling: dict[str, str] = {}  # lower case -> the first spelling
    for word in sorted(found - {""}, key=lambda word: (natural_key(word), word)):
        if word.lower() not in NO_LABEL:
            spelling.setdefault(word.lower(), word)
    number = {word: k for k, word in enumerate(spelling)}
    numbers = [
        text and np.array([number.get(w.strip().lower(), -1) for w in text[0].tolist()])[text[1]]
        for text in texts
    ]
    return numbers, dict(enumerate(spelling.values()))


def _without_unlabelled(values: Sequence[NDArray | None]) -> list[NDArray | None]:
    """Replace the labels of a scan by None where they are one number that means "no labels".

    That is a number that no scan with several labels has, or that follows such a scan.
    """
    distinct = [[] if labels is None else np.unique(labels).tolist() for labels in values]
    is_several = [len(names) > 1 for names in distinct]
    known = {name for names in compress(distinct, is_several) for name in names}
    unlabelled = [
        len(names) == 1 and (any(is_several[:k]) or (any(is_several) and names[0] not in known))
        for k, names in enumerate(distinct)
    ]
    return [None if empty else labels for labels, empty in zip(values, unlabelled, strict=True)]
