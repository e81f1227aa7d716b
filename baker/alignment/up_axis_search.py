"""Find the up axis: a plant grows away from its base, which stays where it is, on a thin stem."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from baker.alignment.sample import EvenSample, surface_graph
from baker.geometry.up_axis import Vertical
from baker.scans.scan import Finding

# By how much the cost of each direction must be less than that of z, which is usual; some programs
# write y. Of 157 real pairs of scans with z up none is taken for another direction, if rotated so
# that y is up 3 are; of their 20 series none (docs/method.md, "Alignment").
NEEDED_LEADS = {"z": 0.0, "y": 0.2, "x": 0.5, "-z": 0.5, "-y": 0.5, "-x": 0.5}
CLOSE_COST = 0.05  # difference of costs below which another direction is named as a doubt
STEM_SHARE = 0.15  # of the longest geodesic distance from the lowest point: the bare stem
SAMPLE_SIZE = 800  # points of a scan from which its costs are computed
END_QUANTILE = 0.01  # of the heights, that of the lower end
LEAST_MOTION = 0.02  # of both ends of an axis, in sizes of the plant; less tells little
HALF_WEIGHT = 2.5  # number of intervals at which motions have half of their weight
MIN_FLATNESS = 1.3  # of flat plants: ratio of the extent across the up axis to that along it


def find_up(
    samples: Sequence[EvenSample], requested: str = "auto", ground_up: str = ""
) -> tuple[str, list[Finding]]:
    """Find the direction of growth of a series, "x", "y", "z", "-x", "-y" or "-z".

    It is the `requested` one, unless that is "auto"; else the direction away from the ground, if
    there is one; else z, unless the cost is much less along another direction.
    """
    if requested != "auto":
        return requested, [Finding("up", f"{requested}, as asked")]
    if ground_up:
        return ground_up, [Finding("up", f"{ground_up}, away from the ground that the scans show")]
    directions, leads = zip(*NEEDED_LEADS.items(), strict=True)
    costs = np.mean([_stem_costs(sample) for sample in samples], axis=0) + _growth_costs(samples)
    best = int(np.argmin(costs + leads))
    is_rare = leads[best] == max(leads)  # a plant that creeps grows along x or y, too
    second = 0 if is_rare else min(set(range(len(costs))) - {best}, key=costs.__getitem__)
    reason = "by the plants' stems and growth" if best else "as scans usually have it"
    doubt = ""
    if is_rare or costs[second] - costs[best] < CLOSE_COST:
        likely = "rather" if costs[second] < costs[best] else "as well"
        who = "they" if best else "by their stems and growth they"
        doubt = f"{who} might {likely} grow along {directions[second]}"
    description, option = f"{directions[best]}, {reason}", f"--up {directions[second]}"
    return directions[best], [Finding("up", description, doubt, option if doubt else "")]


def _growth_costs(samples: Sequence[EvenSample]) -> NDArray[np.float64]:
    """(6,) cost of each direction: less if the lower end stays at rest, or if the plant is flat.

    The lower end of a plant stays at rest while the upper one grows away from it; along other axes
    both ends move alike. A plant that is much shorter along an axis than across it, such as a
    rosette, has no stem to be seen, and grows along that axis.
    """
    heights = [(sample.points + sample.offset)[:, [2, 1, 0]] for sample in samples]  # z, y, x
    extents = np.mean([np.ptp(scan, axis=0) for scan in heights], axis=0) + np.finfo(float).tiny
    quantiles = [np.quantile(scan, [END_QUANTILE, 1.0 - END_QUANTILE], axis=0) for scan in heights]
    motions = np.abs(np.diff(quantiles, axis=0)).sum(axis=0) / max(len(samples) - 1, 1)
    resting = (motions[1] - motions[0]) / (motions.sum(axis=0) + LEAST_MOTION * extents.max())
    resting *= (len(samples) - 1) ** 2 / ((len(samples) - 1) ** 2 + HALF_WEIGHT**2)
    across = np.array([np.delete(extents, axis).min() for axis in range(3)])
    flatness = np.maximum(1.0 - MIN_FLATNESS * extents / np.maximum(across, extents), 0.0)
    return -np.concatenate([resting + flatness, flatness - resting])


def _stem_costs(sample: EvenSample) -> NDArray[np.float64]:
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
