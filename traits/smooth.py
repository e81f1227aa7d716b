"""Noise of the scanner: its estimate, and moving least squares to remove it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

# Neighbours that a paraboloid may be fitted to; residuals about the first estimate the noise.
PATCH_SIZES = (12, 20, 40, 100)
NORMAL_NEIGHBORS = 20  # nearest neighbours whose plane all patches of a point share
MAX_PATCH = 40  # of them where the cloud has no more points than are to be smoothed
BIAS_WEIGHT = 0.4  # a paraboloid's bias at its centre, relative to its mean over the patch
MIN_POINTS_FOR_NOISE = 36
MAX_NOISE_RATIO = 1.25  # noise of one organ relative to the plant's, at most
BLOCK = 128
# Exponents of x, y and z in a paraboloid's terms and in its height, and in the products of any two.
TERMS = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (2, 0, 0), (1, 1, 0), (0, 2, 0), (0, 0, 1)])
MONOMIALS, _place = np.unique((TERMS[:, None] + TERMS).reshape(-1, 3), axis=0, return_inverse=True)
PRODUCTS = _place.reshape(len(TERMS), len(TERMS))  # the monomial that two terms' product is
DEGREES = TERMS[:6].sum(axis=1)
RIDGE = np.array([1e-9, 1e-9, 1e-9, 1e-3, 1e-3, 1e-3])  # for patches whose points lie on a line


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

    most = min(MAX_PATCH * len(cloud) / max(len(points), 1), len(cloud))
    sizes = [size for size in PATCH_SIZES if size <= most]
    normals, fits = np.zeros((len(points), 3)), np.zeros((3, len(sizes), len(points)))
    if sizes:
        distance, neighbors = cKDTree(cloud).query(points, k=sizes[-1])
        for first in range(0, len(points), BLOCK):
            part = slice(first, first + BLOCK)
            offsets = cloud[neighbors[part]] - points[part, None]
            normals[part], fits[..., part] = _fit(offsets, distance[part], np.array(sizes))
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


def axes_of(offsets: NDArray[np.float64]) -> Points:
    """Normals and two tangent directions, the columns of (N, 3, 3), of (N, k, 3) neighbourhoods."""
    about = offsets - offsets.mean(axis=1, keepdims=True)
    return np.linalg.eigh(about.mT @ about)[1]


def _fit(
    offsets: NDArray[np.float64], distance: NDArray[np.float64], sizes: NDArray[np.intp]
) -> tuple[Points, NDArray[np.float64]]:
    """Normals, (n, 3), and the heights, residuals and remaining variances, (3, P, n).

    All sizes share the monomials, whose weighted sums (moments) are all that least squares need.
    """
    axes = axes_of(offsets[:, :NORMAL_NEIGHBORS])
    radii = np.maximum(distance[:, sizes - 1], np.finfo(float).tiny + 1e-6 * distance[:, -1:]).T
    widest = radii[-1]
    zxy = ((axes / widest[:, None, None]).mT @ offsets.mT).swapaxes(0, 1)
    z, x, y = [(1.0, t, t * t, t * t * t, (t * t) ** 2) for t in zxy]
    monomials = np.empty((len(offsets), len(MONOMIALS), sizes[-1]))
    for i, (a, b, c) in enumerate(MONOMIALS):
        monomials[:, i] = x[a] * y[b] * z[c]
    weights = np.zeros((len(offsets), len(sizes), sizes[-1]))
    for i, size in enumerate(sizes):
        weights[:, i, :size] = np.exp(-((distance[:, :size] / radii[i, :, None]) ** 2))
    # Arrays of many small matrices are far faster where the points are their last axis.
    moments = monomials @ np.concatenate([weights, weights**2], axis=1).mT
    moments = np.ascontiguousarray(np.moveaxis(moments, 0, 2))
    first, second = moments[:, : len(sizes)][PRODUCTS], moments[:, len(sizes) :][PRODUCTS]
    total = first[0, 0].copy()
    ridge = RIDGE[:, None, None] * (radii / widest) ** (2 * DEGREES[:, None, None])
    first[range(6), range(6)] += ridge
    _sweep(first, 6)
    inverse, solution, spread = first[:6, :6], first[:6, 6], second[:6, :6]
    misfit = first[6, 6] - (ridge * solution**2).sum(axis=0)
    free = total - np.einsum("ijpn,ijpn->pn", inverse, spread)
    left = np.einsum("ipn,ijpn,jpn->pn", inverse[0], spread, inverse[0])
    residual = np.maximum(misfit, 0.0) / np.maximum(free, 1e-9) * widest**2
    return axes[..., 0], np.stack([solution[0] * widest, residual, np.minimum(left, 1.0)])


def _sweep(matrix: NDArray[np.float64], count: int) -> None:
    """Sweep operator on the first rows of symmetric matrices, (m, m, ...), in place.

    Of the normal equations, bordered by their right side, it leaves the inverse, the solution, and
    in the corner the sum of squares that remains (Goodnight 1979).
    """
    for k in range(count):
        pivot, column = matrix[k, k].copy(), matrix[:, k].copy()
        matrix[k] /= pivot
        row = matrix[k].copy()
        matrix -= column[:, None] * row
        matrix[k], matrix[:, k], matrix[k, k] = row, -column / pivot, 1.0 / pivot
