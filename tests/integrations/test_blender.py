"""The Blender add-on shows what `Clip.at` says, in Blender's own module (`bpy`).

It runs as a program of its own, from an environment of its own: `bpy` needs NumPy 1, this project
NumPy 2. `./run test` sets that environment up where there is a `bpy` for this Python.
"""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from random import Random
from typing import Any

import numpy as np
import pytest
from PIL import Image

import gclip
from baker.interpolation.packing import Movers, pack_interval
from gclip import Clip, Motion, ScanMark, Track
from gclip.evaluate import linear_to_srgb
from tests.gclip.hostile import hostile

ROOT = Path(__file__).parents[2]
PYTHON = Path(sys.prefix, "blender", "bin", "python")
ADD_ON = ROOT / "integrations/blender/growth_clip.py"
GROWN = [ROOT / f"tests/player/pictures/{name}.gclip" for name in ("maize", "tomato", "tree")]
MOTIONS = (Motion.MOVE, Motion.FALL, Motion.FADE, Motion.REMOVE)
MADE = {
    "straight": {"degrees": (1, 1, 1), "colors": False, "precision": "auto"},
    "quadratic": {"degrees": (2, 2, 2), "colors": True, "precision": "auto"},
    "cubic": {"degrees": (3, 3, 3), "colors": True, "precision": "float32"},
    "mixed": {"degrees": (1, 3, 2), "colors": True, "precision": "auto", "up": "-y"},
}
BAD = 200  # damaged and hostile files


def made_clip(
    degrees: tuple[int, ...], colors: bool, precision: str, up: str = "z", each: int = 60
) -> Clip:
    """Intervals in which there are all motions, each with movers on random curves."""
    random = np.random.default_rng(11)
    times = [3.0, 4.0, 6.5, 10.0]

    def movers(motion: Motion, degree: int) -> Movers:
        curve = tuple(random.random((each, 3)) * 100 for _ in range(degree + 1))
        paint = [random.integers(0, 256, (each, 4), np.uint8) for _ in range(2)]
        ends = paint if colors else [None, None]
        return Movers(motion, curve, random.integers(0, 2, each), *ends)

    intervals = tuple(
        pack_interval(a, b, [movers(m, degree) for m in MOTIONS], spacing=5.0, precision=precision)
        for (a, b), degree in zip(pairwise(times), degrees, strict=True)
    )
    return Clip(
        scans=tuple(ScanMark(f"{time}.ply", time, "", 4 * each) for time in times),
        intervals=intervals,
        track_table=(
            Track(0, "stem", (150, 124, 92), kind="root"),
            Track(1, "leaf", (9, 144, 218), parent=0, born=times[1]),
        ),
        origin=(4e5, 5e6, 300.0),
        up=up,
        unit="mm",
        spacing=5.0,
    )


def moments(clip: Clip) -> list[float]:
    """Scans, and times between: while litter lies, after it has gone, and right before a scan."""
    between = [a + share * (b - a) for a, b in pairwise(clip.times) for share in (0.05, 0.4, 0.975)]
    return sorted(clip.times + between)


@dataclass
class Blender:
    """What came of it all."""

    folder: Path
    said: dict[str, str]  #: by bad file
    errors: str

    def shown(self, name: str) -> tuple[Clip, Any]:
        path = self.folder / f"{name}.gclip"
        return gclip.open(path), np.load(f"{path}.npz")


@pytest.fixture(scope="module")
def blender(tmp_path_factory: pytest.TempPathFactory) -> Blender:
    if not PYTHON.exists():
        pytest.skip(f"no Blender: {PYTHON.parent} is missing (./run test makes it)")
    folder = tmp_path_factory.mktemp("blender")
    for name, choices in MADE.items():
        made_clip(**choices).save(folder / f"{name}.gclip")
    for path in GROWN:
        (folder / path.name).write_bytes(path.read_bytes())
    clips = {str(path): moments(gclip.open(path)) for path in sorted(folder.glob("*.gclip"))}
    bad = bad_files(folder)
    tasks = folder / "tasks.json"
    picture = [str(folder / "tomato.gclip"), gclip.open(GROWN[1]).times[-1], f"{folder}/still.png"]
    tasks.write_text(
        json.dumps({"add_on": str(ADD_ON), "clips": clips, "bad": bad, "picture": picture})
    )
    script = Path(__file__).with_name("in_blender.py")
    command = [PYTHON, "-I", script, tasks]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert ran.returncode == 0, ran.stderr
    return Blender(folder, json.loads(Path(f"{tasks}.said").read_text()), ran.stdout + ran.stderr)


def bad_files(folder: Path) -> list[str]:
    whole = GROWN[0].read_bytes()
    length = int.from_bytes(whole[:8], "little")
    bent = whole[: 8 + length].replace(b'\\"degree\\":2', b'\\"degree\\":9', 1)
    assert bent != whole[: 8 + length]
    newer = whole[: 8 + length].replace(b'\\"version\\":\\"1', b'\\"version\\":\\"2', 1)
    files = {
        "missing.gclip": None,
        "empty.gclip": b"",
        "cut.gclip": whole[: len(whole) // 2],
        "cloud.gclip": b"ply\nformat ascii 1.0\nelement vertex 0\nend_header\n",
        "newer.gclip": newer + whole[8 + length :],
        "bent.gclip": bent + whole[8 + length :],
        **{f"hostile{seed}.gclip": hostile(Random(seed)) for seed in range(BAD)},
    }
    (folder / "bad").mkdir()
    for name, content in files.items():
        if content is not None:
            (folder / "bad" / name).write_bytes(content)
    return [str(folder / "bad" / name) for name in files]


def expected(clip: Clip, day: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions, colours and tracks in the add-on's order: one interval after the other."""
    frame = clip.at(day)
    parts = [frame] if frame.litter is None else [frame.litter, frame]
    if day == clip.times[-1]:  # the litter of the interval that the last scan ends
        parts.reverse()
    fields = ("local", "colors", "tracks")
    positions, colors, tracks = (np.concatenate([getattr(p, f) for p in parts]) for f in fields)
    return positions, colors, tracks


@pytest.mark.parametrize("name", [*MADE, *(path.stem for path in GROWN)])
def test_blender_shows_the_clip_at_scans_and_between(blender: Blender, name: str) -> None:
    clip, shown = blender.shown(name)
    size = np.ptp(np.array(clip.bounds), axis=0).max()
    for index, day in enumerate(moments(clip)):
        positions, colors, tracks = expected(clip, day)
        np.testing.assert_array_equal(shown[f"{index}/track"], tracks)
        np.testing.assert_allclose(shown[f"{index}/position"], positions, atol=3e-6 * size)
        found = shown[f"{index}/Col"].astype(float)
        srgb = np.column_stack([linear_to_srgb(found[:, :3]), found[:, 3]]) * 255
        np.testing.assert_allclose(srgb[:, :3], colors[:, :3], atol=0.51)
        np.testing.assert_allclose(srgb[:, 3], colors[:, 3], atol=1.01)  # rounded twice
        np.testing.assert_allclose(shown[f"{index}/radius"], clip.spacing, rtol=1e-6)


def test_all_motions_and_litter_were_compared() -> None:
    clip = made_clip(**MADE["straight"])
    counts = [len(expected(clip, day)[0]) // 60 for day in moments(clip)]
    # four groups at a scan; fading and falling ones between; before that, the litter of the last
    assert counts == [4, 3, 3, 3, 5, 4, 3, 3, 5, 4, 3, 3, 2]


def test_the_plant_stands_upright_in_metres_and_keeps_its_place(blender: Blender) -> None:
    clip, shown = blender.shown("mixed")
    turned = shown["matrix"][:3, :3] @ [0, -1, 0]
    np.testing.assert_allclose(turned, [0, 0, 0.001], atol=1e-9)
    np.testing.assert_allclose(np.linalg.det(shown["matrix"]), 1e-9, rtol=1e-4)
    np.testing.assert_array_equal(shown["origin"], clip.origin)
    assert shown["unit"][0] == "mm"
    assert shown["tracks"].tolist() == ["stem", "leaf"]
    assert shown["frames"].tolist() == [1, 1 + 7 * 40]


def test_bad_files_are_refused_in_a_sentence(blender: Blender) -> None:
    assert "Traceback" not in blender.errors
    for path, said in blender.said.items():
        if said:
            assert said.startswith(f"Error: {path} ")
            assert said.endswith(".\n")
            assert said.count("\n") == 1
        else:  # it is a clip, or one with an error that does not matter here
            assert "hostile" in path
    kinds = {Path(path).stem: said.partition(".gclip ")[2] for path, said in blender.said.items()}
    assert kinds["missing"] == "can't be read: No such file or directory.\n"
    assert kinds["newer"] == "is of format 2.2; this add-on reads 1.\n"
    for name in ("empty", "cut", "cloud", "bent"):
        assert kinds[name] == "is not a growth clip, or it is damaged.\n"
    assert sum(map(bool, blender.said.values())) > BAD / 2


def test_cycles_renders_the_points_in_their_colors(blender: Blender) -> None:
    picture = np.asarray(Image.open(blender.folder / "still.png").convert("RGB"), int)
    plant = picture.min(axis=2) < 200
    assert 0.02 < plant.mean() < 0.6
    rows = np.flatnonzero(plant.any(axis=1))
    assert np.ptp(rows) > 0.5 * len(picture)  # upright, and as high as the camera was told
    clip = gclip.open(GROWN[1])
    mean = clip.at(clip.times[-1]).colors[:, :3].mean(axis=0)
    assert picture[plant].mean(axis=0).argmax() == mean.argmax()
