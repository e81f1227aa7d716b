"""How exactly scans are aligned. Errors are in degrees, of every scan against its predecessor.

    python bench/alignment.py pairs UNALIGNED ALIGNED SERIES...
    python bench/alignment.py scattered ALIGNED SERIES... [--seeds 3]
    python bench/alignment.py grown [maize tomato tree] [--plants 3] [--seeds 1]
    python bench/alignment.py jumps ALIGNED SERIES... [--seeds 3]
    python bench/alignment.py truth ALIGNED SERIES...

UNALIGNED and ALIGNED are folders that hold the same series, each a folder of tables with x, y, z in
the first columns, point for point the same plants: in the second all scans stand in one frame.

pairs      yaw and tilt error of each pair, for `--align auto` and for `--align icp`.
scattered  aligned series whose scans are first turned about the vertical and shifted at random, by
           up to a tenth of their height: yaw errors of all pairs, CHAIN from the first to the last,
           and how far the stem's FOOT is off, level, in % of the height, in the median.
grown      the same with plants that `grow` makes, whose truth is exact.
jumps      aligned series as they are, which should stay, and with one scan turned by 40 to 320
           degrees and, in every second copy, shifted: the others should stay.
truth      how far other, as good definitions of "not turned" lie from the aligned series' own
           (z up, a fourth column with the same label for the same organ, 0 for the stem): the
           median over the organs, weighted by their distance from the stem, of the turn of their
           middles, of their points' mean direction, of their outer halves, and of the directions
           from their attachments to their middles. Nobody's truth is better than they agree.
"""

from __future__ import annotations

import argparse
import time
from itertools import pairwise
from pathlib import Path

import numpy as np

from baker.alignment import Alignment, align
from baker.alignment.up_axis_search import upright
from baker.geometry.rigid import fit_rigid
from baker.geometry.up_axis import Vertical

WRONG = 30.0  # degrees: locked on a wrong way round
SHIFT = 0.1  # of a scan's height


def pairs(unaligned: Path, aligned: Path, names: list[str]) -> None:
    """The table of errors, and a line of sums for each method."""
    totals: dict[str, list[tuple[float, float]]] = {"auto": [], "icp": []}
    print(f"{'series':<26}{'pair':>16}   auto: yaw  tilt    icp: yaw  tilt")
    for name in names:
        table = {path.stem: _table(path)[:, :3] for path in sorted((aligned / name).iterdir())}
        scans = {path.stem: _table(path)[:, :3] for path in sorted((unaligned / name).iterdir())}
        truth = [fit_rigid(scans[day], table[day]) for day in scans]
        errors, seconds = {}, {}
        for method in totals:
            begun = time.process_time()
            found = align([points.astype(np.float32) for points in scans.values()], method=method)
            seconds[method] = time.process_time() - begun
            errors[method] = _errors(found, truth)
            totals[method] += errors[method]
        for row, days in enumerate(pairwise(scans)):
            cells = "".join("{:12.1f}{:6.1f}".format(*errors[method][row]) for method in totals)
            print(f"{name:<26}{' - '.join(days):>16}{cells}")
        chain = sum(yaw for yaw, _ in errors["auto"])
        print(
            f"{name:<26}up {found.up}, first to last {chain:+.1f}, "
            f"{seconds['auto']:.1f} s auto, {seconds['icp']:.1f} s icp"
        )
    for method, found_errors in totals.items():
        tilts = [tilt for _, tilt in found_errors]
        print(f"{method}: {_summary([yaw for yaw, _ in found_errors])}")
        print(f"{method}: tilt median {np.median(tilts):.1f}, worst {max(tilts):.1f}")


def scattered(series: dict[str, list[np.ndarray]], seeds: int) -> None:
    """Errors of series whose scans are turned and shifted at random."""
    everything: list[float] = []
    print(f"{'series':<26}{'WRONG':>6}{'median':>8}{'worst':>8}{'CHAIN':>8}{'FOOT':>6}   s of CPU")
    for name, scans in series.items():
        yaws, chains, feet = [], [], []
        begun = time.process_time()
        for seed in range(1, seeds + 1):
            rng = np.random.default_rng(seed)
            truth = [_pose(rng, points, 0.0, 360.0, SHIFT) for points in scans]
            found = align(
                [_moved(move, points) for move, points in zip(truth, scans, strict=True)], up="z"
            )
            errors = [yaw for yaw, _ in _errors(found, [np.linalg.inv(move) for move in truth])]
            yaws += errors
            places = [at @ move for at, move in zip(found.transforms, truth, strict=True)]
            for points, (before, after) in zip(scans, pairwise(places), strict=False):
                off = np.linalg.inv(before) @ after
                feet.append(100.0 * np.hypot(*off[:2, 3]) / np.ptp(points[:, 2]))
            chains.append((sum(errors) + 180.0) % 360.0 - 180.0)
        seconds = (time.process_time() - begun) / seeds
        size = np.abs(yaws)
        print(
            f"{name:<26}{np.sum(size > WRONG):6d}{np.median(size):8.2f}{size.max():8.2f}"
            f"{np.abs(chains).max():8.2f}{np.median(feet):6.2f}{seconds:8.1f}",
            flush=True,
        )
        everything += yaws
    print(_summary(everything))


def jumps(series: dict[str, list[np.ndarray]], seeds: int) -> None:
    """What becomes of series in one frame, and of those with a single scan out of it."""
    print(f"{'series':<26}as it is   error of one scan that jumped (others)")
    for name, scans in series.items():
        found = align([points.astype(np.float32) for points in scans], up="z")
        stays = all(np.array_equal(each, np.eye(4)) for each in found.transforms)
        told = []
        for seed in range(1, seeds + 1):
            rng = np.random.default_rng(seed)
            out = int(rng.integers(1, len(scans)))
            move = _pose(rng, scans[out], 40.0, 320.0, SHIFT * (seed % 2))
            clouds = [points.astype(np.float32) for points in scans]
            clouds[out] = _moved(move, scans[out])
            found = align(clouds, up="z")
            others = [each for at, each in enumerate(found.transforms) if at != out]
            kept = all(np.array_equal(each, np.eye(4)) for each in others)
            error = found.transforms[out] @ move
            yaw = np.degrees(np.arctan2(error[1, 0], error[0, 0]))
            told.append(f"{yaw:+7.1f} ({'stay' if kept else 'MOVED'})")
        print(f"{name:<26}{'stays' if stays else 'MOVED':<11}{'  '.join(told)}", flush=True)


def truth_itself(tables: dict[str, list[np.ndarray]]) -> None:
    """How much labelled measures of a plant's turn differ, pair by pair."""
    names = ("middle", "mean direction", "outer half", "from attachment")
    spread: list[list[float]] = []
    for series, scans in tables.items():
        print(series)
        azimuths = [_azimuths(table) for table in scans]
        for number, measure in enumerate(names):
            turns = []
            for before, after in pairwise(azimuths):
                shared = sorted(set(before) & set(after))
                turn = np.array([after[of][number] - before[of][number] for of in shared])
                turn = (turn + 180.0) % 360.0 - 180.0
                lever = np.array([min(after[of][-1], before[of][-1]) for of in shared])
                order = np.argsort(turn)
                middle = np.searchsorted(np.cumsum(lever[order]), lever.sum() / 2.0)
                turns.append(float(turn[order][middle]))
            spread.append(turns)
            print(f"    {measure:<18}" + " ".join(f"{turn:+6.1f}" for turn in turns))
    for number, measure in enumerate(names):
        size = np.abs(np.concatenate(spread[number :: len(names)]))
        print(
            f"{measure:<18} median {np.median(size):.1f}, within 2 degrees of the series' own "
            f"{np.sum(size < 2)} of {len(size)}"
        )


def _azimuths(table: np.ndarray) -> dict[int, tuple[float, float, float, float, float]]:
    """Of each organ: where it points in degrees by four measures, and how far out it is."""
    from scipy.spatial import cKDTree

    stem = table[table[:, 3] == 0, :3]
    foot = stem[stem[:, 2] <= stem[:, 2].min() + 0.1 * np.ptp(stem[:, 2])].mean(axis=0)
    found = {}
    for label in np.unique(table[:, 3])[1:]:
        points = table[table[:, 3] == label, :3] - foot
        out = np.hypot(*points[:, :2].T)
        attachment = cKDTree(stem - foot).query(points)[0]
        nearest = points[np.argsort(attachment)[: max(20, len(points) // 20)]]
        units = points[:, :2] / np.maximum(out, 1e-9)[:, None]
        arrows = (
            points[:, :2].mean(axis=0),
            units.mean(axis=0),
            points[out >= np.median(out), :2].mean(axis=0),
            (points.mean(axis=0) - nearest.mean(axis=0))[:2],
        )
        angles = [float(np.degrees(np.arctan2(y, x))) for x, y in arrows]
        found[int(label)] = (*angles, float(out.mean()))
    return found


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


def _summary(yaws: list[float]) -> str:
    size = np.abs(yaws)
    return (
        f"of {len(size)} pairs {np.sum(size < 2)} within 2 degrees, {np.sum(size < 5)} within 5, "
        f"{np.sum(size > WRONG)} beyond {WRONG:.0f}; median {np.median(size):.2f}, "
        f"worst {size.max():.2f}"
    )


def _pose(
    rng: np.random.Generator, points: np.ndarray, least: float, most: float, shift: float
) -> np.ndarray:
    """A turn about z by `least` to `most` degrees and a shift by that share of the height."""
    yaw = np.radians(rng.uniform(least, most))
    pose = np.eye(4)
    pose[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
    pose[:3, 3] = rng.uniform(-shift, shift, 3) * np.ptp(points[:, 2])
    return pose


def _moved(pose: np.ndarray, points: np.ndarray) -> np.ndarray:
    return (points @ pose[:3, :3].T + pose[:3, 3]).astype(np.float32)


def _table(path: Path) -> np.ndarray:
    return np.loadtxt(path)


def _tables(folder: Path, names: list[str]) -> dict[str, list[np.ndarray]]:
    return {name: [_table(path) for path in sorted((folder / name).iterdir())] for name in names}


def _clouds(folder: Path, names: list[str]) -> dict[str, list[np.ndarray]]:
    tables = _tables(folder, names)
    return {name: [table[:, :3] for table in scans] for name, scans in tables.items()}


def _grown(kinds: list[str], plants: int) -> dict[str, list[np.ndarray]]:
    from grow import plant

    series = {}
    for kind in kinds:
        for seed in range(plants):
            subject = plant(kind, seed)
            series[f"{kind} {seed}"] = [
                subject.cloud(float(day), colors=False).points for day in subject.default_days
            ]
    return series


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    what = parser.add_subparsers(dest="what", required=True)
    for name in ("pairs", "scattered", "jumps", "truth"):
        command = what.add_parser(name)
        if name == "pairs":
            command.add_argument("unaligned", type=Path)
        command.add_argument("aligned", type=Path)
        command.add_argument("series", nargs="+")
        command.add_argument("--seeds", type=int, default=3)
    command = what.add_parser("grown")
    command.add_argument("kinds", nargs="*", default=["maize", "tomato", "tree"])
    command.add_argument("--plants", type=int, default=3, help="of each kind")
    command.add_argument("--seeds", type=int, default=1)
    chosen = parser.parse_args()
    if chosen.what == "pairs":
        pairs(chosen.unaligned, chosen.aligned, chosen.series)
    elif chosen.what == "scattered":
        scattered(_clouds(chosen.aligned, chosen.series), chosen.seeds)
    elif chosen.what == "jumps":
        jumps(_clouds(chosen.aligned, chosen.series), chosen.seeds)
    elif chosen.what == "truth":
        truth_itself(_tables(chosen.aligned, chosen.series))
    else:
        scattered(_grown(chosen.kinds, chosen.plants), chosen.seeds)


if __name__ == "__main__":
    main()
