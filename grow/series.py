"""Write a series of scans of one plant, and the truth about it, to a folder."""

import csv
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError
from grow.formats import WRITERS, record
from grow.model import Plant, plant
from grow.output import MAX_NOISE, TRUTH, atomic_series

MAX_SCANS = 10_000  # of a series
MAX_POINTS = 1_000_000_000  # of a scan


@dataclass(frozen=True)
class Plan:
    """What to write; None is the default of the plant."""

    kind: str  # one of `KINDS`
    seed: int = 0
    scans: int | None = None  # number of scans
    days: float | None = None  # length of the series
    points: tuple[int, int] | None = None  # of the first and last scan; else by surface area
    noise: float | None = None  # standard deviation, mm
    labels: bool = True
    colors: bool = True
    suffix: str = "ply"  # of the scans' files, one of `WRITERS`
    truth: tuple[float, ...] = ()  # days of true points, without noise, in the plant's frame
    shuffle: bool = False  # whether organs are renumbered at random in every scan
    pose: bool = False  # whether every scan but the first is rotated and shifted at random


def write_series(
    plan: Plan,
    folder: Path,
    force: bool = False,
    report_written: Callable[[str, int], None] = lambda name, points: None,
) -> None:
    """Write the scans of a series, and the truth about them to a subfolder.

    Parameters
    ----------
    plan : Plan
    folder : Path
    force : bool
        Replace existing scans and truth.
    report_written : callable, optional
        Called with the name of each file and its number of points.

    Raises
    ------
    InputError
        If the plan is impossible, or the folder can't be written or has scans.
    """
    _check(plan)
    subject = plant(plan.kind, plan.seed)
    days = scan_days(subject, plan)
    for day in plan.truth:
        _require_in_life(subject, day)
    with atomic_series(folder, lambda path: path.suffix[1:].lower() in WRITERS, force) as draft:
        _write(plan, subject, days, draft, report_written)


def scan_days(subject: Plant, plan: Plan) -> list[float]:
    """The days of the scans, rounded as in their names: the default days, or even steps."""
    if plan.scans is None and plan.days is None:
        return list(subject.default_days)
    first, usual_last = subject.default_days[0], subject.default_days[-1]
    last = usual_last if plan.days is None else first + plan.days
    _require_in_life(subject, last)
    count = len(subject.default_days) if plan.scans is None else plan.scans
    days = [round(float(day), 3) for day in np.linspace(first, last, count)]
    if len(set(days)) < count:
        raise InputError(f"{count} scans in {last - first:g} days are closer than 0.001 days.")
    return days


def day_names(days: Sequence[float]) -> list[str]:
    """Names such as day05 or day05.25, which give the days exactly."""
    decimals = max(len(f"{day:.3f}".rstrip("0").partition(".")[2]) for day in days)
    digits = max(len(str(int(day))) for day in days)
    width = max(digits, 2) + (decimals + 1 if decimals else 0)
    return [f"day{day:0{width}.{decimals}f}" for day in days]


def _check(plan: Plan) -> None:
    """Raise InputError if a plan is impossible."""
    if plan.scans is not None and plan.scans < 2:
        raise InputError(f"{plan.scans} scans are no series; at least 2 are needed.")
    if plan.scans is not None and plan.scans > MAX_SCANS:
        raise InputError(f"{plan.scans} scans are too many; at most {MAX_SCANS} are grown.")
    if plan.days is not None and not 0 < plan.days < np.inf:
        raise InputError(f"a series can't span {plan.days:g} days; give a number above 0.")
    if plan.points is not None and min(plan.points) < 10:
        raise InputError(f"{min(plan.points)} points show no plant; at least 10 are needed.")
    if plan.points is not None and max(plan.points) > MAX_POINTS:
        raise InputError(f"{max(plan.points)} points are too many; at most {MAX_POINTS} are grown.")
    if plan.noise is not None and not 0 <= plan.noise <= MAX_NOISE:
        raise InputError(f"the noise is {plan.noise:g} mm; 0 to {MAX_NOISE:g} are possible.")
    if plan.shuffle and not plan.labels:
        raise InputError("labels can't be both shuffled and left out.")
    if plan.suffix not in WRITERS:
        raise InputError(f"unknown format '{plan.suffix}': choose one of {', '.join(WRITERS)}.")


def _require_in_life(subject: Plant, day: float) -> None:
    """Raise InputError for a day for which the plant is not designed."""
    first, last = subject.days
    if not first <= day <= last:
        raise InputError(
            f"day {day:g} is outside the life of this {subject.kind}, days {first:g} to {last:g}."
        )


def _write(
    plan: Plan,
    subject: Plant,
    days: Sequence[float],
    folder: Path,
    report_written: Callable[[str, int], None],
) -> None:
    """Write the scans of a plan, and the truth about them, to an empty folder."""
    rng = np.random.default_rng([plan.seed, 1])
    names = [f"{name}.{plan.suffix}" for name in day_names(days)]
    numbers = [np.arange(len(subject.labels)) for _ in days]
    if plan.shuffle:
        numbers = [rng.permutation(number) for number in numbers]
    yaws, shifts = np.zeros(len(days)), np.zeros((len(days), 3))
    if plan.pose:
        yaws[1:] = rng.uniform(-np.pi, np.pi, len(days) - 1)
        shifts[1:] = rng.normal(0, 1, (len(days) - 1, 3)) * (150, 150, 20)

    for day, name, number, yaw, shift in zip(days, names, numbers, yaws, shifts, strict=True):
        count = _points_at(subject, plan, days, day)
        cloud = subject.cloud(day, count, plan.seed, plan.noise, plan.colors)
        points = (cloud.points @ _rotation_about_z(yaw).T + shift).astype(np.float32)
        labels = number[cloud.labels] if plan.labels else None
        _write_cloud(plan, folder / name, points, labels, cloud.colors)
        report_written(name, len(cloud))

    if plan.truth or plan.shuffle or plan.pose:
        truth = folder / TRUTH
        truth.mkdir()
        _write_organs(truth / "organs.csv", subject, days, names, numbers)
        if plan.pose:
            rows = [
                (name, f"{np.degrees(yaw):.6f}", *(f"{value:.4f}" for value in shift))
                for name, yaw, shift in zip(names, yaws, shifts, strict=True)
            ]
            _write_rows(truth / "poses.csv", ("scan", "yaw_degrees", "x", "y", "z"), rows)
        for day in sorted({round(day, 3) for day in plan.truth}):
            count = _points_at(subject, plan, days, day)
            cloud = subject.cloud(day, count, plan.seed + 1, 0.0, plan.colors)
            path = truth / f"truth_{day_names([day])[0]}.{plan.suffix}"
            _write_cloud(plan, path, cloud.points, cloud.labels, cloud.colors)
            report_written(f"{TRUTH}/{path.name}", len(cloud))


def _points_at(subject: Plant, plan: Plan, days: Sequence[float], day: float) -> int:
    """Number of points of a scan at `day`."""
    if plan.points is None:
        return subject.default_points(day)
    counts, areas = plan.points, (subject.area(days[0]), subject.area(days[-1]))
    added = (counts[1] - counts[0]) * (subject.area(day) - areas[0]) / (areas[1] - areas[0])
    return max(round(counts[0] + added), 10)


def _rotation_about_z(yaw: float) -> NDArray[np.float64]:
    """(3, 3) rotation matrix about z, for an angle in radians."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    return np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])


def _write_cloud(
    plan: Plan,
    path: Path,
    points: NDArray[np.float32],
    labels: NDArray[np.int64] | None,
    colors: NDArray[np.uint8] | None,
) -> None:
    WRITERS[plan.suffix](path, record(points, labels, colors))


def _write_organs(
    path: Path,
    subject: Plant,
    days: Sequence[float],
    names: Sequence[str],
    numbers: Sequence[NDArray[np.intp]],
) -> None:
    """Write the true organ of each label in each scan, in the frame of the plant."""
    head = "scan day label organ kind parent birth length area base_x base_y base_z tip_x tip_y"
    rows = [
        (
            name,
            f"{day:g}",
            number[organ.label],
            organ.label,
            organ.kind,
            organ.parent,
            *(f"{v:.4f}" for v in (organ.birth, organ.length, organ.area, *organ.base)),
            *(f"{v:.4f}" for v in (*organ.tip, organ.reach)),
        )
        for day, name, number in zip(days, names, numbers, strict=True)
        for organ in subject.organs(day)
    ]
    _write_rows(path, (*head.split(), "tip_z", "reach"), rows)


def _write_rows(path: Path, head: Sequence[str], rows: Sequence[Sequence[object]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(rows)
