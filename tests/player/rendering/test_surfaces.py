"""Splats along normals are as large as the surface that was sampled."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from baker.geometry.neighbors import nearest_neighbors
from baker.geometry.surface import covariances, surface_normals
from baker.interpolation.packing import Movers, pack_interval
from gclip import Clip, Motion, ScanMark, Track
from player.rendering.headless import Offscreen
from player.view.style import Style
from tests.player.drawn import fitted

SIZE, SIDE = (640, 480), 2.0


def leaf(turn: float = 0.0) -> Clip:
    """A flat square of 900 points, seen by the camera of `cover`; turned about its upright axis."""
    random = np.random.default_rng(3)
    grid = (np.stack(np.meshgrid(*[np.arange(30)] * 2), -1).reshape(-1, 2) + 0.5) / 30
    flat = SIDE * (grid + random.uniform(-0.4, 0.4, grid.shape) / 30) - SIDE / 2
    points = np.column_stack(
        [flat[:, 0] * np.cos(turn), flat[:, 0] * np.sin(turn), flat[:, 1]]
    ).astype(np.float32)
    neighbors = nearest_neighbors(points)
    normals = np.tile(surface_normals(points, covariances(points, neighbors), neighbors), 2)
    ids = np.zeros(len(points), np.uint16)
    movers = Movers(Motion.MOVE, (points, points), ids, normals=normals)
    return Clip(
        scans=(ScanMark("a", 0.0, "a", 900), ScanMark("b", 1.0, "b", 900)),
        intervals=(pack_interval(0.0, 1.0, [movers], spacing=SIDE / 30),),
        track_table=(Track(0, "leaf", (90, 160, 60)),),
        spacing=SIDE / 30,
    )


def cover(clip: Clip) -> np.ndarray:
    """The area that the plant takes up in each pixel, seen along y."""
    low, high = np.full(3, -0.6 * SIDE), np.full(3, 0.6 * SIDE)
    camera = replace(fitted((low, high), aspect=SIZE[0] / SIZE[1]), yaw=-np.pi / 2, pitch=0.0)
    with Offscreen(clip, SIZE) as offscreen:
        alpha = offscreen.picture(0.5, camera, Style(), transparent=True)[..., 3] / 255.0
    px = SIZE[1] * float(camera.projection(1.0)[1, 1]) / 2 / camera.distance
    return alpha / px**2


def without_normals(clip: Clip) -> Clip:
    return replace(clip, intervals=tuple(replace(i, normals=None) for i in clip.intervals))


def test_a_leaf_is_as_large_as_it_was_sampled() -> None:
    assert 0.98 < cover(leaf()).sum() / SIDE**2 < 1.05
    assert cover(without_normals(leaf())).sum() / SIDE**2 > 1.07


def test_a_leaf_seen_from_its_edge_is_thin() -> None:
    turned, seen = leaf(np.radians(80)), SIDE**2 * np.cos(np.radians(80))
    assert 0.98 < cover(turned).sum() / seen < 1.2
    assert cover(without_normals(turned)).sum() / seen > 1.4
