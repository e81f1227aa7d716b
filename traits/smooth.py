"""Noise of the scanner: its estimate, and moving least squares to remove it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

# Neighbours that a paraboloid may be fitted to; residuals about the first estimate the noise.
PATCH_SIZES = (12, 20, 40, 100)
MAX_PATCH = 40  # of them where the cloud has no more points than are to be smoothed
BIAS_WEIGHT = 0.4  # a paraboloid's bias at its centre, relative to its mean over the patch
MIN_POINTS_FOR_NOISE = 36
MAX_NOISE_RATIO = 1.25  # noise of one organ relative to the plant's, at most


class Smoothed(NamedTuple):
    """(N, 3) points, and the share of the noise variance that is left in them."""

    points: Points
    left: float


class Noise(NamedTuple):
    """Standard deviation of the scanner's noise: of the plant, and by track id of single organs."""

    usual: float
    own: dict[int, float]

    def of(self, track: int) -> float:
        return self.own.get(track, self.usual)


class Patches(NamedTuple):
    """Paraboloids fitted to neighbourhoods of P sizes about each of N points.

    Attributes
    ----------
    points : ndarray of shape (N, 3)
    cloud_size : int
        Number of points of the cloud that the neighbours are from.
    normals : ndarray of shape (N, 3)
    height : ndarray of shape (P, N)
        Of the paraboloids over the points, along the normals.
    residual : ndarray of shape (P, N)
        Mean squared residual of the neighbours.
    left : ndarray of shape (P, N)
        Share of the noise variance that the projected point still has.
    """

    points: Points
    cloud_size: int
    normals: Points
    height: NDArray[np.float64]
    residual: NDArray[np.float64]
    left: NDArray[np.float64]


def fit_patches(points: Points, cloud: Points) -> Patches:
    """Fit paraboloids to the nearest neighbours of points, by weighted least squares.

    Parameters
    ----------
    points : ndarray of shape (N, 3)
    cloud : ndarray of shape (M, 3)
        The cloud that the points belong to.

    Returns
    -------
    Patches
        Of no sizes (P = 0) where the cloud has too few points.
    """
    from scipy.spatial import cKDTree

    from traits.neighborhoods import fit_paraboloids

    most = min(MAX_PATCH * len(cloud) / max(len(points), 1), len(cloud))
    sizes = [size for size in PATCH_SIZES if size <= most]
    normals, fits = np.zeros((len(points), 3)), np.zeros((3, len(sizes), len(points)))
    if sizes:
        distance, neighbors = cKDTree(cloud).query(points, k=sizes[-1])
        fit_paraboloids(points, cloud, neighbors, distance, np.array(sizes), normals, fits)
    return Patches(points, len(cloud), normals, *fits)


def noise_of(organs: dict[int, Patches], known: dict[int, float] | None = None) -> Noise:
    """Estimate the standard deviation of the scanner's noise, for the plant and for each organ.

    Residuals about a paraboloid through the neighbours come from noise and, where the surface has
    detail finer than the point spacing, from that detail. The lower quartile over the plant is
    therefore taken for the noise. Organs may differ, as thin leaves scanned from both sides do
    from stems.

    Parameters
    ----------
    organs : dict of int to Patches
        By track id.
    known : dict of int to float, optional
        Weight of each organ in the plant's estimate, 0 to 1; by default 1 for all.

    Returns
    -------
    Noise
    """
    found = {
        track: float(np.sqrt(np.median(patches.residual[0])))
        for track, patches in organs.items()
        if len(patches.points) >= MIN_POINTS_FOR_NOISE
    }
    if not found:
        return Noise(0.0, {})
    order = sorted(found, key=lambda track: (found[track], track))
    sizes = np.array([organs[track].cloud_size for track in order], float)
    weights = sizes * [1.0 if known is None else known[track] for track in order]
    weights = weights if weights.any() else sizes
    # About the quartile, the mean of an eighth to either side: no jump where organs come and go.
    share = np.clip(np.append(0.0, weights.cumsum() / weights.sum()), 1 / 8, 3 / 8)
    usual = float(4.0 * np.diff(share) @ [found[track] for track in order])
    return Noise(usual, {track: min(own, MAX_NOISE_RATIO * usual) for track, own in found.items()})


def smoothed(patches: Patches, noise: float) -> Smoothed:
    """Project points onto paraboloids fitted to their neighbours (moving least squares).

    Small patches leave variance, large ones add bias where the surface is curved. Each point takes
    the patch size of least estimated risk, variance plus squared bias, and stays where it is if
    none reduces it. Planes instead of paraboloids would shrink stems.

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
    points, _, normals, height, residual, left = patches
    if noise <= 0.0 or not height.size:
        return Smoothed(points, float(noise > 0.0))
    risk = BIAS_WEIGHT * np.maximum(residual / noise**2 - 1.0, 0.0) + left
    best = risk.argmin(axis=0), np.arange(len(points))
    worth = risk[best] < 1.0
    moved = points + np.where(worth, height[best], 0.0)[:, None] * normals
    return Smoothed(moved, float(np.where(worth, left[best], 1.0).mean()))
