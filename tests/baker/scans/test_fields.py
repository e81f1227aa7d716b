"""Which names are found, which come first, and what their numbers mean."""

from pathlib import Path

import numpy as np
import pytest

from baker.errors import InputError
from baker.scans.fields import choose_fields, to_srgb
from baker.scans.formats import Columns

HERE = Path("scan.ply")


def columns(**fields):
    position = {axis: np.arange(2.0) for axis in "xyz"}
    return Columns(position | {name: np.asarray(values) for name, values in fields.items()})


def test_fields_that_may_be_labels():
    cloud = choose_fields(columns(segment=[1, 2], area=[0.5, 4], Organ=[5, 6], z2=[7, 8]), HERE)
    assert list(cloud.fields) == ["segment", "Organ", "z2"]
    assert not choose_fields(columns(label=[1, 2]), HERE, use_labels=False).fields
    asked = choose_fields(columns(label=[1, 2], Area=[3, 4]), HERE, label_field="area")
    assert list(asked.fields) == ["Area"]
    with pytest.raises(InputError, match="no field 'leaf'; the fields found: x, y, z, segment"):
        choose_fields(columns(segment=[1, 2]), HERE, label_field="leaf")


@pytest.mark.filterwarnings("error")
def test_scalars_that_are_no_finite_numbers_are_no_values():
    cloud = choose_fields(columns(ndvi=[np.inf, 0.5]), HERE, clip_fields=["ndvi"])
    assert np.array_equal(cloud.scalars["ndvi"], [np.nan, 0.5], equal_nan=True)
    cloud = choose_fields(columns(ndvi=[0.5, -1e300]), HERE, clip_fields=["NDVI"])
    assert np.array_equal(cloud.scalars["NDVI"], [0.5, np.nan], equal_nan=True)


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
