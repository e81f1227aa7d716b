"""What will be baked is told before it is."""

import re

import pytest

from baker.batch.command import finding_lines
from baker.cli import main
from baker.scans.scan import Finding


def test_a_doubt_names_the_option_that_settles_it():
    sure = Finding("days", "day 0 to day 3")
    doubtful = Finding("up", "z", "y is nearly as likely", "--up y")
    assert finding_lines([doubtful, sure]) == [
        "days    sure          day 0 to day 3",
        "up      look at this  z: y is nearly as likely; to change it, use --up y",
    ]


def test_long_lines_are_indented_on_a_narrow_terminal(monkeypatch):
    monkeypatch.setenv("COLUMNS", "40")
    lines = finding_lines([Finding("order", "the natural order of their names: a, b, c, d")])
    assert all(len(line) <= 40 for line in lines)
    assert all(line.startswith(" " * 22) for line in lines[1:])


def test_listing_writes_no_clip(write_scans, tmp_path, monkeypatch, capsys):
    folder = write_scans()
    monkeypatch.chdir(tmp_path)
    assert main([str(folder), "--list", "-q"]) == 0
    out, err = capsys.readouterr()
    assert re.search(r"day 0 +day00.txt +[\d,]+ points", out)
    assert "days    sure          day 0 to day 2" in out
    assert err == ""
    assert [path.name for path in tmp_path.iterdir()] == ["scans"]


def test_a_bake_begins_with_its_listing(write_scans, tmp_path, capsys):
    folder = write_scans()
    assert main([str(folder), "--list", "-q"]) == 0
    listed = capsys.readouterr().out.partition("\n\n")[2].splitlines()
    assert main([str(folder), "-o", str(tmp_path / "plant.gclip")]) == 0
    said = capsys.readouterr().err.splitlines()
    assert said.index(listed[0]) < said.index(next(s for s in said if s.startswith("transport:")))
    assert set(listed) <= set(said)


def test_many_plants_are_listed_and_one_that_cannot_be_read_says_why(greenhouse, capsys):
    house = greenhouse(["p1", "p2"])
    for path in (house / "p2").iterdir():
        path.write_text("no numbers\n")
    assert main([str(house), "--list", "-q"]) == 0
    out = capsys.readouterr().out
    assert "p1:\n" in out
    assert "    days" in out
    assert "can't be read" in out.partition("p2:\n")[2] or "number" in out.partition("p2:\n")[2]


def test_without_a_clip_to_write_or_list_nothing_is_baked(write_scans, capsys):
    assert main([str(write_scans())]) == 2
    assert "-o" in capsys.readouterr().err


@pytest.mark.parametrize("count", [1, 3])
def test_findings_come_in_one_order(count):
    findings = [Finding(topic, "x") for topic in ("labels", "up", "order")][:count]
    topics = [line.split()[0] for line in finding_lines(findings)]
    assert topics == [topic for topic in ("order", "up", "labels") if topic in topics]
