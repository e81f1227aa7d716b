"""Every way out, stopped half way or refused, leaves nothing behind."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from gclip.errors import UserError
from player.export import Film, export
from player.export.formats import FORMATS
from player.rendering.headless import Offscreen

SMALL = Film(size=(64, 48), fps=5, seconds=0.8)


@pytest.mark.parametrize("example", [one.example for one in FORMATS])
def test_stopping_leaves_nothing_and_spares_what_was_there(
    make_clip: Any, tmp_path: Path, example: str
) -> None:
    if example.endswith(".usd"):
        pytest.importorskip("pxr", reason="usd-core is not installed")
    path = tmp_path / example
    before = []
    if "/" not in example:
        path.write_text("an earlier one")
        before = [example]

    def stop(done: int, total: int) -> None:
        if done == total:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        export(make_clip(), SMALL, path, stop)
    left = [entry.name for entry in tmp_path.iterdir()]
    if example in ("still.png", "cloud.ply"):
        return  # done in one step, before anything is told
    assert left == before
    assert not before or path.read_text() == "an earlier one"


def test_a_film_that_is_stopped_before_its_first_picture_needs_no_warning(
    make_clip: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: Any
) -> None:
    def stop(*given: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Offscreen, "picture", stop)
    with pytest.raises(KeyboardInterrupt):
        export(make_clip(), SMALL, tmp_path / "film.mp4")
    assert not caplog.records


@pytest.mark.parametrize("example", [one.example for one in FORMATS])
def test_a_missing_folder_is_said_at_once(make_clip: Any, tmp_path: Path, example: str) -> None:
    if example.endswith(".usd"):
        pytest.importorskip("pxr", reason="usd-core is not installed")
    with pytest.raises(UserError, match="No such file"):
        export(make_clip(), SMALL, tmp_path / "no" / "where" / example)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["plant.glb", "clouds/%04d.ply"])
def test_what_another_one_wrote_meanwhile_stays(make_clip: Any, tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    other = path.with_name(path.name.replace("%04d", "0001"))

    def write_the_other(done: int, total: int) -> None:
        other.parent.mkdir(exist_ok=True)
        other.write_text("the other's")

    with pytest.raises(UserError, match="exists; --force overwrites it"):
        export(make_clip(), SMALL, path, write_the_other, force=False)
    assert [entry for entry in tmp_path.rglob("*") if entry.is_file()] == [other]
    assert other.read_text() == "the other's"
