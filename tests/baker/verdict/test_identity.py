"""Whether an organ is still the same organ."""

from __future__ import annotations

import numpy as np
import pytest

from baker import Options
from baker.pipeline import bake_with_survey
from traits.doubts import doubts_of


def leaf(azimuth: float, length: float, height: float, label: int, scan: int = 0) -> np.ndarray:
    """(300, 4) x y z label: a blade of width 2 that rises from a stem on the z axis.

    scan: each one has other points of the same surface.
    """
    along, across = np.random.default_rng((label, scan)).random((2, 300, 1))
    outwards = np.array([np.cos(azimuth), np.sin(azimuth), 0.4])
    aside = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    points = [0, 0, height] + length * along * outwards + 2 * (across - 0.5) * aside
    return np.column_stack([points, np.full(300, label)])


@pytest.fixture
def series(tmp_path):
    """Write a stem with leaves, one scan a day; return what the bake doubts."""

    def doubts(
        *scans: list[np.ndarray], labels: str = "independent"
    ) -> list[tuple[float, str, bool]]:
        stem = np.random.default_rng(0).random((300, 1)) * [0, 0, 20]
        for day, leaves in enumerate(scans):
            rows = [np.column_stack([stem, np.zeros(300)]), *leaves]
            np.savetxt(tmp_path / f"day{day}.txt", np.concatenate(rows), fmt="%.4f")
        options = Options(align="none", up="z", labels=labels, workers=1)
        clip, _ = bake_with_survey([tmp_path], options)
        return [(doubt.start, doubt.what, doubt.identity) for doubt in doubts_of(clip)]

    return doubts


def test_leaves_that_grow_are_sure(series):
    days = [[leaf(a, 5 + day, 8 + 4 * a, n) for n, a in ((1, 0), (2, 2))] for day in range(3)]
    assert series(*days) == []


def test_a_leaf_that_suddenly_is_many_times_as_large_is_doubtful(series):
    small = [leaf(0, 8, 8, 1), leaf(2, 1, 16, 2), leaf(4, 8, 12, 3)]
    large = [leaf(0, 8, 8, 1), leaf(2, 16, 16, 2), leaf(4, 8, 12, 3)]
    found = series(small, small, large)
    assert [day for day, _, identity in found if identity] == [1.0]
    assert "may be two organs (suddenly much larger)" in found[-1][1]


def test_a_large_leaf_that_vanishes_is_doubtful(series):
    leaves = [leaf(0, 8, 8, 1), leaf(2, 8, 12, 2), leaf(4, 8, 16, 3)]
    found = series(leaves, leaves, leaves[:2])
    assert [(day, identity) for day, _, identity in found] == [(1.0, True)]
    assert "is large but vanishes" in found[0][1]


def test_leaves_that_might_as_well_be_each_other_are_doubtful(series):
    quarters = enumerate((0, 0, np.pi / 2))
    found = series(*[[leaf(a + n * np.pi, 8, 12, n, scan) for n in (1, 2)] for scan, a in quarters])
    assert {day for day, _, identity in found if identity} == {1.0}
    assert {what for _, what, identity in found if identity} == {
        "leaf 1 and leaf 2 may be mixed up"
    }


@pytest.mark.parametrize("exchanged", [None, 1, 2])
def test_labels_that_are_exchanged_in_one_scan_are_doubtful(series, exchanged):
    scans = []
    for day in range(4):
        labels = (2, 1, 3) if day == exchanged else (1, 2, 3)
        places = zip(labels, (0.0, 2.0, 4.0), (8, 12, 16), strict=True)
        scans.append([leaf(a, 5 + day, height, label, day) for label, a, height in places])
    found = series(*scans, labels="consistent")
    if exchanged is None:
        assert found == []
        return
    assert {day for day, _, identity in found if identity} == {exchanged - 1.0, float(exchanged)}
    assert {what for _, what, identity in found if identity} == {
        "leaf 1 and leaf 2 may be mixed up"
    }
