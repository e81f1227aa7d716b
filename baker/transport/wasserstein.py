"""How far apart two segments are: the Wasserstein distance, exact, estimated, or bounded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.transport import bisection
from baker.transport.multiscale import Search, couple
from baker.transport.problem import Points, TransportOptions, checked, costs, uniform_masses
from baker.transport.solve import solve
from baker.transport.support import RIDGE, balance, explained_cost, matrix_power

_ROUNDING = 1e-6  # share of its terms by which a squared distance may come out too small


def wasserstein(
    start: Points, end: Points, *, samples: int = 256, seed: int = 0, power: int = 2
) -> float:
    """The Wasserstein distance of two segments in the points' unit (2-Wasserstein at power 2).

    Exact where neither side has more than `samples` points. Above, each side is replaced by
    the centres of `samples` compact blocks of its points; at power 2 only in what is left after
    the closed-form Gaussian part, which uses all points. Measured on organs of real plants: within
    1.3 % at 256 samples in 10 ms, but up to 6 % where the distance is that between the points.
    """
    start, end = checked(start), checked(end)
    if max(len(start), len(end)) <= samples:
        return solve(start, end, TransportOptions(power=1 if power == 1 else 2)).distance
    here, there, known = start - start.mean(axis=0), end - start.mean(axis=0), 0.0
    if power == 2:
        here, there = balance(start, end)
        known = explained_cost(start, end, here, there)
    rows, columns = (bisection.cut(cloud, samples, seed) for cloud in (here, there))
    supply, demand = uniform_masses(len(start), len(end))
    centres = rows.centres(here), columns.centres(there)
    plan = couple(*centres, rows.masses(supply), columns.masses(demand), Search(power, seed=seed))
    left = float(plan.mass @ costs(*centres, plan.edges, power)) / float(supply.sum())
    return max(known + left, 0.0) ** (1.0 / power)


@dataclass(frozen=True)
class Moments:
    """Count, mean (3,) and covariance (3, 3) of a cloud; `+` gives those of two clouds together."""

    count: int
    mean: NDArray[np.float64]
    covariance: NDArray[np.float64]

    @staticmethod
    def of(points: Points) -> Moments:
        points = checked(points)
        mean = points.mean(axis=0)
        return Moments(len(points), mean, (points - mean).T @ (points - mean) / len(points))

    def __add__(self, other: Moments) -> Moments:
        count = self.count + other.count
        share = other.count / count
        way = other.mean - self.mean
        return Moments(
            count,
            self.mean + share * way,
            (1 - share) * self.covariance
            + share * other.covariance
            + share * (1 - share) * np.outer(way, way),
        )


def gaussian_distance(start: Moments, end: Moments) -> float:
    """2-Wasserstein distance of the Gaussians of the same moments: never above the clouds' own.

    sqrt(|mean - mean'|^2 + tr(C + C' - 2 (C^1/2 C' C^1/2)^1/2)) (Gelbrich 1990).
    """
    root = matrix_power(start.covariance, 0.5)
    cross = matrix_power(root @ end.covariance @ root, 0.5)
    spread = np.trace(start.covariance) + np.trace(end.covariance) - 2.0 * np.trace(cross)
    way = end.mean - start.mean
    return float(np.sqrt(way @ way + max(spread, 0.0)))


def least_distance(start: Moments, ends: Sequence[Moments]) -> NDArray[np.float64]:
    """(len(ends),) distances below which `wasserstein` does not go, be it exact or an estimate.

    `gaussian_distance`, with the cross term as large as `balance` makes it (its ridge included),
    less what rounding may take away.
    """
    mean, covariance, ridged = _stacked([start])
    means, covariances, others = _stacked(ends)
    way = ((means - mean) ** 2).sum(axis=1)
    traces = np.trace(covariance, axis1=1, axis2=2) + np.trace(covariances, axis1=1, axis2=2)
    root = matrix_power(ridged[0], 0.5)
    product = root @ others @ root
    squares = np.linalg.eigvalsh((product + product.transpose(0, 2, 1)) / 2)
    cross = 2.0 * np.sqrt(np.maximum(squares, 0.0)).sum(axis=1)
    is_point = (ridged == 0).all(axis=(1, 2)) | (others == 0).all(axis=(1, 2))
    spread = np.where(is_point, 0.0, np.maximum(traces - cross, 0.0))
    far = (mean**2).sum(axis=1) + (means**2).sum(axis=1)
    sure = way + spread - _ROUNDING * (way + traces) - _ROUNDING**3 * far
    return np.sqrt(np.maximum(sure, 0.0))


def _stacked(
    moments: Sequence[Moments],
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Means (n, 3), covariances (n, 3, 3), and the covariances with the ridge of `balance`."""
    means = np.array([one.mean for one in moments]).reshape(-1, 3)
    covariances = np.array([one.covariance for one in moments]).reshape(-1, 3, 3)
    trace = np.trace(covariances, axis1=1, axis2=2)
    return means, covariances, covariances + (RIDGE / 3 * trace)[:, None, None] * np.eye(3)
