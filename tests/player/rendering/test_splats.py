"""The part of the picture in which splats may appear."""

import numpy as np
import pytest

from player.gl.framebuffer import TILE
from player.rendering.splats import SplatParams
from player.view.camera import Camera

SIZE = (640, 360)
BOX = np.array([[-0.3, -0.2, 0.0], [0.3, 0.2, 0.8]])


@pytest.mark.parametrize("orthographic", [False, True])
@pytest.mark.parametrize("distance", [0.5, 3.0, 10.0])
def test_the_region_holds_all_splats_of_a_box(distance: float, orthographic: bool) -> None:
    rng = np.random.default_rng(1)
    positions = np.column_stack([rng.uniform(*BOX, (2000, 3)), np.ones(2000)])
    for yaw in range(8):
        camera = Camera(distance=distance, yaw=yaw, pitch=0.3 * yaw - 1.0)
        camera = camera.with_orthographic(orthographic)
        splats = SplatParams(camera, SIZE, 0.01, (1.5, 64.0), 1.0, 0.4)
        left, bottom, width, height = splats.region([BOX])
        x, y, share, w = splats.uniforms["to_samples"] @ positions.T
        at = np.array([x, y]).T[share >= 0.0] / w[share >= 0.0, None]
        inside = (at >= 0).all(axis=1) & (at < SIZE).all(axis=1)
        low, high = np.array([left, bottom]), np.array([left + width, bottom + height])
        assert (at[inside] // TILE >= low).all()
        assert (at[inside] // TILE < high).all()
        tiles = -(-SIZE[0] // TILE) * -(-SIZE[1] // TILE)
        assert width * height <= tiles
        if distance == 10.0:
            assert 0 < width * height < tiles / 4, "the plant is small in the picture"
