"""Whatever the scans are: a true clip, or one sentence (tests/baker/hostile_series.py)."""

import os
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings

from tests.baker.hostile_series import LABELS, SHAPES, Scan, Series, all_series, check_series

SHRINKING = tuple(Scan("plant", count) for count in (300, 60, 9, 1))


@pytest.mark.parametrize("shape", SHAPES)
def test_every_shape_next_to_a_plant(shape, tmp_path):
    check_series(Series((Scan("plant", 120), Scan(shape, 60), Scan("plant", 160))), tmp_path)


@pytest.mark.parametrize("labels", LABELS)
def test_every_kind_of_labels(labels, tmp_path):
    scans = (Scan("plant", 90, 0, labels), Scan("plant", 120, 1, labels))
    check_series(Series(scans), tmp_path)


@pytest.mark.parametrize("count", [1, 2, 3, 4])
@pytest.mark.parametrize("shape", ["line", "plane", "plant"])
def test_few_points_bake(shape, count, tmp_path):
    few = Scan(shape, count)
    assert check_series(Series((few, Scan("plant", 200), few)), tmp_path) == "baked"


@pytest.mark.parametrize(
    ("series", "outcome"),
    [
        (Series(SHRINKING), "baked"),
        (Series(SHRINKING, {"paper": True}), "baked"),
        (Series(SHRINKING, {"paths": "straight"}), "baked"),
        (Series((Scan("plant", 200), Scan("plant", 200))), "baked"),
        (Series((Scan("grid", 125, labels="few"), Scan("grid", 64, labels="few"))), "baked"),
        (Series((Scan("plant", 3), Scan("plant", 3000))), "baked"),
        (Series((Scan("plant", 3000), Scan("plant", 3)), {"transport": "sinkhorn"}), "baked"),
        (Series((Scan("plant", 200), Scan("upside down", 200))), "baked"),
        # An empty root that meets a stem, that meets another one, that comes after a stem.
        (Series((Scan("same point", 5), Scan("upside down", 5)), {"root": "virtual"}), "baked"),
        (Series((Scan("line", 5), Scan("plant", 31)), {"root": "virtual"}), "baked"),
        (Series((Scan("ring", 400, 3, scale=40), Scan("parts", 400, 2))), "baked"),
        # Cells of the point spacing by the billion billion.
        (
            Series(
                (Scan("all sizes", 10, 3), Scan("cloud", 31, 1, scale=1e10)), {"segment": "thin"}
            ),
            "baked",
        ),
        (Series((Scan("plant", 200, scale=1000), Scan("plant", 200))), "'day00.pcd' .* by 0.001"),
        (Series((Scan("plant", 200),)), "only one scan"),
        (Series((Scan("plant", 9), Scan("nothing", 0), Scan("plant", 9))), "'.*day01.pcd' holds"),
        (Series((Scan("plant", 9), Scan("all NaN", 9))), "'.*day01.pcd': none of its 9 points"),
        (Series((Scan("plant", 9, scale=1e30), Scan("plant", 9))), "'.*day00.pcd': none of its"),
        (Series((Scan("plant", 9, scale=1e-30), Scan("plant", 9))), "'.*day00.pcd' is only"),
        (
            Series((Scan("cloud", 2000, labels="all different"),) * 2, {"label_field": "label"}),
            "2000 different labels",
        ),
    ],
)
def test_what_becomes_of_a_series(series, outcome, tmp_path):
    assert re.search(outcome, check_series(series, tmp_path))


@given(all_series(most=120))
@settings(max_examples=40, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
def test_any_series_bakes_truly_or_is_refused_by_name(tmp_path_factory, series):
    check_series(series, tmp_path_factory.mktemp("series"))


def test_marks_of_points_not_measured_are_dropped_and_noted(tmp_path):
    """1e30 and -1e38 stand in scans for "nothing there"."""
    from baker.scans.read import read_series

    for name in ("some 1e30", "some -1e38", "some infinite", "some NaN"):
        paths = Series((Scan(name, 100), Scan("plant", 100))).write(tmp_path)
        scan = read_series(paths).scans[0]
        assert np.abs(scan.points).max() < 20
        assert any("dropped" in note and "1e+12" in note for note in scan.notes)


@pytest.mark.parametrize(
    ("labels", "options"),
    [
        (None, {}),
        (None, {"paper": True}),
        ("few", {"smooth": True}),
        ("few", {"outliers": 2.0, "align": "icp"}),
    ],
)
def test_the_unit_of_the_scans_does_not_matter(labels, options, tmp_path):
    """The same plant in units 2 ** 29 times as large or as small moves the same, to the bit."""
    from baker import Options, bake

    def baked(scale):
        counts = (60, 80, 110, 120)
        scans = [Scan("plant", n, k, labels, scale=scale) for k, n in enumerate(counts)]
        folder = tmp_path / f"{scale}"
        folder.mkdir()
        return bake(Series(tuple(scans)).write(folder), Options(workers=1, **options))

    usual = baked(1.0)
    for scale in (2.0**-29, 2.0**29):
        other = baked(scale)
        for day in np.linspace(0, 3, 10):
            expected, found = usual.at(day), other.at(day)
            np.testing.assert_array_equal(found.local / scale, expected.local)
            np.testing.assert_array_equal(found.tracks, expected.tracks)


def test_a_plant_of_one_point_is_verified_reported_and_measured(tmp_path):
    from baker import Options
    from baker.pipeline import bake_with_survey
    from baker.report.page import write_report
    from traits.holdout_error import verify
    from traits.plants import write_traits

    point = Scan("same point", 1)
    clip, record = bake_with_survey(
        Series((point, point, point)).write(tmp_path), Options(holdout=2, workers=1)
    )
    errors = verify(clip)
    assert [error.distances[0].maximum for error in errors] == [0.0]
    write_traits(tmp_path / "traits.csv", clip, "plant", lambda stage, done, total: None)
    write_report(
        tmp_path / "report.html",
        clip,
        record,
        title="plant",
        errors=errors,
        report_progress=lambda stage, done, total: None,
    )
    assert (tmp_path / "traits.csv").stat().st_size
    assert (tmp_path / "report.html").stat().st_size


def test_names_of_files_cannot_command_the_terminal(tmp_path, capfd):
    from baker.cli import main

    names = (b"day0 \x1b[2J\x07.txt", b"day1 \xff\n.txt")
    scans = [Path(os.fsdecode(os.fsencode(tmp_path) + b"/" + name)) for name in names]
    for scan in scans:
        scan.write_text("0 0 0\n0 0 1\n0 0 2\nnan 0 0\n")
    clip = str(tmp_path / "plant.gclip")
    for inputs, code in ((scans, 0), (scans[:1], 2), ([tmp_path], 2)):
        assert main([*map(str, inputs), "-o", clip, "-v", "--force"]) == code
        said = capfd.readouterr()
        assert not any(c in said.out + said.err for c in "\x1b\x07\udcff")
        assert "day0" in said.err
