"""Scanned points brought back onto their surface, as far as noise took them off it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

PROBE = 12  # neighbours whose scatter about a paraboloid tells the noise
PATCHES = (10, 20, 40, 80, 160)  # neighbours that a patch may be fitted to
LARGEST = 40  # of them where no more points are known than are to be smoothed
BENT = 0.4  # how much what is no noise counts: a patch misses less at its middle than over all
FEWEST = 36  # points of an organ that say something about the noise
UNLIKE = 1.25  # times as much noise as usual: the most that an organ's points are taken to have
AT_ONCE = 1024


class Smoothed(NamedTuple):
    """(N, 3) points, and the share of the noise's variance that is left in them."""

    points: Points
    left: float


class Noise(NamedTuple):
    """Deviations of a scanner's noise: the usual one, and those on organs that differ."""

    usual: float
    own: dict[int, float]

    def of(self, track: int) -> float:
        return self.own.get(track, self.usual)


class Fit(NamedTuple):
    """Paraboloids fitted to N neighbourhoods: (N, 3) ways to them; (N,) mean squares by which the
    neighbours miss them; (N,) shares of the noise's variance that a point on them still has.
    """

    way: Points
    missed: NDArray[np.float64]
    left: NDArray[np.float64]


def noise_of(
    organs: dict[int, tuple[Points, Points]], known: dict[int, float] | None = None
) -> Noise:
    """The deviation of the scanner's noise on each organ, by points of it and all that it has.

    Points scatter about a paraboloid through their neighbours by noise, and where the surface is
    finer than they are, by more. So the quarter of the plant's points with the least tells what
    noise there is; but organs may also differ, as thin leaves seen from both sides do from stems.

    known: how much each organ has to say about the others, 0 to 1; 1 for all by default.
    """
    found = {
        track: float(np.sqrt(np.median(_fit(points, *_nearest(points, cloud, PROBE)).missed)))
        for track, (points, cloud) in organs.items()
        if len(points) >= FEWEST
    }
    if not found:
        return Noise(0.0, {})
    order = sorted(found, key=lambda track: (found[track], track))
    sizes = np.array([len(organs[track][1]) for track in order], float)
    weights = sizes * [1.0 if known is None else known[track] for track in order]
    weights = weights if weights.any() else sizes
    middles = weights.cumsum() - weights / 2
    usual = float(np.interp(weights.sum() / 4, middles, [found[track] for track in order]))
    return Noise(usual, {track: min(own, UNLIKE * usual) for track, own in found.items()})


def smoothed(points: Points, cloud: Points, noise: float) -> Smoothed:
    """(N, 3) points of a (M, 3) cloud brought onto paraboloids fitted to their neighbours in it:
    moving least squares (Alexa et al. 2003, "Computing and rendering point set surfaces").

    Small patches leave noise, large ones level what is bent. Each point takes the patch of least
    risk (Stein's estimate): the noise that it leaves, and what its neighbours miss it by beyond
    noise. Where even the smallest would do harm, points stay. A plane would shrink stems.
    """
    if len(cloud) < PROBE or noise <= 0.0:
        return Smoothed(points, float(noise > 0.0))
    most = min(LARGEST * len(cloud) / len(points), len(cloud))
    patches = [patch for patch in PATCHES if patch <= most]
    result, left = points.copy(), np.ones(len(points))
    for first in range(0, len(points), AT_ONCE):
        part = slice(first, first + AT_ONCE)
        distance, neighbors = _nearest(points[part], cloud, patches[-1])
        risk, best, rest = np.full(len(neighbors), 1.0), result[part], left[part]
        for patch in patches:
            fit = _fit(points[part], distance[:, :patch], neighbors[:, :patch])
            bent = BENT * np.maximum(fit.missed / noise**2 - 1.0, 0.0)
            better = bent + fit.left < risk
            risk[better] = (bent + fit.left)[better]
            best[better] = (points[part] + fit.way)[better]
            rest[better] = fit.left[better]
    return Smoothed(result, float(left.mean()))


def axes_of(offsets: NDArray[np.float64]) -> tuple[Points, Points, Points]:
    """(N, 3) each: the normal, and two directions along, of N neighbourhoods (N, k, 3)."""
    about = offsets - offsets.mean(axis=1, keepdims=True)
    _, axes = np.linalg.eigh(np.einsum("nki,nkj->nij", about, about))
    return axes[:, :, 0], axes[:, :, 2], axes[:, :, 1]


def _nearest(
    points: Points, cloud: Points, count: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Distances (N, k) and places (N, k, 3) of each point's neighbours in a cloud, itself first."""
    from scipy.spatial import cKDTree

    distance, index = cKDTree(cloud).query(points, k=min(count, len(cloud)))
    return distance, cloud[index]


def _fit(points: Points, distance: NDArray[np.float64], neighbors: NDArray[np.float64]) -> Fit:
    reach = np.maximum(distance[:, -1:], np.finfo(float).tiny)
    offsets = (neighbors - points[:, None]) / reach[..., None]
    normal, first, second = axes_of(offsets)
    x, y, z = (np.einsum("nki,ni->nk", offsets, axis) for axis in (first, second, normal))
    weights = np.exp(-((distance / reach) ** 2))
    terms = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], -1)
    # The small diagonal keeps patches solvable whose points lie on a line.
    small = np.diag([1e-9, 1e-9, 1e-9, 1e-3, 1e-3, 1e-3])
    weighted = terms * weights[..., None]
    inverse = np.linalg.inv(np.einsum("nki,nkj->nij", weighted, terms) + small)
    shares = np.einsum("nij,nkj->nki", inverse, weighted)
    solution = np.einsum("nki,nk->ni", shares, z)
    missed = z - np.einsum("nki,ni->nk", terms, solution)
    own = np.einsum("nki,nki->nk", shares, terms)
    free = np.maximum((weights * (1.0 - own)).sum(axis=1), 1e-9)
    return Fit(
        way=(solution[:, :1] * reach) * normal,
        missed=(weights * missed**2).sum(axis=1) / free * reach[:, 0] ** 2,
        left=np.minimum((shares[:, :, 0] ** 2).sum(axis=1), 1.0),
    )
