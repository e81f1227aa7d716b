"""Noise of the scanner: its estimate, and moving least squares to remove it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

NOISE_NEIGHBORS = 12  # neighbours whose residuals about a paraboloid estimate the noise
PATCH_SIZES = (10, 20, 40, 80, 160)  # neighbours that a paraboloid may be fitted to
MAX_PATCH = 40  # of them where the cloud has no more points than are to be smoothed
BIAS_WEIGHT = 0.4  # a paraboloid's bias at its centre, relative to its mean over the patch
MIN_POINTS_FOR_NOISE = 36
MAX_NOISE_RATIO = 1.25  # noise of one organ relative to the plant's, at most
BLOCK = 256  # points fitted at once: what they need stays in the processor's cache


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


class Fit(NamedTuple):
    """Paraboloids fitted to N neighbourhoods.

    Attributes
    ----------
    displacement : ndarray of shape (N, 3)
        From each point to its projection onto the paraboloid.
    residual : ndarray of shape (N,)
        Mean squared residual of the neighbours.
    left : ndarray of shape (N,)
        Share of the noise variance that the projected point still has.
    """

    displacement: Points
    residual: NDArray[np.float64]
    left: NDArray[np.float64]


def noise_of(
    organs: dict[int, tuple[Points, Points]], known: dict[int, float] | None = None
) -> Noise:
    """Estimate the standard deviation of the scanner's noise, for the plant and for each organ.

    Residuals about a paraboloid through the neighbours come from noise and, where the surface has
    detail finer than the point spacing, from that detail. The lower quartile over the plant is
    therefore taken for the noise. Organs may differ, as thin leaves scanned from both sides do
    from stems.

    Parameters
    ----------
    organs : dict of int to (points, cloud)
        By track id, (N, 3) points of the organ and the (M, 3) cloud that they are a sample of.
    known : dict of int to float, optional
        Weight of each organ in the plant's estimate, 0 to 1; by default 1 for all.

    Returns
    -------
    Noise
    """
    found = {
        track: float(
            np.sqrt(np.median(_fit(points, *_nearest(points, cloud, NOISE_NEIGHBORS)).residual))
        )
        for track, (points, cloud) in organs.items()
        if len(points) >= MIN_POINTS_FOR_NOISE
    }
    if not found:
        return Noise(0.0, {})
    order = sorted(found, key=lambda track: (found[track], track))
    sizes = np.array([len(organs[track][1]) for track in order], float)
    weights = sizes * [1.0 if known is None else known[track] for track in order]
    weights = weights if weights.any() else sizes
    middles = weights.cumsum() - weights / 2
    usual = float(np.interp(weights.sum() / 4, middles, [found[track] for track in order]))
    return Noise(usual, {track: min(own, MAX_NOISE_RATIO * usual) for track, own in found.items()})


def smoothed(points: Points, cloud: Points, noise: float) -> Smoothed:
    """Project points onto paraboloids fitted to their neighbours (moving least squares).

    Small patches leave variance, large ones add bias where the surface is curved. Each point takes
    the patch size of least estimated risk, variance plus squared bias, and stays where it is if
    none reduces it. Planes instead of paraboloids would shrink stems.

    Parameters
    ----------
    points : ndarray of shape (N, 3)
    cloud : ndarray of shape (M, 3)
        The cloud that the points belong to.
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
    if len(cloud) < NOISE_NEIGHBORS or noise <= 0.0:
        return Smoothed(points, float(noise > 0.0))
    most = min(MAX_PATCH * len(cloud) / len(points), len(cloud))
    patches = [patch for patch in PATCH_SIZES if patch <= most]
    every = _nearest(points, cloud, patches[-1])
    result, left = points.copy(), np.ones(len(points))
    for first in range(0, len(points), BLOCK):
        part = slice(first, first + BLOCK)
        distance, neighbors = (values[part] for values in every)
        risk, best, rest = np.full(len(neighbors), 1.0), result[part], left[part]
        for patch in patches:
            fit = _fit(points[part], distance[:, :patch], neighbors[:, :patch])
            bias = BIAS_WEIGHT * np.maximum(fit.residual / noise**2 - 1.0, 0.0)
            better = bias + fit.left < risk
            risk[better] = (bias + fit.left)[better]
            best[better] = (points[part] + fit.displacement)[better]
            rest[better] = fit.left[better]
    return Smoothed(result, float(left.mean()))


def axes_of(offsets: NDArray[np.float64]) -> tuple[Points, Points, Points]:
    """Normals and two tangent directions, each (N, 3), of N neighbourhoods of shape (N, k, 3)."""
    about = offsets - offsets.mean(axis=1, keepdims=True)
    _, axes = np.linalg.eigh(about.mT @ about)
    return axes[:, :, 0], axes[:, :, 2], axes[:, :, 1]


def _nearest(
    points: Points, cloud: Points, count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Distances (N, k) and positions (N, k, 3) of the nearest points of a cloud, itself first."""
    from scipy.spatial import cKDTree

    distance, index = cKDTree(cloud).query(points, k=min(count, len(cloud)))
    return distance, cloud[index]


def _fit(points: Points, distance: NDArray[np.float64], neighbors: NDArray[np.float64]) -> Fit:
    radius = np.maximum(distance[:, -1:], np.finfo(float).tiny)
    offsets = (neighbors - points[:, None]) / radius[..., None]
    normal, first, second = axes_of(offsets)
    x, y, z = np.moveaxis(offsets @ np.stack([first, second, normal], axis=2), 2, 0)
    weights = np.exp(-((distance / radius) ** 2))
    terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)
    # The small diagonal regularises patches whose points lie on a line.
    small = np.diag([1e-9, 1e-9, 1e-9, 1e-3, 1e-3, 1e-3])
    weighted = terms * weights[:, None]
    shares = np.linalg.inv(weighted @ terms.mT + small) @ weighted
    solution = shares @ z[..., None]
    misfit = z - (terms.mT @ solution)[..., 0]
    own = (shares * terms).sum(axis=1)
    free = np.maximum((weights * (1.0 - own)).sum(axis=1), 1e-9)
    return Fit(
        displacement=(solution[:, 0] * radius) * normal,
        residual=(weights * misfit**2).sum(axis=1) / free * radius[:, 0] ** 2,
        left=np.minimum((shares[:, 0] ** 2).sum(axis=1), 1.0),
    )
