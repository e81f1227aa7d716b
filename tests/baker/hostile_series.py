"""Series of scans from hell, and what a bake owes them: a true clip or one sentence.

A case is plain data, so that hypothesis can draw it and its text can be run again:

    check_series(Series((Scan("plant", 200), Scan("nothing", 0)), {"paper": True}), folder)

`python -m tests.baker.fuzz_scans` draws thousands of them; test_hostile_series.py a few.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from tests.baker.sound_files import pcd_bytes

Points = NDArray[np.float64]
Shape = Callable[[np.random.Generator, int], Points]

GOLDEN = 2.4  # radians between successive leaves


def _rod(random: np.random.Generator, start: Points, end: Points, count: int) -> Points:
    along = np.sort(random.random((count, 1)), axis=0)
    return start + along * (end - start) + random.normal(0, 0.03, (count, 3))


def _plant(random: np.random.Generator, count: int) -> Points:
    """A stem with four leaves of different sizes."""
    parts = [_rod(random, np.zeros(3), np.array([0.0, 0.0, 12.0]), count - count // 2)]
    for leaf in range(4):
        base = np.array([0.0, 0.0, 3.0 + 2 * leaf])
        way = (1 + leaf) * np.array([np.cos(GOLDEN * leaf), np.sin(GOLDEN * leaf), 0.5])
        parts.append(_rod(random, base, base + way, count // 8))
    return np.concatenate(parts)


def _some(value: float) -> Shape:
    """A plant of which a tenth of the coordinates are `value`."""

    def shape(random: np.random.Generator, count: int) -> Points:
        points = _plant(random, count)
        points[random.random(points.shape) < 0.1] = value
        return points

    return shape


def _grid(random: np.random.Generator, count: int) -> Points:
    """Equal distances throughout: nothing but ties."""
    side = max(round(count ** (1 / 3)), 1)
    return np.stack(np.meshgrid(*[np.arange(float(side))] * 3), axis=-1).reshape(-1, 3)


def _parts(random: np.random.Generator, count: int) -> Points:
    """Pieces that touch nothing."""
    centers = random.normal(0, 50, (max(count // 20, 1), 3))
    return centers[np.arange(count) % len(centers)] + random.normal(0, 0.1, (count, 3))


SHAPES: dict[str, Shape] = {
    "plant": _plant,
    "nothing": lambda random, count: np.zeros((0, 3)),
    "same point": lambda random, count: np.full((count, 3), 1.25),
    "line": lambda random, count: np.outer(random.random(count), [1.0, 2.0, 3.0]),
    "upright line": lambda random, count: np.outer(np.arange(count), [0.0, 0.0, 1.0]),
    "plane": lambda random, count: random.random((count, 3)) * [1.0, 0.0, 2.0],
    "level plane": lambda random, count: random.random((count, 3)) * [1.0, 1.0, 0.0],
    "cloud": lambda random, count: random.normal(size=(count, 3)),
    "sphere": lambda random, count: _unit(random.normal(size=(count, 3))),
    "ring": lambda random, count: _ring(2 * np.pi * np.arange(count) / max(count, 1)),
    "grid": _grid,
    "two blobs": lambda random, count: (
        random.normal(size=(count, 3)) + 1e6 * (np.arange(count)[:, None] % 2)
    ),
    "one far": lambda random, count: np.concatenate([_plant(random, count), [[1e15, 0.0, 0.0]]]),
    "duplicates": lambda random, count: random.integers(0, 3, (count, 3)).astype(float),
    "parts": _parts,
    "upside down": lambda random, count: -_plant(random, count),
    "some NaN": _some(np.nan),
    "all NaN": lambda random, count: np.full((count, 3), np.nan),
    "some infinite": _some(np.inf),
    "some 1e30": _some(1e30),
    "some -1e38": _some(-1e38),
    "some 1e300": _some(1e300),
    "some 1e-30": _some(1e-30),
    "all sizes": lambda random, count: (
        random.normal(size=(count, 3)) * 10.0 ** random.uniform(-40, 37, (count, 1))
    ),
}


def _unit(points: Points) -> Points:
    return points / np.maximum(np.linalg.norm(points, axis=1, keepdims=True), 1e-9)


def _ring(angle: NDArray[np.float64]) -> Points:
    return np.column_stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)])


LABELS: dict[str, Callable[[np.random.Generator, Points], NDArray[Any]]] = {
    "one": lambda random, points: np.ones(len(points), np.int64),
    "few": lambda random, points: np.arange(len(points)) * 5 // max(len(points), 1),
    "scattered": lambda random, points: random.integers(0, 4, len(points)),
    "all different": lambda random, points: np.arange(len(points)),
    "negative": lambda random, points: -1 - np.arange(len(points)) * 3 // max(len(points), 1),
    "huge": lambda random, points: 2**62 + np.arange(len(points)) % 3 * 2**60,
    "extreme": lambda random, points: np.where(np.arange(len(points)) % 2, 2**63 - 1, -(2**63)),
    "an organ of one point": lambda random, points: (np.arange(len(points)) == 0).astype(int),
    "whole floats": lambda random, points: np.round(random.uniform(0, 3, len(points))),
    "fractions": lambda random, points: random.uniform(0, 3, len(points)),
    "NaN": lambda random, points: np.where(random.random(len(points)) < 0.1, np.nan, 1.0),
}


@dataclass(frozen=True)
class Scan:
    """One scan: a shape of `SHAPES` with about `count` points, and how it is written.

    labels: of `LABELS`, or None.
    """

    shape: str
    count: int
    seed: int = 0
    labels: str | None = None
    colors: bool = False
    scale: float = 1.0
    offset: float = 0.0

    def points(self) -> Points:
        random = np.random.default_rng(self.seed)
        with np.errstate(over="ignore"):
            return SHAPES[self.shape](random, self.count) * self.scale + self.offset

    def write(self, path: Path) -> None:
        """A PLY where labels are floats, else a PCD, whose integers have 64 bits."""
        points, random = self.points(), np.random.default_rng([self.seed, 1])
        columns = {"x": points[:, 0], "y": points[:, 1], "z": points[:, 2]}
        if self.colors:
            for name in ("red", "green", "blue"):
                columns[name] = random.integers(0, 256, len(points)).astype(np.uint8)
        if self.labels:
            columns["label"] = LABELS[self.labels](random, points)
        path.write_bytes(pcd_bytes(columns))


@dataclass(frozen=True)
class Series:
    """Scans in order, and what `baker.Options` says besides `workers`."""

    scans: tuple[Scan, ...]
    options: dict[str, Any] = field(default_factory=dict)

    def write(self, folder: Path) -> list[Path]:
        paths = [folder / f"day{day:02d}.pcd" for day in range(len(self.scans))]
        for path, scan in zip(paths, self.scans, strict=True):
            scan.write(path)
        return paths


def check_series(series: Series, folder: Path) -> str:
    """Bake the series in an empty folder; returns "baked", or the sentence that refuses it.

    Raises AssertionError for a clip that doesn't hold, and whatever a bake should not raise;
    warnings are errors.
    """
    import gclip
    from baker import Options
    from baker.pipeline import bake_with_survey
    from gclip.errors import UserError

    paths = series.write(folder)
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        warnings.simplefilter("error", UserWarning)
        try:
            clip, record = bake_with_survey(paths, Options(workers=1, **series.options))
            clip.save(folder / "plant.gclip")
            opened = gclip.open(folder / "plant.gclip")
            _check_clip(opened, record, series)
        except UserError as error:
            _check_sentence(str(error), paths)
            return str(error)
    return "baked"


def _check_sentence(sentence: str, paths: list[Path]) -> None:
    assert "\n" not in sentence, f"more than a line: {sentence!r}"
    assert 10 < len(sentence) < 600, f"no sentence: {sentence!r}"
    named = any(path.name in sentence for path in paths) or "--" in sentence
    assert named, f"names neither a scan nor an option: {sentence!r}"


def _check_clip(clip: Any, record: Any, series: Series) -> None:
    frames = record.aligned.keyframes
    assert [scan.points for scan in clip.scans] == [len(frame.positions) for frame in frames]
    exact = not series.options.get("smooth")
    whole = np.concatenate([frame.positions for frame in frames]).astype(float)
    size = np.ptp(whole, axis=0).max()
    middle = (whole.max(axis=0) + whole.min(axis=0)) / 2
    for k, interval in enumerate(clip.intervals):
        for share in (0.0, 0.25, 0.5, 0.9, 1.0):
            frame = clip.at(interval.start + share * (interval.end - interval.start))
            assert np.isfinite(frame.local).all(), "positions that aren't finite"
            if len(frame):
                beyond = np.abs(frame.local - middle).max() / max(size, 1e-300)
                assert size == 0 or beyond < 3, f"{beyond} sizes away from the scans"
        if exact:
            step = 0.0 if interval.box is None else float(interval.box.step.max())
            _check_same_set(clip.at(interval.start).local, frames[k].positions, step)
    if exact:
        _check_same_set(clip.at(clip.times[-1]).local, frames[-1].positions, step)


def _check_same_set(shown: NDArray[Any], scan: NDArray[Any], step: float) -> None:
    from scipy.spatial import cKDTree

    shown, scan = shown.astype(float), scan.astype(float)
    near = step + 2.0**-22 * np.abs(scan).max()
    missed = cKDTree(shown).query(scan)[0].max()
    made_up = cKDTree(scan).query(shown)[0].max()
    assert missed <= near, f"a point of the scan is missed by {missed} (allowed {near})"
    assert made_up <= near, f"a point is {made_up} from all of the scan (allowed {near})"


def _maybe(strategy: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    return st.none() | strategy


_OPTIONS = {
    "paper": st.just(True),
    "segment": st.sampled_from(["thin", "organs"]),
    "labels": st.sampled_from(["consistent", "independent", "ignore"]),
    "decay": st.sampled_from(["fade", "remove"]),
    "paths": st.sampled_from(["straight", "curved"]),
    "transport": st.sampled_from(["exact", "sinkhorn", "whole"]),
    "smooth": st.just(True),
    "even": st.sampled_from([0.0, 0.3, 4.0]),
    "resample": st.sampled_from([10, 60]),
    "voxel": st.sampled_from([1e-300, 1e-3, 0.5, 1e10, 1e300]),
    "outliers": st.sampled_from([1e-9, 0.5, 2.0]),
    "up": st.sampled_from(["x", "y", "z", "-x", "-z"]),
    "align": st.sampled_from(["icp", "none"]),
    "holdout": st.sampled_from([2, 3]),
    "bifurcation": st.sampled_from([0, 5, 10**9]),
    "bud": st.sampled_from([1, 1000]),
    "root": st.sampled_from(["virtual", (0.0, 0.0, 0.0), (1e30, 0.0, 0.0)]),
    "neighbors": st.sampled_from([1, 200]),
    "graph_neighbors": st.sampled_from([1, 200]),
    "colors": st.sampled_from(["segment", "none"]),
    "precision": st.just("float32"),
    "every": st.just(2),
}


ROUGH = [
    "nothing", "all NaN", "some NaN", "some infinite", "some 1e30", "some -1e38", "some 1e300",
    "some 1e-30", "all sizes", "one far",
]  # fmt: skip
"""Shapes that are refused, or that reading makes harmless."""


@st.composite
def all_series(draw: st.DrawFn, most: int = 400) -> Series:
    """Series of up to five scans, more often than not of one scale and with the same labels."""
    rare = st.integers(0, 9).map(lambda number: number == 9)
    sound = [name for name in SHAPES if name not in ROUGH]
    labels = draw(_maybe(st.sampled_from(list(LABELS))))
    usual = draw(st.sampled_from(sound))
    scale = draw(st.sampled_from([1e-30, 1e-6, 1e6, 1e30])) if draw(rare) else 1.0
    offset = draw(st.sampled_from([5e6, -1e12])) if draw(rare) else 0.0
    scans = []
    for _ in range(1 if draw(rare) else draw(st.integers(2, 5))):
        shape = draw(st.sampled_from(ROUGH if draw(rare) else [usual, "plant", *sound]))
        count = draw(st.sampled_from([1, 2, 3, 4, 5, 10, 30, 31, 100, most]))
        own = draw(_maybe(st.sampled_from(list(LABELS)))) if draw(rare) else labels
        scans.append(Scan(shape, count, draw(st.integers(0, 3)), own, draw(rare), scale, offset))
    chosen = draw(st.lists(st.sampled_from(list(_OPTIONS)), max_size=4, unique=True))
    return Series(tuple(scans), {name: draw(_OPTIONS[name]) for name in chosen})
