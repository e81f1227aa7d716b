"""Scraps that one scan alone shows: which are given back, and to whom."""

from __future__ import annotations

import numpy as np
import pytest

from baker.matching.glimpses import FEWEST, without_glimpses

STEM, LEAF, SCRAP, NEW = range(4)


def scan(scrap: int, new: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """A stem, a leaf to its right whose tip is a scrap, and a new leaf, on a line of points."""
    counts = [3000, 3000, scrap, new]
    numbers = np.repeat(np.arange(4), counts)
    return np.stack([np.arange(len(numbers)), 0 * numbers, 0 * numbers], axis=1) / 10.0, numbers


def test_a_glimpse_is_what_it_was_cut_from() -> None:
    clouds, tracks = zip(scan(0), scan(FEWEST - 1), scan(0, 30), strict=True)
    found = without_glimpses(clouds, tracks)
    np.testing.assert_array_equal(found[0], tracks[0])
    assert np.bincount(found[1]).tolist() == [3000, 3000 + FEWEST - 1]
    assert np.bincount(found[2]).tolist() == [3000, 3000, 30]  # numbered from 0 without a gap


@pytest.mark.parametrize(
    ("scraps", "why"),
    [
        ((0, FEWEST, 0), "of so many points it may have been an organ"),
        ((0, 9, 9), "it is there again"),
        ((9, 9, 0), "it was there before"),
        ((0, 0, 9), "it may have come to stay"),
    ],
)
def test_what_stays(scraps: tuple[int, ...], why: str) -> None:
    clouds, tracks = zip(*map(scan, scraps), strict=True)
    for before, after in zip(tracks, without_glimpses(clouds, tracks), strict=True):
        np.testing.assert_array_equal(before, after, err_msg=why)


def test_in_a_scan_of_few_points_a_few_are_an_organ() -> None:
    clouds, tracks = zip(scan(0), scan(30), scan(0), strict=True)
    thin = slice(None, None, 10)
    clouds, tracks = [c[thin] for c in clouds], [t[thin] for t in tracks]
    tracks[1] = np.where(np.arange(len(tracks[1])) % 40 == 7, SCRAP, tracks[1])
    found = without_glimpses(clouds, tracks)
    np.testing.assert_array_equal(found[1], tracks[1])
