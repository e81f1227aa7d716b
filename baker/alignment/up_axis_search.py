"""Find the up axis: a plant has a thin stem at its lowest point, and most of its surface above."""

from collections.abc import Sequence
from itertools import compress

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import EvenSample, surface_graph
from baker.geometry.up_axis import Vertical
from baker.scans.scan import Finding

# Directions, and by how much their cost must be less than that of z, which is usual (some programs
# write y). Of 157 real pairs of scans with z up, one has a lead of more than 0.2 along y, and none
# of 0.5 along another direction.
NEEDED_LEADS = {"z": 0.0, "y": 0.2, "x": 0.5, "-z": 0.5, "-y": 0.5, "-x": 0.5}
CLOSE = 0.1  # difference of costs below which another direction is named as a doubt
TURNED_OVER = 0.35  # difference of costs above which a single scan is named as upside down
STEM_SHARE = 0.15  # of the longest geodesic distance from the lowest point: the bare stem
SAMPLE_SIZE = 800


def find_up(
    samples: Sequence[EvenSample], requested: str = "auto", ground_up: str = ""
) -> tuple[str, list[Finding]]:
    """Find the direction of growth of a series.

    It is the direction away from the ground, if one was found. Otherwise it is z, unless the mean
    cost of the scans is much less along another direction.

    Parameters
    ----------
    samples : sequence of EvenSample
    requested : str
        The direction that the user gave, or "auto".
    ground_up : str
        The direction away from the ground, "" if none was found.

    Returns
    -------
    up : str
        "x", "y", "z", "-x", "-y" or "-z".
    findings : list of Finding
    """
    if requested != "auto":
        return requested, [Finding("up", f"{requested}, as asked")]
    directions = list(NEEDED_LEADS)
    costs = np.array([_costs(sample) for sample in samples])
    total = costs.mean(axis=0)
    if ground_up:
        best, reason = directions.index(ground_up), "away from the ground that the scans show"
    else:
        best = int(np.argmin(total + list(NEEDED_LEADS.values())))
        reason = "as scans usually have it" if best == 0 else "along it the plants stand on stems"
    up, option, doubts = directions[best], "", list[str]()
    down = directions.index(up[1:] if up.startswith("-") else f"-{up}")
    is_over = costs[:, best] - costs[:, down] > TURNED_OVER
    if is_over.any() and 2 * is_over.sum() < len(samples):
        names = ", ".join(sample.name for sample in compress(samples, is_over))
        doubts = [f"{names} seems to be upside down: turn it over"]
        total = costs[~is_over].mean(axis=0)
    lead = np.delete(total, best).min() - total[best]
    if not ground_up and lead < CLOSE:
        other = directions[int(np.argmin(np.where(np.arange(len(total)) == best, np.inf, total)))]
        option = f"--up {other}"
        if lead < 0:
            doubts = [f"by their shape they might rather grow along {other}"]
        else:
            doubts.append(f"by their shape they might as well grow along {other}")
    return up, [Finding("up", f"{up}, {reason}", "; ".join(doubts), option)]


def upright(vertical: Vertical) -> NDArray[np.float64]:
    """(3, 3) rotation from the direction of growth to +z, the identity for z up."""
    first, up = np.zeros(3), np.zeros(3)
    first[(vertical.axis + 1) % 3] = 1.0
    up[vertical.axis] = vertical.sign
    return np.stack([first, np.cross(up, first), up])


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
