"""Real plants: each scan centred on its own, the yaw free, against the same plants aligned."""

import time
from itertools import pairwise

import numpy as np
import pytest

from baker.alignment import align, find_up
from baker.alignment.icp import rigid_fit
from baker.alignment.up_axis_search import upright
from baker.geometry.up_axis import Vertical
from baker.scans import read_series

ALIGNED = [
    "maize_control_plant1",
    "tomato2_control_plant3",
    "sorghum_control_plant1",
    "tobacco_heat_plant3",
    "tomato1_control2_plant1",
]


def clouds_of(folder):
    return [np.loadtxt(path)[:, :3].astype(np.float32) for path in sorted(folder.iterdir())]


@pytest.mark.parametrize(
    ("name", "up"),
    [
        ("maize_control_plant1", "z"),
        ("tomato2_control_plant3", "z"),
        ("sorghum_control_plant1", "y"),
    ],
)
def test_yaw_within_two_degrees_for_every_pair(shared_data, name, up):
    scans, table = clouds_of(shared_data / "unaligned" / name), clouds_of(shared_data / name)
    # The copies have their points in the same order: so the true move is known exactly.
    truth = [rigid_fit(scan.astype(float), there) for scan, there in zip(scans, table, strict=True)]
    begun = time.perf_counter()
    found = align(scans)
    assert time.perf_counter() - begun < 2.0 * (len(scans) - 1)
    assert found.up == up
    frame = upright(Vertical.named(up))
    for pair, true_pair in zip(pairwise(found.transforms), pairwise(truth), strict=True):
        step, wanted = (np.linalg.inv(a) @ b for a, b in (pair, true_pair))
        turn = frame @ step[:3, :3] @ wanted[:3, :3].T @ frame.T
        assert abs(np.degrees(np.arctan2(turn[1, 0], turn[0, 0]))) < 2.0
        assert np.degrees(np.arccos(np.clip(turn[2, 2], -1.0, 1.0))) < 0.1


@pytest.mark.parametrize("name", ALIGNED)
def test_aligned_series_stay_and_stand_up(shared_data, name):
    clouds = clouds_of(shared_data / name)
    found = align(clouds)
    assert found.up == "z"
    assert all(np.array_equal(transform, np.eye(4)) for transform in found.transforms)
    for up in ("x", "y", "-x", "-y", "-z"):
        turn = upright(Vertical.named(up)).astype(np.float32)
        assert find_up([cloud @ turn for cloud in clouds]) == up


def test_full_resolution_is_quick(shared_data):
    scans = read_series([shared_data / "tomato_fullres"]).scans
    begun = time.perf_counter()
    found = align([scan.points for scan in scans])
    assert time.perf_counter() - begun < 5.0
    assert found.up == "z"
    # What turns one into the other in the frame of tomato2_control_plant3, days 3 and 5.
    assert abs(found.drift[0].yaw - 7.1) < 5.0
