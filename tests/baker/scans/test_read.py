"""From a folder to a series: what `read_series` promises."""

import subprocess
import sys

import numpy as np
import pytest

from baker.errors import InputError
from baker.options import Options
from baker.scans.read import read_series


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
    text = "x y z label\n" + "".join(f"{i % 7} {i % 5} {i % 3} {i % 7 > 3:d}\n" for i in range(200))
    folder = make_folder({"day1.txt": text, "day2.txt": text})
    options = Options(voxel=2.0, outliers=3.0)
    first, second = (read_series([folder], options) for _ in range(2))
    for a, b in zip(first.scans, second.scans, strict=True):
        assert a.points.tobytes() == b.points.tobytes()
        assert a.labels.tobytes() == b.labels.tobytes()


def test_cleaning_is_noted(make_folder):
    text = "x y z label\n0 0 0 1\n0 0 0 2\nnan 0 0 1\n1 1 1 3\n1.1 1.1 1.1 3\n"
    series = read_series([make_folder({"day1.txt": text, "day2.txt": text})], Options(voxel=0.5))
    assert [len(scan) for scan in series.scans] == [2, 2]
    assert series.scans[0].labels.tolist() == [1, 3]
    assert series.scans[0].notes[1:] == (
        "dropped 1 point with coordinates NaN, infinite or beyond 1e+12.",
        "dropped 1 point at exactly the place of another one.",
        "dropped 1 point to keep one for each voxel of 0.5.",
    )


def test_coordinates_beyond_float32_are_dropped(make_folder):
    text = "1 2 3\n1e300 0 0\n4 5 6\n"
    series = read_series([make_folder({"day1.txt": text, "day2.txt": text})])
    assert [len(scan) for scan in series.scans] == [2, 2]


def test_labels_missing_in_some_scans(make_folder):
    labelled = "0 0 0 1\n1 0 0 1\n8 0 0 2\n9 0 0 2"
    folder = make_folder({"day1.txt": labelled, "day2.txt": "0 0 0\n9 0 0", "day3.txt": labelled})
    series = read_series([folder])
    assert [scan.labels is None for scan in series.scans] == [False, True, False]
    assert series.label_field == "column 4"
    series = read_series([folder], Options(labels="ignore"))
    assert all(scan.labels is None for scan in series.scans)


def test_words_soil_and_dropped_labels(make_folder):
    text = "0 0 0 stem\n1 0 0 stem\n8 0 0 leaf1\n9 0 0 leaf1\n0 0 -5 soil\n1 0 -5 soil\n"
    folder = make_folder({"day1.txt": text, "day2.txt": text})
    series = read_series([folder])
    assert series.label_words == {0: "leaf1", 1: "soil", 2: "stem"}
    assert series.scans[0].labels.tolist() == [2, 2, 0, 0]
    assert "labels: 'soil', 4 points, taken out." in [f.sentence for f in series.findings]
    assert len(read_series([folder], Options(ground="keep")).scans[0]) == 6
    only_soil = Options(ground="keep", drop_label="leaf1,stem", labels="ignore")
    assert len(read_series([folder], only_soil).scans[0]) == 2


def test_scale_multiplies_coordinates(make_folder):
    folder = make_folder({"day1.txt": "0 0 0\n1 2 3", "day2.txt": "0 0 0\n1 2 3"})
    series = read_series([folder], Options(scale=1000, unit="mm"))
    assert series.scans[0].points.max() == 3000
    assert "unit: mm; the last scan is 2,970 mm across." in [f.sentence for f in series.findings]


def test_a_scan_in_another_unit_is_named(make_folder):
    small, large = "0 0 0\n0.1 0.2 0.3", "0 0 0\n110 210 310"
    folder = make_folder({"day1.txt": small, "day2.txt": large, "day3.txt": small})
    with pytest.raises(InputError, match=r"'day2\.txt' is 307 across.*'day2\.txt' by 0\.001"):
        read_series([folder])
    larger = {"day1.txt": "0 0 0\n90 170 250", "day2.txt": large, "day3.txt": small}
    with pytest.raises(InputError, match=r"'day3\.txt' is 0\.297 across.*'day3\.txt' by 1000,"):
        read_series([make_folder(larger, "the last one is small")])
    folder = make_folder({"day1.txt": small, "day2.txt": "0 0 0\n1 2 3"}, "ten times as large")
    assert "as if they were in different units" in read_series([folder]).findings[-1].sentence


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


@pytest.mark.parametrize("later", [0, 1, 2])
def test_las_with_one_class_a_scan_has_no_labels(tmp_path, later):
    import laspy

    for day, label in ((1, later if later < 2 else 0), (2, later)):
        las = laspy.LasData(laspy.LasHeader(point_format=3, version="1.2"))
        las.x = las.y = las.z = np.arange(5.0)
        las.classification = np.full(5, label)
        las.write(tmp_path / f"day{day}.las")
    series = read_series([tmp_path])
    assert all(scan.labels is None for scan in series.scans)
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
    heavy = {"scipy", "open3d", "laspy", "pye57", "lzf", "numba", "imageio"}
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
