"""z is up, unless a ground or the whole series says clearly otherwise; what was close is told."""

from baker.alignment.sample import even_sample
from baker.alignment.up_axis_search import find_up, upright
from baker.geometry.up_axis import Vertical


def test_z_is_not_left_for_little(days):
    up, (finding,) = find_up([even_sample(cloud) for cloud in days])
    assert (up, finding.found, finding.doubt) == ("z", "z, as scans usually have it", "")


def test_y_is_found(days):
    turn = upright(Vertical.named("y"))
    up, (finding,) = find_up([even_sample(cloud @ turn) for cloud in days])
    assert (up, finding.doubt) == ("y", "")


def test_the_ground_decides(days):
    up, (finding,) = find_up([even_sample(cloud) for cloud in days], ground_up="-z")
    assert up == "-z"
    assert "ground" in finding.found


def test_another_axis_is_found_or_named(days):
    for name in ("x", "-x", "-y", "-z"):
        turn = upright(Vertical.named(name))
        up, (finding,) = find_up([even_sample(cloud @ turn) for cloud in days])
        assert up == name or finding.option == f"--up {name}"


def test_one_scan_upside_down_is_named(days):
    clouds = {"a": days[0], "b": days[1] * [1, -1, -1], "c": days[2]}
    samples = [even_sample(cloud, name=name) for name, cloud in clouds.items()]
    up, (finding,) = find_up(samples)
    assert up == "z"
    assert "b seems to be upside down" in finding.doubt
