"""Attachments that belong to the series: a tip that hangs against the stem is no base."""

from __future__ import annotations

import numpy as np
import pytest

from baker.interpolation.organ_shapes import organ_attachments
from baker.matching.match import Match
from baker.segmentation.hierarchy import NO_PARENT, Hierarchy

STEM, LEAF = 400, 300
HEIGHT = 30.0  # at which the leaf is attached


def arch(reach: float, droop: float) -> np.ndarray:
    """(LEAF, 3) a leaf; with droop 1 its tip hangs against the stem, below its base."""
    angle = np.linspace(0, 1, LEAF) * np.pi * (0.4 + 0.6 * droop)
    return np.column_stack(
        [reach * np.sin(angle), np.zeros(LEAF), HEIGHT + 12 * (np.cos(angle) - 1)]
    )


def plant(droop: float) -> np.ndarray:
    stem = np.column_stack([np.zeros((STEM, 2)), np.linspace(0, 50, STEM)])
    return np.concatenate([stem, arch(15.0, droop)[::-1]])  # the tip first, and so its contact


def attachments_of(clouds: list[np.ndarray]) -> list[np.ndarray]:
    parts = np.arange(STEM), np.arange(STEM, STEM + LEAF)
    hierarchy = Hierarchy(parts, (0, 1), (NO_PARENT, 0), 0, organs=(0, 1))
    match = Match(hierarchy, hierarchy, ((0, 0), (1, 1)), (), ())
    count = len(clouds) - 1
    found = organ_attachments(clouds, [0.15] * len(clouds), [match] * count)
    return [attachments[1].mean(axis=0) for attachments in found]


@pytest.mark.parametrize("droops", [(0.0, 1.0), (1.0, 0.0), (0.0, 1.0, 1.0), (1.0, 1.0, 0.0)])
def test_a_tip_that_touches_the_stem_is_no_attachment(droops: tuple[float, ...]) -> None:
    for attachment in attachments_of([plant(droop) for droop in droops]):
        assert attachment[2] == pytest.approx(HEIGHT, abs=1.5)


def test_what_is_born_has_none() -> None:
    parts = np.arange(STEM), np.arange(STEM, STEM + LEAF)
    second = Hierarchy(parts, (0, 1), (NO_PARENT, 0), 0, organs=(0, 1))
    first = Hierarchy(parts[:1], (0,), (NO_PARENT,), 0, organs=(0,))
    match = Match(first, second, ((0, 0),), (1,), ())
    clouds = [plant(0.0)[:STEM], plant(0.0)]
    before, after = organ_attachments(clouds, [0.15, 0.15], [match])
    assert not before
    assert not after
