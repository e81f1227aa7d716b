"""Noisy points drawn onto the surface that their neighbours span."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.scans.cloud import Cloud

BATCH = 50_000  # points whose neighbourhoods are held at a time


def denoised(cloud: Cloud, neighbors: int) -> Cloud:
    """Move each point along the normal onto a plane through its nearest neighbours.

    The nearer a neighbour the more it counts. What is round rather than flat at that scale, a thin
    stem or a tip, has no such plane: there points stay where they are. Colours and labels stay.

    Source: moving least squares, first order (M. Alexa et al., Computing and Rendering Point Set
    Surfaces, IEEE Transactions on Visualization and Computer Graphics 9, 2003).
    """
    from scipy.spatial import cKDTree

    if len(cloud) <= neighbors:
        return cloud.noting(f"not denoised: it has no {neighbors} neighbours to a point.")
    points = cloud.points.astype(np.float64)
    tree, moved = cKDTree(points), points.copy()
    for first in range(0, len(points), BATCH):
        own = points[first : first + BATCH]
        apart, near = tree.query(own, k=neighbors + 1)
        moved[first : first + BATCH] += _to_plane(own, points[near], apart)
    shift = float(np.sqrt(((moved - points) ** 2).sum(axis=1).mean()))
    drawn = replace(cloud, points=moved.astype(cloud.points.dtype))
    return drawn.noting(f"denoised: points moved by {shift:.3g} in the mean square.")


def _to_plane(
    points: NDArray[np.float64], near: NDArray[np.float64], apart: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(n, 3) from each point towards the plane fitted to its (n, k, 3) neighbours."""
    reach = np.maximum(apart[:, -1:], np.finfo(float).tiny)
    weight = np.exp(-2 * (apart / reach) ** 2)
    weight /= weight.sum(axis=1, keepdims=True)
    center = np.einsum("nk,nkd->nd", weight, near)
    away = near - center[:, None]
    spread, axes = np.linalg.eigh(np.einsum("nk,nki,nkj->nij", weight, away, away))
    normal = axes[:, :, 0]
    flat = 1 - spread[:, 0] / np.maximum(spread[:, 1], np.finfo(float).tiny)
    height = np.einsum("nd,nd->n", center - points, normal)
    return (np.clip(flat, 0, 1) * height)[:, None] * normal
