"""Which way is up: a plant stands on a stem and carries its mass above."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import EvenSample, distance_graph, even_sample, touching_pairs
from baker.geometry.up_axis import Vertical

# What scanners call up, the usual ones first, and what the less usual ones cost beforehand.
NAMES = ("z", "y", "x", "-z", "-y", "-x")
PRIOR_COSTS = np.array([0.0, 0.03, 0.1, 0.1, 0.1, 0.1])
STEM_SHARE = 0.15  # of the longest geodesic distance from the lowest point: should be bare stem
SAMPLE_SIZE = 800


def find_up(clouds: Sequence[NDArray[np.floating]]) -> str:
    """The axis direction along which a series of scans grows: "x", "y", "z", "-x", "-y" or "-z".

    Seen along the right direction a plant is a thin straight stem at its lowest point, and most of
    its surface is high up. All scans vote; young plants vote as loud as old ones.
    """
    return find_up_of([even_sample(cloud) for cloud in clouds])


def find_up_of(samples: Sequence[EvenSample]) -> str:
    """`find_up` of clouds that are sampled already."""
    costs = np.mean([_costs(sample) for sample in samples], axis=0)
    return NAMES[int(np.argmin(costs + PRIOR_COSTS))]


def upright(vertical: Vertical) -> NDArray[np.float64]:
    """(3, 3) rotation that turns the growing direction to +z, the identity for z up."""
    first, up = np.zeros(3), np.zeros(3)
    first[(vertical.axis + 1) % 3] = 1.0
    up[vertical.axis] = vertical.sign
    return np.stack([first, np.cross(up, first), up])


def _costs(sample: EvenSample) -> NDArray[np.float64]:
    """(6,) how unlike an upright plant the sample looks along each direction; 0 is best."""
    from scipy.sparse.csgraph import dijkstra

    points = sample.points[:SAMPLE_SIZE]
    if len(points) < 2:
        return np.zeros(len(NAMES))
    coarse = EvenSample(sample.pool, points, sample.radii[:SAMPLE_SIZE])
    graph = distance_graph(points, touching_pairs(coarse))
    costs = []
    for name in NAMES:
        vertical = Vertical.named(name)
        heights = vertical.height(points)
        distances = dijkstra(graph, indices=int(np.argmin(heights)))
        length = STEM_SHARE * distances.max()
        stem = distances <= length
        sideways = np.delete(points[stem], vertical.axis, axis=1)
        width = np.sqrt(((sideways - sideways.mean(axis=0)) ** 2).sum(axis=1).mean())
        lean = 1.0 - np.ptp(heights[stem]) / length
        extent = np.ptp(heights)
        lowness = (heights.max() - heights.mean()) / extent if extent > 0 else 1.0
        costs.append(width / length + lean + lowness)
    return np.array(costs)
