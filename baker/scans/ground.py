"""Remove the ground that a plant stands on (soil, a pot or a table) from its scans."""

from collections.abc import Sequence
from functools import partial

import numpy as np

from baker.geometry.parallel import MapLike
from baker.scans.ground_plane import CERTAIN_SCORE, Ground, find_ground
from baker.scans.scan import Finding, Scan

DIRECTIONS = ("z", "y", "x", "-z", "-y", "-x")  # candidates for up, the most usual first
MAX_LAYERS = 3  # grounds that are removed one after the other: a table, then the pot on it
MIN_SHARE_OF_LABEL = 0.5  # of a label's points that lie in the ground, if it labels the ground
MIN_SHARE_OF_GROUND = 0.1  # of the ground's points that have this label


def remove_ground(
    scans: Sequence[Scan], up: str = "auto", keep: bool = False, map: MapLike = map
) -> tuple[list[Scan], str, tuple[Finding, ...]]:
    """Remove the ground from the scans of a series, where they show one.

    In scans with labels, the labels of which most points lie in the ground are removed. `up` is the
    direction of growth, "auto" where it is not known; `keep` finds the ground, but does not remove
    it. Returns the scans, the direction away from the ground ("" without one) and the findings.
    """
    directions = DIRECTIONS if up == "auto" else (up,)
    remaining, ground_up, findings = list(scans), "", []
    for _ in range(MAX_LAYERS):
        grounds = _find_grounds(remaining, directions, map)
        found = [ground for ground in grounds if ground]
        if not found:
            break
        ground_up = found[0].up
        directions = (ground_up,)
        kind = "a pot" if any(ground.margin for ground in found) else "a plane"
        description, doubt = f"{kind} under the plant in {len(found)} of {len(scans)} scans", ""
        if not _are_most(grounds):
            having = [scan.name for scan, ground in zip(scans, grounds, strict=True) if ground]
            doubt = f"the other scans show none, only {', '.join(having)}"
        if keep:
            findings.append(Finding("ground", f"{description}, kept as asked"))
            break
        count = sum(map(len, remaining))
        remaining = list(map(_without_ground, remaining, grounds))
        description += f"; its {count - sum(map(len, remaining)):,} points are taken out"
        findings.append(Finding("ground", description, doubt, "--ground keep"))
    return remaining, ground_up, tuple(findings)


def _find_grounds(
    scans: Sequence[Scan], directions: Sequence[str], map: MapLike
) -> list[Ground | None]:
    """Find the ground of each scan, along the first direction where most scans show one.

    Along an unusual direction only certain grounds count. So they do along the usual one where only
    some scans show a ground.
    """
    for up in directions:
        found = list(map(partial(find_ground, up=up), [scan.points for scan in scans]))
        if up == directions[0] and _are_most(found):
            return found
        certain = [ground if ground and ground.score >= CERTAIN_SCORE else None for ground in found]
        if _are_most(certain) or (up == directions[0] and any(certain)):
            return certain
    return [None] * len(scans)


def _are_most(grounds: Sequence[Ground | None]) -> bool:
    return 2 * sum(ground is not None for ground in grounds) > len(grounds)


def _without_ground(scan: Scan, ground: Ground | None) -> Scan:
    """Remove the labels of which most points lie in the ground or, without such, its points."""
    if ground is None:
        return scan
    is_ground = ground.holds(scan.points)
    if scan.labels is not None:
        _, index, count = np.unique(scan.labels, return_inverse=True, return_counts=True)
        inside = np.bincount(index, is_ground)
        least = np.maximum(MIN_SHARE_OF_LABEL * count, MIN_SHARE_OF_GROUND * inside.sum())
        is_label = inside > least
        is_ground = is_label[index] if is_label.any() else is_ground
    if is_ground.all() or not is_ground.any():
        return scan
    note = f"took out {is_ground.sum()} points of the ground."
    return scan.take(np.flatnonzero(~is_ground)).noting(note)
