"""How exactly scans are aligned: `python bench/alignment.py UNALIGNED ALIGNED SERIES...`.

UNALIGNED and ALIGNED are folders that hold the same series, each a folder of tables with x, y, z in
the first columns, point for point the same plants: in the second all scans stand in one frame. So
the true move of every scan is known. Series that are missing in UNALIGNED are turned and moved at
random first, and where that is all one has ALIGNED may be named twice.

Printed for each pair of successive scans: the error of the yaw and of the tilt in degrees, for
`--align auto` and for `--align icp`.
"""

from __future__ import annotations

import sys
import time
from itertools import pairwise
from pathlib import Path

import numpy as np

from baker.align import Alignment, align
from baker.align.icp import rigid_fit
from baker.align.up import upright
from baker.vertical import Vertical


def main(unaligned: Path, aligned: Path, names: list[str]) -> None:
    """Print the table of errors, and a line of sums for each method."""
    totals: dict[str, list[tuple[float, float]]] = {"auto": [], "icp": []}
    print(f"{'series':<26}{'pair':>16}   auto: yaw  tilt    icp: yaw  tilt")
    for name in names:
        table = {path.stem: _points(path) for path in sorted((aligned / name).iterdir())}
        scans = {path.stem: _points(path) for path in sorted((unaligned / name).iterdir())}
        if unaligned == aligned:
            scans = _scattered(scans)
        truth = [rigid_fit(scans[day], table[day]) for day in scans]
        clouds = [points.astype(np.float32) for points in scans.values()]
        errors, seconds = {}, {}
        for method in totals:
            begun = time.perf_counter()
            found = align(clouds, method=method)
            seconds[method] = time.perf_counter() - begun
            errors[method] = _errors(found, truth)
            totals[method] += errors[method]
        for row, days in enumerate(pairwise(scans)):
            cells = "".join("{:12.1f}{:6.1f}".format(*errors[method][row]) for method in totals)
            print(f"{name:<26}{' - '.join(days):>16}{cells}")
        print(f"{name:<26}up {found.up}, {seconds['auto']:.1f} s auto, {seconds['icp']:.1f} s icp")
    for method, pairs in totals.items():
        yaws = np.abs([yaw for yaw, _ in pairs])
        print(
            f"{method}: of {len(yaws)} pairs {np.sum(yaws < 2)} within 2 degrees, "
            f"{np.sum(yaws < 5)} within 5, {np.sum(yaws > 30)} beyond 30; "
            f"median {np.median(yaws):.1f}, worst {yaws.max():.1f}; "
            f"tilt median {np.median([tilt for _, tilt in pairs]):.1f}"
        )


def _errors(found: Alignment, truth: list[np.ndarray]) -> list[tuple[float, float]]:
    """Yaw and tilt error in degrees of every scan against its predecessor."""
    frame = upright(Vertical.named(found.up))
    errors = []
    for (before, after), (true_before, true_after) in zip(
        pairwise(found.transforms), pairwise(truth), strict=True
    ):
        step = (np.linalg.inv(before) @ after)[:3, :3]
        wanted = (np.linalg.inv(true_before) @ true_after)[:3, :3]
        turn = frame @ step @ wanted.T @ frame.T
        yaw = np.arctan2(turn[1, 0] - turn[0, 1], turn[0, 0] + turn[1, 1])
        tilt = np.arccos(np.clip(turn[2, 2], -1.0, 1.0))
        errors.append((float(np.degrees(yaw)), float(np.degrees(tilt))))
    return errors


def _scattered(scans: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Every scan turned about the vertical and centred on its own, as one scanned alone is."""
    rng = np.random.default_rng(0)
    scattered = {}
    for day, points in scans.items():
        yaw = rng.uniform(0.0, 2.0 * np.pi)
        turn = [[np.cos(yaw), -np.sin(yaw), 0], [np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]]
        scattered[day] = (points - points.mean(axis=0)) @ np.transpose(turn)
    return scattered


def _points(path: Path) -> np.ndarray:
    return np.loadtxt(path)[:, :3]


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3:])
