"""Planes that a plant may stand on: soil, a table, or the soil in a pot.

In each cell of a grid seen from above the lowest point counts, and RANSAC fits a plane to these, as
filters of terrain do. The plane is the ground where it is round and closed, next to nothing lies
below it, and something rises from its middle; leaves are narrow, have gaps between them, or carry
the plant at their edge. The soil in a pot is looked for in all slices of a scan, by the highest
point of each cell: what lies below it, the pot, is nearly as wide, but no wider.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from baker.geometry.neighbors import point_spacing
from baker.geometry.up_axis import Vertical

Points = NDArray[np.floating]

MAX_SAMPLE = 20_000  # points of a scan that its ground is found by
CELLS = 16  # of the grid along its longer side; the plane is met within the width of one
LOW_SHARES = (0.05, 0.25)  # of the height, in which a small or a wide ground is looked for
TRIES, SEED = 300, 0  # of RANSAC
BELOW_COST = 4  # cells in the plane that one cell below it outweighs
MAX_SLOPE = 0.5  # of the ground against the axis that may be up: 27 degrees
MIN_THICKNESS = 0.05  # of the width of a cell: a plane of numbers without any roughness
THICKNESS = 3.0  # standard deviations of the ground's roughness, within which points belong to it
MAX_BELOW = 0.05  # of the points that may lie below the ground
MAX_COVERED = 0.5  # of the ground, by what lies just above it
MIN_IN_MIDDLE = 0.1  # of the points just above the ground: a quarter of a radius from its edge
MIN_SCORE, MIN_POT_SCORE = 0.5, 0.7  # of a ground, and of the soil in a pot
SLICES, OVERLAP = 24, 1.5  # of the height, in which a pot's soil is looked for; their thickness
MIN_FILLED = 0.55  # of the cells of such a slice; soil fills 0.79 if it is round
MIN_IN_POT = 0.05  # of the points, below its soil,
POT_EDGE = 0.5  # and most of them nearer to its edge than this share of its radius
RIM_WIDTH, RIM_SECTORS, MIN_RIM = 0.2, 32, 0.7  # of the radius; of a ring, and how many it fills


@dataclass(frozen=True)
class Ground:
    """A level place under a plant."""

    frame: Points  # (3, 3) rotation; its third row leads away from the ground
    height: float  # in that direction
    thickness: float  # how far above and below its points lie
    outline: Points  # (E, 3) a, b, c of the lines around it: a x + b y + c <= 0 inside
    score: float  # how round and closed it is, from 0 to 1
    margin: float = 0.0  # how far its pot reaches on both sides of its outline
    rim: float = 0.0  # how far above it the pot's rim goes

    def seen(self, points: Points) -> tuple[Points, Points, Points]:
        """Of (N, 3) points: in the ground's frame, (N,) height above it, distance from its edge."""
        turned = points @ self.frame.T
        inside = -(turned[:, :2] @ self.outline[:, :2].T + self.outline[:, 2]).max(axis=1)
        return turned, turned[:, 2] - self.height, inside

    def holds(self, points: Points) -> NDArray[np.bool_]:
        """(N,) whether points lie in the ground or below; not those of a stem that enters it.

        The stem goes on below what rises from the ground, as near, seen from above, as points are.
        """
        from scipy.spatial import KDTree

        turned, heights, inside = self.seen(points)
        held = (heights <= self.thickness) & (inside >= 0)
        held |= (heights <= self.rim) & (np.abs(inside) <= self.margin)
        rising = ~held & (heights <= 3 * self.thickness) & (inside >= self.margin)
        layer = np.flatnonzero(held & (heights >= -self.thickness))
        if min(rising.sum(), len(layer)) > 1:
            spacing = min(point_spacing(points[rising]), point_spacing(points[layer]))
            distances, _ = KDTree(turned[rising, :2]).query(turned[layer, :2])
            held[layer[distances <= spacing]] = False
        return held


def find_ground(points: Points, up: str) -> Ground | None:
    """The likeliest ground of an (N, 3) scan that stands along `up`, more or less."""
    vertical = Vertical.named(up)
    frame = _frame(vertical.sign * np.eye(3)[vertical.axis])
    sample = np.asarray(points[:: -(-len(points) // MAX_SAMPLE)], np.float64)
    # In this order heights are sorted again next to at once, for every slice.
    sample = sample[np.argsort(vertical.height(sample), kind="stable")]
    found = [_ground(sample, frame, -np.inf, share) for share in LOW_SHARES]
    if not any(found):
        slices = [(k / SLICES, (k + OVERLAP) / SLICES) for k in range(1, SLICES)]
        found = [_ground(sample, frame, *heights, is_pot=True) for heights in slices]
    return max(filter(None, found), key=lambda ground: ground.score, default=None)


def _ground(
    sample: Points, frame: Points, low: float, high: float, is_pot: bool = False
) -> Ground | None:
    """The ground at these shares of the height, its lowest points, or the highest in a pot."""
    from scipy.spatial import ConvexHull, QhullError

    for _ in range(1 if is_pot else 2):  # the second time in a frame in which the ground is level
        cells, width = _one_of_each_cell(sample @ frame.T, low, high, -1 if is_pot else 1)
        if len(cells) < (MIN_FILLED * CELLS**2 if is_pot else CELLS):
            return None
        level, normal = _plane(cells, width)
        if level.sum() < CELLS:
            return None
        turn = _frame(normal)
        frame, cells = turn @ frame, cells[level] @ turn.T
    try:
        hull = ConvexHull(cells[:, :2])
    except QhullError:
        return None
    area = hull.volume + hull.area * width / 2 + width**2  # half a cell more on all sides
    narrow, wide = np.linalg.eigvalsh(np.cov(cells[:, :2].T))
    score = float(min(len(cells) * width**2 / area, 1.0) * np.sqrt(narrow / wide))
    if score < (MIN_POT_SCORE if is_pot else MIN_SCORE):
        return None
    outline = hull.equations - [0.0, 0.0, width]
    rough = Ground(frame, float(np.median(cells[:, 2])), 2 * width, outline, score)
    turned, heights, inside = rough.seen(sample)
    near = (np.abs(heights) <= rough.thickness) & (inside >= 0)
    columns = np.floor(turned[:, :2] / width) @ [1e6, 1.0]
    middle = _median_of_medians(columns[near], heights[near])
    deviation = 1.4826 * _median_of_medians(columns[near], np.abs(heights[near] - middle))
    thickness = max(THICKNESS * deviation, MIN_THICKNESS * width)
    margin = RIM_WIDTH * float(inside.max()) if is_pot else 0.0
    ground = Ground(frame, rough.height + middle, thickness, outline, score, margin)
    if not _carries_plant(ground, sample, columns, width):
        return None
    return replace(ground, rim=_rim(ground, sample, width)) if is_pot else ground


def _carries_plant(ground: Ground, sample: Points, columns: Points, width: float) -> bool:
    """Whether a pot or nothing lies below the ground, and something rises from its bare middle."""
    _, heights, inside = ground.seen(sample)
    thickness, radius = ground.thickness, float(inside.max()) - width
    below = heights < -thickness
    if ground.margin:
        in_pot = inside[below & (inside >= -ground.margin)]
        if len(in_pot) < MIN_IN_POT * len(sample) or np.median(in_pot) > POT_EDGE * radius:
            return False
        below &= inside < -ground.margin
    over = (heights > thickness) & (inside >= ground.margin)
    foot = inside[over & (heights <= max(2 * thickness, thickness + radius / 6))]
    bare = np.unique(columns[(np.abs(heights) <= thickness) & (inside >= 0)])
    covered = np.unique(columns[over & (heights <= 3 * thickness)])
    return bool(
        below.mean() <= MAX_BELOW
        and len(covered) <= MAX_COVERED * len(bare)
        and np.sum(foot > width + radius / 4) >= max(1, MIN_IN_MIDDLE * len(foot))
    )


def _rim(ground: Ground, sample: Points, width: float) -> float:
    """How far above the soil the wall of its pot goes: as long as it goes all round."""
    turned, heights, inside = ground.seen(sample)
    on_edge = np.abs(inside) <= ground.margin
    x, y = (turned[on_edge, :2] - turned[inside > 0, :2].mean(axis=0)).T
    sector = np.floor((np.arctan2(y, x) / (2 * np.pi) + 0.5) * RIM_SECTORS)
    layer = np.floor((heights[on_edge] - ground.thickness) / width)
    rim = 0
    while len(np.unique(sector[layer == rim])) >= MIN_RIM * RIM_SECTORS:
        rim += 1
    return ground.thickness + rim * width


def _one_of_each_cell(turned: Points, low: float, high: float, sign: int) -> tuple[Points, float]:
    """Of the points between two shares of the height one of each cell, and the cells' width.

    sign: 1 for the lowest one, -1 for the highest.
    """
    rising = np.argsort(turned[:, 2], kind="stable")
    heights = turned[rising, 2]
    bottom, top = heights[len(heights) // 500], heights[-1]
    begin = np.searchsorted(heights, bottom + low * ((top - bottom) or 1.0))
    stop = np.searchsorted(heights, bottom + high * ((top - bottom) or 1.0), "right")
    points = turned[rising[begin:stop][::sign]]
    if not len(points):
        return points, 1.0
    corner, end = np.quantile(points[:, :2], [0.005, 0.995], axis=0)
    width = float((end - corner).max()) / CELLS or 1.0
    cell = np.floor((points[:, :2] - corner) / width).astype(np.int64)
    within = ((cell >= 0) & (cell <= CELLS)).all(axis=1)
    points, cell = points[within], cell[within]
    _, first = np.unique(cell @ [CELLS + 1, 1], return_index=True)
    return points[first], width


def _plane(cells: Points, width: float) -> tuple[NDArray[np.bool_], Points]:
    """Which of (C, 3) points lie in the plane that most do and few lie below; its normal."""
    heights, ones = cells[:, 2] / width, np.ones(len(cells))
    sides = np.column_stack([cells[:, :2] / width, ones])
    triples = np.random.default_rng(SEED).integers(0, len(cells), (TRIES, 3))
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
    return level, np.array([-plane[0], -plane[1], 1.0])


def _frame(up: Points) -> Points:
    """The rotation that turns `up` to z."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.align_vectors([[0.0, 0.0, 1.0]], [up])[0].as_matrix())


def _median_of_medians(groups: Points, values: Points) -> float:
    """Of the groups' medians: a stem has many points, but in few cells."""
    order = np.lexsort((values, groups))
    starts = np.flatnonzero(np.diff(groups[order], prepend=np.inf))
    counts = np.diff(starts, append=len(groups))
    return float(np.median(values[order[starts + counts // 2]]))
