"""`bake GREENHOUSE/*/ -o clips/`: what is written, what is told, what is done again."""

import csv
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from baker.batch.plant import PlantJob, bake_plant
from baker.cli import main
from baker.options import Options, Outputs
from grow.cli import main as grow
from tests.baker.batch.conftest import sprout, write_greenhouse

NAMES = ["p1", "p2", "p10"]


def bake(*words) -> int:
    return main([str(word) for word in words])


def states(told: str) -> dict[str, str]:
    """Each plant's state, from the table at the end."""
    table = told[told.index("plant ") :]
    return dict(re.findall(r"^(\S+) .* (baked|unchanged|failed)(?:: .*)?$", table, re.M))


def files(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


def test_a_clip_a_plant_just_as_each_alone(greenhouse, tmp_path, capsys):
    house = greenhouse(NAMES)
    clips, table = tmp_path / "out" / "clips", tmp_path / "traits.csv"
    asked = [house, "-o", f"{clips}/", "--align", "none", "--traits", table, "--workers", 2]
    assert bake(*asked) == 0
    told = capsys.readouterr().err
    assert states(told) == dict.fromkeys(NAMES, "baked")
    assert "3 plants: 3 baked" in told
    assert told.count("baked: The interval looks right\n") == 3
    written = files(clips)
    assert sorted(written) == sorted(f"{name}.gclip" for name in NAMES)
    alone, measured = tmp_path / "p10.gclip", tmp_path / "p10.csv"
    assert bake(house / "p10", "-o", alone, "--align", "none", "-q", "--traits", measured) == 0
    assert written["p10.gclip"] == alone.read_bytes()
    rows = list(csv.DictReader(table.open()))
    assert [row for row in rows if row["plant"] == "p10"] == list(csv.DictReader(measured.open()))
    assert list(dict.fromkeys(row["plant"] for row in rows)) == NAMES

    np.savetxt(house / "p1" / "day01.txt", sprout(1, 99), fmt="%.4f")  # changed
    (clips / "p2.gclip").write_bytes(written["p2.gclip"][:-9])  # cut short
    before = table.read_bytes()
    capsys.readouterr()
    asked[-1] = 1
    assert bake(*asked) == 0
    assert states(capsys.readouterr().err) == {"p1": "baked", "p2": "baked", "p10": "unchanged"}
    again = files(clips)
    assert again["p2.gclip"] == written["p2.gclip"]
    assert again["p1.gclip"] != written["p1.gclip"]
    # The table that grew step by step is the one that is made at once.
    whole = tmp_path / "whole.csv"
    assert bake(*asked[:5], "--traits", whole, "--force", "--workers", 1, "-q") == 0
    assert whole.read_bytes() == table.read_bytes() != before
    assert files(clips) == again


def test_what_fails_is_told_at_the_end_and_the_rest_is_done(greenhouse, tmp_path, capsys):
    house = greenhouse(["good", "short", "torn"])
    (house / "short" / "day01.txt").unlink()
    (house / "torn" / "day01.txt").write_text("1 2 3 0\n4 five 6 0\n")
    clips, reports = tmp_path / "clips", tmp_path / "reports"
    clips.mkdir()
    folders = [house / name for name in ("torn", "good", "short")]
    code = bake(*folders, "-o", clips, "--align", "none", "--report", reports, "--workers", 1)
    assert code == 2
    told = capsys.readouterr().err
    assert states(told) == {"torn": "failed", "good": "baked", "short": "failed"}
    assert "Traceback" not in told
    listed = told[told.index("2 of 3 plants failed") :].splitlines()
    assert listed[1].startswith("  torn: ")
    assert "line 2" in listed[1]
    assert listed[2].startswith("  short: ")
    assert list(files(clips)) == ["good.gclip"]
    assert list(files(reports)) == ["good.html"]


def test_a_changed_option_a_changed_time_a_missing_report_bake_again(greenhouse, tmp_path):
    folder = greenhouse(["p"]) / "p"
    times, clip = tmp_path / "times", tmp_path / "p.gclip"
    times.write_text("day00.txt 0\nday01.txt 5\n")

    def state(report: Path | None = None, force: bool = False, **options) -> str:
        chosen = Options(align="none", times=times, **options)
        return bake_plant(PlantJob("p", folder, chosen, Outputs(clip, report, force=force))).state

    assert state() == "baked"
    assert state(workers=1) == "unchanged"
    assert state(force=True) == "baked"
    assert state(decay="fade") == "baked"
    times.write_text("day00.txt 0\nday01.txt 6\n")
    assert state(decay="fade") == "baked"
    assert state(report=tmp_path / "p.html", decay="fade") == "baked"
    assert state(report=tmp_path / "p.html", decay="fade") == "unchanged"
    (folder / "day02.txt").write_text((folder / "day01.txt").read_text())
    times.write_text("day00.txt 0\nday01.txt 6\nday02.txt 7\n")
    assert state(decay="fade") == "baked"
    standing = clip.read_bytes()
    (folder / "day02.txt").unlink()
    (folder / "day01.txt").unlink()
    assert state(decay="fade") == "failed"
    assert clip.read_bytes() == standing


def test_a_pipe_takes_no_table(greenhouse, tmp_path):
    """A file takes its place, as it takes that of any other output."""
    table = tmp_path / "traits.csv"
    os.mkfifo(table)
    house = greenhouse(["p1"])
    assert bake(house, "-o", f"{tmp_path}/clips/", "--align", "none", "--traits", table) == 0
    assert table.read_text().startswith("plant,")


def test_images_are_known_again(tmp_path):
    folder = tmp_path / "komatsuna"
    words = ["--days", "1", "--per-day", "2", "--size", "96x72", "-q"]
    assert grow(["komatsuna", str(folder), *words]) == 0
    job = PlantJob("k", folder, Options(), Outputs(tmp_path / "k.gclip"))
    assert [bake_plant(job).state for _ in range(2)] == ["baked", "unchanged"]


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGKILL])
def test_stopped_in_the_midst_nothing_half_written_and_nobody_stays(tmp_path, how):
    house = write_greenhouse(tmp_path / "house", [f"p{k:03d}" for k in range(60)])
    clips = tmp_path / "clips"
    command = [sys.executable, "-m", "baker", house, "-o", f"{clips}/", "--align", "none"]
    bake = subprocess.Popen(
        list(map(str, [*command, "--workers", 2])), stderr=subprocess.PIPE, text=True
    )
    assert bake.stderr is not None
    bake.stderr.readline()  # the first plant is done
    crew = children(bake.pid)
    assert crew
    bake.send_signal(how)
    rest = bake.stderr.read()
    bake.wait(timeout=120)
    if how == signal.SIGINT:
        assert bake.returncode == 130
        assert rest.strip().splitlines()[-1].startswith("bake: stopped")
        assert "Traceback" not in rest
    deadline = time.monotonic() + 120.0
    while any(alive(pid) for pid in crew) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not any(alive(pid) for pid in crew)
    written = files(clips)
    assert 1 <= len(written) < 60
    assert all(name.endswith(".gclip") and not name.startswith(".") for name in written)


def children(pid: int) -> list[int]:
    of_threads = Path(f"/proc/{pid}/task").glob("*/children")
    return [int(child) for path in of_threads for child in path.read_text().split()]


def alive(pid: int) -> bool:
    try:
        os.kill(pid, 0)
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (ProcessLookupError, FileNotFoundError):
        return False
