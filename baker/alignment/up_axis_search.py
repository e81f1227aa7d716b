"""Which way is up: a plant stands on a stem and carries its mass above."""

from collections.abc import Sequence
from itertools import compress

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import EvenSample, surface_graph
from baker.geometry.up_axis import Vertical
from baker.scans.scan import Finding

# Directions, and by how much the plants must look more upright along one than along z before it is
# taken: z is usual, some programs write y; others speak through a ground, or beyond any doubt. Of
# 157 real pairs of scans with z up one leads by more than 0.2 along y, none by 0.5 elsewhere.
NEEDED_LEADS = {"z": 0.0, "y": 0.2, "x": 0.5, "-z": 0.5, "-y": 0.5, "-x": 0.5}
CLOSE = 0.1  # a lead over the direction taken, from which on the other is named
TURNED_OVER = 0.35  # lead of "upside down" in one scan of a series, from which on it is named
STEM_SHARE = 0.15  # of the longest geodesic distance from the lowest point: should be bare stem
SAMPLE_SIZE = 800


def find_up(
    samples: Sequence[EvenSample], requested: str = "auto", ground_up: str = ""
) -> tuple[str, list[Finding]]:
    """The axis direction along which a series grows: "x", "y", "z", "-x", "-y" or "-z".

    One direction for all scans: away from the ground where one was found, else z, unless seen along
    another direction the plants look far more like plants: a thin straight stem at the lowest
    point, and most of the surface high up. requested: the direction, where the user gave one.
    """
    if requested != "auto":
        return requested, [Finding("up", f"{requested}, as asked")]
    directions = list(NEEDED_LEADS)
    costs = np.array([_costs(sample) for sample in samples])
    total = costs.mean(axis=0)
    if ground_up:
        found, why = directions.index(ground_up), "away from the ground that the scans show"
    else:
        found = int(np.argmin(total + list(NEEDED_LEADS.values())))
        why = "as scans usually have it" if found == 0 else "along it the plants stand on stems"
    up, option, doubts = directions[found], "", list[str]()
    down = directions.index(up[1:] if up.startswith("-") else f"-{up}")
    over = costs[:, found] - costs[:, down] > TURNED_OVER
    if over.any() and 2 * over.sum() < len(samples):
        named = ", ".join(sample.name for sample in compress(samples, over))
        doubts = [f"{named} seems to be upside down: turn it over"]
        total = costs[~over].mean(axis=0)
    lead = np.delete(total, found).min() - total[found]
    if not ground_up and lead < CLOSE:
        other = directions[int(np.argmin(np.where(np.arange(len(total)) == found, np.inf, total)))]
        option = f"--up {other}"
        if lead < 0:
            doubts = [f"by their shape they might rather grow along {other}"]
        else:
            doubts.append(f"by their shape they might as well grow along {other}")
    return up, [Finding("up", f"{up}, {why}", "; ".join(doubts), option)]


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
        return np.zeros(len(NEEDED_LEADS))
    graph = surface_graph(points)
    costs = []
    for name in NEEDED_LEADS:
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
