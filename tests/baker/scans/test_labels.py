"""Which field is that of the labels, for all scans together, and what is dropped by label."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from baker.errors import InputError
from baker.scans.labels import choose_labels, drop_labels, label_rank
from baker.scans.scan import Scan

PATHS = [Path("a.ply"), Path("b.ply"), Path("c.ply")]
POINTS = np.arange(12.0).reshape(4, 3)


def clouds(*scans):
    return [
        Scan(POINTS, fields={n: np.asarray(values) for n, values in scan.items()}, path=path)
        for scan, path in zip(scans, PATHS, strict=False)
    ]


def chosen(*scans, is_requested=False):
    """The labels of each scan, what they were read from, and what was said."""
    labelled, field, _, findings = choose_labels(clouds(*scans), is_requested)
    labels = [None if cloud.labels is None else cloud.labels.tolist() for cloud in labelled]
    return labels, field, " ".join(finding.sentence for finding in findings)


@pytest.mark.parametrize("change", [str.lower, str.upper, str.title])
@pytest.mark.parametrize(
    "name",
    [
        "label",
        "scalar_label",
        "class",
        "classification",
        "instance",
        "segment",
        "organ_id",
        "leaf",
        "semantic",
        "instance_label",
        "gt_instance_id",
        "labels",
        "column",
    ],
)
def test_names_of_labels(name, change):
    assert label_rank(change(name)) is not None
    values = [5, 5, -6, -6]
    assert chosen({change(name): values}) == ([values], change(name), "")


@pytest.mark.parametrize(
    "name", ["leaf_area", "Original cloud index", "intensity", "point_source_id", "user_data", "id"]
)
def test_names_of_other_things(name):
    assert label_rank(name) is None


def test_instances_come_before_classes():
    names = ["instance", "organ", "leaf", "label", "segment", "class", "semantic", "column 4"]
    for first, second in pairwise(names):
        labels, field, _ = chosen({second: [1, 1, 2, 2], first: [3, 3, 4, 4]})
        assert (labels, field) == ([[3, 3, 4, 4]], first)
    assert label_rank("leafID") == label_rank("leafid") == label_rank("leaf")
    assert label_rank("organ_class") == label_rank("class") > label_rank("ins_label")
    assert label_rank("gt_instance_label") == label_rank("InstanceLabel") == label_rank("instance")


def test_what_is_the_same_everywhere_is_no_label():
    one, two = [1, 1, 1, 1], [1, 1, 2, 2]
    assert chosen({"label": one, "class": two}, {"label": one, "class": one})[1] == "class"
    labels, field, said = chosen({"classification": one}, {"classification": one})
    assert (labels, field) == ([None, None], "")
    assert said == "labels: 'classification' is not used, as it is the same everywhere in a scan."
    # One organ in the first scan, two in the second.
    assert chosen({"label": one}, {"label": two})[0] == [one, two]


def test_fractions_are_no_labels():
    labels, _, said = chosen({"column 4": [0.25, 1, 1, 1]})
    assert labels == [None]
    assert "'column 4' is not used, as it holds 0.25" in said
    with pytest.raises(InputError, match=r"'a.ply': the field 'area' holds 0.25"):
        chosen({"area": [0.25, 1, 1, 1]}, is_requested=True)


def test_intensities_are_no_labels():
    rng = np.random.default_rng(0)
    points, intensity = rng.random((5000, 3)), rng.integers(0, 256, 5000).astype(float)
    organs = np.floor(4 * points[:, 0])
    scans = [Scan(points, fields={"column 4": values}) for values in (intensity, organs)]
    found = [choose_labels([scan, scan]) for scan in scans]
    assert found[0][0][0].labels is None
    assert "--label-field 'column 4'" in found[0][3][0].sentence
    assert found[1][0][0].labels.tolist() == organs.tolist()
    named = Scan(points, fields={"instance": intensity})
    assert choose_labels([named, named])[1] == ""
    assert choose_labels([named, named], is_requested=True)[1] == "instance"


@pytest.mark.parametrize("kind", ["u1", "i1", "u2", "i4", "i8", ">i4", "f4", "f8", ">f8"])
def test_labels_of_any_type(kind):
    (cloud,), *_ = choose_labels(clouds({"label": np.array([0, 0, 100, 100], kind)}))
    assert cloud.labels.dtype == np.int64
    assert cloud.labels.tolist() == [0, 0, 100, 100]


@pytest.mark.parametrize("beyond", [2.0**63, -(2.0**63), 1e300, np.inf, 2**64 - 1])
def test_labels_beyond_64_bits_are_none(beyond):
    kind = np.uint64 if isinstance(beyond, int) else np.float64
    assert chosen({"label": np.array([0, 0, 1, beyond], kind)})[0] == [None]
    extreme = np.array([-(2**63), 0, 0, 2**63 - 1])
    assert chosen({"label": extreme})[0] == [extreme.tolist()]


def test_words_get_the_same_number_in_all_scans():
    scans = clouds(
        {"label": ["stem", "leaf2", "leaf2", "leaf10"]}, {"label": ["Leaf2 ", "leaf2", "Stem", ""]}
    )
    (first, second), field, words, _ = choose_labels(scans)
    assert (field, words) == ("label", {0: "Leaf2", 1: "leaf10", 2: "Stem"})
    assert first.labels.tolist() == [2, 0, 0, 1]
    assert second.labels.tolist() == [0, 0, 2, -1]


def test_scans_without_labels_among_others_stay_so():
    labels, field, _ = chosen({"label": [1, 1, 2, 2]}, {}, {"class": [5, 5, 6, 6]})
    assert labels == [[1, 1, 2, 2], None, [5, 5, 6, 6]]
    assert field == "label, class"


def test_labels_are_dropped():
    scans, _, words, _ = choose_labels(clouds({"label": [0, 0, 1, 2]}, {"label": [1, 1, 1, 0]}))
    left, (finding,) = drop_labels(scans, words, "0", False)
    assert [cloud.labels.tolist() for cloud in left] == [[1, 2], [1, 1, 1]]
    assert finding.sentence == "labels: '0', 3 points, taken out."
    assert drop_labels(scans, words, "", False) == (scans, ())
    with pytest.raises(InputError, match=r"--drop-label 7: no scan has .* found: 0, 1, 2\."):
        drop_labels(scans, words, "7", False)
    with pytest.raises(InputError, match=r"'b\.ply': without the labels to drop"):
        drop_labels(scans, words, "0,1", False)


def test_soil_by_name_is_dropped_unless_it_is_kept():
    scans, _, words, _ = choose_labels(clouds({"label": ["Soil", "pot_2", "leaf", "potato"]}))
    (left,), _ = drop_labels(scans, words, "", False)
    assert len(left) == 2
    assert drop_labels(scans, words, "", True)[1] == ()
    assert len(drop_labels(scans, words, "SOIL", True)[0][0]) == 3
    instance = Scan(
        POINTS, fields={"semantic": np.array(["soil", *3 * ["plant"]]), "id": np.arange(4)}
    )
    (scan,), *_ = choose_labels([instance])
    assert len(drop_labels([scan], {}, "", False)[0][0]) == 3


RNG = np.random.default_rng(0)
STEM = np.column_stack([RNG.normal(0, 0.2, (400, 2)), RNG.uniform(0, 10, 400)])
LEAVES = [RNG.uniform([0, 0, h - 0.1], [8, 1, h], (200, 3)) * [(-1) ** h, 1, 1] for h in (3, 6, 9)]
PLANT = np.concatenate([STEM, *LEAVES])
ORGANS = np.repeat([0, 1, 2, 3], [400, 200, 200, 200])


def choice(**fields):
    """The field that is taken of two scans of a plant, and what was said."""
    scans = [Scan(PLANT, fields=fields)] * 2
    _, field, _, findings = choose_labels(scans)
    return field, " ".join(finding.sentence for finding in findings)


def test_kinds_of_organs_are_no_labels():
    kinds = np.minimum(ORGANS, 1)
    assert choice(organ=ORGANS) == ("organ", "")
    field, said = choice(organ=kinds)
    assert field == ""
    assert "kinds of organs" in said
    assert "--label-field 'organ'" in said
    assert choice(organ=kinds, label=ORGANS)[0] == "label"
    assert choice(organ=np.array(["stem", "leaf"])[kinds])[0] == ""
    words = np.array(["stem", "leaf 1", "leaf 2", "leaf 3"])
    assert choice(organ=words[ORGANS]) == ("organ", "")


def test_a_few_points_do_not_tell_that_labels_are_kinds():
    few = np.zeros(len(PLANT), int)
    for leaf in (1, 2):
        few[np.flatnonzero(leaf == ORGANS)[np.argsort(-np.abs(LEAVES[leaf - 1][:, 0]))[:12]]] = 1
    assert choice(organ=few) == ("organ", "")


def test_labels_that_are_needed_are_taken_at_their_word():
    kinds = {"organ": np.minimum(ORGANS, 1)}
    scans = [Scan(PLANT, fields=kinds)] * 2
    assert choose_labels(scans)[1] == ""
    assert choose_labels(scans, is_labelled=True)[1] == "organ"


def test_a_field_of_any_name_counts_where_its_values_lie_as_organs_do():
    field, said = choice(object_no=ORGANS)
    assert (field, said) == ("object_no", "")
    field, said = choice(user_data=ORGANS)
    assert field == "user_data"
    assert "Look at this" in said
    assert choice(user_data=RNG.integers(0, 4, 1000)) == ("", "")
    assert choice(user_data=np.minimum(ORGANS, 1)) == ("", "")
    heights = np.argsort(np.argsort(PLANT[:, 2])) // 25
    assert choice(user_data=heights) == ("", "")
    assert choice(user_data=ORGANS + 7, leaf=ORGANS)[0] == "leaf"


def test_one_number_in_a_scan_among_labelled_ones_stands_for_none():
    one, two = [0, 0, 0, 0], [0, 0, 2, 2]
    assert chosen({"label": two}, {"label": one})[0] == [two, None]
    assert chosen({"label": [-1] * 4}, {"label": two})[0] == [None, two]
    assert chosen({"label": [1] * 4}, {"label": [2] * 4})[0] == [None, None]


def test_missing_numbers_are_negative_labels():
    assert chosen({"label": [0.0, 0.0, 1.0, np.nan]})[0] == [[0, 0, 1, -1]]
