"""The part of the picture in which splats may appear."""

import numpy as np
import pytest
from numpy.typing import NDArray

from player.gl.framebuffer import TILE
from player.rendering.splats import SplatParams
from player.view.camera import Camera

SIZE = (640, 360)
TILES = -(-SIZE[0] // TILE) * -(-SIZE[1] // TILE)
BOX = np.array([[-0.3, -0.2, 0.0], [0.3, 0.2, 0.8]])
BESIDE_THE_EYE = np.array([[0.1, -4.0, -0.1], [0.3, -1.0, 0.1]])


def region_of(camera: Camera, box: NDArray[np.float64]) -> tuple[int, int, int, int]:
    """The region of a box, once all points of the box in the picture were found in it."""
    splats = SplatParams(camera, SIZE, 0.01, (1.5, 64.0), 1.0, 0.4)
    left, bottom, width, height = splats.region([box])
    points = np.random.default_rng(1).uniform(*box, (5000, 3))
    x, y, share, w = splats.uniforms["to_samples"] @ np.insert(points, 3, 1.0, axis=1).T
    at = np.array([x, y]).T[share >= 0.0] / w[share >= 0.0, None]
    tile = at[(at >= 0).all(axis=1) & (at < SIZE).all(axis=1)] // TILE
    assert (tile >= (left, bottom)).all()
    assert (tile < (left + width, bottom + height)).all()
    return left, bottom, width, height


@pytest.mark.parametrize("orthographic", [False, True])
@pytest.mark.parametrize("distance", [0.1, 0.5, 3.0, 10.0])
def test_the_region_holds_all_points_of_a_box(distance: float, orthographic: bool) -> None:
    for yaw in range(8):
        camera = Camera(distance=distance, yaw=yaw, pitch=0.3 * yaw - 1.0)
        _, _, width, height = region_of(camera.with_orthographic(orthographic), BOX)
        assert width * height <= TILES
        if distance == 10.0:
            assert 0 < width * height < TILES / 4, "the plant is small in the picture"


def test_a_box_reaches_behind_the_eye() -> None:
    region_of(Camera(distance=3.0, yaw=-np.pi / 2, pitch=0.0), BESIDE_THE_EYE)
