"""Find the up axis: a plant has a thin stem at its lowest point, and most of its surface above."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import EvenSample, surface_graph
from baker.geometry.up_axis import Vertical
from baker.scans.scan import Finding

# By how much the cost of each direction must be less than that of z, which is usual; some programs
# write y. Of 157 real pairs of scans with z up, the cost of one is less by more than 0.2 along y,
# and that of none by 0.5 along another direction.
NEEDED_LEADS = {"z": 0.0, "y": 0.2, "x": 0.5, "-z": 0.5, "-y": 0.5, "-x": 0.5}
CLOSE_COST = 0.1  # difference of costs below which another direction is named as a doubt
STEM_SHARE = 0.15  # of the longest geodesic distance from the lowest point: the bare stem
SAMPLE_SIZE = 800  # points of a scan from which its costs are computed


def find_up(
    samples: Sequence[EvenSample], requested: str = "auto", ground_up: str = ""
) -> tuple[str, list[Finding]]:
    """Find the direction of growth of a series, "x", "y", "z", "-x", "-y" or "-z".

    It is the `requested` one, unless that is "auto"; else the direction away from the ground, if
    there is one; else z, unless the mean cost of the scans is much less along another direction.
    """
    if requested != "auto":
        return requested, [Finding("up", f"{requested}, as asked")]
    if ground_up:
        return ground_up, [Finding("up", f"{ground_up}, away from the ground that the scans show")]
    directions = list(NEEDED_LEADS)
    costs = np.mean([_costs(sample) for sample in samples], axis=0)
    best = int(np.argmin(costs + list(NEEDED_LEADS.values())))
    reason = "along it the plants stand on stems" if best else "as scans usually have it"
    second_best = min(set(range(len(costs))) - {best}, key=costs.__getitem__)
    doubt = ""
    if costs[second_best] - costs[best] < CLOSE_COST:
        likely = "rather" if costs[second_best] < costs[best] else "as well"
        doubt = f"by their shape they might {likely} grow along {directions[second_best]}"
    description, option = f"{directions[best]}, {reason}", f"--up {directions[second_best]}"
    return directions[best], [Finding("up", description, doubt, option if doubt else "")]


def _costs(sample: EvenSample) -> NDArray[np.float64]:
    """(6,) cost of each direction: relative width and lean of the stem, and lowness of the mass."""
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
