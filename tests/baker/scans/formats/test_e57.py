"""E57: positions and colours, with the scanner's place; without its library one sentence."""

import sys

import numpy as np
import pytest

from baker.errors import InputError
from baker.scans.fields import choose_fields
from baker.scans.formats import read_columns

pye57 = pytest.importorskip("pye57", reason="it has no wheel for this machine")


def write(path, *scans, **placed):
    file = pye57.E57(str(path), mode="w")
    for scan in scans:
        file.write_scan_raw(scan, **placed)
    file.close()


def scan_of(points, colors=None):
    named = dict(zip(("cartesianX", "cartesianY", "cartesianZ"), points.T.copy(), strict=True))
    if colors is not None:
        names = ("colorRed", "colorGreen", "colorBlue")
        named |= dict(zip(names, colors.T.copy(), strict=True))
    return named


@pytest.fixture
def points():
    return np.random.default_rng(0).random((30, 3), np.float32).astype(float)


def test_scans_become_one(tmp_path, points):
    colors = np.arange(90).reshape(30, 3)
    write(tmp_path / "a.e57", scan_of(points, colors), scan_of(points + 5, colors))
    cloud = choose_fields(read_columns(tmp_path / "a.e57"), tmp_path / "a.e57")
    expected = np.concatenate([points, points + 5])
    np.testing.assert_allclose(cloud.points, expected, rtol=1e-7)  # written in single precision
    np.testing.assert_array_equal(cloud.colors, np.concatenate([colors, colors]))


def test_the_place_of_the_scanner_counts(tmp_path, points):
    write(tmp_path / "a.e57", scan_of(points), translation=np.array([364e3, 5_620e3, 60.0]))
    values = read_columns(tmp_path / "a.e57").values
    np.testing.assert_allclose(values["y"], points[:, 1] + 5_620e3, rtol=1e-15)
    assert set(values) == {"x", "y", "z"}


def test_without_its_library_the_extra_is_named(tmp_path, points, monkeypatch):
    write(tmp_path / "a.e57", scan_of(points))
    monkeypatch.setitem(sys.modules, "pye57", None)
    with pytest.raises(InputError, match=r'install "plant-growth-clips\[e57\]"'):
        read_columns(tmp_path / "a.e57")


def test_cut_short_is_refused(tmp_path, points):
    write(tmp_path / "a.e57", scan_of(points))
    whole = (tmp_path / "a.e57").read_bytes()
    for size in (1, 47, 500, len(whole) // 2, len(whole) - 1):
        (tmp_path / "a.e57").write_bytes(whole[:size])
        with pytest.raises(InputError, match=r"a\.e57' is not a valid E57 file"):
            read_columns(tmp_path / "a.e57")
