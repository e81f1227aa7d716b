"""The command `grow`: what it writes, and what it refuses."""

import csv
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from baker.scans.read import read_series
from grow import formats, plant
from grow.cli import main
from grow.model import Cloud
from grow.series import day_names


def rows_of(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def contents(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }


def test_the_same_command_writes_the_same_bytes(tmp_path: Path) -> None:
    for name in ("one", "two"):
        command = ["maize", str(tmp_path / name), "--scans", "3", "--truth", "5,6.5", "--pose"]
        assert main(command) == 0
    one = contents(tmp_path / "one")
    assert one == contents(tmp_path / "two")
    assert sorted(one) == [
        "day00.ply",
        "day07.ply",
        "day14.ply",
        "truth/organs.csv",
        "truth/poses.csv",
        "truth/truth_day05.ply",
        "truth/truth_day06.5.ply",
    ]


@cache
def tree_on(day: float) -> Cloud:
    return plant("tree1", 2).cloud(day, seed=2)


@pytest.mark.parametrize("suffix", sorted(formats.WRITERS))
@pytest.mark.parametrize("unlabelled", [False, True])
def test_the_reader_reads_what_was_written(tmp_path: Path, suffix: str, unlabelled: bool) -> None:
    flags = ["--unlabelled", "--no-colors"] if unlabelled else []
    command = ["tree1", str(tmp_path / "t"), "--format", suffix, "--scans", "5", "--seed", "2"]
    assert main([*command, "-q", *flags]) == 0
    series = read_series([tmp_path / "t"])
    assert [scan.time for scan in series.scans] == [0.0, 7.5, 15.0, 22.5, 30.0]
    for scan in series.scans:
        cloud = tree_on(scan.time)
        np.testing.assert_allclose(scan.points + scan.origin, cloud.points, atol=2e-3)
        if unlabelled:
            assert scan.labels is None
            assert scan.colors is None
        else:
            np.testing.assert_array_equal(scan.labels, cloud.labels)
            np.testing.assert_array_equal(scan.colors, cloud.colors)


def test_points_can_be_one_number_or_grow(tmp_path: Path) -> None:
    assert main(["tomato", str(tmp_path / "a"), "--scans", "3", "--points", "500"]) == 0
    assert main(["tomato", str(tmp_path / "b"), "--scans", "3", "--points", "500,900"]) == 0
    same, growing = ([len(scan) for scan in read_series([tmp_path / name]).scans] for name in "ab")
    assert same == [500, 500, 500]
    assert growing[0] == 500
    assert 500 < growing[1] < 900
    assert growing[2] == 900


def test_shuffled_labels_can_be_told_from_the_truth(tmp_path: Path) -> None:
    assert main(["maize", str(tmp_path / "m"), "--shuffle-labels", "--pose", "--scans", "3"]) == 0
    organs = rows_of(tmp_path / "m" / "truth" / "organs.csv")
    poses = rows_of(tmp_path / "m" / "truth" / "poses.csv")
    subject = plant("maize")
    renumbered = 0
    series = read_series([tmp_path / "m"])
    for scan, pose in zip(series.scans, poses, strict=True):
        own = {int(r["label"]): int(r["organ"]) for r in organs if r["scan"] == scan.name}
        cloud = subject.cloud(scan.time)
        assert [own[label] for label in scan.labels.tolist()] == cloud.labels.tolist()
        renumbered += sum(label != organ for label, organ in own.items())

        yaw = np.radians(float(pose["yaw_degrees"]))
        turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
        placed = cloud.points.astype(float)
        placed[:, :2] = placed[:, :2] @ turn.T
        placed += [float(pose[axis]) for axis in "xyz"]
        np.testing.assert_allclose(scan.points + scan.origin, placed, atol=2e-3)
    assert renumbered > 3
    assert [float(poses[0][key]) for key in ("yaw_degrees", "x", "y", "z")] == [0, 0, 0, 0]


def test_truth_has_no_noise_and_the_true_labels(tmp_path: Path) -> None:
    command = ["maize", str(tmp_path / "m"), "--truth", "5", "--unlabelled", "--noise", "9"]
    assert main([*command, "--scans", "2"]) == 0
    truth = formats_read(tmp_path / "m" / "truth" / "truth_day05.ply")
    subject = plant("maize")
    exact = subject.cloud(5.0, len(truth), seed=1, noise=0.0)
    np.testing.assert_array_equal(np.stack([truth[axis] for axis in "xyz"], 1), exact.points)
    np.testing.assert_array_equal(truth["label"], exact.labels)


def formats_read(path: Path) -> np.ndarray:
    from plyfile import PlyData

    return PlyData.read(path)["vertex"].data


def test_scans_are_replaced_only_when_told_to(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "m"
    command = ["maize", str(folder), "-q", "--truth", "1"]
    assert main([*command, "--scans", "3"]) == 0
    (folder / "notes.md").write_text("mine")
    before = contents(folder)
    assert main([*command, "--scans", "2"]) == 2
    assert "--force" in capsys.readouterr().err
    assert contents(folder) == before

    assert main(["maize", str(folder), "-q", "--scans", "2", "--format", "txt", "--force"]) == 0
    assert sorted(contents(folder)) == ["day00.txt", "day14.txt", "notes.md"]


def test_what_fails_half_way_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    written = []

    def full_disk(path: Path, rows: np.ndarray) -> None:
        if len(written) == 2:
            raise OSError(28, "No space left on device")
        written.append(path)
        path.write_bytes(b"x")

    monkeypatch.setitem(formats.WRITERS, "ply", full_disk)
    assert main(["maize", str(tmp_path / "m")]) == 2
    assert "No space left" in capsys.readouterr().err
    assert len(written) == 2
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["orchid", "OUT"], "orchid"),
        (["maize"], "OUTDIR"),
        (["maize", "OUT", "--scans", "1"], "at least 2"),
        (["maize", "OUT", "--scans", "many"], "--scans"),
        (["maize", "OUT", "--points", "a"], "--points"),
        (["maize", "OUT", "--points", "1.5"], "whole number"),
        (["maize", "OUT", "--points", "1,2,3"], "whole number"),
        (["maize", "OUT", "--points", "3"], "at least 10"),
        (["maize", "OUT", "--days", "-1"], "above 0"),
        (["maize", "OUT", "--days", "900"], "outside the life"),
        (["maize", "OUT", "--days", "nan"], "nan"),
        (["maize", "OUT", "--days", "0.001", "--scans", "9"], "closer"),
        (["maize", "OUT", "--truth", "99"], "outside the life"),
        (["maize", "OUT", "--truth", "x"], "--truth"),
        (["maize", "OUT", "--truth", "nan"], "--truth"),
        (["maize", "OUT", "--noise", "-1"], "noise"),
        (["maize", "OUT", "--noise", "1e300"], "noise"),
        (["komatsuna", "OUT", "--noise", "1e300"], "noise"),
        (["maize", "OUT", "--scans", "9" * 20], "at most"),
        (["maize", "OUT", "--points", "9" * 20], "at most"),
        (["maize", "OUT", "--points", f"1000,{'9' * 20}"], "at most"),
        (["maize", "OUT", "--seed", "-1"], "seed"),
        (["maize", "OUT", "--format", "obj"], "ply"),
        (["maize", "OUT", "--unlabelled", "--shuffle-labels"], "shuffled"),
        (["maize", "OUT", "--nonsense"], "--nonsense"),
        (["maize", "FILE"], "is a file"),
        (["maize", "FILE/below"], "can't be written"),
    ],
)
def test_bad_input_gets_one_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], sentence: str
) -> None:
    (tmp_path / "FILE").write_text("")
    places = {name: str(tmp_path / name) for name in ("OUT", "FILE", "FILE/below")}
    assert main([places.get(argument, argument) for argument in arguments]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.startswith("grow: ")
    assert sentence in shown.err
    assert len(shown.err.strip().splitlines()) == 1
    assert [path.name for path in tmp_path.iterdir()] == ["FILE"]


def test_names_give_back_the_days() -> None:
    assert day_names([0, 2, 14]) == ["day00", "day02", "day14"]
    assert day_names([0, 3.75, 7.5]) == ["day00.00", "day03.75", "day07.50"]
    assert day_names([0.0, 100.0]) == ["day000", "day100"]
