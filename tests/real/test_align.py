"""Plants whose scans stand anyhow, against the same plants in one frame."""

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest

from baker.alignment.icp import fit_rigid
from baker.alignment.register import align
from baker.alignment.sample import even_sample
from baker.alignment.up_axis_search import find_up
from baker.geometry.up_axis import Vertical
from baker.scans.read import read_series
from tests.baker.series import series_of
from tests.real.series import EXAMPLE, GROWN, SHARED, present

ALIGNED = (
    "maize_control_plant1",
    "tomato2_control_plant3",
    "sorghum_control_plant1",
    "tobacco_heat_plant3",
    "tomato1_control2_plant1",
)


@cache
def tables_of(folder):
    return [np.loadtxt(path) for path in sorted(folder.glob("*.txt"))]


def clouds_of(folder):
    return [table[:, :3].astype(np.float32) for table in tables_of(folder)]


def example_clouds():
    return [scan.points for scan in read_series([EXAMPLE]).scans]


def moved(cloud, transform):
    return (cloud @ transform[:3, :3].T + transform[:3, 3]).astype(np.float32)


def assert_steps_agree(found, truth, up):
    """From each scan to the one before it: yaw within 3.5 degrees, tilt within 0.1."""
    frame = Vertical.named(up).to_z
    for pair, true_pair in zip(pairwise(found), pairwise(truth), strict=True):
        step, wanted = (np.linalg.inv(a) @ b for a, b in (pair, true_pair))
        turn = frame @ step[:3, :3] @ wanted[:3, :3].T @ frame.T
        assert abs(np.degrees(np.arctan2(turn[1, 0], turn[0, 0]))) < 3.5
        assert np.degrees(np.arccos(np.clip(turn[2, 2], -1.0, 1.0))) < 0.1


@pytest.mark.parametrize("up", ["z", "y"])
def test_it_does_not_matter_how_each_scan_stands(series, up):
    clouds = clouds_of(series(GROWN))
    random, poses = np.random.default_rng(3), []
    for _ in clouds:
        yaw = random.uniform(-np.pi, np.pi)
        pose = np.eye(4)
        pose[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
        pose[:3, 3] = random.uniform(-50.0, 50.0, 3)
        pose[:3] = Vertical.named(up).to_z.T @ pose[:3]
        poses.append(pose)
    found = align(series_of(list(map(moved, clouds, poses))))
    truth = [
        transform @ np.linalg.inv(pose)
        for transform, pose in zip(align(series_of(clouds)).transforms, poses, strict=True)
    ]
    assert found.up == up
    assert_steps_agree(found.transforms, truth, up)


@pytest.mark.parametrize(
    ("name", "up"),
    [
        (name, up)
        for name, up in (
            ("maize_control_plant1", "z"),
            ("tomato2_control_plant3", "z"),
            ("sorghum_control_plant1", "y"),
        )
        if present(name)
    ]
    or [(GROWN, "z")],
)
def test_every_pair_is_turned_rightly(series, name, up):
    table = clouds_of(series(name))
    scans = table if name == GROWN else clouds_of(SHARED / "unaligned" / name)
    # The copies have their points in the same order: so the true move is known exactly.
    truth = [fit_rigid(scan.astype(float), there) for scan, there in zip(scans, table, strict=True)]
    found = align(series_of(scans))
    assert found.up == up
    assert_steps_agree(found.transforms, truth, up)


@pytest.mark.parametrize("name", [GROWN, *present(*ALIGNED)])
@pytest.mark.parametrize("labelled", [True, False])
@pytest.mark.parametrize("few", [False, True])
def test_series_in_one_frame_stay(series, name, labelled, few):
    tables = tables_of(series(name))
    tables = [tables[0], tables[len(tables) // 2], tables[-1]] if few else tables
    labels = [table[:, 3].astype(int) for table in tables] if labelled else None
    found = align(series_of([table[:, :3] for table in tables], labels))
    assert found.up == "z"
    assert all(np.array_equal(transform, np.eye(4)) for transform in found.transforms)


@pytest.mark.parametrize("name", present(*ALIGNED) or [GROWN])
def test_labelled_scans_turned_at_random_come_back(series, name):
    tables = tables_of(series(name))
    random, clouds, truth = np.random.default_rng(7), [], []
    for table in tables:
        yaw, move = random.uniform(-np.pi, np.pi) if clouds else 0.0, np.eye(4)
        move[:2, :2] = [[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]]
        move[:2, 3] = random.normal(size=2) * 30.0 * bool(clouds)
        clouds.append(moved(table[:, :3], move))
        truth.append(move)
    found = align(series_of(clouds, [table[:, 3].astype(int) for table in tables])).transforms
    placed = [transform @ move for transform, move in zip(found, truth, strict=True)]
    steps = [np.linalg.inv(a) @ b for a, b in pairwise(placed)]
    yaws = np.array([abs(np.degrees(np.arctan2(step[1, 0], step[0, 0]))) for step in steps])
    assert (yaws > 15.0).mean() <= 0.25
    assert np.median(yaws) < 6.0  # labels in the frame that the scanner gave say no less


@pytest.mark.parametrize("name", ["the example", *present(*ALIGNED)])
def test_z_or_y_is_found_and_any_other_axis_is_found_or_named(series, name):
    clouds = example_clouds() if name == "the example" else clouds_of(series(name))
    samples = [even_sample(cloud) for cloud in clouds]
    for up in ("x", "y", "z", "-x", "-y", "-z"):
        turn = Vertical.named(up).to_z
        turned = [replace(s, pool=s.pool @ turn, points=s.points @ turn) for s in samples]
        found, (finding, *_) = find_up(turned)
        assert found == up or (up not in "yz" and finding.option == f"--up {up}")


@pytest.mark.parametrize("folder", [EXAMPLE, *(SHARED / n for n in present("tomato_fullres"))])
def test_the_tomato_stays_as_its_makers_turned_it(folder):
    found = align(read_series([folder]))
    assert found.up == "z"
    assert np.array_equal(found.transforms[1], np.eye(4))
