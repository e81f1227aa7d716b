"""Organs start at the same place in all scans, whatever one of them shows by itself."""

from __future__ import annotations

import numpy as np
import pytest

from baker.matching.borders import align_borders, running_medians
from baker.matching.labels import LabelUse, with_tracked_labels
from tests.baker.segmentation.seedling import seedling

LEAF = 2


@pytest.fixture
def series() -> tuple[list[np.ndarray], list[np.ndarray], list[int]]:
    """Points, tracks and base of five scans of a seedling that grows."""
    scans = [seedling(size=5.0 + 0.5 * day, seed=day) for day in range(5)]
    clouds, tracks = [cloud for cloud, _ in scans], [labels for _, labels in scans]
    return clouds, tracks, [int(cloud[:, 2].argmin()) for cloud in clouds]


def with_petiole(cloud: np.ndarray, tracks: np.ndarray) -> np.ndarray:
    """The tracks where the petiole and a piece of the stem belong to the leaf."""
    base = cloud[tracks == LEAF]
    base = base[np.hypot(base[:, 0], base[:, 1]).argmin()]
    is_near = np.linalg.norm(cloud - base, axis=1) < 2.5
    return np.where(is_near & (tracks == 0), LEAF, tracks)


@pytest.mark.parametrize("scan", range(5))
def test_a_petiole_that_one_scan_gives_to_its_leaf_is_given_back(series, scan):
    clouds, tracks, bases = series
    found = list(tracks)
    found[scan] = with_petiole(clouds[scan], tracks[scan])
    is_wrong = found[scan] != tracks[scan]
    assert is_wrong.sum() > 100
    aligned = align_borders(clouds, found, bases)
    assert (aligned[scan] != tracks[scan]).sum() < 0.4 * is_wrong.sum()
    kept = [
        (a != t).sum() for k, (a, t) in enumerate(zip(aligned, tracks, strict=True)) if k != scan
    ]
    assert max(kept) < 0.4 * is_wrong.sum()


def test_a_border_that_all_scans_show_stays(series):
    clouds, tracks, bases = series
    found = [with_petiole(*scan) for scan in zip(clouds, tracks, strict=True)]
    for labels in (tracks, found):
        for before, after in zip(labels, align_borders(clouds, labels, bases), strict=True):
            assert (before != after).mean() < 0.01


def test_an_organ_that_was_corrected_keeps_its_border(series):
    clouds, tracks, bases = series
    found = list(tracks)
    found[2] = with_petiole(clouds[2], tracks[2])
    aligned = align_borders(clouds, found, bases, {(2, LEAF)})
    np.testing.assert_array_equal(aligned[2] == LEAF, found[2] == LEAF)


def test_two_scans_do_not_tell_which_border_is_wrong(series):
    clouds, tracks, bases = (side[:2] for side in series)
    found = [with_petiole(clouds[0], tracks[0]), tracks[1]]
    for before, after in zip(found, align_borders(clouds, found, bases), strict=True):
        np.testing.assert_array_equal(before, after)


@pytest.mark.parametrize("values", [[0.98, 0.8, 0.7, 0.65], [0.1, 0.2, 0.3], [0.5, 0.4], [0.3]])
def test_a_trend_is_not_smoothed(values):
    np.testing.assert_array_equal(running_medians(np.array(values)), values)


@pytest.mark.parametrize("k", range(5))
def test_one_value_that_is_off_is_smoothed(k):
    values = np.full(5, 0.6)
    values[k] = 0.2
    np.testing.assert_allclose(running_medians(values), 0.6)


def test_only_organs_found_by_shape_get_other_borders(series):
    clouds, tracks, bases = series
    found = list(tracks)
    found[2] = with_petiole(clouds[2], tracks[2])
    for given, is_kept in ((tuple(found), True), ((None,) * 5, False)):
        use = with_tracked_labels(LabelUse(given, consistent=False), clouds, found, bases)
        numbers = use.available[2]
        leaf, stem = (np.bincount(numbers[found[2] == organ]).argmax() for organ in (LEAF, 0))
        share = (numbers[found[2] != tracks[2]] == (leaf if is_kept else stem)).mean()
        assert share == 1.0 if is_kept else share > 0.7
