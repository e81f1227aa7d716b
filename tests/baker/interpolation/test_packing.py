"""Packing: precise enough, near in memory what is near in space, a prefix is a fair sample."""

import numpy as np
import pytest

from baker.interpolation.packing import Movers, pack_interval
from gclip import Motion
from gclip.schema import BLOCK


def pack(points: np.ndarray, spacing: float, **more):
    movers = Movers(Motion.MOVE, (points, points + 1.0), np.zeros(len(points), int))
    return pack_interval(0.0, 1.0, [movers], spacing=spacing, **more)


def test_quantisation_is_finer_than_a_hundredth_of_the_spacing():
    points = np.random.default_rng(0).random((1000, 3)) * 50
    assert pack(points, spacing=1.0).box is not None
    assert pack(points, spacing=0.01).box is None
    assert pack(points, spacing=1.0, precision="float32").curve[0].dtype == np.float32


def test_flat_and_single_point_clouds_pack():
    flat = np.zeros((5, 3))
    flat[:, 0] = np.arange(5)
    interval = pack(flat, spacing=1.0)
    assert np.isfinite(interval.box.step).all()
    assert len(pack(np.zeros((1, 3)), spacing=1.0)) == 1


def test_all_movers_are_kept():
    points = np.random.default_rng(0).random((1000, 3))
    kept = pack(points, spacing=1.0, precision="float32").curve[0]
    assert np.array_equal(np.sort(kept, axis=0), np.sort(points.astype(np.float32), axis=0))


def test_a_prefix_is_a_fair_sample():
    points = np.random.default_rng(0).random((400 * BLOCK, 3))
    prefix = pack(points, spacing=1.0, precision="float32").curve[0][: 100 * BLOCK]
    for axis in range(3):
        quarters = np.histogram(prefix[:, axis], bins=4, range=(0, 1))[0] / len(prefix)
        assert np.all(quarters > 0.2)


def test_neighbours_in_a_block_are_neighbours_in_space():
    points = np.random.default_rng(0).random((40 * BLOCK, 3))
    block = pack(points, spacing=1.0, precision="float32").curve[0][:BLOCK]
    assert np.prod(np.ptp(block, axis=0)) < 0.2


@pytest.mark.parametrize("count", [0xFFFF, 0x10000])
def test_track_ids_widen_when_they_must(count):
    points = np.random.default_rng(0).random((count + 1, 3))
    movers = Movers(Motion.MOVE, (points, points), np.arange(count + 1))
    interval = pack_interval(0.0, 1.0, [movers], spacing=1.0)
    assert interval.tracks.dtype == (np.uint16 if count == 0xFFFF else np.uint32)


def test_raising_the_degree_changes_no_curve():
    from baker.interpolation.packing import elevate_degree
    from gclip.evaluate import bernstein

    curve = tuple(np.random.default_rng(0).random((3, 5, 3)))
    for low in (1, 2):
        for high in (2, 3):
            for share in (0.0, 0.3, 1.0):
                before, after = curve[: low + 1], elevate_degree(curve[: low + 1], max(high, low))
                assert len(after) == max(high, low) + 1
                expected = np.tensordot(bernstein(low, share), before, 1)
                found = np.tensordot(bernstein(len(after) - 1, share), after, 1)
                assert np.allclose(found, expected)


def test_movers_of_lower_degree_are_raised_to_the_highest():
    straight = Movers(Motion.MOVE, (np.zeros((2, 3)), np.ones((2, 3))), np.zeros(2, int))
    bent = Movers(Motion.FALL, tuple(np.ones((3, 1, 3))), np.ones(1, int))
    interval = pack_interval(0.0, 1.0, [bent, straight], spacing=1.0)
    assert interval.degree == 2
    assert [(g.first, g.count, g.motion) for g in interval.groups] == [
        (0, 2, Motion.MOVE),
        (2, 1, Motion.FALL),
    ]
    middle = interval.box.low + interval.box.step * interval.curve[1][:2]
    assert np.allclose(middle, 0.5, atol=1e-4)
