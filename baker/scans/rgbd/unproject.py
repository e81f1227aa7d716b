"""From a depth image to points that stand upright."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baker.scans.rgbd.camera import Camera


def unproject(
    depth: NDArray[np.float64], chosen: NDArray[np.bool_], camera: Camera, ground: float
) -> NDArray[np.float64]:
    """The points that pixels show, in mm, row by row.

    x points to the picture's right, y to its top, z from the ground to the camera; the origin lies
    on the ground, on the camera's axis. (Of the usual camera axes, right, down and forward, the
    last two are turned over: a half turn about x.)

    Parameters
    ----------
    depth : (H, W) float64
        mm along the camera's axis.
    chosen : (H, W) bool
        The pixels.
    camera : Camera
    ground : float
        Distance from the camera to the ground, mm.

    Returns
    -------
    (N, 3) float64
    """
    v, u = np.nonzero(chosen)
    left, top = camera.crop or (0, 0)
    z = depth[v, u]
    x = (u + left - camera.cx) / camera.fx * z
    y = (v + top - camera.cy) / camera.fy * z
    return np.stack([x, -y, ground - z], axis=1)
