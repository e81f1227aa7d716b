"""The napari plug-in's layers are what `Clip.at` says; napari itself is not needed."""

from __future__ import annotations

import importlib
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import npe2
import numpy as np
import pytest

import gclip
from baker.interpolation.packing import Movers, pack_interval

ROOT = Path(__file__).parents[2]
PLUGIN = ROOT / "integrations/napari"
CLIPS = [ROOT / f"tests/player/pictures/{name}.gclip" for name in ("maize", "tomato", "tree")]


@pytest.fixture(autouse=True)
def plugins(monkeypatch: pytest.MonkeyPatch) -> npe2.PluginManager:
    """A manager with this plug-in alone."""
    monkeypatch.syspath_prepend(PLUGIN)
    manager = npe2.PluginManager()
    manager.register(npe2.PluginManifest.from_file(PLUGIN / "napari_growth_clip/napari.yaml"))
    monkeypatch.setattr(npe2.PluginManager, "instance", lambda: manager)
    return manager


@pytest.mark.parametrize("path", CLIPS, ids=lambda path: path.stem)
def test_napari_reads_a_clip_at_its_scans_and_between(path: Path) -> None:
    clip = gclip.open(path)
    [(data, properties, kind)] = npe2.read([str(path)], stack=False)
    assert kind == "points"
    assert properties["name"] == path.stem
    world = data * properties["scale"] + properties["translate"]  # as napari places them
    days = np.unique(properties["features"]["day"])
    assert set(clip.times) <= set(days.tolist())
    assert len(days) >= 4 * (len(clip.times) - 1) + 1
    for index, day in enumerate(days):
        now = data[:, 0] == index
        frame = clip.at(float(day))
        np.testing.assert_allclose(world[now, 1:], frame.positions, atol=1e-4)
        np.testing.assert_allclose(world[now, 0], day, atol=properties["scale"][0] / 2)
        np.testing.assert_array_equal(properties["face_color"][now] * 255, frame.colors)
        np.testing.assert_array_equal(properties["features"]["track"][now], frame.tracks)
    names = {track.name for track in clip.track_table}
    assert set(properties["features"]["organ"].tolist()) <= names


def still(scans: tuple[gclip.ScanMark, ...]) -> gclip.Clip:
    """A clip of these scans, of one point that does not move."""
    point = Movers(gclip.Motion.MOVE, (np.ones((1, 3)),) * 2, np.zeros(1, int))
    pairs = pairwise(scan.time for scan in scans)
    intervals = tuple(pack_interval(*times, [point], spacing=1.0) for times in pairs)
    track = gclip.Track(0, "stem", (0, 0, 0))
    return gclip.Clip(scans=scans, intervals=intervals, track_table=(track,))


@pytest.mark.parametrize("times", [[0, 3, 7], [5, 6, 6.5, 12], [0, 1, 100]])
def test_uneven_scans_stand_at_the_nearest_step(times: list[float]) -> None:
    module = importlib.import_module("napari_growth_clip")
    scans = tuple(gclip.ScanMark("scan", time, points=10) for time in times)
    step, days = module.states(still(scans))
    assert set(times) <= set(days)
    even = times[0] + step * np.arange(len(days))
    np.testing.assert_allclose(days, even, atol=step / 2 + 1e-9)
    assert np.diff(times).min() >= step * module.STATES_BETWEEN
    many = tuple(gclip.ScanMark("scan", time, points=10**6) for time in times)
    assert len(module.states(still(many))[1]) <= 6


def test_several_clips_are_several_layers() -> None:
    layers = npe2.read([str(path) for path in CLIPS], stack=True)
    assert [properties["name"] for _, properties, _ in layers] == [path.stem for path in CLIPS]


def test_a_damaged_clip_is_refused_in_a_sentence(tmp_path: Path) -> None:
    path = tmp_path / "cut.gclip"
    path.write_bytes(CLIPS[0].read_bytes()[:1000])
    with pytest.raises(gclip.ClipError, match=r"cut\.gclip: .*\.$"):
        npe2.read([str(path)], stack=False)


def test_other_files_are_left_to_others(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="No compatible readers"):
        npe2.read([str(tmp_path / "scan.ply")], stack=False)


def test_the_installed_package_tells_napari_of_itself(tmp_path: Path) -> None:
    options = ["--no-deps", "--no-build-isolation", "--quiet", "--target", str(tmp_path)]
    command = [sys.executable, "-m", "pip", "install", *options, str(PLUGIN)]
    subprocess.run(command, check=True, capture_output=True)
    look = "import npe2; npe2.PluginManifest.from_distribution('napari-growth-clip')"
    validated = [sys.executable, "-c", f"{look}.validate_imports()"]
    subprocess.run(validated, check=True, env={"PYTHONPATH": f"{tmp_path}:{ROOT}"})
