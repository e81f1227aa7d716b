"""Movers come to the GPU chunk by chunk, and leave it when there is no room."""

from __future__ import annotations

from dataclasses import replace
from unittest.mock import MagicMock as Mock

import moderngl
import numpy as np
import pytest

from baker.interpolation.packing import Movers, pack_interval
from gclip import Clip, Motion
from gclip.evaluate import layers_at
from gclip.schema import BLOCK
from player.gl.context import total_gpu_memory
from player.rendering import point_buffers
from player.rendering.point_buffers import DrawRange, PointBuffers, bytes_per_point, full_ranges
from player.rendering.renderer import Renderer
from player.view.style import Style
from tests.player.drawn import drawn, fitted
from tests.player.positions import gpu_positions

SIZE = (160, 120)


@pytest.fixture
def small_chunks(monkeypatch: pytest.MonkeyPatch) -> int:
    """Points of a quantised chunk."""
    monkeypatch.setattr(point_buffers, "BUFFER_SIZES", (6 * 333,) * 2)
    monkeypatch.setattr(point_buffers, "SLICE", 100)
    return 333


def series(clip: Clip, count: int) -> Clip:
    """The clip's first interval again and again."""
    first = clip.intervals[0]
    return replace(
        clip,
        intervals=tuple(replace(first, start=float(k), end=k + 1.0) for k in range(count)),
        scans=tuple(replace(clip.scans[0], time=float(k)) for k in range(count + 1)),
    )


def ranges_at(clip: Clip, day: float) -> list[DrawRange]:
    return full_ranges(layers_at(clip, day))


@pytest.mark.parametrize(
    ("degree", "colors", "size"), [(1, None, 14), (2, None, 20), (2, ((9,) * 4, (9,) * 4), 28)]
)
def test_bytes_a_mover(
    context: moderngl.Context, make_clip, degree: int, colors: tuple | None, size: int
) -> None:
    clip = series(make_clip(degree=degree, colors=colors), 1)
    assert bytes_per_point(clip.intervals[0]) == size
    buffers = PointBuffers(context, clip, 1 << 30)
    buffers.load(ranges_at(clip, 0.0), 1.0)
    count = 2 + degree + (2 if colors else 0)
    assert 0 < buffers.size() - size * len(clip.intervals[0]) <= count * point_buffers.PADDING


def test_an_interval_that_does_not_fit_is_drawn_in_chunks(
    context: moderngl.Context, make_clip, small_chunks: int
) -> None:
    clip = make_clip(lost=Motion.FADE)
    camera = fitted(clip.bounds)
    chunked, whole = (drawn(context, clip, 2.1, camera, SIZE, memory=room) for room in (1, None))
    assert (whole.max(axis=2) > 60).sum() > 1000
    assert (chunked == whole).all()


@pytest.mark.parametrize("computed", [False, True])
def test_positions_do_not_depend_on_the_chunks(
    context: moderngl.Context, make_clip, small_chunks: int, computed: bool
) -> None:
    clip = make_clip(degree=2)
    frame = clip.at(3.3)
    found = gpu_positions(context, clip, 3.3, computed=computed, memory=1)
    assert np.abs(found - frame.local).max() < 1e-4 * np.linalg.norm(np.subtract(*clip.bounds))


def test_the_room_is_kept_to(context: moderngl.Context, make_clip, small_chunks: int) -> None:
    clip = series(make_clip(), 9)
    limit = 3 * len(clip.intervals[0]) * bytes_per_point(clip.intervals[0])
    buffers = PointBuffers(context, clip, limit)
    for day in np.linspace(0, 9, 30):
        wanted = ranges_at(clip, float(day))
        assert buffers.load(wanted, 1.0) == wanted
        assert 0 < buffers.size() <= limit


@pytest.mark.parametrize(
    ("memory", "limit", "size"),
    [
        (2 << 30, 2 << 30, 96 << 20),  # a small GPU keeps several chunks
        (8 << 30, 2 << 30, 256 << 20),
        (8 << 30, 128 << 20, (128 << 20) - point_buffers.PADDING),  # the driver's limit
        (8 << 30, None, 96 << 20),  # without compute shaders
        (64 << 30, 2 << 30, 512 << 20),
    ],
)
def test_chunks_are_as_large_as_the_gpu_allows(
    make_clip, memory: int, limit: int | None, size: int
) -> None:
    reported = {} if limit is None else {"GL_MAX_SHADER_STORAGE_BLOCK_SIZE": limit}
    interval = Mock(curve=(np.zeros((1, 3), np.uint16),), __len__=lambda _: 10**9)
    buffers = PointBuffers(Mock(info=reported), make_clip(), memory)
    assert buffers.chunk_length(interval) == size // 6


def test_without_time_the_beginning_is_there_and_the_rest_follows(
    context: moderngl.Context, make_clip, small_chunks: int
) -> None:
    clip = make_clip()
    buffers, wanted = PointBuffers(context, clip, 1 << 30), ranges_at(clip, 3.0)
    assert buffers.load(wanted, 0.0) == [
        replace(drawn, count=min(100, drawn.count)) for drawn in wanted
    ]
    assert buffers.load(wanted, 1.0) == wanted


def test_what_comes_next_is_there_before_it_is_shown(context: moderngl.Context, make_clip) -> None:
    """And takes the place of what was shown before, where there is room for two intervals."""
    clip = series(make_clip(), 4)
    size = len(clip.intervals[0]) * bytes_per_point(clip.intervals[0])
    buffers = PointBuffers(context, clip, int(2.2 * size))
    for shown in (0, 1, 2):
        buffers.load(ranges_at(clip, shown + 0.5), 60.0)
        ranges = [ranges_at(clip, day + 0.5)[0] for day in range(4)]
        there = [buffers.resident(one) == one.count for one in ranges]
        assert there == [day in (shown, shown + 1) for day in range(4)]


def test_a_budget_draws_what_is_there(
    context: moderngl.Context, make_clip, small_chunks: int
) -> None:
    clip = make_clip()
    renderer = Renderer(context, clip)
    framebuffer = context.simple_framebuffer(SIZE)
    view = (1.0, fitted(clip.bounds), Style(), SIZE)
    assert not renderer.draw(framebuffer, *view, upload_budget=0.0)
    assert not renderer.draw(framebuffer, *view, stride=2)
    assert renderer.draw(framebuffer, *view)
    assert renderer.draw(framebuffer, *view, upload_budget=0.0)
    renderer.release()


@pytest.mark.parametrize("stride", [2, 3, 1000, 10**6])
def test_one_point_in_many(
    context: moderngl.Context, make_clip, small_chunks: int, stride: int
) -> None:
    """Of each chunk; a shadow takes one in a thousand of ten million."""
    clip = make_clip()
    found = gpu_positions(context, clip, 2.1, stride=stride)
    counts = [layer.group.count for layer in layers_at(clip, 2.1)]
    taken = [np.arange(n) % small_chunks % stride == 0 for n in counts]
    wanted = gpu_positions(context, clip, 2.1)[np.concatenate(taken)]
    np.testing.assert_array_equal(found, wanted)


def test_the_gpu_has_memory(context: moderngl.Context) -> None:
    assert total_gpu_memory(context) >= 256 << 20


def test_a_prefix_is_a_fair_sample() -> None:
    """Shares of the tracks, and of the plant's parts, up to the chance of drawing whole blocks."""
    random = np.random.default_rng(5)
    points = random.normal(size=(200_000, 3)) * [3.0, 1.0, 5.0]
    tracks = (points[:, 2] > 2.0).astype(int) + (points[:, 0] > 0.0)
    interval = pack_interval(0.0, 1.0, [Movers(Motion.MOVE, (points, points), tracks)], spacing=1.0)
    for count in (20_000, 50_000, 100_000):
        for values, bins in (
            (interval.tracks, 3),
            (interval.curve[0][:, 2] > 30_000, 2),
            (interval.curve[0][:, 1] // 8192, 8),
        ):
            full = np.bincount(values.astype(int), minlength=bins) / len(interval)
            some = np.bincount(values[:count].astype(int), minlength=bins) / count
            chance = np.sqrt(full * (1 - full) * BLOCK / count)
            assert (np.abs(some - full) <= 4.0 * chance + 1e-3).all()


def test_what_is_shown_together_does_not_evict_each_other(
    context: moderngl.Context, make_clip, small_chunks: int
) -> None:
    """Litter is of the interval before; with too little room for both, loading comes to an end."""
    clip = series(make_clip(), 3)
    size = len(clip.intervals[0]) * bytes_per_point(clip.intervals[0])
    buffers = PointBuffers(context, clip, int(1.3 * size))
    wanted = [*ranges_at(clip, 0.5), *ranges_at(clip, 1.5)]
    buffers.load(wanted, 1.0)
    loaded, there = buffers.loaded, buffers.load(wanted, 1.0)
    assert buffers.load(wanted, 1.0) == there
    assert buffers.loaded == loaded
    assert buffers.size() <= 1.3 * size
