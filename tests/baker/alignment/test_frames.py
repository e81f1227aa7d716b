"""Scans that share a frame are left there, whatever single organs or scans did."""

import numpy as np
import pytest

from baker.alignment import frames
from baker.alignment.register import Alignment, align
from baker.alignment.sample import even_sample
from baker.alignment.yaw import YAWS, YawFit
from tests.baker.series import series_of


@pytest.fixture(scope="module")
def week(plant) -> list[np.ndarray]:
    return [plant(day)[::2] for day in range(5)]


def aligned(clouds: list[np.ndarray], method: str = "auto", **known) -> Alignment:
    return align(series_of(clouds, **known), method, "z")


def stays(found: Alignment) -> list[bool]:
    return [np.array_equal(transform, np.eye(4)) for transform in found.transforms]


def farthest(transform: np.ndarray, cloud: np.ndarray, there: np.ndarray) -> float:
    moved = cloud @ transform[:3, :3].T + transform[:3, 3]
    return float(np.linalg.norm(moved - there, axis=1).max())


def frame_finding(found: Alignment):
    (finding,) = (finding for finding in found.findings if finding.topic == "frame")
    return finding


@pytest.mark.parametrize(("number", "shift"), [(1, (25.0, -10.0, 6.0)), (4, (-3.0, 28.0, 0.0))])
def test_one_scan_from_elsewhere_is_brought_back_and_the_others_stay(week, posed, number, shift):
    jumped = [posed(each, 130.0, shift) if at == number else each for at, each in enumerate(week)]
    found = aligned(jumped)
    assert stays(found) == [at != number for at in range(5)]
    assert farthest(found.transforms[number], jumped[number], week[number]) < 4.0
    finding = frame_finding(found)
    assert f"but for scan {number + 1}" in finding.found
    assert "more than a fifth" in finding.doubt
    assert finding.option == "--align none"


def test_where_the_first_scan_jumped_the_others_follow_it_together(week, posed):
    first = posed(week[0], -70.0, (29.0, 4.0, 2.0))
    found = aligned([first, *week[1:]])
    assert np.array_equal(found.transforms[0], np.eye(4))
    for transform in found.transforms[2:]:
        assert np.allclose(transform, found.transforms[1])
    assert farthest(np.linalg.inv(found.transforms[1]), first, week[0]) < 4.0


def test_a_lone_turn_is_told_and_left(week, posed):
    turned = [posed(each, 130.0 * (at == 2), (0, 0, 0)) for at, each in enumerate(week)]
    found = aligned(turned)
    assert all(stays(found))
    assert "scan 3 would fit the scan before better turned by -130 degrees" in (
        frame_finding(found).doubt
    )
    assert frame_finding(found).option == "--align turn"
    brought = aligned(turned, "turn")
    assert "as asked" in frame_finding(brought).found
    assert farthest(brought.transforms[2], turned[2], week[2]) < 4.0


def test_an_organ_that_turned_is_no_jump(week, plant):
    turned = [*week[:2], plant(2, turned={3: 60.0})[::2], *week[3:]]
    assert all(stays(aligned(turned)))


def test_turned_scans_of_which_none_says_so_are_brought_together(week, posed):
    yaws = (0.0, 80.0, 200.0, -60.0, 130.0)
    clouds = [posed(each, yaw, (0, 0, 0)) for each, yaw in zip(week, yaws, strict=True)]
    found = aligned(clouds)
    assert "do not share a frame" in frame_finding(found).found
    for transform, cloud, there in zip(found.transforms, clouds, week, strict=True):
        assert farthest(transform, cloud, there) < 5.0


def test_a_scan_in_another_coordinate_system_comes_back_exactly(week):
    far = np.array([5.4e5, 5.6e6, 300.0])
    found = aligned(week, origins=[np.zeros(3), far, far, far, far])
    (first, *others) = found.transforms
    assert np.array_equal(first, np.eye(4))
    for transform, cloud in zip(others, week[1:], strict=True):
        assert farthest(transform, cloud, cloud) < 4.0


def plant_doubt(clouds: list[np.ndarray]) -> str:
    found = aligned(clouds, names=[f"day{number}" for number in range(len(clouds))])
    return " ".join(finding.doubt for finding in found.findings if finding.topic == "plant")


def test_another_plant_is_named(week):
    rng = np.random.default_rng(0)
    other = rng.normal(0.0, 1.0, (2000, 3)) * [2.0, 30.0, 2.0] + [60.0, 0.0, 10.0]
    assert not plant_doubt(week)
    for place in range(5):
        series = [*week[:place], other, *week[place + 1 :]]
        assert plant_doubt(series).startswith(f"day{place} may be of another plant")


def test_leaves_of_another_width_are_another_plant(week):
    """Where leaves of one plant lie in the other's, only their shape tells them apart."""
    grass = [cloud.copy() for cloud in week]
    for cloud in grass:
        for leaf in np.split(cloud[450:], 4):
            along = leaf[:, :2].mean(axis=0) / np.linalg.norm(leaf[:, :2].mean(axis=0))
            leaf[:, :2] = np.outer(leaf[:, :2] @ along, along)
    assert not plant_doubt(grass)
    for place in range(5):
        series = [*week[:place], grass[place], *week[place + 1 :]]
        assert plant_doubt(series).startswith(f"day{place} may be of another plant")


def test_labels_tell_organs_that_look_alike(plant, posed):
    """Three equal leaves at even angles: only their labels tell how the plant was turned."""
    rng = np.random.default_rng(0)
    leaf = np.column_stack(
        [1 + 20 * rng.random(600), rng.normal(0, 2, 600), rng.normal(20, 1, 600)]
    )
    stem = rng.normal(0, 0.3, (600, 3)) + np.outer(np.linspace(0, 22, 600), [0, 0, 1])
    scan = np.concatenate([stem, *(posed(leaf, yaw, (0, 0, 0)) for yaw in (0, 120, 240))])
    labels = np.repeat([0, 1, 2, 3], 600)
    clouds = [posed(scan, yaw, (0, 0, 0)) for yaw in (0, 120, -120, 60)]
    found = aligned(clouds, labels=[labels] * 4)
    for transform, cloud in zip(found.transforms, clouds, strict=True):
        assert farthest(transform, cloud, scan) < 1.0
    anew = [rng.permutation(10)[labels] for _ in clouds]
    assert "nearly as well" in frame_finding(aligned(clouds, "turn", labels=anew)).doubt


@pytest.mark.parametrize(("turn", "is_doubted"), [(0, False), (90, True)])
def test_scans_that_fit_as_well_at_random_yaws_may_not_share_a_frame(week, turn, is_doubted):
    """The fit of a plant with five leaves at each height, whose best yaw gains too little."""
    samples = [even_sample(cloud) for cloud in week[:4]]
    curve = 0.8 + 0.05 * np.cos(np.radians(YAWS)) + 0.05 * np.cos(np.radians(5 * YAWS))
    fit = YawFit(False, [np.roll(curve, turn // 5 * k) for k in (1, 2, 3)])
    assert (fit.distinction < 0.6) == is_doubted
    finding = frames.frame_finding(samples, np.zeros((4, 3)), fit, np.ones(4, bool), "", False)
    assert ("turned at random" in finding.doubt) == is_doubted
    assert finding.option == ("--align turn" if is_doubted else "")


def test_stems_fit_alike_at_all_yaws():
    assert YawFit(False, [np.ones(len(YAWS))]).distinction == np.inf
