"""Remove the ground that a plant stands on (soil or a table) from its scans."""

from collections import Counter
from collections.abc import Sequence
from functools import partial
from itertools import chain

import numpy as np

from baker.geometry.parallel import MapLike
from baker.geometry.up_axis import Vertical
from baker.scans.ground_plane import MIN_SCORE, Ground, find_ground
from baker.scans.scan import Finding, Scan

DIRECTIONS = ("z", "y", "x", "-z", "-y", "-x")  # candidates for up, the most usual first
# Least score of a ground across an unusual direction, and of one that is certain. With discs of
# soil of 3 to 300 % of the plant's size, sloped, rough, oblong or in mounds, no scan scores below
# 0.57. Twenty plants without ground score at most 0.46 in the usual direction, 0.63 upside down.
MIN_UNUSUAL_SCORE, CERTAIN_SCORE = 0.7, 0.55
MAX_LAYERS = 3  # grounds that are removed one after the other: a table, then the soil on it
MIN_SHARE_OF_LABEL = 0.5  # of a label's points that lie in the ground, if it labels the ground
MIN_SHARE_OF_GROUND = 0.1  # of the ground's points that have this label


def remove_ground(
    scans: Sequence[Scan], up: str = "auto", keep: bool = False, map: MapLike = map
) -> tuple[list[Scan], str, tuple[Finding, ...]]:
    """Remove the ground from the scans of a series, where they show one.

    In scans with labels, the labels of which most points lie in the ground are removed.

    Parameters
    ----------
    scans : sequence of Scan
    up : str
        The direction of growth, one of `DIRECTIONS`, or "auto" where it is not known.
    keep : bool
        Find the ground, but don't remove it.
    map : map-like callable
        Maps over the scans.

    Returns
    -------
    scans : list of Scan
    ground_up : str
        The direction away from the ground, one of `DIRECTIONS`; "" where no ground was found.
    findings : tuple of Finding
    """
    directions = DIRECTIONS if up == "auto" else (up,)
    remaining, ground_up, findings = list(scans), "", []
    for _ in range(MAX_LAYERS):
        grounds = _find_grounds(remaining, directions, map)
        found = [ground for ground in grounds if ground]
        if not found:
            break
        normals = np.array([ground.frame[2] for ground in found])
        ground_up = max(directions, key=lambda up: Vertical.named(up).height(normals).sum())
        directions = (ground_up,)
        description, doubt = _describe(grounds, [scan.name for scan in remaining])
        if keep:
            findings.append(Finding("ground", f"{description}, kept as asked"))
            break
        labels = list(map(_labels_of_ground, remaining, grounds))
        votes = Counter(chain.from_iterable(labels))
        usual = {label for label, count in votes.items() if 2 * count > len(found)}
        count = sum(map(len, remaining))
        remaining = [*map(_without_ground, remaining, grounds, [own or usual for own in labels])]
        description += f"; its {count - sum(map(len, remaining)):,} points are taken out"
        findings.append(Finding("ground", description, doubt, "--ground keep"))
    return remaining, ground_up, tuple(findings)


def _describe(grounds: Sequence[Ground | None], names: Sequence[str]) -> tuple[str, str]:
    """What was found, and what speaks against it, as texts of a `Finding`."""
    found = [ground for ground in grounds if ground]
    description = f"a plane under the plant in {len(found)} of {len(grounds)} scans"
    if 2 * len(found) <= len(grounds):
        having = ", ".join(name for name, ground in zip(names, grounds, strict=True) if ground)
        return description, f"the other scans show none, only {having}"
    is_close = np.median([ground.score for ground in found]) < CERTAIN_SCORE
    return description, "it is not quite round and closed, and may be leaves" * bool(is_close)


def _find_grounds(
    scans: Sequence[Scan], directions: Sequence[str], map: MapLike
) -> list[Ground | None]:
    """Find the ground of each scan, along the first direction where most scans show one.

    If only some do along the usual direction, those grounds count of which the score is certain.
    """

    clouds = [scan.points for scan in scans]
    for up in directions:
        found = list(map(partial(find_ground, up=up), clouds))
        score = np.median([ground.score if ground else 0.0 for ground in found])
        if score >= (MIN_SCORE if up == directions[0] else MIN_UNUSUAL_SCORE):
            return found
        certain = [ground if ground and ground.score >= CERTAIN_SCORE else None for ground in found]
        if up == directions[0] and any(certain):
            return certain
    return [None] * len(scans)


def _labels_of_ground(scan: Scan, ground: Ground | None) -> set[int]:
    """The labels of which most points lie in the ground, if they are a large part of it."""
    if ground is None or scan.labels is None:
        return set()
    labels, index = np.unique(scan.labels, return_inverse=True)
    inside = np.bincount(index, ground.holds(scan.points))
    is_most = inside > MIN_SHARE_OF_LABEL * np.bincount(index)
    return set(labels[is_most & (inside > MIN_SHARE_OF_GROUND * inside.sum())].tolist())


def _without_ground(scan: Scan, ground: Ground | None, labels: set[int]) -> Scan:
    """Remove the points with these labels or, if the scan or the set has none, in the ground."""
    is_ground = np.zeros(len(scan), bool)
    if scan.labels is not None and labels:
        is_ground = np.isin(scan.labels, list(labels))
    elif ground:
        is_ground = ground.holds(scan.points)
    if is_ground.all() or not is_ground.any():
        return scan
    note = f"took out {is_ground.sum()} points of the ground."
    return scan.take(np.flatnonzero(~is_ground)).noting(note)
