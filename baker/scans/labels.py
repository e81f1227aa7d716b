"""Which field of a series is that of its labels, and what the labels are called.

All scans decide together. A field that is the same everywhere or holds fractions says nothing of
organs, and one whose values lie in several separate places each tells kinds of them. Fields whose
names say nothing count, after all others, where neighbours share their values as in organs.
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

# What fields of labels are called: first those that tell organs apart, then those that tell their
# kinds, at last columns of texts without a header.
LABEL_WORDS = (
    "instance inst ins", "organ", "leaf leaflet", "label annotation", "part object",
    "segment seg segmentation cluster", "class category type", "semantic sem", "classification",
    "column",
)  # fmt: skip
INSTANCE, CLASS = 0, 6  # of these words
RANKS = {word: rank for rank, words in enumerate(LABEL_WORDS) for word in words.split()}
WORDS_BESIDE = {"scalar", "field", "id", "index", "number", "no", "name", "gt", "pred", "true"}
WORDS_BESIDE |= {"plant"}
GROUND_WORDS = {"soil", "ground", "pot", "background", "floor", "table", "tray", "turntable"}
NO_LABEL = {"", "nan", "none", "null", "na", "unlabelled", "unlabeled", "unclassified", "noise"}
KINDS = {"leaf", "leaves", "leaflet", "leaflets", "petiole", "petioles"}  # not one of a plant
SCANS_TO_ASK = 3  # of the series
NEIGHBORS, MIN_SAMPLE, MAX_SAMPLE = 8, 100, 10_000  # among how many points they are looked for
# The labels of 20 real series have an agreement of 0.9 or more and lie in 1.1 places each at most;
# their kinds, stem and leaf, in 1.2 (two grasses) to 5, heights in steps in 1.5 to 4.
MIN_AGREEMENT = 0.5  # of neighbours, beyond chance
MAX_PLACES, MAX_PLACES_OF_FEW, FEW_VALUES = 2.0, 1.25, 3  # in which a label may lie
MIN_POINTS_OF_PLACE = 30
MAX_STEPS = 0.9  # of neighbours that differ, differ by one: heights or scan lines


def label_rank(name: str) -> int | None:
    """How early a field of this name counts as labels; None where it never does."""
    words = re.findall("[a-z]+", re.sub("(?<=[a-z])(?=[A-Z])", " ", name).lower())
    known = RANKS.keys() | WORDS_BESIDE
    words = [w if w in known else re.sub("(?<=.)(id|number|(?<!s)s)$", "", w) for w in words]
    ranks = [RANKS[word] for word in words if word in RANKS]
    if not ranks or not known >= set(words):
        return None
    tells_kinds = max(ranks) >= CLASS and INSTANCE not in ranks  # an organ's class, not the organ
    return max(ranks) if tells_kinds else min(ranks)


def choose_labels(
    scans: Sequence[Scan],
    is_asked: bool = False,
    are_needed: bool = False,
) -> tuple[list[Scan], str, dict[int, str], tuple[Finding, ...]]:
    """Take the labels of each scan from the likeliest of its fields.

    is_asked: the fields are named by the user. are_needed: the user said that there are labels, so
    a field that is called labels is not doubted. Returned with the scans: where labels are from (""
    where there are none), what they are called where it is by words, and which fields were passed
    over; none where they are what the user asked for. Raises InputError where such a field holds
    neither whole numbers nor words.
    """
    names: list[str] = []
    findings: list[Finding] = []
    for name in sorted({name for scan in scans for name in scan.fields}, key=_order):
        is_known = is_asked or label_rank(name) is not None
        having = [scan for scan in scans if name in scan.fields]
        if not is_known and (names or min(map(len, having)) < MIN_SAMPLE):
            continue
        bad = [(one.path, v) for one in having for v in _not_whole(one.fields[name])[:1]]
        if bad and is_asked:
            raise InputError(
                f"'{bad[0][0]}': the field '{excerpt(name)}' holds {bad[0][1]:g}, but "
                "labels must be whole numbers or words; choose another field with --label-field, "
                "or read the scans without labels (--labels ignore)."
            )
        objection = _objection(name, having, [v for _, v in bad])
        at_their_word = are_needed and is_known and objection and objection.doubt
        if is_asked or not objection or at_their_word:
            names.append(name)
            if not is_known:
                said = "is taken for labels: its values lie together as those of organs do"
                findings.append(_finding(name, said, "its name does not say so", "--labels ignore"))
        elif is_known and not names:
            findings.append(objection)
    chosen = [next((name for name in names if name in scan.fields), "") for scan in scans]
    used = sorted(set(chosen) - {""}, key=_order)
    values = [scan.fields.get(name) for scan, name in zip(scans, chosen, strict=True)]
    numbers, words = _numbered(values if is_asked else _without_unlabelled(values))
    labelled = [
        scan if own is None else replace(scan, labels=own)
        for scan, own in zip(scans, numbers, strict=True)
    ]
    kept = [finding for finding in findings if finding.doubt or not used]
    return labelled, ", ".join(map(excerpt, used)), words, tuple(kept)


def drop_labels(
    scans: Sequence[Scan],
    words: dict[int, str],
    dropped: str,
    keep_ground: bool,
) -> tuple[list[Scan], tuple[Finding, ...]]:
    """The scans without the points of some labels: those that are asked for, soil, pots and such.

    Raises InputError where no scan has a label that is asked for, or a scan has no other one.
    """
    asked = set(filter(None, dropped.lower().split(",")))
    found, out, left = set[str](), set[str](), []
    for scan in scans:
        held = np.zeros(len(scan), bool)
        for texts, index in _named(scan, words):
            named = [text.lower() for text in texts]
            ground = set() if keep_ground else GROUND_WORDS
            is_out = [t in asked or bool(ground & {*re.findall("[a-z]+", t)}) for t in named]
            held |= np.array(is_out, bool)[index]
            found |= {*named}
            out |= {*compress(named, is_out)}
        if held.all():
            raise InputError(f"'{scan.path}': without the labels to drop no points are left.")
        left.append(scan.take(np.flatnonzero(~held)) if held.any() else scan)
    if missing := sorted(asked - found):
        listed = excerpt(", ".join(sorted(found, key=natural_key))) or "none"
        raise InputError(f"--drop-label {missing[0]}: no scan has such a label; found: {listed}.")
    if not out:
        return list(scans), ()
    count = sum(map(len, scans)) - sum(map(len, left))
    listed = ", ".join(f"'{excerpt(text)}'" for text in sorted(out, key=natural_key))
    return left, (Finding("labels", f"{listed}, {count:,} points, taken out"),)


def _named(scan: Scan, words: dict[int, str]) -> Iterator[tuple[list[str], NDArray[np.intp]]]:
    """The distinct labels as texts and which of them each point has; likewise fields of words."""
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
    """Those of the numbers that can't be labels."""
    if values.dtype.kind in "iU":
        return values[:0]
    with np.errstate(invalid="ignore"):
        is_whole = (values == np.rint(values)) & (np.abs(values) < 2.0**63)
        return values[~(is_whole | np.isnan(values))]


def _objection(name: str, scans: Sequence[Scan], bad: Sequence[float]) -> Finding | None:
    """Why a field is none of labels, if it isn't."""
    if bad:
        return _finding(name, f"is not used, as it holds {bad[0]:g}, which is no whole number")
    values = [scan.fields[name] for scan in scans]
    in_scans = [np.unique(own) for own in values]
    distinct = np.unique(np.concatenate(in_scans))
    texts = [str(value).strip().lower() for value in distinct]
    if len(distinct) == 1:
        return _finding(name, f"is not used, as it is {texts[0].removesuffix('.0')} everywhere")
    if max(map(len, in_scans)) == 1:
        return _finding(name, "is not used, as it is one number in each scan")
    asked = np.unique(np.linspace(0, len(scans) - 1, SCANS_TO_ASK).astype(int))
    found = [_patches(scans[k].points, values[k]) for k in asked]
    agreement, places, steps = np.mean(found, axis=0)
    doubt = ""
    if agreement < MIN_AGREEMENT:
        doubt = f"its {len(distinct)} values are mixed among neighbours, as an intensity's are"
    elif steps > MAX_STEPS:
        doubt = "its values change by one from point to point, as heights or scan lines do"
    elif places > (MAX_PLACES_OF_FEW if len(distinct) <= FEW_VALUES else MAX_PLACES) or (
        KINDS & {*texts} and not re.search(r"\d", "".join(texts))
    ):
        doubt = "it seems to tell kinds of organs (stem, leaf) and not one organ from another"
    return _finding(name, "is not used", doubt, f"--label-field '{name}'") if doubt else None


def _finding(name: str, said: str, doubt: str = "", option: str = "") -> Finding:
    return Finding("labels", f"'{excerpt(name)}' {said}", doubt, option)


def _patches(points: NDArray[np.floating], labels: NDArray) -> tuple[float, float, float]:
    """How labels lie: agreement of nearest neighbours, places of a label, steps by one.

    The first is beyond chance (Cohen's kappa). The second is the typical label's number of
    connected components, as the inverse of Simpson's index counts them. The third is the share of
    nearest neighbours that differ by one, among those that differ; 0 where labels are few.
    """
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import connected_components

    step = -(-len(points) // MAX_SAMPLE)
    points = points[::step]
    names, label = np.unique(labels[::step], return_inverse=True)
    if len(points) < MIN_SAMPLE or len(names) == 1:
        return 1.0, 1.0, 0.0
    near = nearest_neighbors(points, NEIGHBORS).indices
    same = label[near] == label[:, None]
    counts = np.bincount(label)
    by_chance = float(((counts / len(label)) ** 2).sum())
    agreement = (same[:, 0].mean() - by_chance) / (1.0 - by_chance)
    source, k = np.nonzero(same)
    edges = np.ones(len(source)), (source, near[source, k])
    _, piece = connected_components(csr_matrix(edges, shape=(len(points),) * 2), directed=False)
    _, first, size = np.unique(piece, return_index=True, return_counts=True)
    places = counts**2 / np.bincount(label[first], size.astype(float) ** 2)
    many = counts >= MIN_POINTS_OF_PLACE  # a few points lie apart by chance
    places, counts = places[many], counts[many]
    typical = max(np.median(places), np.median(np.repeat(places, counts))) if many.any() else 1.0
    differ = np.abs(label[near[:, 0]] - label)[~same[:, 0]]
    steps = float((differ == 1).mean()) if len(differ) and len(names) > NEIGHBORS else 0.0
    return float(agreement), float(typical), steps


def _numbered(
    values: Sequence[NDArray | None],
) -> tuple[list[NDArray[np.int64] | None], dict[int, str]]:
    """Labels as numbers, -1 where they are none; the words that they stand for, if any."""
    if not any(own is not None and own.dtype.kind == "U" for own in values):
        whole = [None if own is None else np.nan_to_num(own, nan=-1) for own in values]
        return [None if own is None else own.astype(np.int64) for own in whole], {}
    distinct = partial(np.unique, return_inverse=True)
    texts = [None if own is None else distinct(own.astype(str)) for own in values]
    found = {str(word).strip() for text in texts if text for word in text[0]}
    spelled: dict[str, str] = {}  # by the word in lower case
    for word in sorted(found - {""}, key=lambda word: (natural_key(word), word)):
        if word.lower() not in NO_LABEL:
            spelled.setdefault(word.lower(), word)
    number = {word: k for k, word in enumerate(spelled)}
    numbers = [
        text and np.array([number.get(w.strip().lower(), -1) for w in text[0].tolist()])[text[1]]
        for text in texts
    ]
    return numbers, dict(enumerate(spelled.values()))


def _without_unlabelled(values: Sequence[NDArray | None]) -> list[NDArray | None]:
    """The labels of each scan; None where one number, which is no organ, stands for no labels.

    That is one that no other scan has, or that comes after scans with several organs.
    """
    in_scans = [[] if own is None else np.unique(own).tolist() for own in values]
    left: list[NDArray | None] = []
    for k, (own, names) in enumerate(zip(values, in_scans, strict=True)):
        others = [other for i, other in enumerate(in_scans) if i != k and len(other) > 1]
        is_new = bool(others) and not any(names[:1] == [n] for other in others for n in other)
        is_late = any(len(other) > 1 for other in in_scans[:k])
        left.append(None if len(names) == 1 and (is_new or is_late) else own)
    return left
