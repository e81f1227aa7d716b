"""What the main thread does for a frame of 10^9 points, counted on a GPU that costs nothing."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any
from unittest.mock import MagicMock, NonCallableMock

import numpy as np
import pytest

import player.rendering.point_cloud
from gclip import Clip, Group, Interval, Motion, ScanMark, Track
from gclip.evaluate import layers_at
from gclip.schema import Box
from player.rendering.point_buffers import ChunkBuffers, full_ranges
from player.rendering.point_cloud import PointCloud

LARGEST_BUFFER = 512 << 20
CHUNK = LARGEST_BUFFER // 6
MANY = 10**9


class Shader(dict):
    """A program that knows all uniforms, and counts how often they are set."""

    def __init__(self) -> None:
        self.sets: Counter[str] = Counter()
        self.runs = 0

    def get(self, name: str, default: Any = None) -> Any:
        self.sets[name] += 1
        return MagicMock()

    def run(self, groups: int) -> None:
        assert groups <= 65_535
        self.runs += 1


@pytest.fixture
def shader(monkeypatch: pytest.MonkeyPatch) -> Shader:
    """And uploads that cost nothing."""
    made = Shader()

    def upload(self: ChunkBuffers, stop: int) -> None:
        self.resident = stop

    monkeypatch.setattr(player.rendering.point_cloud, "compile_program", lambda *_, **__: made)
    monkeypatch.setattr(ChunkBuffers, "upload", upload)
    return made


def clip_of(count: int) -> Clip:
    """As many points as wanted, in one place: it takes no memory."""

    def repeated(*shape: int) -> np.ndarray:
        return np.broadcast_to(np.zeros((), np.uint16), (count, *shape))

    interval = Interval(
        start=0.0,
        end=1.0,
        degree=2,
        box=Box((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),
        groups=(Group(first=0, count=count, motion=Motion.MOVE),),
        curve=(repeated(3),) * 3,
        tracks=repeated(),
    )
    scans = tuple(ScanMark(name, time, name, count) for name, time in (("a", 0.0), ("b", 1.0)))
    return Clip(scans=scans, intervals=(interval,), track_table=(Track(0, "", (1, 2, 3)),))


def loaded(count: int, shader: Shader) -> Callable[[], list[int]]:
    """A frame of a cloud whose points are all on the GPU; gives how many are drawn."""
    limits = {"GL_MAX_SHADER_STORAGE_BLOCK_SIZE": LARGEST_BUFFER}
    context = MagicMock(error="GL_NO_ERROR", info=limits)
    context.buffer = lambda reserve: NonCallableMock(size=reserve)
    clip = clip_of(count)
    points = PointCloud(context, clip, memory=1 << 40)
    wanted = full_ranges(layers_at(clip, 0.3))

    def frame() -> list[int]:
        resident = points.buffers.load(wanted, 1e9)
        points.compute("points", wanted, {}, PICK=0)
        return [drawn.count for drawn in resident]

    assert frame() == [count]
    shader.sets.clear()
    shader.runs = 0
    context.memory_barrier.reset_mock()
    frame.context = context  # type: ignore[attr-defined]
    return frame


def test_a_frame_costs_a_few_calls_a_chunk(shader: Shader) -> None:
    frame = loaded(MANY, shader)
    assert frame() == [MANY]
    chunks = -(-MANY // CHUNK)
    assert shader.runs == chunks == 12
    assert frame.context.memory_barrier.call_count == 1  # type: ignore[attr-defined]
    assert shader.sets.pop("count") == shader.sets.pop("first_point") == chunks
    assert set(shader.sets.values()) == {1}, "all other uniforms once for a layer"


def test_python_works_in_proportion_to_the_chunks(shader: Shader) -> None:
    few, many = (_calls(loaded(chunks * CHUNK, shader)) for chunks in (10, 60))
    each = (many - few) / 50
    assert each < 20
    assert few - 10 * each < 200


def _calls(work: Callable[[], object]) -> int:
    """How many of the player's functions are called, or gone on with."""
    count, package = 0, str(Path(player.rendering.point_cloud.__file__).parents[1])

    def called(frame: FrameType, event: str, argument: object) -> None:
        nonlocal count
        count += event == "call" and frame.f_code.co_filename.startswith(package)

    sys.setprofile(called)
    try:
        work()
    finally:
        sys.setprofile(None)
    return count
