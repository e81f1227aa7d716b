"""Trees: a trunk, several orders of branches, and leaves on the young twigs."""

from dataclasses import dataclass, replace

import numpy as np

from grow.part import Change, Part, blade_outline, random_deviations, tapered_radii
from grow.species import Species

BRANCH_DAYS = 56.0  # duration of the growth of a branch
GOLDEN_ANGLE = np.pi * (3 - 5**0.5)  # radians, between successive branches or leaves
# Colours, sRGB from 0 to 1.
BARK, TWIG = (0.42, 0.33, 0.25), (0.52, 0.50, 0.28)
LEAF_YOUNG, LEAF = (0.66, 0.82, 0.30), (0.24, 0.52, 0.16)


@dataclass(frozen=True)
class Habit:
    """How a tree branches; lengths in mm, times in days."""

    height: float  # of the mature trunk
    radius: float  # of the mature trunk at its base
    branches: tuple[int, ...]  # number of branches on each part, by order (trunk, branch, twig)
    ratio: tuple[float, ...]  # length of the longest branches : length of their parent, by order
    leaves: int = 0  # number of leaves on every branch
    birth: float = -60.0  # of the trunk
    duration: float = 110.0  # of the growth of the trunk
    apical: float = 0.6  # gradient of the trunk, see `Part`


def grow(rng: np.random.Generator) -> Species:
    """A young tree in leaf, six scans in thirty days."""
    habit = Habit(2600.0, 30.0, (15, 7), (0.55, 0.52), leaves=9)
    return Species(_parts(rng, habit), (0.0, 34.0), tuple(range(0, 31, 6)), (8000, 40000), 1.5)


def tree1(rng: np.random.Generator) -> Species:
    """A bare sapling of the size of the paper's Synthetic Tree 1, thinner than its spacing."""
    habit = Habit(2400.0, 6.0, (9, 4), (0.62, 0.55))
    return Species(_parts(rng, habit), (0.0, 34.0), (0.0, 10.0, 20.0, 30.0), (778, 2253), 2.0)


def tree2(rng: np.random.Generator) -> Species:
    """A bare tree of the size of the paper's Synthetic Tree 2."""
    habit = Habit(6500.0, 95.0, (20, 9, 6), (0.56, 0.50, 0.45))
    return Species(_parts(rng, habit), (0.0, 34.0), (0.0, 30.0), (77448, 326032), 3.0)


def _parts(rng: np.random.Generator, habit: Habit) -> tuple[Part, ...]:
    """The trunk, the branches of all orders, and the leaves."""
    trunk = Part(
        label=0,
        kind="trunk",
        parent=-1,
        at=0.0,
        azimuth=0.0,
        birth=habit.birth,
        duration=habit.duration,
        length=habit.height,
        gradient=habit.apical,
        width=tapered_radii(habit.radius, 0.08 * habit.radius),
        tube=True,
        young=TWIG,
        mature=BARK,
        lag=1.3,
        deviations=random_deviations(rng, 0.07, 1.5),
    )
    parts, parents = [trunk], [0]
    for order, number in enumerate(habit.branches):
        new_branches: list[int] = []
        for parent in parents:
            branches = _branches(rng, parts[parent], parent, number, habit.ratio[order], order)
            for branch in branches:
                new_branches.append(len(parts))
                parts.append(replace(branch, label=len(parts)))
        parents = new_branches
    if habit.leaves:
        for index in range(1, len(parts)):
            parts += _leaves(rng, parts[index], index, habit.leaves)
    return tuple(parts)


def _branches(
    rng: np.random.Generator, parent: Part, index: int, number: int, ratio: float, order: int
) -> list[Part]:
    """The branches of one parent, from its base to its tip, without their labels."""
    azimuth = rng.uniform(0, 2 * np.pi)
    branches = []
    for position in range(number):
        low = 0.22 if order == 0 else 0.2
        at = low + (0.93 - low) * (position + rng.uniform(-0.3, 0.3) + 0.3) / number
        azimuth += GOLDEN_ANGLE + rng.normal(0, 0.25)
        crown = np.interp(at, [0, 0.2, 0.45, 1.0], [0.7, 0.8, 1.0, 0.3])
        length = parent.length * ratio * crown * rng.uniform(0.75, 1.15)
        parent_radius = np.interp(at, np.linspace(0, 1, len(parent.width)), parent.width)
        radius = min(0.7 * parent_radius, 0.0115 * length)
        birth = parent.birth + parent.gradient * parent.duration * at + rng.uniform(1.0, 4.0)
        branches.append(
            Part(
                label=-1,
                kind="branch",
                parent=index,
                at=at,
                azimuth=azimuth,
                birth=birth,
                duration=BRANCH_DAYS,
                length=length,
                gradient=0.5,
                width=tapered_radii(radius, 0.15 * radius),
                tube=True,
                young=TWIG,
                mature=BARK,
                opening=30.0,
                upright=0.15,
                lean=Change(0.45, rng.uniform(0.8, 1.15)),
                bend=Change(-0.1, rng.uniform(-0.65, -0.2)),
                lag=1.3,
                deviations=random_deviations(rng, 0.16, 1.6),
            )
        )
    return branches


def _leaves(rng: np.random.Generator, branch: Part, index: int, number: int) -> list[Part]:
    """The leaves of one branch, with its label, since a branch with its leaves is one organ."""
    azimuth = rng.uniform(0, 2 * np.pi)
    leaves = []
    for position in range(number):
        at = 0.3 + 0.7 * (position + 1) / number
        azimuth += GOLDEN_ANGLE
        birth = branch.birth + branch.gradient * branch.duration * min(at, 0.97)
        length = rng.uniform(75, 110)
        leaves.append(
            Part(
                label=branch.label,
                kind="branch",
                parent=index,
                at=at,
                azimuth=azimuth,
                birth=birth + rng.uniform(0.3, 1.5),
                duration=14.0,
                length=length,
                width=np.maximum(blade_outline(0.30 * length, 0.05, 0.9, 0.8), 1.0),
                tube=False,
                young=LEAF_YOUNG,
                mature=LEAF,
                rib=(0.50, 0.70, 0.30),
                opening=9.0,
                upright=0.5,
                lean=Change(0.2, rng.uniform(0.9, 1.5)),
                bend=Change(0.0, rng.uniform(0.3, 1.0)),
                roll=Change(1.5, 0.25),
                fold=0.2,
                twist=Change(0.0, rng.normal(0, 0.3)),
            )
        )
    return leaves
