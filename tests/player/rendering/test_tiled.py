"""Splats by tiles, without a GPU, are the splats that a GPU blends."""

from __future__ import annotations

import moderngl
import numpy as np
import pytest

import player.gl.context
import player.rendering.tiled
from gclip import Clip, Motion, ScanMark, Track
from gclip.pack import Movers, pack_interval
from player.rendering.tiled import by_tile
from player.view.style import Style
from tests.player.drawn import Picture, camera_at, drawn

SIZE = (161, 119)  # no multiple of a tile's side
BOTH = ((90, 160, 60, 255), (200, 120, 40, 255))


def two_sheets() -> Clip:
    """A near sheet before the middle of a far one, which comes before it and after it again."""
    across, above = np.meshgrid(np.linspace(-20, 20, 40), np.linspace(0, 40, 40))
    far = np.column_stack([across.ravel(), np.full(1600, 12.0), above.ravel()])
    near = far * [0.5, -1.0, 0.5] + [0.0, 0.0, 10.0]
    points, tracks = np.concatenate([far, near, far[::-1]]), np.repeat([0, 1, 0], 1600)
    return Clip(
        scans=tuple(ScanMark(name, time, name, 4800) for name, time in [("a", 0.0), ("b", 5.0)]),
        intervals=(
            pack_interval(0.0, 5.0, [Movers(Motion.MOVE, (points, points), tracks)], spacing=1.0),
        ),
        track_table=(Track(0, "far", (200, 60, 40)), Track(1, "near", (40, 90, 220), parent=0)),
        spacing=1.0,
    )


def picture(
    context: moderngl.Context,
    clip: Clip,
    style: Style,
    supersample: int,
    tiled: bool,
    nearer: float = 1.0,
    every: int = 1,
) -> Picture:
    camera = camera_at(clip, SIZE, -70, 0.2).zoom(nearer)
    return drawn(
        context, clip, 2.3, camera, SIZE, style,
        supersample=supersample, as_on_a_gpu=not tiled, every=every,
    )  # fmt: skip


@pytest.fixture
def cpu_context(context: moderngl.Context) -> moderngl.Context:
    if not player.gl.context.on_cpu(context):
        pytest.skip("a GPU blends splats itself")
    return context


@pytest.mark.parametrize("supersample", [1, 2])
@pytest.mark.parametrize(
    ("colors", "style"),
    [
        (None, Style(show_ground=False)),
        (BOTH, Style(show_ground=False)),
        (None, Style(color_by="height")),
        (None, Style(hidden=frozenset({1}))),
    ],
    ids=["tracks", "scan colours", "values", "hidden"],
)
def test_tiles_make_the_picture_of_splats(
    cpu_context: moderngl.Context, make_clip, colors, style: Style, supersample: int
) -> None:
    clip = make_clip(degree=2, colors=colors)
    tiled, blended = (picture(cpu_context, clip, style, supersample, way) for way in (True, False))
    assert (blended.max(axis=2) > 60).sum() > 1500
    # Where a distance is on one side of a threshold by rounding alone, a few may differ more.
    assert (np.abs(tiled - blended).max(axis=2) > 2).mean() < 0.004


@pytest.mark.parametrize("supersample", [1, 2])
def test_what_is_near_hides_what_is_far(cpu_context: moderngl.Context, supersample: int) -> None:
    """And the sum over a sample's discs may stop at the first that is hidden."""
    clip, style = two_sheets(), Style(show_ground=False, eye_dome=0.0)
    tiled, blended = (picture(cpu_context, clip, style, supersample, way) for way in (True, False))
    blue = tiled[..., 2] > tiled[..., 0] + 60
    red = tiled[..., 0] > tiled[..., 2] + 60
    assert blue[50:70, 70:90].all()
    assert red.sum() > blue.sum() > 1000
    assert (np.abs(tiled - blended).max(axis=2) > 2).mean() < 0.004


@pytest.mark.parametrize("supersample", [1, 2])
def test_discs_reach_into_the_picture_from_outside(
    cpu_context: moderngl.Context, make_clip, supersample: int
) -> None:
    clip, style = make_clip(degree=2), Style(show_ground=False, point_size=2.0)
    tiled, blended = (
        picture(cpu_context, clip, style, supersample, way, nearer=4.0) for way in (True, False)
    )
    assert (blended.max(axis=2) > 60).mean() > 0.5
    assert (np.abs(tiled - blended).max(axis=2) > 2).mean() < 0.004


def test_the_same_picture_from_run_to_run(cpu_context: moderngl.Context, make_clip) -> None:
    clip = make_clip(degree=2)
    first, second = (picture(cpu_context, clip, Style(), 2, True) for _ in range(2))
    assert (first == second).all()


def test_fewer_movers_are_fewer_discs(cpu_context: moderngl.Context, make_clip) -> None:
    clip, style = make_clip(degree=2), Style(show_ground=False)
    tiled, blended = (picture(cpu_context, clip, style, 1, way, every=2) for way in (True, False))
    assert (np.abs(tiled - blended).max(axis=2) > 2).mean() < 0.004


@pytest.mark.parametrize("limit", ["MOVERS", "ENTRIES"])
def test_too_many_discs_are_blended(
    cpu_context: moderngl.Context, make_clip, monkeypatch: pytest.MonkeyPatch, limit: str
) -> None:
    clip = make_clip()
    blended = picture(cpu_context, clip, Style(), 1, tiled=False)
    monkeypatch.setattr(player.rendering.tiled, limit, 100)
    assert (picture(cpu_context, clip, Style(), 1, tiled=True) == blended).all()


def test_every_tile_has_the_discs_that_reach_it() -> None:
    random = np.random.default_rng(5)
    places = random.uniform(-40, 200, (300, 2)).astype(np.float32)
    radii = random.uniform(0.5, 25, 300).astype(np.float32)
    tiles, side = (10, 7), 16
    order, runs = by_tile(places, radii, tiles, side)
    found = {(x, y): list(order[first : first + count]) for x, y, first, count in runs.tolist()}
    for x in range(tiles[0]):
        for y in range(tiles[1]):
            low = np.array([x, y]) * side
            reach = (places + radii[:, None] >= low) & (places - radii[:, None] < low + side)
            assert found.get((x, y), []) == np.flatnonzero(reach.all(axis=1)).tolist()
    assert all(count for *_, count in runs.tolist())


def test_nothing_to_see_has_no_tiles() -> None:
    order, runs = by_tile(np.full((3, 2), -90, np.float32), np.ones(3, np.float32), (4, 4), 16)
    assert len(order) == len(runs) == 0
    order, runs = by_tile(np.zeros((0, 2), np.float32), np.zeros(0, np.float32), (4, 4), 16)
    assert len(order) == len(runs) == 0
