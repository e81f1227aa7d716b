"""From a folder to a series: what `read_series` promises."""

import subprocess
import sys

import numpy as np
import pytest

from baker.errors import InputError
from baker.options import Options
from baker.scans import read_series


@pytest.fixture
def make_series(any_format, make_sample, tmp_path):
    suffix, write = any_format
    samples = [make_sample(40, seed, offset=(5000.0, -7000.0, 100.0)) for seed in range(3)]
    for day, sample in zip((1, 9, 10), samples, strict=True):
        write(tmp_path / f"day{day}{suffix}", sample)
    return tmp_path, samples


def test_series_in_every_format(make_series):
    folder, samples = make_series
    series = read_series([folder])
    assert [scan.time for scan in series.scans] == [1, 9, 10]
    assert [scan.date for scan in series.scans] == ["day 1", "day 9", "day 10"]
    assert (series.unit, series.fixed, series.length, series.root) == ("days", False, "", None)
    for scan, sample in zip(series.scans, samples, strict=True):
        assert scan.path.parent == folder
        assert scan.name == scan.path.name
        assert scan.points.dtype == np.float32
        assert scan.origin.dtype == np.float64
        np.testing.assert_array_equal(scan.origin, series.scans[0].origin)
        np.testing.assert_allclose(scan.points + scan.origin, sample.points, rtol=0, atol=1e-3)
        np.testing.assert_array_equal(scan.labels, sample.labels)
        np.testing.assert_array_equal(scan.colors, sample.colors)


def test_big_world_coordinates_are_kept(make_folder):
    rows = [[364000.1231, 5620000.4562, 60.7893], [364000.1232, 5620000.4561, 60.7891]]
    text = "\n".join(" ".join(map(str, row)) for row in rows)
    series = read_series([make_folder({"day1.txt": text, "day2.txt": text})])
    scan = series.scans[1]
    np.testing.assert_allclose(scan.points + scan.origin, rows, rtol=0, atol=1e-9)


def test_reading_twice_gives_the_same_bytes(make_folder):
    text = "".join(f"{i % 7} {i % 5} {i % 3} {i % 2}\n" for i in range(200))
    folder = make_folder({"day1.txt": text, "day2.txt": text})
    options = Options(voxel=2.0, outliers=3.0)
    first, second = (read_series([folder], options) for _ in range(2))
    for a, b in zip(first.scans, second.scans, strict=True):
        assert a.points.tobytes() == b.points.tobytes()
        assert a.labels.tobytes() == b.labels.tobytes()


def test_cleaning_is_noted(make_folder):
    text = "0 0 0 1\n0 0 0 2\nnan 0 0 1\n1 1 1 1\n1.1 1.1 1.1 1\n"
    series = read_series([make_folder({"day1.txt": text, "day2.txt": text})], Options(voxel=0.5))
    assert [len(scan) for scan in series.scans] == [2, 2]
    assert series.scans[0].labels.tolist() == [1, 1]
    assert series.scans[0].notes[2:] == (
        "dropped 1 point with coordinates NaN, infinite or beyond 1e+12.",
        "dropped 1 point at exactly the place of another one.",
        "dropped 1 point to keep one for each voxel of 0.5.",
    )


def test_coordinates_beyond_float32_are_dropped(make_folder):
    text = "1 2 3\n1e300 0 0\n4 5 6\n"
    series = read_series([make_folder({"day1.txt": text, "day2.txt": text})])
    assert [len(scan) for scan in series.scans] == [2, 2]


def test_labels_missing_in_some_scans(make_folder):
    folder = make_folder(
        {"day1.txt": "0 0 0 1\n1 0 0 1", "day2.txt": "0 0 0\n1 0 0", "day3.txt": "0 0 0 1\n1 0 0 1"}
    )
    with pytest.raises(InputError, match=r"^'day2\.txt' of the 3 scans: no labels"):
        read_series([folder])
    series = read_series([folder], Options(labels="ignore"))
    assert all(scan.labels is None for scan in series.scans)


def test_label_field_is_used(make_folder):
    text = "x y z label organ\n0 0 0 1 7\n1 0 0 1 8\n"
    folder = make_folder({"day1.txt": text, "day2.txt": text})
    series = read_series([folder], Options(label_field="organ"))
    assert series.scans[0].labels.tolist() == [7, 8]
    with pytest.raises(InputError, match=r"day1\.txt' has no field 'leaf'.*x, y, z, label, organ"):
        read_series([folder], Options(label_field="leaf"))


def test_colors_missing_in_some_scans_are_left_out(make_folder):
    folder = make_folder({"day1.txt": "0 0 0 9 9 9\n1 0 0 9 9 9", "day2.txt": "0 0 0\n1 0 0"})
    series = read_series([folder])
    assert all(scan.colors is None for scan in series.scans)
    assert series.scans[0].notes[-1] == "colours left out ('day2.txt' without colours)."


@pytest.mark.parametrize("later", [0, 2])
def test_las_that_was_never_classified_has_no_labels(tmp_path, later):
    import laspy

    for day, label in ((1, 0), (2, later)):
        las = laspy.LasData(laspy.LasHeader(point_format=3, version="1.2"))
        las.x = las.y = las.z = np.arange(5.0)
        las.classification = np.full(5, label)
        las.write(tmp_path / f"day{day}.las")
    series = read_series([tmp_path])
    # All 0 in one scan alone may be a plant that is all stem.
    assert all((scan.labels is None) == (later == 0) for scan in series.scans)
    assert all(scan.colors is None for scan in series.scans)


def test_progress_is_reported_after_each_scan(make_folder):
    folder = make_folder({"day1.txt": "0 0 0\n1 1 1", "day2.txt": "0 0 0\n1 1 1"})
    calls = []
    read_series([folder], report_progress=lambda *call: calls.append(call))
    assert calls == [(0, 2), (1, 2), (2, 2)]


@pytest.mark.parametrize("bad", [0, -1, float("nan"), float("inf")])
def test_options_out_of_range(bad):
    with pytest.raises(InputError, match=r"voxel is .*; a number above 0 is needed"):
        Options(voxel=bad)
    with pytest.raises(InputError, match=r"outliers is .*; a number above 0 is needed"):
        Options(outliers=bad)


def test_the_package_imports_nothing_heavy():
    heavy = {"scipy", "open3d", "laspy", "plyfile", "pye57", "lzf", "numba", "imageio"}
    code = f"import sys, baker.scans; print({heavy} & set(sys.modules))"
    result = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert result.stdout.strip() == "set()"


def test_every_nth_scan_needs_two(make_folder):
    folder = make_folder({f"day{day}.txt": "0 0 0\n1 1 1" for day in range(4)})
    for every, days in ((2, [0, 2]), (3, [0, 3])):
        assert [scan.time for scan in read_series([folder], Options(every=every)).scans] == days
    with pytest.raises(InputError, match="--every 4 leaves only the first one"):
        read_series([folder], Options(every=4))
