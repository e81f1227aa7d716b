"""Which names are found, which come first, and what their numbers mean."""

from pathlib import Path

import numpy as np
import pytest

from baker.errors import InputError
from baker.scans.cloud import Columns
from baker.scans.fields import choose_fields, to_srgb

HERE = Path("scan.ply")


def columns(**fields):
    position = {axis: np.arange(2.0) for axis in "xyz"}
    return Columns(position | {name: np.asarray(values) for name, values in fields.items()})


@pytest.mark.parametrize(
    "name", ["label", "scalar_label", "class", "classification", "instance", "segment"]
)
@pytest.mark.parametrize("change", [str.lower, str.upper, str.title])
def test_label_names(name, change):
    cloud = choose_fields(columns(**{change(name): [5, -6]}), HERE)
    assert cloud.labels.tolist() == [5, -6]
    assert f"labels from '{change(name)}'" in cloud.notes[-1]


def test_first_label_name_counts_unless_another_is_chosen():
    both = columns(segment=[1, 2], label=[3, 4], organ=[5, 6])
    assert choose_fields(both, HERE).labels.tolist() == [3, 4]
    assert choose_fields(both, HERE, label_field="Organ").labels.tolist() == [5, 6]
    with pytest.raises(InputError, match="no field 'leaf'; the fields found: x, y, z, segment"):
        choose_fields(both, HERE, label_field="leaf")


@pytest.mark.parametrize("kind", ["u1", "i1", "u2", "i4", "i8", ">i4", "f4", "f8", ">f8"])
def test_labels_of_any_type(kind):
    labels = choose_fields(columns(label=np.array([0, 100], kind)), HERE).labels
    assert labels.dtype == np.int64
    assert labels.tolist() == [0, 100]


@pytest.mark.parametrize("beyond", [2.0**63, -(2.0**63), 1e300, np.inf])
def test_labels_beyond_64_bits_are_none(beyond):
    for kind in (np.float32, np.float64):
        with np.errstate(over="ignore"), pytest.raises(InputError, match=r"'label' holds .*whole"):
            choose_fields(columns(label=np.array([0, beyond]).astype(kind)), HERE)
    assert choose_fields(columns(label=[0, 2.0**62]), HERE).labels.tolist() == [0, 2**62]


def test_extreme_labels():
    extreme = np.array([-(2**63), 2**63 - 1])
    assert choose_fields(columns(label=extreme), HERE).labels.tolist() == extreme.tolist()
    with pytest.raises(InputError, match="labels must be whole numbers"):
        choose_fields(columns(label=np.array([0, 2**64 - 1], np.uint64)), HERE)


@pytest.mark.parametrize(
    "names",
    [
        ("red", "green", "blue"),
        ("diffuse_red", "diffuse_green", "diffuse_blue"),
        ("r", "g", "b"),
        ("R", "G", "B"),
    ],
)
def test_color_names(names):
    fields = dict(zip(names, np.array([[1, 2], [3, 4], [5, 6]], np.uint8), strict=True))
    assert choose_fields(columns(**fields), HERE).colors.tolist() == [[1, 3, 5], [2, 4, 6]]


@pytest.mark.parametrize(
    ("values", "kind", "expected"),
    [
        ([0, 1], "u1", [0, 1]),
        ([0, 200], "i4", [0, 200]),
        ([0, 1], "u2", [0, 1]),
        ([0, 257 * 200], "u2", [0, 200]),
        ([0, 256 * 200], "u2", [0, 200]),
        ([0, 65535], "f8", [0, 255]),
        ([0, 1], "f4", [0, 255]),
        ([0, 0.2], "f8", [0, 51]),
        ([0, 200], "f8", [0, 200]),
        ([-1, 200], "i2", None),
        ([0, np.nan], "f4", None),
        ([0, 1e6], "f4", None),
    ],
)
def test_color_scales(values, kind, expected):
    colors, _ = to_srgb([np.array(values, kind)] * 3)
    if expected is None:
        assert colors is None
    else:
        assert colors.dtype == np.uint8
        assert colors.tolist() == [[value] * 3 for value in expected]


def test_senseless_colors_are_left_out_with_a_note():
    cloud = choose_fields(columns(r=[-1, 0], g=[0, 0], b=[0, 0]), HERE)
    assert cloud.colors is None
    assert "left out: values from -1 to 0 are no colours" in cloud.notes[-1]


def test_missing_axis():
    with pytest.raises(InputError, match=r"scan\.ply' has no field 'z'; the fields found: x, y"):
        choose_fields(Columns({"x": np.zeros(1), "y": np.zeros(1)}), HERE)
