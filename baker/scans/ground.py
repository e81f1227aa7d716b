"""The ground that a plant stands on, soil, a pot or a table, taken out of its scans."""

from collections import Counter
from collections.abc import Sequence
from functools import partial
from itertools import chain

import numpy as np

from baker.geometry.parallel import MapLike
from baker.geometry.up_axis import Vertical
from baker.scans.ground_plane import MIN_SCORE, Ground, find_ground
from baker.scans.scan import Finding, Scan

DIRECTIONS = ("z", "y", "x", "-z", "-y", "-x")  # that may be up, the usual ones first
SCANS_TO_ASK = 3  # of a series, whether there may be a ground across an unusual direction
# Scores across unusual directions, of a single scan, and without doubt. With discs of soil from 3
# to 300 % of the plant's size, sloped, rough, oblong or in mounds, no scan has less than 0.57.
# Twenty plants without ground have at most 0.46 across the usual direction, 0.63 upside down.
MIN_SCORE_OF_UNUSUAL, CERTAIN_SCORE = 0.7, 0.55
MAX_LAYERS = 3  # that are taken out one after the other: a table, the pot on it
MIN_SHARE_OF_LABEL = 0.5  # of its points in the ground, for a label to be that of the ground
MIN_SHARE_OF_GROUND = 0.1  # of the ground's points that this label has


def take_out_ground(
    scans: Sequence[Scan],
    up: str = "auto",
    keep: bool = False,
    map: MapLike = map,
) -> tuple[list[Scan], str, tuple[Finding, ...]]:
    """The scans of a series without the ground that they stand on, where they have one.

    Of scans with labels those go of which most points lie in the ground. `up` is the direction of
    growth, "auto" where it is not known; `keep` only finds the ground. Also returned: which of
    `DIRECTIONS` leads away from the ground, "" where there is none, and what was found.
    """
    directions = DIRECTIONS if up == "auto" else (up,)
    left, ground_up, findings = list(scans), "", []
    for _ in range(MAX_LAYERS):
        grounds = _grounds(left, directions, map)
        found = [ground for ground in grounds if ground]
        if not found:
            break
        normals = np.array([ground.frame[2] for ground in found])
        ground_up = max(directions, key=lambda up: Vertical.named(up).height(normals).sum())
        directions = (ground_up,)
        said, doubt = _said(grounds, [scan.name for scan in left])
        if keep:
            findings.append(Finding("ground", f"{said}, kept as asked"))
            break
        labels = list(map(_labels_of_ground, left, grounds))
        votes = Counter(chain.from_iterable(labels))
        usual = {label for label, count in votes.items() if 2 * count > len(found)}
        count = sum(map(len, left))
        left = [*map(_without, left, grounds, [own or usual for own in labels])]
        said += f"; its {count - sum(map(len, left)):,} points are taken out"
        findings.append(Finding("ground", said, doubt, "--ground keep"))
    return left, ground_up, tuple(findings)


def _said(grounds: Sequence[Ground | None], names: Sequence[str]) -> tuple[str, str]:
    """What was found, and what speaks against it."""
    found = [ground for ground in grounds if ground]
    kind = "a pot" if any(ground.margin for ground in found) else "a plane"
    said = f"{kind} under the plant in {len(found)} of {len(grounds)} scans"
    if 2 * len(found) <= len(grounds):
        having = ", ".join(name for name, ground in zip(names, grounds, strict=True) if ground)
        return said, f"the other scans show none, only {having}"
    is_close = np.median([ground.score for ground in found]) < CERTAIN_SCORE
    return said, "it is not quite round and closed, and may be leaves" * bool(is_close)


def _grounds(scans: Sequence[Scan], directions: Sequence[str], map: MapLike) -> list[Ground | None]:
    """The ground of each scan: of most along one direction, or of some along the usual one."""
    asked = np.linspace(0, len(scans) - 1, min(len(scans), SCANS_TO_ASK)).astype(int)
    for up in directions:
        is_usual = up == directions[0]
        for some in (scans,) if is_usual else ([scans[k] for k in asked], scans):
            found = list(map(partial(find_ground, up=up), [scan.points for scan in some]))
            scores = np.array([ground.score if ground else 0.0 for ground in found])
            if np.median(scores) < (MIN_SCORE if is_usual else MIN_SCORE_OF_UNUSUAL):
                break
        else:
            return found
        if is_usual and scores.max() >= CERTAIN_SCORE:
            return [g if g and g.score >= CERTAIN_SCORE else None for g in found]
    return [None] * len(scans)


def _labels_of_ground(scan: Scan, ground: Ground | None) -> set[int]:
    """The labels of which most points lie in the ground, where they are much of it."""
    if ground is None or scan.labels is None:
        return set()
    names, number = np.unique(scan.labels, return_inverse=True)
    inside = np.bincount(number, ground.holds(scan.points))
    is_most = inside > MIN_SHARE_OF_LABEL * np.bincount(number)
    return set(names[is_most & (inside > MIN_SHARE_OF_GROUND * inside.sum())].tolist())


def _without(scan: Scan, ground: Ground | None, labels: set[int]) -> Scan:
    """The scan without its ground: without these labels, if it has any of them."""
    held = np.zeros(len(scan), bool)
    if scan.labels is not None and labels:
        held = np.isin(scan.labels, list(labels))
    elif ground:
        held = ground.holds(scan.points)
    if held.all() or not held.any():
        return scan
    return scan.take(np.flatnonzero(~held)).noting(f"took out {held.sum()} points of the ground.")
