"""Splats along normals are as large as the surface that was sampled."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import nearest_neighbors
from baker.geometry.surface import covariances, surface_normals
from baker.interpolation.packing import Movers, pack_interval
from gclip import Clip, Motion, ScanMark, Track
from player.rendering.headless import Offscreen
from player.view.style import Style
from tests.player.drawn import fitted

SIZE, SIDE = (640, 480), 2.0
COLORS = ((200, 90, 60), (90, 160, 60))
Floats = NDArray[np.floating]


def leaf(turn: float = 0.0) -> Clip:
    """A flat square of 900 points that faces the camera of `picture`, or is turned from it."""
    return clip_of(turned(square(SIDE), turn))


def square(side: float) -> Floats:
    """(900, 2) places on a grid in a square, moved a little."""
    random = np.random.default_rng(3)
    grid = (np.stack(np.meshgrid(*[np.arange(30)] * 2), -1).reshape(-1, 2) + 0.5) / 30
    return side * (grid + random.uniform(-0.4, 0.4, grid.shape) / 30) - side / 2


def turned(places: Floats, turn: float = 0.0) -> Floats:
    """(N, 3) upright places, turned about the upright axis by an angle in radians."""
    across = np.outer(places[:, 0], (np.cos(turn), np.sin(turn)))
    return np.column_stack([across, places[:, 1]])


def clip_of(*leaves: Floats) -> Clip:
    """A clip of leaves, each of (N, 3) points, that stand still."""
    points = np.concatenate(leaves).astype(np.float32)
    normals = np.concatenate([np.tile(normals_of(leaf), 2) for leaf in leaves])
    ids = np.repeat(np.arange(len(leaves), dtype=np.uint16), [*map(len, leaves)])
    movers = Movers(Motion.MOVE, (points, points), ids, normals=normals)
    return Clip(
        scans=(ScanMark("a", 0.0, "a", len(points)), ScanMark("b", 1.0, "b", len(points))),
        intervals=(pack_interval(0.0, 1.0, [movers], spacing=SIDE / 30),),
        track_table=tuple(Track(i, str(i), COLORS[i]) for i in range(len(leaves))),
        spacing=SIDE / 30,
    )


def normals_of(points: Floats) -> NDArray[np.uint8]:
    neighbors = nearest_neighbors(points)
    return surface_normals(points, covariances(points, neighbors), neighbors)


def picture(clip: Clip) -> tuple[NDArray[np.uint8], float]:
    """The plant seen along y on no background, and the area of a pixel."""
    low, high = np.full(3, -0.6 * SIDE), np.full(3, 0.6 * SIDE)
    camera = replace(fitted((low, high), aspect=SIZE[0] / SIZE[1]), yaw=-np.pi / 2, pitch=0.0)
    with Offscreen(clip, SIZE) as offscreen:
        pixels = offscreen.picture(0.5, camera, Style(), transparent=True)
    side_px = SIZE[1] * float(camera.projection(1.0)[1, 1]) / 2 / camera.distance
    return pixels, 1.0 / side_px**2


def cover(clip: Clip) -> float:
    """The area that the plant takes up in the picture."""
    pixels, pixel_area = picture(clip)
    return float(pixels[..., 3].sum() / 255.0 * pixel_area)


def without_normals(clip: Clip) -> Clip:
    return replace(clip, intervals=tuple(replace(i, normals=None) for i in clip.intervals))


def test_a_leaf_is_as_large_as_it_was_sampled() -> None:
    assert 0.98 < cover(leaf()) / SIDE**2 < 1.05
    assert cover(without_normals(leaf())) / SIDE**2 > 1.07


def test_a_leaf_seen_from_its_edge_is_thin() -> None:
    upright, seen = leaf(np.radians(80)), SIDE**2 * np.cos(np.radians(80))
    assert 0.98 < cover(upright) / seen < 1.2
    assert cover(without_normals(upright)) / seen > 1.4


def test_what_lies_behind_an_edge_continues_up_to_it() -> None:
    """Splats hide more than their surface; where it has ended, the leaf behind is seen."""
    small, large = turned(square(SIDE / 2)), turned(square(SIDE))
    pixels, pixel_area = picture(clip_of(small - [0.0, 0.3, 0.0], large))
    height, width = pixels.shape[:2]
    part = int(0.45 * SIDE / np.sqrt(pixel_area))  # of the picture, within the large leaf
    middle = pixels[height // 2 - part : height // 2 + part, width // 2 - part : width // 2 + part]
    assert (middle[..., 3] == 255).all(), "no ground between the leaves"
    is_small = middle[..., 0] > middle[..., 1].astype(int)
    # It is nearer to the eye than the plane in which pixels have that area.
    assert 1.0 < is_small.sum() * pixel_area / (SIDE / 2) ** 2 < 1.25
    assert np.ptp(np.nonzero(is_small), axis=1).max() < 1.1 * np.sqrt(is_small.sum())
