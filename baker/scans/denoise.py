"""Noisy points drawn onto the surface that their neighbours span."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from baker.scans.cloud import Cloud

BATCH_POINTS = 50_000  # whose neighbourhoods are held at a time


def denoised(cloud: Cloud, neighbors: int) -> Cloud:
    """Moving least squares: project each point onto a plane fitted to its nearest neighbours.

    Nearer neighbours have more weight. Where the neighbourhood is round rather than flat, at a thin
    stem or a tip, points stay where they are. Colours and labels stay.

    References
    ----------
    M. Alexa et al., Computing and Rendering Point Set Surfaces, IEEE Transactions on Visualization
    and Computer Graphics 9, 2003 (first order).
    """
    from scipy.spatial import KDTree

    if len(cloud) <= neighbors:
        return cloud.noting(f"not denoised: it has no {neighbors} neighbours to a point.")
    points = cloud.points.astype(np.float64)
    tree, moved = KDTree(points), points.copy()
    for first in range(0, len(points), BATCH_POINTS):
        own = points[first : first + BATCH_POINTS]
        distances, indices = tree.query(own, k=neighbors + 1)
        moved[first : first + BATCH_POINTS] += _to_plane(own, points[indices], distances)
    shift = float(np.sqrt(((moved - points) ** 2).sum(axis=1).mean()))
    drawn = replace(cloud, points=moved.astype(cloud.points.dtype))
    return drawn.noting(f"denoised: points moved by {shift:.3g} in the mean square.")


def _to_plane(
    points: NDArray[np.float64], neighbors: NDArray[np.float64], distances: NDArray[np.float64]
) -> NDArray[np.float64]:
    """(n, 3) from each point to the plane fitted to its (n, k, 3) neighbours."""
    radius = np.maximum(distances[:, -1:], np.finfo(float).tiny)
    weight = np.exp(-2 * (distances / radius) ** 2)
    weight /= weight.sum(axis=1, keepdims=True)
    center = np.einsum("nk,nkd->nd", weight, neighbors)
    offset = neighbors - center[:, None]
    spread, axes = np.linalg.eigh(np.einsum("nk,nki,nkj->nij", weight, offset, offset))
    normal = axes[:, :, 0]
    flat = 1 - spread[:, 0] / np.maximum(spread[:, 1], np.finfo(float).tiny)
    height = np.einsum("nd,nd->n", center - points, normal)
    return (np.clip(flat, 0, 1) * height)[:, None] * normal
