"""Find the plane that a plant stands on: soil or a table.

As in the filtering of terrain, RANSAC fits a plane to the lowest points in the cells of a
horizontal grid. The plane is the ground if it is round, without gaps and bare for the most part,
and something rises from its middle. Leaves are rejected: they are narrow, have gaps between them,
or are joined to the plant at their edge.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import Points, point_spacing
from baker.geometry.rigid import rotations_between

CELLS = 16  # cells along the longer side of the grid; the plane's tolerance is one cell's width
LOW_SHARES = (0.05, 0.25)  # of the height, in which a small or a wide ground is searched for
TRIALS, SEED = 300, 0  # number of planes that RANSAC tries; seed of its generator
BELOW_COST = 4  # number of cells in the plane that one cell below it cancels
MAX_SLOPE = 0.5  # of the ground against the direction of growth: 27 degrees
MIN_THICKNESS = 0.05  # of a ground without any roughness, in widths of a cell
THICKNESS = 3.0  # of a ground, in standard deviations of its heights
MAX_COVERED = 0.5  # share of the ground's cells that may have points just above them
MAX_GAPS, GAP_RADIUS = 0.05, 2.0  # share of the ground in gaps; their least radius, in spacings
PLACES = 2_000  # number of random places at which gaps are searched for
MIN_IN_MIDDLE = 0.1  # share of the points just above the ground that are 1/4 radius from its edge
MIN_SCORE = 0.5  # of a ground, see `Ground.score`


@dataclass(frozen=True)
class Ground:
    """A level surface under a plant."""

    frame: Points  # (3, 3) rotation; its third row is the direction away from the ground
    height: float  # in that direction
    thickness: float  # greatest distance of the ground's points above and below `height`
    outline: Points  # (E, 3) a, b, c of the lines around it: a x + b y + c <= 0 inside
    score: float  # how round and free of gaps it is, from 0 to 1

    def coordinates(self, points: Points) -> tuple[Points, Points, Points]:
        """Rotate (N, 3) points into `frame`; their (N,) heights and distances inside the edge."""
        rotated = points @ self.frame.T
        inside = -(rotated[:, :2] @ self.outline[:, :2].T + self.outline[:, 2]).max(axis=1)
        return rotated, rotated[:, 2] - self.height, inside

    def holds(self, points: Points) -> NDArray[np.bool_]:
        """(N,) whether points lie in the ground or below it; False for a stem that enters it.

        Points of the ground's layer belong to the stem if, seen from above, they are within a point
        spacing of points that rise from the ground.
        """
        from scipy.spatial import cKDTree

        rotated, heights, inside = self.coordinates(points)
        held = (heights <= self.thickness) & (inside >= 0)
        rising = ~held & (heights <= 3 * self.thickness) & (inside >= 0)
        layer = np.flatnonzero(held & (heights >= -self.thickness))
        if min(rising.sum(), len(layer)) > 1:
            spacing = min(point_spacing(points[rising]), point_spacing(points[layer]))
            distances, _ = cKDTree(rotated[rising, :2]).query(rotated[layer, :2])
            held[layer[distances <= spacing]] = False
        return held


def find_plane(sample: Points, frame: Points) -> Ground | None:
    """Find the ground of best score below (N, 3) points, or None; frame: rotates up to +z."""
    grounds = [_fit_ground(sample, frame, share) for share in LOW_SHARES]
    return max(filter(None, grounds), key=lambda ground: ground.score, default=None)


def _fit_ground(sample: Points, frame: Points, share: float) -> Ground | None:
    """Fit a ground to the points in the lowest share of the height; None if it is not accepted."""
    for _ in range(2):  # the second time in a frame in which the ground is level
        cells, width = _lowest_points(sample @ frame.T, share)
        if len(cells) < CELLS:
            return None
        level, normal = _fit_plane(cells, width)
        if level.sum() < CELLS:
            return None
        rotation = rotations_between(normal[None], np.eye(3)[2:])[0]
        frame, cells = rotation @ frame, cells[level] @ rotation.T
    outline, score = outline_of(cells[:, :2], width)
    if score < MIN_SCORE:
        return None
    ground = Ground(frame, float(np.median(cells[:, 2])), 2 * width, outline, score)
    rotated, heights, inside = ground.coordinates(sample)
    is_near = (np.abs(heights) <= ground.thickness) & (inside >= 0)
    columns = np.floor(rotated[:, :2] / width) @ [1e6, 1.0]
    middle = _median_of_medians(columns[is_near], heights[is_near])
    deviation = 1.4826 * _median_of_medians(columns[is_near], np.abs(heights[is_near] - middle))
    thickness = max(THICKNESS * deviation, MIN_THICKNESS * width)
    is_flat = thickness <= 2 * width  # leaves that lie on each other fill the whole tolerance
    ground = Ground(frame, ground.height + middle, thickness, outline, score)
    return ground if is_flat and _carries_plant(ground, sample, columns, width) else None


def outline_of(cells: Points, width: float) -> tuple[Points, float]:
    """The lines around (C, 2) cells, and a score of their roundness without gaps, from 0 to 1."""
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


def _carries_plant(ground: Ground, sample: Points, columns: Points, width: float) -> bool:
    """Whether the ground is bare for the most part, and a plant rises from its middle."""
    _, heights, inside = ground.coordinates(sample)
    thickness, radius = ground.thickness, float(inside.max()) - width
    over = (heights > thickness) & (inside >= 0)
    just_above = inside[over & (heights <= max(2 * thickness, thickness + radius / 6))]
    bare = np.unique(columns[(np.abs(heights) <= thickness) & (inside >= 0)])
    covered = np.unique(columns[over & (heights <= 3 * thickness)])
    return bool(
        len(covered) <= MAX_COVERED * len(bare)
        and _gap_share(ground, sample, width) <= MAX_GAPS
        and np.sum(just_above > width + radius / 4) >= max(1, MIN_IN_MIDDLE * len(just_above))
    )


def _gap_share(ground: Ground, sample: Points, margin: float) -> float:
    """The share of the ground, without a margin, that has no point near, nor any above it.

    Near is compared with the mean spacing of the ground's points. A plant hides the ground from
    above, but the gaps between leaves are open.
    """
    from scipy.spatial import cKDTree

    rotated, heights, inside = ground.coordinates(sample)
    is_above = (heights >= -ground.thickness) & (inside >= margin)
    flat, count = rotated[is_above, :2], int(np.sum(heights[is_above] <= ground.thickness))
    if not count:
        return 1.0
    low, high = flat.min(axis=0), flat.max(axis=0)
    places = np.random.default_rng(SEED).uniform(low, high, (PLACES, 2))
    edges = ground.outline
    places = places[(places @ edges[:, :2].T + edges[:, 2] <= -margin).all(axis=1)]
    spacing = np.sqrt(np.prod(high - low) * len(places) / PLACES / count)
    is_gap = cKDTree(flat).query(places)[0] > GAP_RADIUS * spacing
    return float(is_gap.mean()) if len(places) else 1.0


def _lowest_points(points: Points, share: float) -> tuple[Points, float]:
    """The lowest point in each cell of a grid over the lowest share of the height; their width."""
    if len(points) < CELLS:  # too few for a ground
        return points, 1.0
    bottom, top = np.quantile(points[:, 2], [0.002, 1.0])
    points = points[points[:, 2] <= bottom + share * ((top - bottom) or 1.0)]
    points = points[np.argsort(points[:, 2], kind="stable")]
    corner, end = np.quantile(points[:, :2], [0.005, 0.995], axis=0)
    width = float((end - corner).max()) / CELLS or 1.0
    column, row = np.floor((points[:, :2] - corner) / width).T
    is_in_grid = (column >= 0) & (column <= CELLS) & (row >= 0) & (row <= CELLS)
    cell = ((CELLS + 1) * column + row)[is_in_grid].astype(np.int16)  # short integers sort fast
    return points[is_in_grid][np.unique(cell, return_index=True)[1]], width


def _fit_plane(cells: Points, width: float) -> tuple[NDArray[np.bool_], Points]:
    """Fit a plane with few points below it to (C, 3) points by RANSAC: its inliers and normal."""
    heights, ones = cells[:, 2] / width, np.ones(len(cells))
    sides = np.column_stack([cells[:, :2] / width, ones])
    triples = np.random.default_rng(SEED).integers(0, len(cells), (TRIALS, 3))
    triples = triples[np.abs(np.linalg.det(sides[triples])) > 1]
    planes = np.linalg.solve(sides[triples], heights[triples][..., None])[..., 0]
    planes = planes[np.hypot(planes[:, 0], planes[:, 1]) <= MAX_SLOPE]
    if not len(planes):
        return np.zeros(len(cells), bool), ones[:3]
    residuals = heights - planes @ sides.T
    votes = (np.abs(residuals) <= 1).sum(axis=1) - BELOW_COST * (residuals < -1).sum(axis=1)
    plane = planes[np.argmax(votes)]
    for _ in range(4):
        level = np.abs(heights - sides @ plane) <= 1
        plane = np.linalg.lstsq(sides[level], heights[level], rcond=None)[0]
    normal = np.array([-plane[0], -plane[1], 1.0])
    return level, normal / np.linalg.norm(normal)


def _median_of_medians(groups: Points, values: Points) -> float:
    """The median of the groups' medians: a stem has many points, but in few groups."""
    order = np.lexsort((values, groups))  # importing scipy.ndimage would take longer
    values = values[order]
    _, first, count = np.unique(groups[order], return_index=True, return_counts=True)
    return float(np.median((values[first + (count - 1) // 2] + values[first + count // 2]) / 2))
