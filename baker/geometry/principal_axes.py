"""The shape of the neighbourhood of each point: a rod, a sheet, or neither."""

import numpy as np
from numpy.typing import NDArray


def principal_spreads(points: NDArray[np.float64], radius: float) -> NDArray[np.float64]:
    """Standard deviations along the principal axes of the ball of points around each point.

    Parameters
    ----------
    points : (N, 3) float64
    radius : float
        Of the balls, in the unit of the points.

    Returns
    -------
    (N, 3) float64
        In ascending order. In a rod the first two are small, on a sheet the first.
    """
    from scipy.sparse import csr_matrix, identity
    from scipy.spatial import KDTree

    count, centered = len(points), points - points.mean(axis=0)
    i, j = KDTree(points).query_pairs(radius, output_type="ndarray").T
    half = csr_matrix((np.ones(len(i)), (i, j)), (count, count))
    adjacency = half + half.T + identity(count, format="csr")
    number = adjacency @ np.ones((count, 1))
    mean = (adjacency @ centered) / number
    products = (centered[:, :, None] * centered[:, None]).reshape(count, 9)
    squares = ((adjacency @ products) / number).reshape(count, 3, 3)
    variances = np.linalg.eigvalsh(squares - mean[:, :, None] * mean[:, None])
    return np.sqrt(np.maximum(variances, 0.0))
