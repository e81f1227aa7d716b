"""z is up, unless a ground or the whole series says clearly otherwise; what was close is told."""

import numpy as np
import pytest

from baker.alignment.sample import even_sample
from baker.alignment.up_axis_search import find_up
from baker.geometry.up_axis import Vertical


def test_z_is_not_left_for_little(days):
    up, (finding,) = find_up([even_sample(cloud) for cloud in days])
    assert (up, finding.found, finding.doubt) == ("z", "z, as scans usually have it", "")


def test_y_is_found(days):
    turn = Vertical.named("y").to_z
    up, (finding,) = find_up([even_sample(cloud @ turn) for cloud in days])
    assert (up, finding.doubt) == ("y", "")


def test_the_ground_decides(days):
    up, (finding,) = find_up([even_sample(cloud) for cloud in days], ground_up="-z")
    assert up == "-z"
    assert "ground" in finding.found


@pytest.mark.parametrize("name", ["z", "y", "-z", "-y", "x", "-x"])
def test_the_end_that_stays_is_the_lower_one(name):
    """A rod that grows at one end looks the same upside down, and may creep along the ground."""
    rng, turn = np.random.default_rng(0), Vertical.named(name).to_z
    rods = [rng.random((800, 3)) * [1, 1, 10 + 4 * day] for day in range(6)]
    up, (finding,) = find_up([even_sample(rod @ turn) for rod in rods])
    assert (up, finding.option) == (name, "" if name in ("z", "y") else "--up z")
    assert bool(finding.doubt) == bool(finding.option)


@pytest.mark.parametrize("name", ["z", "y"])
def test_a_flat_rosette_grows_along_its_axis(name):
    rng, turn, rosettes = np.random.default_rng(1), Vertical.named(name).to_z, []
    for day in range(1, 6):
        radius, turns = 10 * day * rng.random(2000), 2 * np.pi * rng.integers(0, 9, 2000) / 9
        across = rng.uniform(-0.2, 0.2, 2000) * radius
        x, y = np.cos(turns), np.sin(turns)
        flat = [radius * x - across * y, radius * y + across * x, 0.1 * radius + rng.random(2000)]
        rosettes.append(np.column_stack(flat) @ turn)
    up, (finding,) = find_up([even_sample(rosette) for rosette in rosettes])
    assert up == name
    assert finding.option in ("", "--up z")  # it is so flat that a stem may be anywhere


def test_another_axis_is_found_or_named(days):
    for name in ("x", "-x", "-y", "-z"):
        turn = Vertical.named(name).to_z
        up, (finding,) = find_up([even_sample(cloud @ turn) for cloud in days])
        assert up == name or finding.option == f"--up {name}"
