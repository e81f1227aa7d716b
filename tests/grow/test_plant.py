"""What must be true of every procedural plant at every time."""

import numpy as np
import pytest

from baker.errors import InputError
from grow import KINDS, plant
from grow.model import Plant
from grow.surface import Material

SMALL = ("maize", "tomato", "tree1")
SEEDS = (0, 7)


def axis_of(subject: Plant, label: int, count: int = 50) -> Material:
    """The middle line of an organ's main part."""
    part = int(np.flatnonzero(subject._body.label == label)[0])
    return Material(np.full(count, part), np.linspace(0, 1, count), np.zeros(count))


@pytest.mark.parametrize("kind", SMALL)
def test_a_cloud_is_a_function_of_its_arguments(kind: str) -> None:
    one, same = plant(kind, 3).cloud(5.5, 900), plant(kind, 3).cloud(5.5, 900)
    np.testing.assert_array_equal(one.points, same.points)
    np.testing.assert_array_equal(one.labels, same.labels)
    np.testing.assert_array_equal(one.colors, same.colors)

    for other in (plant(kind, 4).cloud(5.5, 900), plant(kind, 3).cloud(5.5, 900, seed=1)):
        assert not set(map(tuple, one.points)) & set(map(tuple, other.points))


@pytest.mark.parametrize("kind", KINDS)
def test_the_usual_scans_have_the_numbers_of_points_they_should(kind: str) -> None:
    subject = plant(kind)
    expected = {
        "maize": (8, 1700, 5000),
        "tomato": (9, 4000, 16000),
        "tree": (6, 8000, 40000),
        "tree1": (4, 778, 2253),
        "tree2": (2, 77448, 326032),
    }[kind]
    counts = [subject.default_points(day) for day in subject.default_days]
    assert (len(counts), counts[0], counts[-1]) == expected
    assert counts == sorted(counts)


@pytest.mark.parametrize("count", [10, 777, 20000])
def test_a_cloud_has_exactly_as_many_points_as_asked_for(count: int) -> None:
    cloud = plant("maize").cloud(9.0, count)
    assert cloud.points.shape == (count, 3)
    assert cloud.points.dtype == np.float32
    assert cloud.labels.shape == (count,)
    assert cloud.colors is not None
    assert cloud.colors.shape == (count, 3)
    assert cloud.colors.dtype == np.uint8
    assert plant("maize").cloud(9.0, count, colors=False).colors is None


@pytest.mark.parametrize("kind", SMALL)
@pytest.mark.parametrize("seed", SEEDS)
def test_stems_and_leaves_only_grow(kind: str, seed: int) -> None:
    subject = plant(kind, seed)
    first, last = subject.days
    lengths: dict[int, float] = {}
    height = area = 0.0
    for day in np.linspace(first, last, 30):
        organs = subject.organs(day)
        assert set(lengths) <= {organ.label for organ in organs}, "an organ was lost"
        for organ in organs:
            assert organ.length > 0
            assert organ.length >= lengths.get(organ.label, 0.0) - 1e-9
            lengths[organ.label] = organ.length
        assert organs[0].tip[2] > height
        assert subject.area(day) > area
        height, area = organs[0].tip[2], subject.area(day)


@pytest.mark.parametrize("kind", SMALL)
@pytest.mark.parametrize("seed", SEEDS)
def test_organs_sit_on_their_parents_at_all_times(kind: str, seed: int) -> None:
    subject = plant(kind, seed)
    for day in np.linspace(*subject.days, 7):
        parts = subject._body.parts
        children = np.arange(1, len(parts))
        here = Material(children, np.zeros(len(children)), np.zeros(len(children)))
        there = Material(
            np.array([part.parent for part in parts[1:]]),
            np.array([part.at for part in parts[1:]]),
            np.array([(2 - part.azimuth / np.pi) % 2 - 1 for part in parts[1:]]),
        )
        base, tube = subject.track(here, day), subject._body.tube[1:]
        on_parent = subject.track(there, day)
        np.testing.assert_allclose(base[~tube], on_parent[~tube], atol=1e-6)
        for organ in subject.organs(day)[1:]:
            first = int(np.argmax(subject._body.label[1:] == organ.label))
            np.testing.assert_allclose(organ.base, on_parent[first], atol=1e-6)


def test_no_gap_shows_between_organs_in_a_scan() -> None:
    subject = plant("maize")
    for day in subject.default_days:
        cloud = subject.cloud(day)
        spacing = np.sqrt(subject.area(day) / len(cloud))
        stem = cloud.points[cloud.labels == 0]
        for label in np.unique(cloud.labels)[1:]:
            leaf = cloud.points[cloud.labels == label]
            gap = np.linalg.norm(leaf[:, None] - stem[None], axis=2).min()
            assert gap < 2 * spacing, (label, day)


@pytest.mark.parametrize("kind", SMALL)
def test_organs_are_born_tiny_at_their_attachment(kind: str) -> None:
    subject = plant(kind)
    for organ in subject.organs(subject.days[1])[1:]:
        assert organ.label not in {o.label for o in subject.organs(organ.birth)}
        newborn = next(o for o in subject.organs(organ.birth + 0.05) if o.label == organ.label)
        assert newborn.length < 0.02 * max(organ.length, 20)
        before = subject.track(axis_of(subject, organ.label), organ.birth - 1.0)
        np.testing.assert_allclose(before, before[:1].repeat(len(before), 0), atol=1e-9)


@pytest.mark.parametrize("kind", SMALL)
def test_tracks_pass_through_the_points_of_a_cloud(kind: str) -> None:
    subject = plant(kind)
    cloud = subject.cloud(6.25, 1500, noise=0.0)
    np.testing.assert_allclose(subject.track(cloud.material, 6.25), cloud.points, atol=1e-3)
    np.testing.assert_array_equal(subject.label_of(cloud.material), cloud.labels)
    assert subject.born(cloud.material, 6.25).all()
    assert not subject.born(cloud.material, -1000.0).any()


@pytest.mark.parametrize("kind", SMALL)
def test_tissue_moves_without_jumps(kind: str) -> None:
    subject = plant(kind)
    first, last = subject.days
    material = subject.cloud(last, 600, noise=0.0).material
    days = np.linspace(first, last, 200)
    tracks = np.array([subject.track(material, day) for day in days])
    assert np.isfinite(tracks).all()
    speed = np.linalg.norm(np.diff(tracks, axis=0), axis=2) / (days[1] - days[0])
    size = np.ptp(tracks[-1], axis=0).max()
    assert speed.max() < 0.5 * size  # per day
    assert np.abs(np.diff(speed, axis=0)).max() < 0.03 * size


def test_noise_is_as_large_as_asked_for() -> None:
    subject = plant("maize")
    cloud = subject.cloud(8.0, 20000, noise=0.7)
    off = cloud.points - subject.track(cloud.material, 8.0)
    assert off.std() == pytest.approx(0.7, rel=0.02)


def test_points_are_spread_more_evenly_than_at_random() -> None:
    from scipy.spatial import cKDTree

    points = plant("maize").cloud(10.0, 5000, noise=0.0).points
    nearest = cKDTree(points).query(points, k=2)[0][:, 1]
    assert nearest.std() / nearest.mean() < 0.45  # 0.52 for a Poisson process in the plane


def test_labels_stay_with_their_organs_and_name_every_seen_one() -> None:
    subject = plant("tomato")
    seen: set[int] = set()
    for day in subject.default_days:
        labels, counts = np.unique(subject.cloud(day).labels, return_counts=True)
        assert seen <= set(labels.tolist())
        assert set(labels.tolist()) <= {organ.label for organ in subject.organs(day)}
        assert counts.min() >= 5, "specks are no organs"
        seen = set(labels.tolist())
    assert seen == set(subject.labels.tolist())
    assert len(plant("tomato").organs(0.0)) < len(seen)


def test_the_hierarchy_has_one_root_and_no_loops() -> None:
    parents = {organ.label: organ.parent for organ in plant("tree1").organs(34.0)}
    assert parents[0] == -1
    assert sum(parent == -1 for parent in parents.values()) == 1
    assert any(parent > 0 for parent in parents.values()), "branches bear branches"
    assert all(parent < label for label, parent in parents.items())


def test_unknown_kinds_and_negative_seeds_are_refused() -> None:
    with pytest.raises(InputError, match="maize, tomato"):
        plant("orchid")
    with pytest.raises(InputError, match="seed"):
        plant("maize", -1)
