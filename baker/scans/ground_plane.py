"""Find the plane that a plant stands on: soil, a table, or the soil in a pot.

As in the filtering of terrain, a plane is fitted to the lowest points in the cells of a horizontal
grid. It is fitted in slabs of the scan: the lowest ones or, if these hold no ground, those above,
for the soil in a pot. The plane is the ground if it is round and without gaps, and something rises
from its middle; what lies below it must be a pot about as wide. Leaves fail: they are narrow, have
gaps between them, or are joined to the plant at their edge.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import point_spacing
from baker.geometry.up_axis import Vertical

Points = NDArray[np.floating]

MAX_SAMPLE = 20_000  # points of a scan in which its ground is searched for
CELLS = 16  # cells along the longer side of the grid; the plane's tolerance is one cell's width
LOW_SLABS = ((0.0, 0.05), (0.0, 0.25))  # shares of the height: of a small, and of a wide ground
SLABS = tuple((k / 24, (k + 1.5) / 24) for k in range(1, 24))  # that may hold the soil in a pot
FITS = 8  # of the plane
MAX_SLOPE = 0.5  # of the ground against the direction of growth: 27 degrees
MIN_THICKNESS = 0.05  # in widths of a cell, for a plane without any roughness
THICKNESS = 3.0  # in standard deviations of the ground's roughness
MAX_BELOW = 0.05  # share of the points that may lie below the ground
MAX_COVERED = 0.5  # share of the ground's cells that may have points just above them
MIN_IN_MIDDLE = 0.1  # share of the points just above the ground that are 1/4 radius from its edge
# Scores of a ground. Discs of soil on slopes, rough or in mounds score 0.87 or more, soil in pots
# 0.77, rectangles of 3 : 5 0.56. Of 23 series of plants without ground no scan has more than 0.51
# along its true direction, five have up to 0.6 along another.
MIN_SCORE, CERTAIN_SCORE = 0.53, 0.7
POT_EDGE = 0.5  # in radii, from the edge of the soil: median distance of the pot's points
RIM_WIDTH, RIM_SECTORS, MIN_RIM = 0.2, 32, 0.7  # in radii; of a ring; share of sectors with points


@dataclass(frozen=True)
class Ground:
    """A surface under a plant, level or on a slope. Heights are vertical, along `up`."""

    up: str
    plane: Points  # (3,) a, b, c: its height is a x + b y + c
    thickness: float  # greatest distance of the ground's points above and below the plane
    outline: Points  # (E, 3) a, b, c of the lines around it: a x + b y + c <= 0 inside
    score: float  # how round and free of gaps it is, from 0 to 1
    margin: float = 0.0  # half the width of the pot's wall, on both sides of the outline
    rim: float = 0.0  # height of the pot's rim above the soil

    def holds(self, points: Points) -> NDArray[np.bool_]:
        """(N,) whether points lie in the ground or below it; False for a stem that enters it.

        Points of the ground's layer belong to the stem if, seen from above, they are within a point
        spacing of points that rise from the ground.
        """
        from scipy.spatial import KDTree

        upright = _upright(points, self.up)
        heights, inside = _heights(upright, self.plane), _inside(upright, self.outline)
        held = (heights <= self.thickness) & (inside >= 0)
        held |= (heights <= self.rim) & (np.abs(inside) <= self.margin)
        rising = ~held & (heights <= 3 * self.thickness) & (inside >= self.margin)
        layer = np.flatnonzero(held & (heights >= -self.thickness))
        if min(rising.sum(), len(layer)) > 1:
            spacing = min(point_spacing(points[rising]), point_spacing(points[layer]))
            distances, _ = KDTree(upright[rising, :2]).query(upright[layer, :2])
            held[layer[distances <= spacing]] = False
        return held


def find_ground(points: Points, up: str) -> Ground | None:
    """The ground of best score under (N, 3) points of a plant that grows roughly along `up`."""
    sample = _upright(np.asarray(points[:: -(-len(points) // MAX_SAMPLE)], np.float64), up)
    sample = sample[np.argsort(sample[:, 2], kind="stable")]
    for slabs in (LOW_SLABS, SLABS):
        found = [ground for slab in slabs if (ground := _fit_ground(sample, up, *slab))]
        if found:
            return max(found, key=lambda ground: ground.score)
    return None


def _upright(points: Points, up: str) -> Points:
    """(N, 3) points in a frame whose z axis points up."""
    vertical = Vertical.named(up)
    return np.column_stack([np.delete(points, vertical.axis, axis=1), vertical.height(points)])


def _heights(points: Points, plane: Points) -> Points:
    """(N,) heights of upright points above a plane."""
    return points[:, 2] - points[:, :2] @ plane[:2] - plane[2]


def _inside(points: Points, outline: Points) -> Points:
    """(N,) distances of upright points inside an outline, negative outside."""
    return -(points[:, :2] @ outline[:, :2].T + outline[:, 2]).max(axis=1)


def _fit_ground(sample: Points, up: str, low: float, high: float) -> Ground | None:
    """Fit a ground to the points between two shares of the height, if they are one.

    sample: upright points, the lowest first.
    """
    plane: Points = np.zeros(3)
    for _ in range(2):  # the second time, the slab is as steep as the ground
        heights = _heights(sample, plane)
        bottom, top = np.quantile(heights, [0.002, 1.0])
        shares = (heights - bottom) / ((top - bottom) or 1.0)
        slab = sample[(shares <= high) & ((shares >= low) | (low == 0.0))]
        if len(slab) < CELLS:
            return None
        cells, width = _lowest_points(slab)
        plane = _fit_plane(cells, width)
    level = cells[np.abs(_heights(cells, plane)) <= width]
    if len(level) < CELLS or np.hypot(*plane[:2]) > MAX_SLOPE:
        return None
    outline, score = _outline(level[:, :2], width)
    if score < MIN_SCORE:
        return None

    heights, inside = _heights(sample, plane), _inside(sample, outline)
    columns = np.floor(sample[:, :2] / width) @ [1e6, 1.0]
    near = (np.abs(heights) <= 2 * width) & (inside >= 0)
    middle = _median_of_medians(columns[near], heights[near])
    deviation = 1.4826 * _median_of_medians(columns[near], np.abs(heights[near] - middle))
    thickness = max(THICKNESS * deviation, MIN_THICKNESS * width)
    plane[2] += middle
    heights -= middle
    radius, below = float(inside.max()), heights < -thickness
    margin = rim = 0.0
    if below.mean() > MAX_BELOW:
        margin = RIM_WIDTH * radius
        in_pot = below & (inside >= -margin)
        is_pot = in_pot.mean() >= MAX_BELOW and np.median(inside[in_pot]) <= POT_EDGE * radius
        if not is_pot or score < CERTAIN_SCORE or (below & ~in_pot).mean() > MAX_BELOW:
            return None
        wall = np.abs(inside) <= margin
        sides = sample[wall, :2] - sample[inside > 0, :2].mean(axis=0)
        rim = thickness + _rim_height(sides, heights[wall] - thickness, width)
    rises = (heights > thickness) & (inside >= margin)
    just_above = inside[rises & (heights <= thickness + max(thickness, radius / 6))]
    bare = np.unique(columns[(np.abs(heights) <= thickness) & (inside >= 0)])
    covered = np.unique(columns[rises & (heights <= 3 * thickness)])
    in_middle = np.sum(just_above > width + radius / 4)
    is_joined = in_middle < max(1, MIN_IN_MIDDLE * len(just_above))
    if is_joined or len(covered) > MAX_COVERED * len(bare):
        return None
    return Ground(up, plane, thickness, outline, score, margin, rim)


def _lowest_points(points: Points) -> tuple[Points, float]:
    """The first of (N, 3) points in each cell of a horizontal grid, and the cells' width."""
    corner, end = np.quantile(points[:, :2], [0.005, 0.995], axis=0)
    width = float((end - corner).max()) / CELLS or 1.0
    cell = np.floor((points[:, :2] - corner) / width)
    within = ((cell >= 0) & (cell <= CELLS)).all(axis=1)
    _, first = np.unique(cell[within] @ [CELLS + 1, 1], return_index=True)
    return points[within][first], width


def _fit_plane(points: Points, tolerance: float) -> Points:
    """The (3,) plane through most of (N, 3) points, by least trimmed squares."""
    sides = np.column_stack([points[:, :2], np.ones(len(points))])
    is_level = np.ones(len(points), bool)
    for _ in range(FITS):
        plane = np.linalg.lstsq(sides[is_level], points[is_level, 2], rcond=None)[0]
        distances = np.abs(points[:, 2] - sides @ plane)
        is_level = distances <= max(tolerance, np.median(distances))
    return plane


def _outline(cells: Points, width: float) -> tuple[Points, float]:
    """The lines around (C, 2) cells, and how round and free of gaps these are, from 0 to 1."""
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(cells)
    except QhullError:  # the cells are on one line
        return np.empty((0, 3)), 0.0
    # In 2D, `volume` is the area of the hull and `area` its perimeter; half a cell is added around.
    area = hull.volume + hull.area * width / 2 + width**2
    narrow, wide = np.linalg.eigvalsh(np.cov(cells.T))
    score = min(len(cells) * width**2 / area, 1.0) * np.sqrt(narrow / wide)
    return hull.equations - [0.0, 0.0, width], float(score)


def _median_of_medians(groups: Points, values: Points) -> float:
    """The median of the groups' medians: a stem has many points, but in few groups."""
    from scipy.ndimage import median

    return float(np.median(median(values, groups, np.unique(groups))))


def _rim_height(sides: Points, heights: Points, width: float) -> float:
    """The height up to which the wall of a pot, around zero, has points in most directions."""
    sector = np.floor((np.arctan2(*sides.T) / (2 * np.pi) + 0.5) * RIM_SECTORS)
    layer, rim = np.floor(heights / width), 0
    while len(np.unique(sector[layer == rim])) >= MIN_RIM * RIM_SECTORS:
        rim += 1
    return rim * width
