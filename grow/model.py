"""A plant as a function of time: point clouds, organs, and the position of any tissue."""

from dataclasses import dataclass
from functools import cached_property
from importlib import import_module

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError
from grow.color import shade
from grow.kinds import KINDS
from grow.pose import Body, Pose
from grow.species import Species
from grow.surface import Material, areas, positions, sample

MIN_ORGAN_POINTS = 8  # no scan has an organ with fewer points


@dataclass(frozen=True)
class Cloud:
    """A scan of a plant at one time."""

    points: NDArray[np.float32]  # (N, 3) mm, z up, the base of the stem at the origin
    labels: NDArray[np.int64]  # (N,) organ of each point, the same at all times
    colors: NDArray[np.uint8] | None  # (N, 3) sRGB
    material: Material  # the tissue of each point, without noise

    def __len__(self) -> int:
        return len(self.points)


@dataclass(frozen=True)
class Organ:
    """One organ at one time, in mm and mm²."""

    label: int
    kind: str
    parent: int  # label of the organ that it grows from, -1 for the stem or trunk
    birth: float  # day
    length: float  # of the main axis; of a compound leaf, of the stalk and its terminal leaflet
    area: float  # of the surface, one side of leaves
    base: tuple[float, float, float]  # start of the main axis, on the surface of the parent
    tip: tuple[float, float, float]  # end of the main axis
    reach: float  # distance from the base to the farthest tip along the axes of all parts


class Plant:
    """A plant, the positions of whose tissue are known at every time.

    Attributes
    ----------
    days : (float, float)
        First and last day for which the plant is designed; it may be sampled on other days, too.
    default_days : tuple of float
        Days of the default series of scans.
    default_noise : float
        Default standard deviation of the noise, mm.
    """

    def __init__(self, kind: str, seed: int, species: Species) -> None:
        self.kind = kind
        self.seed = seed
        self.days = species.days
        self.default_days = species.scan_days
        self.default_noise = species.noise
        self._scan_points = species.scan_points
        self._body = Body(species.parts)

    def cloud(
        self,
        day: float,
        points: int | None = None,
        seed: int = 0,
        noise: float | None = None,
        colors: bool = True,
    ) -> Cloud:
        """Scan the plant: sample points uniformly by area, with Gaussian noise.

        Parameters
        ----------
        day : float
        points : int, optional
            Their number; by default that of the default series, in proportion to the surface.
        seed : int
            Of the scan; scans of different seeds or days are sampled independently.
        noise : float, optional
            Standard deviation in mm; by default `default_noise`.
        colors : bool
            Whether points have colours.

        Returns
        -------
        Cloud
        """
        count = self.default_points(day) if points is None else points
        pose = self._body.pose(day)
        rng = np.random.default_rng([self.seed, seed, _bits(day)])
        material = sample(self._visible_area(day, count), count, rng)
        exact = positions(self._body, pose, material)
        deviation = self.default_noise if noise is None else noise
        noisy = exact + rng.normal(0, 1, exact.shape) * deviation
        paint = shade(self._body, pose, material, rng) if colors else None
        return Cloud(noisy.astype(np.float32), self.label_of(material), paint, material)

    def track(self, material: Material, day: float) -> NDArray[np.float64]:
        """(N, 3) positions of tissue at a day, mm; of unborn tissue where it will emerge."""
        return positions(self._body, self._body.pose(day), material)

    def label_of(self, material: Material) -> NDArray[np.int64]:
        """(N,) label of the organ of each point of tissue."""
        return self._body.label[material.part]

    def born(self, material: Material, day: float) -> NDArray[np.bool_]:
        """(N,) whether the part of each point was born before `day`."""
        return self._body.column("birth")[material.part] < day

    @property
    def labels(self) -> NDArray[np.int64]:
        """Labels of all organs at any time, 0, 1, 2, ..."""
        return np.unique(self._body.label)

    def organs(self, day: float) -> list[Organ]:
        """The organs born before `day`, in the order of their labels."""
        body, pose = self._body, self._body.pose(day)
        area = np.bincount(body.label, areas(body, pose).sum((1, 2)))
        main = np.unique(body.label, return_index=True)[1]
        axes = [self._main_axis(index) for index in main.tolist()]
        return [
            Organ(
                label,
                body.parts[first].kind,
                int(body.label[body.parent[first]]) if body.parent[first] >= 0 else -1,
                body.parts[first].birth,
                float(pose.length[[first, *following]].sum()),
                float(area[label]),
                tuple(pose.axis[first, 0].tolist()),
                tuple(pose.axis[[first, *following][-1], -1].tolist()),
                self._reach(label, pose),
            )
            for label, (first, *following) in enumerate(axes)
            if body.parts[first].birth < day
        ]

    def _reach(self, label: int, pose: Pose) -> float:
        """Distance from an organ's base along its axes to its farthest tip, mm."""
        body, distances, farthest = self._body, dict[int, float](), 0.0
        for part in np.flatnonzero(body.label == label).tolist():
            parent, distance = int(body.parent[part]), 0.0
            if parent in distances:
                steps = np.linalg.norm(np.diff(pose.axis[parent], axis=0), axis=1).cumsum()
                along = np.linspace(0.0, 1.0, len(steps) + 1)
                distance = float(np.interp(body.at[part], along, np.r_[0.0, steps]))
                distance += distances[parent]
            distances[part] = distance
            farthest = max(farthest, distance + float(pose.length[part]))
        return farthest

    def _main_axis(self, first: int) -> list[int]:
        """The parts of an organ's main axis from base to tip, each at the end of the previous."""
        chain, parts = [first], self._body.parts
        while True:
            successors = [
                index
                for index, part in enumerate(parts)
                if part.parent == chain[-1] and part.at == 1.0 and part.label == parts[first].label
            ]
            if not successors:
                return chain
            chain.append(successors[0])

    def default_points(self, day: float) -> int:
        """Number of points of a default scan at `day`, interpolated by surface area."""
        counts, areas = self._scan_points, self._default_areas
        added = (counts[1] - counts[0]) * (self.area(day) - areas[0]) / (areas[1] - areas[0])
        return max(round(counts[0] + added), 1)

    @cached_property
    def _default_areas(self) -> tuple[float, float]:
        """The surface areas at the first and the last day of the default series."""
        return self.area(self.default_days[0]), self.area(self.default_days[-1])

    def area(self, day: float) -> float:
        """The surface area at `day`, mm²; it never shrinks."""
        return float(self._area(day).sum())

    def _visible_area(self, day: float, count: int) -> NDArray[np.float64]:
        """Areas, with 0 for organs that would have too few of `count` points."""
        area = self._area(day)
        organ_area = np.bincount(self._body.label, area.sum((1, 2)))
        is_visible = organ_area * count >= MIN_ORGAN_POINTS * organ_area.sum()
        is_visible[np.argmax(organ_area)] = True
        return area * is_visible[self._body.label][:, None, None]

    def _area(self, day: float) -> NDArray[np.float64]:
        """(P, NODES - 1, STRIPES) areas of the cells of all parts at a day, mm²."""
        return areas(self._body, self._body.pose(day))


def plant(kind: str, seed: int = 0) -> Plant:
    """Make a plant; the same kind and seed give the same plant.

    Parameters
    ----------
    kind : str
        One of `KINDS`. tree1 and tree2 are bare trees like those of the paper's Table 1: four
        scans of 778 to 2,253 points; two scans of 77,448 and 326,032 points.
    seed : int

    Returns
    -------
    Plant

    Raises
    ------
    InputError
        For an unknown kind or a negative seed.
    """
    if kind not in KINDS:
        raise InputError(f"unknown plant {kind!r}: choose one of {', '.join(KINDS)}.")
    if seed < 0:
        raise InputError(f"the seed is {seed}; it must be 0 or more.")
    module = import_module(f"grow.{kind.rstrip('12')}")
    rng = np.random.default_rng([seed, *kind.encode()])
    species: Species = module.grow(rng) if kind[-1] not in "12" else getattr(module, kind)(rng)
    return Plant(kind, seed, species)


def _bits(day: float) -> int:
    """The bits of a number as an integer, part of the seed of a scan."""
    return int(np.float64(day + 0.0).view(np.uint64))
