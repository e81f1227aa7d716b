"""Estimate the noise of a scanner, and remove it by moving least squares."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

PATCH_SIZES = (12, 30, 100)  # numbers of neighbours; the first is used to estimate the noise
MAX_PATCH = 30  # most neighbours, if all points of the cloud are smoothed; else more in proportion
FRAME_NEIGHBORS = 20  # number of neighbours to which a tangent plane is fitted
# Regularisation of a paraboloid's terms 1, x, y, x², xy and y², for points on a line.
RIDGE = np.array([1e-9, 1e-9, 1e-9, 1e-3, 1e-3, 1e-3])
BIAS_WEIGHT = 0.4  # bias of a paraboloid at its centre : mean bias over the patch
MIN_POINTS_FOR_NOISE = 36  # of an organ
MAX_NOISE_RATIO = 1.25  # standard deviation of the noise of an organ : that of the plant


class Smoothed(NamedTuple):
    """(N, 3) points, and the share of the noise variance that remains in them."""

    points: Points
    remaining: float


class Noise(NamedTuple):
    """Standard deviation of the noise: of the plant, and of single organs by track id."""

    plant: float
    organs: dict[int, float]

    def of(self, track: int) -> float:
        """The noise of an organ, or that of the plant if the organ is too small."""
        return self.organs.get(track, self.plant)


class Patches(NamedTuple):
    """Paraboloids fitted to neighbourhoods of P sizes about each of N points.

    Attributes
    ----------
    points : ndarray of shape (N, 3)
    cloud_size : int
        Number of points of the cloud that the neighbours are from.
    normals : ndarray of shape (N, 3)
    height : ndarray of shape (P, N)
        Heights of the paraboloids above the points, along the normals.
    residual : ndarray of shape (P, N)
        Mean squared residuals of the neighbours.
    remaining : ndarray of shape (P, N)
        Shares of the noise variance that remain in the projected points.
    """

    points: Points
    cloud_size: int
    normals: Points
    height: NDArray[np.float64]
    residual: NDArray[np.float64]
    remaining: NDArray[np.float64]


def fit_patches(points: Points, cloud: Points) -> Patches:
    """Fit paraboloids to the nearest neighbours of points, by weighted least squares.

    Parameters
    ----------
    points : ndarray of shape (N, 3)
    cloud : ndarray of shape (M, 3)
        The cloud to which the points belong.

    Returns
    -------
    Patches
        With P = 0 if the cloud has too few points.
    """
    from scipy.spatial import cKDTree

    max_size = min(MAX_PATCH * len(cloud) / max(len(points), 1), len(cloud))
    sizes = [size for size in PATCH_SIZES if size <= max_size]
    fits = np.zeros((3, len(sizes), len(points)))
    if not sizes:
        return Patches(points, len(cloud), np.zeros_like(points), *fits)
    distance, neighbors = cKDTree(cloud).query(points, k=sizes[-1])
    offsets = cloud[neighbors] - points[:, None]
    axes = tangent_frames(offsets[:, :FRAME_NEIGHBORS])
    local = axes.swapaxes(1, 2) @ offsets.swapaxes(1, 2)
    for fit, size in zip(fits.swapaxes(0, 1), sizes, strict=True):
        radius = np.maximum(distance[:, size - 1], 1e-300 + 1e-6 * distance[:, -1])
        weight = np.exp(-((distance[:, :size] / radius[:, None]) ** 2))
        z, x, y = local.swapaxes(0, 1)[..., :size] / radius[:, None]
        terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)
        weighted = terms * weight[:, None]
        inverse = np.linalg.inv(weighted @ terms.swapaxes(1, 2) + np.diag(RIDGE))
        coefficients = inverse @ (weighted @ z[..., None])
        misfit = (weight * (z - (coefficients.swapaxes(1, 2) @ terms)[:, 0]) ** 2).sum(axis=1)
        twice_weighted = weighted @ weighted.swapaxes(1, 2)
        degrees_of_freedom = weight.sum(axis=1) - (inverse * twice_weighted).sum(axis=(1, 2))
        fit[0] = coefficients[:, 0, 0] * radius
        fit[1] = misfit / np.maximum(degrees_of_freedom, 1e-9) * radius**2
        fit[2] = np.minimum((inverse[:, :1] @ twice_weighted @ inverse[:, :, :1])[:, 0, 0], 1.0)
    return Patches(points, len(cloud), axes[..., 0], *fits)


def tangent_frames(neighbors: NDArray[np.float64]) -> NDArray[np.float64]:
    """(N, 3, 3) principal axes of (N, k, 3) neighbours, as columns, the normal first."""
    centered = neighbors - neighbors.mean(axis=1, keepdims=True)
    return np.linalg.eigh(centered.swapaxes(1, 2) @ centered)[1]


def noise_of(organs: dict[int, Patches], organ_weights: dict[int, float] | None = None) -> Noise:
    """Estimate the standard deviation of the scanner's noise, for the plant and for each organ.

    Residuals of paraboloids come from noise, and from detail of the surface that is finer than the
    point spacing. The noise is therefore estimated by the lower quartile of the organs. Single
    organs may have more or less, like thin leaves that are scanned from both sides.

    Parameters
    ----------
    organs : dict of int to Patches
        By track id.
    organ_weights : dict of int to float, optional
        Weight of each organ in the estimate of the plant, 0 to 1; by default 1.

    Returns
    -------
    Noise
    """
    residuals = {
        track: float(np.sqrt(np.median(patches.residual[0])))
        for track, patches in organs.items()
        if len(patches.points) >= MIN_POINTS_FOR_NOISE
    }
    if not residuals:
        return Noise(0.0, {})
    order = sorted(residuals, key=lambda track: (residuals[track], track))
    sizes = np.array([organs[track].cloud_size for track in order], float)
    weights = sizes * [1.0 if organ_weights is None else organ_weights[track] for track in order]
    weights = weights if weights.any() else sizes
    # The mean of quantiles 1/8 to 3/8 instead of the quartile is continuous as organs come and go.
    share = np.clip(np.append(0.0, weights.cumsum() / weights.sum()), 1 / 8, 3 / 8)
    plant = float(4.0 * np.diff(share) @ [residuals[track] for track in order])
    limit = MAX_NOISE_RATIO * plant
    return Noise(plant, {track: min(noise, limit) for track, noise in residuals.items()})


def smoothed(patches: Patches, noise: float) -> Smoothed:
    """Project points onto paraboloids fitted to their neighbours (moving least squares).

    Small patches leave variance, large ones add bias where the surface is curved. For each point,
    the patch size with the least estimated risk is used, variance plus squared bias; the point is
    not moved if no size reduces the risk. Planes instead of paraboloids would shrink stems.

    Parameters
    ----------
    patches : Patches
    noise : float
        Standard deviation of the noise, in the unit of the points.

    Returns
    -------
    Smoothed

    References
    ----------
    Alexa et al. (2003), "Computing and rendering point set surfaces", IEEE TVCG 9.
    Stein (1981), "Estimation of the mean of a multivariate normal distribution", Ann. Stat. 9.
    """
    points, _, normals, height, residual, remaining = patches
    if noise <= 0.0 or not height.size:
        return Smoothed(points, float(noise > 0.0))
    risk = BIAS_WEIGHT * np.maximum(residual / noise**2 - 1.0, 0.0) + remaining
    best = risk.argmin(axis=0), np.arange(len(points))
    is_moved = risk[best] < 1.0
    moved = points + np.where(is_moved, height[best], 0.0)[:, None] * normals
    return Smoothed(moved, float(np.where(is_moved, remaining[best], 1.0).mean()))
