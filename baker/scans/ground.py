"""Remove the ground that a plant stands on (soil, a pot or a table) from its scans."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from baker.geometry.neighbors import Points
from baker.geometry.parallel import MapLike
from baker.geometry.up_axis import Vertical
from baker.scans.ground_plane import MIN_SCORE, Ground, find_plane
from baker.scans.pot import Pot, find_pot
from baker.scans.scan import Finding, Scan

MAX_SAMPLE = 20_000  # number of points of a scan in which its ground is searched for
DIRECTIONS = ("z", "y", "x", "-z", "-y", "-x")  # candidates for up, the most usual first
# Least score of a ground along an unusual direction or in few scans, and of one that is certain.
# Discs of soil of 3 to 300 % of the plant's size, sloped, rough, oblong or in mounds, score 0.57 or
# more; twenty plants without ground at most 0.46 upright and 0.63 upside down.
MIN_UNUSUAL_SCORE, CERTAIN_SCORE = 0.7, 0.55
MAX_LAYERS = 3  # grounds that are removed one after the other: a table, then the pot on it
MIN_SHARE_OF_LABEL = 0.5  # of a label's points that lie in the ground, if it labels the ground
MIN_SHARE_OF_GROUND = 0.1  # of the ground's points that have this label


def remove_ground(
    scans: Sequence[Scan], up: str = "auto", keep: bool = False, map: MapLike = map
) -> tuple[list[Scan], str, tuple[Finding, ...]]:
    """Remove the ground from the scans of a series, where they show one.

    In scans with labels, the labels of which most points lie in the ground are removed.

    up: the direction of growth, one of `DIRECTIONS`, or "auto" where it is not known. keep: find
    the ground but leave it in the scans. Also returns the direction away from the ground, "" where
    none was found, and the findings.
    """
    directions = DIRECTIONS if up == "auto" else (up,)
    remaining, ground_up, findings = list(scans), "", list[Finding]()
    for _ in range(MAX_LAYERS):
        direction, grounds = _find_grounds(remaining, directions, map)
        showing = [scan.name for scan, ground in zip(scans, grounds, strict=True) if ground]
        if not showing or (findings and 2 * len(showing) <= len(scans)):
            break
        ground_up, directions = direction, (direction,)
        kind = "a pot" if any(isinstance(ground, Pot) for ground in grounds) else "a plane"
        description = f"{kind} under the plant in {len(showing)} of {len(scans)} scans"
        if keep:
            findings.append(Finding("ground", f"{description}, kept as asked"))
            break
        doubt = ""
        if 2 * len(showing) <= len(scans):
            doubt = f"the other scans show none, only {', '.join(showing)}"
        elif np.median([ground.score for ground in grounds if ground]) < CERTAIN_SCORE:
            doubt = "it is not quite round and closed, and may be leaves"
        count = sum(len(scan) for scan in remaining)
        remaining = list(map(_without_ground, remaining, grounds))
        count -= sum(len(scan) for scan in remaining)
        description += f"; its {count:,} points are taken out"
        findings.append(Finding("ground", description, doubt, "--ground keep"))
    return remaining, ground_up, tuple(findings)


def find_ground(points: Points, up: str) -> Ground | None:
    """Find the plane or, if there is none, the pot below (N, 3) points that grow roughly `up`."""
    sample = np.asarray(points[:: -(-len(points) // MAX_SAMPLE)], np.float64)
    frame = Vertical.named(up).to_z
    return find_plane(sample, frame) or find_pot(sample, frame)


def _find_grounds(
    scans: Sequence[Scan], directions: Sequence[str], map: MapLike
) -> tuple[str, list[Ground | None]]:
    """Find the ground of each scan, along the first direction along which most scans show one.

    Along the usual direction, it is enough if some scans show one; only grounds with a score of at
    least `MIN_UNUSUAL_SCORE` are then returned.
    """
    points = [scan.points for scan in scans]
    for up in directions:
        is_usual, search = up == directions[0], partial(find_ground, up=up)
        tried = len(scans) if is_usual else len(scans) // 2 + 1  # if these show none, most do
        grounds = list(map(search, points[:tried]))
        if any(grounds):
            grounds += map(search, points[tried:])
        score = np.median([ground.score if ground else 0.0 for ground in grounds])
        if score >= (MIN_SCORE if is_usual else MIN_UNUSUAL_SCORE):
            return up, grounds
        certain = [g if g and g.score >= MIN_UNUSUAL_SCORE else None for g in grounds]
        if is_usual and any(certain):
            return up, certain
    return "", [None] * len(scans)


def _without_ground(scan: Scan, ground: Ground | None) -> Scan:
    """Remove the points in the ground or, if the scan has labels, those of the ground's labels."""
    if ground is None:
        return scan
    is_ground = ground.holds(scan.points)
    if scan.labels is not None:
        _, index = np.unique(scan.labels, return_inverse=True)
        inside = np.bincount(index, is_ground)
        is_most = inside > MIN_SHARE_OF_LABEL * np.bincount(index)
        if (is_label := is_most & (inside > MIN_SHARE_OF_GROUND * inside.sum())).any():
            is_ground = is_label[index]
    if is_ground.all() or not is_ground.any():
        return scan
    note = f"took out {is_ground.sum()} points of the ground."
    return scan.take(np.flatnonzero(~is_ground)).noting(note)
