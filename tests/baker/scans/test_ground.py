"""Ground is found, taken out and told of; plants without any lose nothing."""

from dataclasses import replace

import numpy as np
import pytest

from baker.scans.ground import DIRECTIONS, find_ground, remove_ground
from baker.scans.scan import Scan

NAMES = ["day1", "day2", "day3", "day4", "day5"]
TURNS = {
    "z": np.eye(3),
    "-y": np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]]),
    "-x": np.array([[0, 0, -1.0], [0, 1, 0], [1, 0, 0]]),
}


def plant(rng, size=100.0):
    """A stem with six bent leaves, upright."""
    height = rng.random(1500)
    stem = np.column_stack([np.zeros((1500, 2)), height * size])
    parts = [stem + rng.normal(0, 0.01 * size, stem.shape) * [1, 1, 0]]
    for leaf in range(6):
        along, across = rng.random(800), rng.normal(0, 0.04, 800)
        out = np.array([np.cos(2.4 * leaf), np.sin(2.4 * leaf)])
        flat = 0.6 * along[:, None] * out + across[:, None] * [-out[1], out[0]]
        rise = 0.15 + 0.12 * leaf + 0.5 * along - 0.5 * along**2
        parts.append(size * np.column_stack([flat, rise]))
    return np.concatenate(parts)


def soil(rng, radius, count, roughness, slope=0.0):
    r, t = radius * np.sqrt(rng.random(count)), 2 * np.pi * rng.random(count)
    x, y = r * np.cos(t), r * np.sin(t)
    return np.column_stack([x, y, slope * x + rng.normal(0, roughness, count)])


def shares(left, whole):
    """Of each of some points, whether it is left."""
    kept = {tuple(point) for point in left.tolist()}
    return np.mean([tuple(point) in kept for point in whole.tolist()])


@pytest.mark.parametrize(
    ("radius", "count", "roughness", "slope", "is_labelled", "up"),
    [
        (12, 700, 0.5, 0, False, "z"),
        (12, 700, 0.5, 0, False, "-x"),
        (30, 3000, 1, 0, True, "z"),
        (30, 3000, 1, 0, True, "-y"),
        (70, 900, 1, 0.2, False, "z"),
        (70, 900, 1, 0.2, False, "-y"),
        (200, 9000, 3, 0, False, "z"),
        (50, 4000, 0, 0.1, True, "z"),
        (50, 4000, 0, 0.1, True, "-x"),
    ],
)
def test_soil_is_taken_out_and_the_plant_stays(radius, count, roughness, slope, is_labelled, up):
    rng = np.random.default_rng(2)
    grown = [plant(rng, size).astype(np.float32) @ TURNS[up].T for size in (60, 80, 100)]
    grounds = [soil(rng, radius, count, roughness, slope) @ TURNS[up].T for _ in grown]
    clouds = []
    for points, ground in zip(grown, grounds, strict=True):
        labels = np.repeat([3, -1], [len(points), count]) if is_labelled else None
        clouds.append(Scan(np.concatenate([points, ground]).astype(np.float32), labels))
    left, ground_up, (finding,) = remove_ground(clouds)
    assert ground_up == up
    assert "in 3 of 3 scans" in finding.sentence
    for cloud, points, ground in zip(left, grown, grounds, strict=True):
        assert shares(cloud.points, ground.astype(np.float32)) < (0.06 if radius < 20 else 0.02)
        assert shares(cloud.points, points.astype(np.float32)) > (1 if is_labelled else 0.97) - 1e-9


def test_ground_is_kept_as_asked():
    rng = np.random.default_rng(2)
    clouds = [Scan(np.concatenate([plant(rng, 80), soil(rng, 50, 4000, 1)])) for _ in range(2)]
    kept, up, (finding,) = remove_ground(clouds, keep=True)
    assert all(after is before for after, before in zip(kept, clouds, strict=True))
    assert up == "z"
    assert "kept" in finding.sentence


def test_a_plant_without_ground_loses_nothing():
    rng = np.random.default_rng(3)
    clouds = [Scan(plant(rng, size)) for size in (60, 80, 100)]
    left, ground_up, findings = remove_ground(clouds)
    assert (ground_up, findings) == ("", ())
    assert all(after is before for after, before in zip(left, clouds, strict=True))


@pytest.mark.parametrize("leaves", [7, 9, 10])
def test_a_rosette_below_a_stalk_is_no_ground(leaves):
    """Its leaves are level, cover most of a disc, and have gaps between them."""
    rng, parts = np.random.default_rng(0), []
    for leaf in range(leaves):
        along, across = rng.random(450), rng.uniform(-1, 1, 450)
        width = 0.24 * np.sqrt(np.maximum(1 - (2 * along - 1.15) ** 2 / 0.75, 0))
        out = np.array([np.cos(2.4 * leaf), np.sin(2.4 * leaf)])
        flat = along[:, None] * out + (across * width)[:, None] * [-out[1], out[0]]
        parts.append(50 * np.column_stack([flat, 0.02 * leaf + 0.05 * along]))
    stalk = rng.random((600, 3)) * [1.5, 1.5, 60]
    rosette = np.concatenate([*parts, stalk])
    rosette += rng.normal(0, 0.2, rosette.shape)
    assert find_ground(rosette, "z") is None
    with_soil = np.append(rosette, soil(rng, 70, 4000, 0.5) - [0, 0, 2], axis=0)
    assert find_ground(with_soil, "z") is not None


@pytest.mark.parametrize("leaves", [20, 30])
def test_a_dense_rosette_is_no_ground(leaves):
    """It has no gaps, but leaves that lie on each other are thick."""
    rng, parts = np.random.default_rng(0), []
    for leaf in range(leaves):
        along, across = rng.random(300), rng.uniform(-1, 1, 300)
        length, width = 25 + min(leaf, 20), 0.4 * np.sqrt(np.maximum(along - along**4, 0))
        out = np.array([np.cos(2.4 * leaf), np.sin(2.4 * leaf)])
        flat = along[:, None] * out + (across * width)[:, None] * [-out[1], out[0]]
        height = 0.3 * leaf + length * (0.2 * along + 0.05 * np.abs(across))
        parts.append(np.column_stack([length * flat, height]))
    rosette = np.concatenate(parts)
    assert find_ground(rosette, "z") is None


def test_one_scan_with_ground_among_many_is_named():
    rng = np.random.default_rng(3)
    clouds = [Scan(plant(rng), name=name) for name in NAMES]
    whole = clouds[1]
    clouds[1] = replace(whole, points=np.concatenate([whole.points, soil(rng, 50, 4000, 1)]))
    left, _, (finding,) = remove_ground(clouds)
    assert [after is before for after, before in zip(left, clouds, strict=True)].count(True) == 4
    assert shares(left[1].points, whole.points) > 0.97
    assert "in 1 of 5 scans" in finding.sentence
    assert "only day2" in finding.sentence


def pot(rng, radius, count, rim):
    """Soil, a wall that narrows downwards and goes above the soil by `rim`; a table below."""
    turn, down = 2 * np.pi * rng.random(count), rng.random(count)
    around = radius * (1 - 0.25 * down)[:, None] * np.column_stack([np.cos(turn), np.sin(turn)])
    wall = np.column_stack([around, rim - down * (1.5 * radius + rim)])
    table = np.column_stack([rng.uniform(-3, 3, (count, 2)) * radius, rng.normal(0, 1, count)])
    return np.concatenate([soil(rng, radius, count, 1), wall]), table - [0, 0, 1.5 * radius]


@pytest.mark.parametrize(
    ("radius", "rim", "has_table", "up"),
    [(20, 3, False, "z"), (20, 3, False, "-y"), (40, 10, True, "z"), (40, 10, True, "-x")],
)
def test_a_pot_is_taken_out_with_the_table_under_it(radius, rim, has_table, up):
    rng = np.random.default_rng(4)
    clouds, plants = [], []
    for size in (70, 85, 100):
        potted, table = pot(rng, radius, 3000, rim)
        plants.append((plant(rng, size) @ TURNS[up].T).astype(np.float32))
        ground = np.concatenate([potted, table]) if has_table else potted
        clouds.append(Scan(np.concatenate([plants[-1], (ground @ TURNS[up].T).astype(np.float32)])))
    left, ground_up, findings = remove_ground(clouds)
    assert ground_up == up
    assert "a pot under the plant in 3 of 3 scans" in findings[-1].sentence
    for cloud, points in zip(left, plants, strict=True):
        assert shares(cloud.points, points) > 0.97
        assert len(cloud) < 1.02 * len(points)


@pytest.mark.parametrize("up", DIRECTIONS)
def test_degenerate_clouds_have_no_ground(up):
    rng = np.random.default_rng(0)
    line, square = np.zeros((500, 3)), rng.random((5000, 3))
    line[:, 0], square[:, 2] = np.arange(500), 0
    for points in (
        np.zeros((1, 3)),
        np.eye(3),
        np.zeros((50, 3)),
        line,
        square,
        rng.random((5000, 3)),
    ):
        assert find_ground(points, up) is None or up not in ("z", "-z")
