"""A GLB's animation, played by the rules of glTF 2.0, is the clip."""

from __future__ import annotations

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from gclip import Clip, Motion
from gclip.evaluate import linear_to_srgb
from player.export import Film, export

KINDS = {5126: np.float32, 5123: np.uint16}
WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


class Reader:
    """What any glTF viewer does, in a few lines: no code is shared with the export."""

    def __init__(self, path: Path) -> None:
        data = path.read_bytes()
        magic, version, length = struct.unpack("<4sII", data[:12])
        assert (magic, version, length) == (b"glTF", 2, len(data))
        size = struct.unpack("<I", data[12:16])[0]
        self.json = json.loads(data[20 : 20 + size])
        self.blob = data[20 + size + 8 :]
        assert self.json["buffers"][0]["byteLength"] <= len(self.blob)
        assert "uri" not in self.json["buffers"][0]

    def array(self, index: int) -> np.ndarray:
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        width = WIDTHS[accessor["type"]]
        values = np.frombuffer(
            self.blob, KINDS[accessor["componentType"]], accessor["count"] * width,
            view["byteOffset"],
        )  # fmt: skip
        values = values.reshape(-1, width)
        if "min" in accessor:
            assert values.min(axis=0).tolist() == accessor["min"]
            assert values.max(axis=0).tolist() == accessor["max"]
        return values

    def sampled(self, node: int, path: str, seconds: float) -> np.ndarray:
        animation = self.json["animations"][0]
        for channel in animation["channels"]:
            if channel["target"] == {"node": node, "path": path}:
                sampler = animation["samplers"][channel["sampler"]]
                times = self.array(sampler["input"])[:, 0].astype(float)
                assert (np.diff(times) > 0).all()
                values = self.array(sampler["output"]).reshape(len(times), -1)
                if sampler["interpolation"] == "STEP":
                    return values[max(np.searchsorted(times, seconds, "right") - 1, 0)]
                return np.array([np.interp(seconds, times, column) for column in values.T])
        raise AssertionError(f"no channel {path} for node {node}")

    def at(self, seconds: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Positions in the clip's own coordinates, colours, labels: of all nodes that show."""
        parts = []
        for node in self.json["nodes"][0]["children"]:
            scale = self.sampled(node, "scale", seconds)
            assert scale.tolist() in ([0, 0, 0], [1, 1, 1])
            if not scale[0]:
                continue
            mesh = self.json["meshes"][self.json["nodes"][node]["mesh"]]
            primitive = mesh["primitives"][0]
            assert primitive["mode"] == 0
            points = self.array(primitive["attributes"]["POSITION"]).astype(float)
            weights = self.sampled(node, "weights", seconds)
            for weight, target in zip(weights, primitive["targets"], strict=True):
                points = points + weight * self.array(target["POSITION"])
            paint = self.array(primitive["attributes"]["COLOR_0"]) / 65535
            labels = self.array(primitive["attributes"]["_LABEL"])[:, 0]
            assert labels.dtype == np.float32
            parts.append((points, paint, labels))
        return tuple(np.concatenate(part) for part in zip(*parts, strict=True))  # type: ignore[return-value]


def exported(clip: Clip, folder: Path) -> Reader:
    export(clip, Film(seconds=10.0), folder / "plant.glb")
    assert [path.name for path in folder.iterdir()] == ["plant.glb"]
    return Reader(folder / "plant.glb")


@pytest.mark.parametrize("degree", [1, 2, 3])
@pytest.mark.parametrize("lost", [Motion.FALL, Motion.REMOVE])
def test_the_animation_is_the_clip(
    make_clip: Any, tmp_path: Path, degree: int, lost: Motion
) -> None:
    clip = make_clip(degree=degree, lost=lost)
    reader = exported(clip, tmp_path)
    for day in (0.0, 0.5, 1.9, 2.0625, 3.5, 4.99):
        points, _, labels = reader.at(10.0 * day / 5.0)
        frame = clip.at(day)
        assert (labels == frame.tracks).all()
        # Between two keys of a curve a chord is cut: 1/8 (1/16)² of its second derivative.
        assert points == pytest.approx(frame.local, abs=0.1)
    at_key, _, _ = reader.at(10.0 * (2 + 3 * 9 / 16) / 5)
    assert at_key == pytest.approx(clip.at(2 + 3 * 9 / 16).local, abs=2e-4)
    assert len(reader.at(10.0)[0]) == len(clip.at(5.0)), "the last scan stays"


def test_organs_that_fade_dissolve(make_clip: Any, tmp_path: Path) -> None:
    clip = make_clip(lost=Motion.FADE)
    reader = exported(clip, tmp_path)
    counts = [len(reader.at(seconds)[0]) for seconds in np.linspace(4.0, 10.0, 30)]
    assert counts[0] == len(clip.at(2.0))
    assert counts[-1] == len(clip.at(5.0))
    assert np.diff(counts).max() <= 0
    assert len(set(counts)) > 6


def test_colors_are_linear_light_and_the_root_stands_up(make_clip: Any, tmp_path: Path) -> None:
    clip = make_clip(colors=((200, 40, 30, 255), (200, 40, 30, 255)), up="x")
    reader = exported(clip, tmp_path)
    _, paint, _ = reader.at(1.0)
    assert np.round(255 * linear_to_srgb(paint[0, :3])).tolist() == [200, 40, 30]
    root = np.array(reader.json["nodes"][0]["matrix"]).reshape(4, 4).T
    assert root @ [1, 0, 0, 0] == pytest.approx([0, 0.001, 0, 0]), "up, and mm to m"
    assert np.linalg.det(1000 * root[:3, :3]) == pytest.approx(1)
    assert reader.json["materials"][0]["extensions"] == {"KHR_materials_unlit": {}}


def test_trimesh_reads_the_scans_points(make_clip: Any, tmp_path: Path) -> None:
    trimesh = pytest.importorskip("trimesh")
    clip = make_clip(degree=2)
    exported(clip, tmp_path)
    scene = trimesh.load(tmp_path / "plant.glb")
    clouds = list(scene.geometry.values())
    first = np.asarray(clouds[0].vertices)
    assert first == pytest.approx(clip.at(0.0).local, abs=1e-4)
    assert len(np.asarray(clouds[0].colors)) == len(first)


def test_the_same_clip_gives_the_same_bytes(make_clip: Any, tmp_path: Path) -> None:
    for name in ("a.glb", "b.glb"):
        export(make_clip(), Film(), tmp_path / name)
    assert (tmp_path / "a.glb").read_bytes() == (tmp_path / "b.glb").read_bytes()


def test_an_interval_may_end_between_scans(make_clip, tmp_path) -> None:
    """A clip may have keyframes that are no scans' (found by fuzzing)."""
    from dataclasses import replace

    from player.export import Film, export

    clip = make_clip()
    export(replace(clip, scans=(clip.scans[0], clip.scans[-1])), Film(), tmp_path / "plant.glb")
    content = (tmp_path / "plant.glb").read_bytes()
    assert b'"day 0 to day 2.0"' in content
    assert b'"day 2.0 to day 5"' in content
