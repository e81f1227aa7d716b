"""The shape of the neighbourhood of each point: a rod, a sheet, or neither."""

import numpy as np
from numpy.typing import NDArray


def principal_spreads(points: NDArray[np.float64], radius: float) -> NDArray[np.float64]:
    """Standard deviations along the principal axes of the ball of points around each point.

    points: (N, 3) float64.
    radius: of the balls, in the unit of the points.

    Returns (N, 3) in ascending order. In a rod the first two are small, on a sheet the first.
    """
    from scipy.sparse import csr_matrix
    from scipy.spatial import cKDTree

    count, centered = len(points), points - points.mean(axis=0)
    i, j = cKDTree(points).query_pairs(radius, output_type="ndarray").T
    half = csr_matrix((np.ones(len(i)), (i, j)), (count, count))
    products = (centered[:, :, None] * centered[:, None]).reshape(count, 9)
    moments = np.column_stack([np.ones(count), centered, products])
    sums = moments + half @ moments + half.T @ moments  # over each ball
    mean, squares = np.split(sums[:, 1:] / sums[:, :1], [3], axis=1)
    covariance = squares.reshape(count, 3, 3) - mean[:, :, None] * mean[:, None]
    return np.sqrt(np.maximum(np.linalg.eigvalsh(covariance), 0.0))
