"""`bake --traits` and `play --export traits.csv` write the same table."""

from __future__ import annotations

import csv
from pathlib import Path

import pytest

from baker.cli import main as bake
from grow.cli import main as grow
from player.cli import main as play


def test_both_commands_write_the_same_table(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    assert grow(["maize", str(tmp_path / "scans"), "--scans", "2", "-q"]) == 0
    clip, first, second = (tmp_path / name for name in ("p.gclip", "a.csv", "b.csv"))
    assert bake([str(tmp_path / "scans"), "-o", str(clip), "--traits", str(first), "-q"]) == 0
    assert play([str(clip), "--export", str(second), "-q"]) == 0
    assert first.read_bytes() == second.read_bytes()
    rows = list(csv.DictReader(first.open(newline="")))
    assert {row["plant"] for row in rows} == {"p"}
    assert {row["state"] for row in rows} == {"scan", "between", "rate"}
    assert bake([str(tmp_path / "scans"), "-o", str(clip), "--traits", "t.xlsx", "--force"]) == 2
    assert "ends in .csv" in capsys.readouterr().err
