"""PLY files hold what `Clip.at` says; one point stays one point within an interval."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from plyfile import PlyData

from gclip import Motion
from player.errors import PlayerError
from player.export import Film, export


def read(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    vertex = PlyData.read(path)["vertex"]
    positions = np.column_stack([vertex[axis] for axis in "xyz"])
    colors = np.column_stack([vertex[name] for name in ("red", "green", "blue", "alpha")])
    return positions, colors, np.asarray(vertex["scalar_label"])


@pytest.mark.parametrize("lost", [Motion.FALL, Motion.FADE, Motion.REMOVE])
def test_a_sequence_holds_the_clip_at_its_times(make_clip: Any, tmp_path: Path, lost: Any) -> None:
    clip = make_clip(lost=lost, degree=2)
    export(clip, Film(every=0.5), tmp_path / "c" / "p%03d.ply")
    paths = sorted((tmp_path / "c").iterdir())
    assert [path.name for path in paths] == [f"p{i:03d}.ply" for i in range(11)]
    for index, path in enumerate(paths):
        positions, colors, labels = read(path)
        frame = clip.at(0.5 * index)
        interval = clip.intervals[0 if index < 4 else 1]
        assert len(positions) == len(interval), "constant count within an interval"
        assert (labels == interval.tracks).all(), "constant order within an interval"
        seen = colors[:, 3] > 0
        assert positions[seen] == pytest.approx(frame.positions, abs=1e-5)
        assert (colors[seen] == frame.colors).all()
        if not seen.all():
            hidden = np.unique(positions[~seen], axis=0)
            assert len(hidden) == 1
            assert np.abs(positions[seen] - hidden).max(axis=1).min() == 0


def test_other_programs_read_it(make_clip: Any, tmp_path: Path) -> None:
    open3d = pytest.importorskip("open3d")
    clip = make_clip()
    export(clip, Film(at=(1.0,)), tmp_path / "cloud.ply")
    cloud = open3d.io.read_point_cloud(str(tmp_path / "cloud.ply"))
    frame = clip.at(1.0)
    assert np.asarray(cloud.points) == pytest.approx(frame.positions, abs=1e-5)
    assert (np.round(np.asarray(cloud.colors) * 255) == frame.colors[:, :3]).all()
    again = open3d.t.io.read_point_cloud(str(tmp_path / "cloud.ply"))
    assert (again.point["scalar_label"].numpy()[:, 0] == frame.tracks).all()


def test_large_coordinates_keep_their_decimals(make_clip: Any, tmp_path: Path) -> None:
    clip = replace(make_clip(), origin=(4_500_000.0, 300_000.0, 120.0))
    export(clip, Film(), tmp_path / "cloud.ply")
    positions, _, _ = read(tmp_path / "cloud.ply")
    assert positions.dtype == np.float64
    assert positions - clip.origin == pytest.approx(clip.at(5.0).local, abs=1e-6)


def test_dates_cannot_write_the_header(make_clip: Any, tmp_path: Path) -> None:
    clip = make_clip()
    scans = tuple(replace(s, date="x\nelement face 3\n\u2028") for s in clip.scans)
    export(replace(clip, scans=scans), Film(), tmp_path / "cloud.ply")
    data = PlyData.read(tmp_path / "cloud.ply")
    assert [element.name for element in data.elements] == ["vertex"]
    assert "date x?element face 3??" in data.comments


def test_stopping_leaves_nothing(make_clip: Any, tmp_path: Path) -> None:
    def stop(done: int, total: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        export(make_clip(), Film(), tmp_path / "c" / "%04d.ply", stop)
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(PlayerError, match=r"--day and --every"):
        export(make_clip(), Film(at=(1.0,), every=1.0), tmp_path / "%04d.ply")
