"""The ground that a plant stands on: soil, a table or a turntable, found as a plane.

In each cell of a grid seen from above the lowest point counts, and RANSAC fits a plane to these, as
filters of terrain do. The plane is the ground where it is round and closed, next to nothing lies
below it, and something rises from its middle; leaves are narrow, have gaps between them, or carry
the plant at their edge. All scans decide together: either most of them have a ground, or none has.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from baker.geometry.parallel import MapLike
from baker.geometry.up_axis import Vertical
from baker.scans.cloud import Cloud
from baker.scans.finding import Finding

Points = NDArray[np.floating]

DIRECTIONS = ("z", "y", "x", "-z", "-y", "-x")  # that may be up, the usual ones first
SCANS_TO_ASK = 3  # of a series, whether there may be a ground across a direction at all
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
# Score of the median scan, across the usual direction and others. With discs of soil from 3 to
# 300 % of the plant's size, sloped, rough, oblong or in mounds, no scan has less than 0.57. Of two
# or more scans of twenty plants without ground it is 0.45 at most, and 0.63 upside down.
MIN_SCORE, MIN_SCORE_OF_UNUSUAL, CERTAIN_SCORE = 0.5, 0.7, 0.55
MIN_SCORE_OF_ONE = 0.25  # of any scan of a series that has a ground
MIN_SHARE_OF_LABEL = 0.5  # of its points in the ground, for a label to be that of the ground
MIN_SHARE_OF_GROUND = 0.1  # of the ground's points that this label has


@dataclass(frozen=True)
class Ground:
    """A level place under a plant."""

    frame: Points  # (3, 3) rotation; its third row leads away from the ground
    height: float  # in that direction
    thickness: float  # how far above and below its points lie
    outline: Points  # (E, 3) a, b, c of the lines around it: a x + b y + c <= 0 inside
    score: float  # how round and closed it is, from 0 to 1

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
        rising = ~held & (heights <= 3 * self.thickness) & (inside >= 0)
        if rising.sum() > 1:
            spacing = np.median(KDTree(points[rising]).query(points[rising], k=2)[0][:, 1])
            layer = np.flatnonzero(held & (heights >= -self.thickness))
            distances, _ = KDTree(turned[rising, :2]).query(turned[layer, :2])
            held[layer[distances <= spacing]] = False
        return held


def take_out_ground(
    clouds: Sequence[Cloud], up: str = "auto", keep: bool = False, map: MapLike = map
) -> tuple[list[Cloud], tuple[float, float, float] | None, tuple[Finding, ...]]:
    """The scans of a series without the ground that they stand on, if most of them have one.

    Of scans with labels those go of which most points lie in the ground. `up` is the direction of
    growth, "auto" where it is not known; `keep` only finds the ground. Also returned: the unit
    vector away from the ground, and what was found, if there is one.
    """
    grounds = _grounds(clouds, DIRECTIONS if up == "auto" else (up,), map)
    found = [ground for ground in grounds if ground]
    if not found:
        return list(clouds), None, ()
    mean = np.mean([ground.frame[2] for ground in found], axis=0)
    x, y, z = (mean / np.linalg.norm(mean)).tolist()
    said = f"a plane under the plant in {len(found)} of {len(clouds)} scans"
    if keep:
        return list(clouds), (x, y, z), (Finding("ground", f"{said}, kept as asked"),)
    labels = list(map(_labels_of_ground, clouds, grounds))
    votes = Counter(chain.from_iterable(labels))
    usual = {label for label, count in votes.items() if 2 * count > len(found)}
    left = list(map(_without, clouds, grounds, [own or usual for own in labels]))
    count = sum(len(cloud) for cloud in clouds) - sum(len(cloud) for cloud in left)
    said += f"; its {count:,} points are taken out"
    close = np.median([ground.score for ground in found]) < CERTAIN_SCORE
    doubt = "it is not quite round and closed, and may be leaves" if close else ""
    return left, (x, y, z), (Finding("ground", said, doubt, "--ground keep"),)


def _grounds(
    clouds: Sequence[Cloud], directions: Sequence[str], map: MapLike
) -> list[Ground | None]:
    """The ground of each scan; of none where most have none."""
    asked = np.linspace(0, len(clouds) - 1, min(len(clouds), SCANS_TO_ASK)).astype(int)
    for up in directions:
        for scans in (asked, range(len(clouds))):
            points = [clouds[scan].points for scan in scans]
            found = list(map(partial(find_ground, up=up), points))
            score = np.median([ground.score if ground else 0.0 for ground in found])
            if score < (MIN_SCORE if up == directions[0] else MIN_SCORE_OF_UNUSUAL):
                break
        else:
            return found
    return [None] * len(clouds)


def _labels_of_ground(cloud: Cloud, ground: Ground | None) -> set[int]:
    """The labels of which most points lie in the ground, where they are much of it."""
    if ground is None or cloud.labels is None:
        return set()
    names, number = np.unique(cloud.labels, return_inverse=True)
    inside = np.bincount(number, ground.holds(cloud.points))
    is_most = inside > MIN_SHARE_OF_LABEL * np.bincount(number)
    return set(names[is_most & (inside > MIN_SHARE_OF_GROUND * inside.sum())].tolist())


def _without(cloud: Cloud, ground: Ground | None, labels: set[int]) -> Cloud:
    """The scan without its ground: without these labels, if it has any of them."""
    held = np.zeros(len(cloud), bool)
    if cloud.labels is not None and labels:
        held = np.isin(cloud.labels, list(labels))
    elif ground:
        held = ground.holds(cloud.points)
    if held.all() or not held.any():
        return cloud
    return cloud.take(np.flatnonzero(~held)).noting(f"took out {held.sum()} points of the ground.")


def find_ground(points: Points, up: str) -> Ground | None:
    """The likeliest ground of an (N, 3) scan that stands along `up`, more or less."""
    vertical = Vertical.named(up)
    along = vertical.sign * np.eye(3)[vertical.axis]
    sample = np.asarray(points[:: -(-len(points) // MAX_SAMPLE)], np.float64)
    found = [_ground(sample, along, share) for share in LOW_SHARES]
    return max(filter(None, found), key=lambda ground: ground.score, default=None)


def _ground(sample: Points, up: Points, share: float) -> Ground | None:
    from scipy.spatial import ConvexHull, QhullError

    frame = _frame(up)
    for _ in range(2):  # the second time in a frame in which the ground is level
        cells, width = _lowest_points(sample @ frame.T, share)
        if len(cells) < CELLS:
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
    if score < MIN_SCORE_OF_ONE:
        return None
    outline = hull.equations - [0.0, 0.0, width]
    rough = Ground(frame, float(np.median(cells[:, 2])), 2 * width, outline, score)
    turned, heights, inside = rough.seen(sample)
    near = (np.abs(heights) <= rough.thickness) & (inside >= 0)
    columns = np.floor(turned[:, :2] / width) @ [1e6, 1.0]
    middle = _median_of_medians(columns[near], heights[near])
    deviation = 1.4826 * _median_of_medians(columns[near], np.abs(heights[near] - middle))
    thickness = max(THICKNESS * deviation, MIN_THICKNESS * width)
    ground = Ground(frame, rough.height + middle, thickness, outline, score)
    return ground if _carries_plant(ground, sample, columns, width) else None


def _carries_plant(ground: Ground, sample: Points, columns: Points, width: float) -> bool:
    """Whether nothing lies below the ground, much of it is bare, and something rises from it."""
    _, heights, inside = ground.seen(sample)
    thickness, radius = ground.thickness, float(inside.max()) - width
    over = (heights > thickness) & (inside >= 0)
    foot = inside[(heights > thickness) & (heights <= max(2 * thickness, thickness + radius / 6))]
    bare = np.unique(columns[(np.abs(heights) <= thickness) & (inside >= 0)])
    covered = np.unique(columns[over & (heights <= 3 * thickness)])
    return bool(
        (heights < -thickness).mean() <= MAX_BELOW
        and len(covered) <= MAX_COVERED * len(bare)
        and np.sum(foot > width + radius / 4) >= max(1, MIN_IN_MIDDLE * len(foot))
    )


def _lowest_points(turned: Points, share: float) -> tuple[Points, float]:
    """The lowest point of each cell that has any near the bottom, and the cells' width."""
    heights = turned[:, 2]
    bottom = np.quantile(heights, 0.002)
    low = turned[heights <= bottom + share * (heights.max() - bottom)]
    corner, end = np.quantile(low[:, :2], [0.005, 0.995], axis=0)
    width = float((end - corner).max()) / CELLS or 1.0
    cell = np.floor((low[:, :2] - corner) / width).astype(np.int64)
    within = ((cell >= 0) & (cell <= CELLS)).all(axis=1)
    low, cell = low[within], cell[within]
    rising = np.argsort(low[:, 2], kind="stable")
    _, first = np.unique(cell[rising] @ [CELLS + 1, 1], return_index=True)
    return low[rising[first]], width


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
