"""The spine of an organ: a curve through the level sets of the geodesic distance in it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import connected_knn_graph, geodesic_distances

Points = NDArray[np.float64]
Floats = NDArray[np.float64]

# docs/method.md, "Motion of organs".
NODES = 11  # number of nodes of a spine
NODE_POSITIONS = np.linspace(0.0, 1.0, NODES)  # along the spine
NEIGHBORS = 9  # of a point in the kNN graph
TIP_QUANTILE = 0.98  # of the geodesic distances, that of the tip; larger distances may be noise
KERNEL_WIDTH = 0.09  # standard deviation of the Gaussian around a node, in lengths of the spine
WEIGHT_FLOOR = 1e-12  # least weight of a point, so that no node is without points
RIDGE = 1e-4  # of the local lines, in squared kernel widths
MAX_SAMPLE = 400  # points of an organ to which its spine is fitted
MIN_POINTS_FOR_SPINE = 12  # of an organ


@dataclass(frozen=True)
class Spine:
    """A curve from an organ's attachment (along = 0) to its tip (along = 1)."""

    nodes: Points  # (NODES, 3) at even steps along the spine
    tangents: Points  # (NODES, 3) unit vectors towards the tip
    along: NDArray[np.float64]  # (n,) position of each of the organ's points, 0 to 1


def sample_members(members: NDArray[np.intp]) -> NDArray[np.intp]:
    """A random sample of at most MAX_SAMPLE of an organ's points, the same in every call."""
    if len(members) <= MAX_SAMPLE:
        return members
    chosen = np.random.default_rng(0).permutation(len(members))[:MAX_SAMPLE]
    return members[np.sort(chosen)]


def path_lengths(points: Points, seeds: NDArray[np.intp], offsets: Floats) -> Floats:
    """(n,) geodesic distances from seeds, to whose (s,) offsets they add, less the least offset."""
    graph = connected_knn_graph(points, NEIGHBORS)
    return geodesic_distances(graph, seeds, offsets - offsets.min())


def fit_spine(points: Points, lengths: NDArray[np.float64]) -> Spine:
    """Fit the spine of an organ by local linear regression, which is not biased at the ends.

    lengths: (n,) geodesic distances of the points from the attachment, in any unit.
    """
    length = float(np.quantile(lengths, TIP_QUANTILE)) or 1.0
    along = np.clip(lengths / length, 0.0, 1.0)
    weights, lag = section_weights(along, NODE_POSITIONS), along - NODE_POSITIONS[:, None]
    nodes, slopes = local_lines(weights, lag, points, RIDGE * KERNEL_WIDTH**2)
    return Spine(nodes, unit(slopes), along)


def section_weights(along: Floats, levels: Floats) -> Floats:
    """(m, n) weights of n points in the cross-sections at m levels of the spine, with sums of 1."""
    weights = np.exp(-0.5 * ((along - levels[:, None]) / KERNEL_WIDTH) ** 2) + WEIGHT_FLOOR
    return np.asarray(weights / weights.sum(axis=1, keepdims=True))


def local_lines(
    weights: NDArray[np.float64], lag: NDArray[np.float64], values: Points, ridge: float
) -> tuple[Points, Points]:
    """Fit a line to (n, d) values by weighted least squares around each of m positions.

    weights, lag: (m, n) weights of the values, and their positions minus each of the m. ridge: is
    added to the variance of the lag, so that it is never 0. Returns the (m, d) values and slopes of
    the lines at the m positions.
    """
    weights = weights / weights.sum(axis=1, keepdims=True)
    mean_lag = (weights * lag).sum(axis=1, keepdims=True)
    centered = weights * (lag - mean_lag)
    variance = (centered * (lag - mean_lag)).sum(axis=1, keepdims=True)
    slopes = centered @ values / (variance + ridge)
    return weights @ values - mean_lag * slopes, slopes


def interpolate_nodes(values: Floats, along: Floats) -> Floats:
    """Interpolate (NODES, ...) values of the nodes linearly at (n,) positions along the spine."""
    position = np.clip(along, 0.0, 1.0) * (NODES - 1)
    lower = np.minimum(position.astype(np.intp), NODES - 2)
    share = (position - lower).reshape(-1, *[1] * (values.ndim - 1))
    return (1.0 - share) * values[lower] + share * values[lower + 1]


def unit(vectors: Points) -> Points:
    """Scale vectors to length 1; zero vectors become z."""
    norm = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.where(norm > 0, vectors / np.where(norm > 0, norm, 1.0), (0.0, 0.0, 1.0))
