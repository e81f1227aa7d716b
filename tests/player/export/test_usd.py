"""A USD stage, read by OpenUSD itself, is the clip."""

from __future__ import annotations

import sys
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gclip import Motion
from player.errors import PlayerError
from player.export import Film, export

FILM = Film(seconds=10.0, fps=24)


@pytest.fixture(scope="module")
def pxr() -> Any:
    pytest.importorskip("pxr", reason="usd-core is not installed")
    from pxr import Usd, UsdGeom

    return Usd, UsdGeom


def at(pxr: Any, path: Path, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """World positions, colours and labels of all points that show."""
    Usd, UsdGeom = pxr
    stage = Usd.Stage.Open(str(path))
    parts = []
    for prim in stage.Traverse():
        points = UsdGeom.Points(prim)
        if not points or points.ComputeVisibility(time) == UsdGeom.Tokens.invisible:
            continue
        matrix = np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(time))
        local = np.array(points.GetPointsAttr().Get(time), float)
        label = UsdGeom.PrimvarsAPI(prim).GetPrimvar("label").Get()
        color = np.array(points.GetDisplayColorPrimvar().Get(time))
        parts.append((local @ matrix[:3, :3] + matrix[3, :3], color, np.array(label)))
    return tuple(np.concatenate(part) for part in zip(*parts, strict=True))  # type: ignore[return-value]


@pytest.mark.parametrize(
    ("degree", "lost"), [(1, Motion.REMOVE), (2, Motion.FALL), (3, Motion.FADE)]
)
def test_the_stage_is_the_clip(
    pxr: Any, make_clip: Any, tmp_path: Path, degree: int, lost: Motion
) -> None:
    clip = replace(make_clip(degree=degree, lost=lost), origin=(5e5, 4e6, 100.0))
    path = tmp_path / "plant.usd"
    export(clip, FILM, path)
    assert [p.name for p in tmp_path.iterdir()] == ["plant.usd"]
    for day in (0.0, 0.7, 1.9, 2.0 + 3 / 16, 3.5, 4.99, 5.0):
        world, _, labels = at(pxr, path, 240 * day / 5)
        frame = clip.at(day)
        if lost is Motion.REMOVE or day != 2.0:
            assert (labels == frame.tracks).all()
        assert world - clip.origin == pytest.approx(frame.local, abs=0.1)
    Usd, UsdGeom = pxr
    stage = Usd.Stage.Open(str(path))
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (0, 240)
    assert stage.GetTimeCodesPerSecond() == 24
    assert UsdGeom.GetStageMetersPerUnit(stage) == 0.001
    assert UsdGeom.GetStageUpAxis(stage) == "Z"


def test_colors_blend_and_other_axes_stand_up(pxr: Any, make_clip: Any, tmp_path: Path) -> None:
    clip = make_clip(colors=((0, 0, 0, 255), (255, 255, 255, 255)), up="x")
    export(clip, FILM, tmp_path / "plant.usda")
    world, color, _ = at(pxr, tmp_path / "plant.usda", 48.0)
    assert color == pytest.approx(0.5)
    assert world[:, 2] == pytest.approx(clip.at(1.0).local[:, 0], abs=1e-4)
    assert (tmp_path / "plant.usda").read_text().startswith("#usda 1.0")


def test_a_name_that_usd_cannot_write_is_said(pxr: Any, make_clip: Any, tmp_path: Path) -> None:
    for name in ("a\udcff.usd", "a\nb.usd"):
        with pytest.raises(PlayerError, match="plain names"):
            export(make_clip(), FILM, tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_without_the_library_one_sentence_says_what_to_do(
    make_clip: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pxr", None)
    with pytest.raises(PlayerError, match=r"\[usd\]"):
        export(make_clip(), FILM, tmp_path / "plant.usd")
    assert list(tmp_path.iterdir()) == []


def test_a_package_holds_the_same_stage_and_the_same_bytes_each_time(
    pxr: Any, make_clip: Any, tmp_path: Path
) -> None:
    clip = make_clip(degree=2)
    for name in ("a.usdz", "b.usdz", "plant.usdc"):
        export(clip, FILM, tmp_path / name)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.usdz", "b.usdz", "plant.usdc"]
    with zipfile.ZipFile(tmp_path / "a.usdz") as package:
        assert package.infolist()[0].date_time == (1980, 1, 1, 0, 0, 0)
    assert (tmp_path / "a.usdz").read_bytes() == (tmp_path / "b.usdz").read_bytes()
    for packed, plain in zip(
        at(pxr, tmp_path / "a.usdz", 100.0), at(pxr, tmp_path / "plant.usdc", 100.0), strict=True
    ):
        np.testing.assert_array_equal(packed, plain)
