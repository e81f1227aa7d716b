"""z is up, unless a ground or the whole series says clearly otherwise; what was close is told."""

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


def test_another_axis_is_found_or_named(days):
    for name in ("x", "-x", "-y", "-z"):
        turn = Vertical.named(name).to_z
        up, (finding,) = find_up([even_sample(cloud @ turn) for cloud in days])
        assert up == name or finding.option == f"--up {name}"
