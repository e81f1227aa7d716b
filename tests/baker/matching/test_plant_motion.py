"""A plant that leans to another side in every scan is rotated before its organs are compared."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from baker.matching import plant_motion
from baker.matching.descriptors import OrganDescriptors, describe_organs
from baker.matching.plant_motion import plant_motions
from baker.matching.tracking import track_organs

GOLDEN_ANGLE = 2.4  # radians between successive leaves, as of a tobacco
LEAN = Rotation.from_euler("xyz", [55, -25, 40], degrees=True)


def spiral(leaves: int, growth: float = 1.0, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """A stem with leaves in a spiral, and the number of the organ of each point; 0 is the stem."""
    rng = np.random.default_rng(seed)
    height = 20.0 * growth
    organs = [np.linspace([0, 0, 0], [0, 0, height], 300)]
    for leaf in range(leaves):
        azimuth, along = GOLDEN_ANGLE * leaf, np.linspace(0, 1, 150)[:, None]
        outward = np.array([np.cos(azimuth), np.sin(azimuth), 0.6])
        start = np.array([0.0, 0.0, height * (leaf + 1) / (leaves + 1)])
        length = growth * (11.0 - leaf)
        organs.append(start + along * length * outward - along**2 * [0, 0, 3.0])
    points = np.concatenate(organs)
    labels = np.repeat(np.arange(len(organs)), [len(organ) for organ in organs])
    return points + rng.normal(0, 0.05, points.shape), labels


def described(points: np.ndarray, labels: np.ndarray) -> OrganDescriptors:
    root = int(np.argmin(np.linalg.norm(points, axis=1)))
    return describe_organs(points, labels, root)


@pytest.mark.parametrize("leaves", [3, 6])
@pytest.mark.parametrize("growth", [1.0, 1.7, 2.5])
def test_a_plant_that_leans_is_rotated(leaves: int, growth: float) -> None:
    first, labels = spiral(leaves)
    second, later = spiral(leaves, growth, seed=1)
    base = np.array([3.0, -2.0, 1.0])
    organs = described(first, labels), described(LEAN.apply(second) + base, later)
    (motion,) = plant_motions(organs)
    rest = Rotation.from_matrix(motion[:3, :3]) * LEAN.inv()
    assert np.degrees(rest.magnitude()) < 20.0
    np.testing.assert_allclose(motion[:3, :3] @ motion[:3, :3].T, np.eye(3), atol=1e-9)
    assert np.linalg.det(motion[:3, :3]) == pytest.approx(1.0)
    np.testing.assert_allclose(motion[:3, 3], base, atol=0.5)  # plant base onto plant base


@pytest.mark.parametrize("step", [1, 2, 5])
def test_the_largest_organs_keep_their_size_with_fewer_points(step: int) -> None:
    organs = described(*spiral(5))
    largest = organs.largest(3, step)
    order = np.argsort(-organs.sizes)[:3]
    np.testing.assert_array_equal(largest.sizes, organs.sizes[order])
    for sample, index in zip(largest.samples, order, strict=True):
        np.testing.assert_array_equal(sample, organs.samples[index][::step])


@pytest.mark.parametrize("growth", [0.7, 1.0, 1.4])
def test_a_plant_that_only_grows_is_not_rotated(growth: float) -> None:
    first, second = described(*spiral(5)), described(*spiral(5, growth, seed=1))
    np.testing.assert_array_equal(plant_motions([first, second]), [np.eye(4)])


def test_leaves_in_two_rows_are_not_taken_for_each_other() -> None:
    """Rotated by half a turn, the plant would look nearly the same."""
    points, labels = spiral(1)
    leaf = points[labels == 1]
    other = leaf * [-1.0, -1.0, 1.0] + [0.0, 0.0, 2.0]
    points = np.concatenate([points, other])
    labels = np.concatenate([labels, np.full(len(other), 2)])
    again = points + np.random.default_rng(1).normal(0, 0.1, points.shape)
    organs = described(points, labels), described(again, labels)
    np.testing.assert_array_equal(plant_motions(organs), [np.eye(4)])


@pytest.mark.parametrize("rotates_often", [False, True])
def test_a_rotation_is_likely_if_the_plant_rotates_in_other_intervals(
    monkeypatch: pytest.MonkeyPatch, rotates_often: bool
) -> None:
    """In one of eight intervals organs match better by 0.7 if turned by 2.5 radians."""
    usual = (1.0, 1.0) if rotates_often else (0.0, 0.0)  # angle and gain in the other intervals
    choices = [usual] * 3 + [(2.5, 0.7)] + [usual] * 4

    def candidates(angle: float, gain: float) -> tuple[np.ndarray, np.ndarray]:
        motions = np.tile(np.eye(4), (2, 1, 1))
        motions[1, :3, :3] = Rotation.from_rotvec([0, 0, angle]).as_matrix()
        return motions, np.array([0.0, gain])

    steps = iter([candidates(*choice) for choice in choices])
    monkeypatch.setattr(plant_motion, "candidate_motions", lambda first, second: next(steps))
    monkeypatch.setattr(plant_motion, "_score", lambda first, second: 0.0)
    motions = plant_motions([described(*spiral(3))] * 9)
    turned = np.degrees(Rotation.from_matrix(motions[3][:3, :3]).magnitude())
    assert turned == pytest.approx(np.degrees(2.5) if rotates_often else 0.0, abs=1e-6)


@pytest.mark.parametrize("leaves", [0, 1])
def test_too_few_organs_determine_no_rotation(leaves: int) -> None:
    alone, plant = described(*spiral(leaves)), described(*spiral(4, seed=1))
    np.testing.assert_array_equal(plant_motions([alone, alone]), [np.eye(4)])
    assert np.shape(plant_motions([alone, plant, alone])) == (2, 4, 4)
    assert plant_motions([plant]) == []


def test_motions_of_successive_intervals_compose() -> None:
    leans = [Rotation.identity(), LEAN, Rotation.from_euler("zy", [80, 40], degrees=True) * LEAN]
    scans = [spiral(5, 1.1**k, seed=k) for k in range(3)]
    organs = [
        described(lean.apply(points) + k, labels)
        for k, (lean, (points, labels)) in enumerate(zip(leans, scans, strict=True))
    ]
    first, second = plant_motions(organs)
    total = second @ first
    rest = Rotation.from_matrix(total[:3, :3]) * leans[2].inv()
    assert np.degrees(rest.magnitude()) < 30.0
    np.testing.assert_allclose(total[:3, 3], 2.0, atol=1.0)


def test_scans_two_apart_tell_of_a_wrong_rotation(monkeypatch: pytest.MonkeyPatch) -> None:
    """Even if the scans of one interval fit slightly better with it."""
    motions = np.stack([np.eye(4)] * 2)
    motions[1, :3, :3] = LEAN.as_matrix()
    intervals = (motions, np.array([1.0, 1.35])), (motions[:1], np.array([1.0]))
    organs = [described(*spiral(5, seed=k)) for k in range(3)]
    for count, expected in (2, motions[1:]), (3, motions[[0, 0]]):
        candidates = iter(intervals)
        monkeypatch.setattr(plant_motion, "candidate_motions", lambda *_, c=candidates: next(c))
        np.testing.assert_array_equal(plant_motions(organs[:count]), expected)


def test_a_plant_that_rotates_often_is_rotated_sooner(monkeypatch: pytest.MonkeyPatch) -> None:
    """The penalty is above 0.2 a radian if nothing else rotates, and below 0.1 if the rest does."""
    motions = np.stack([np.eye(4)] * 2)
    motions[1, :3, :3] = LEAN.as_matrix()
    small = np.array([1.0, 1.0 + 0.15 * LEAN.magnitude()])
    monkeypatch.setattr(plant_motion, "INDIRECT_WEIGHT", 0.0)
    organs = [described(*spiral(5, seed=k)) for k in range(5)]
    for gain, expected in (0.0, [0, 0, 0, 0]), (3.0, [1, 1, 1, 1]):
        steps = iter([*[(motions, np.array([1.0, 1.0 + gain]))] * 3, (motions, small)])
        monkeypatch.setattr(plant_motion, "candidate_motions", lambda *_, s=steps: next(s))
        np.testing.assert_array_equal(plant_motions(organs), motions[expected])


def test_organs_keep_their_tracks_in_a_plant_that_leans() -> None:
    """Each scan leans to another side, also the one in which a leaf is hidden."""
    leans = [Rotation.identity(), LEAN, *Rotation.from_euler("xy", [[30, 0], [0, -40]], True)]
    clouds, roots, truth = [], [], []
    for k, lean in enumerate(leans):
        points, labels = spiral(5, 1.1**k, seed=k)
        hidden = (labels == 2) & (k == 2)
        points, labels = lean.apply(points[~hidden]), labels[~hidden]
        clouds.append(points)
        truth.append(labels)
        roots.append(int(np.argmin(np.linalg.norm(points, axis=1))))
    tracks = track_organs(clouds, truth, roots)
    pairs = {pair for each in zip(truth, tracks, strict=True) for pair in zip(*each, strict=True)}
    assert len(pairs) == 6
