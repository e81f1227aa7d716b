"""An even sample of a point cloud: every point stands for the same share of surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import NEIGHBORS_FOR_REACH, nearest_neighbors

POOL, MOST, SEED = 6_000, 1_500, 0


@dataclass(frozen=True)
class EvenSample:
    """Points of a cloud in farthest-point order: any first n of them cover the cloud evenly.

    pool:    (M, 3) float64, the cloud itself without outliers, thinned at random if it is large.
    points:  (n, 3) float64, the sample of it.
    radii:   (n,) float64, never rising: how far the pool's farthest point is from the first 1, 2, …
             points of the sample.
    """

    pool: NDArray[np.float64]
    points: NDArray[np.float64]
    radii: NDArray[np.float64]

    def within(self, radius: float) -> NDArray[np.float64]:
        """As many points of the sample as it takes to come within `radius` of the whole pool."""
        return self.points[: int(np.searchsorted(-self.radii, -radius)) + 1]


def even_sample(cloud: NDArray[np.floating]) -> EvenSample:
    """At most 1,500 points of an (N, 3) cloud, by farthest-point sampling (Eldar et al. 1997).

    Scanners see some organs densely and others hardly; an even sample weighs organs by area.
    """
    pool = _pool(cloud)
    columns = np.ascontiguousarray(pool.T)  # coordinate by coordinate this is ten times as fast
    chosen = [int(np.argmax(((columns.T - columns.mean(axis=1)) ** 2).sum(axis=1)))]
    radii: list[float] = []
    gaps = np.full(len(pool), np.inf)
    while True:
        apart = columns - columns[:, chosen[-1:]]
        gaps = np.minimum(gaps, (apart * apart).sum(axis=0))
        farthest = int(np.argmax(gaps))
        radii.append(float(np.sqrt(gaps[farthest])))
        if radii[-1] == 0.0 or len(chosen) == MOST:
            return EvenSample(pool, pool[chosen], np.array(radii))
        chosen.append(farthest)


def _pool(cloud: NDArray[np.floating]) -> NDArray[np.float64]:
    """At most 6,000 of the cloud's points, drawn with a fixed seed, without outliers."""
    if len(cloud) > POOL:
        cloud = cloud[np.random.default_rng(SEED).choice(len(cloud), POOL, replace=False)]
    pool = np.asarray(cloud, np.float64)
    return pool[nearest_neighbors(pool, NEIGHBORS_FOR_REACH).inliers]
