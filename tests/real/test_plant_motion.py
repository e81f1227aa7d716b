"""Real plants that lean to another side in every scan are rotated back."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from baker.alignment.stem_base import base_point
from baker.geometry.up_axis import Vertical
from baker.matching.descriptors import OrganDescriptors, describe_organs
from baker.matching.plant_motion import plant_motions
from tests.real.series import labelled, present, tables_of

UP = Vertical.named("z")


def marked_organs(tables: list[np.ndarray]) -> list[OrganDescriptors]:
    clouds = [table[:, :3] for table in tables]
    bases = [base_point(cloud, UP) for cloud in clouds]
    labels = [table[:, 3].astype(np.int64) for table in tables]
    return list(map(describe_organs, clouds, labels, bases))


def direction(table: np.ndarray, base: np.ndarray, label: float) -> np.ndarray:
    offset = table[table[:, 3] == label, :3].mean(axis=0) - base
    return offset / np.linalg.norm(offset)


def true_rotation(first: np.ndarray, second: np.ndarray, bases: list[np.ndarray]) -> Rotation:
    """The rotation that fits the directions from the base to the organs of the same label."""
    both = np.intersect1d(first[:, 3], second[:, 3])
    before, after = (
        np.array([direction(table, base, label) for label in both])
        for table, base in zip((first, second), bases, strict=True)
    )
    return Rotation.align_vectors(after, before)[0]


def errors_of(tables: list[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Angles of the true rotations of a series, and of what is left after those found."""
    organs = marked_organs(tables)
    truth = [
        true_rotation(*scans, [side.base for side in sides])
        for scans, sides in zip(pairwise(tables), pairwise(organs), strict=True)
    ]
    found = [Rotation.from_matrix(motion[:3, :3]) for motion in plant_motions(organs)]
    left = [a * b.inv() for a, b in zip(truth, found, strict=True)]
    return tuple(np.degrees([r.magnitude() for r in side]) for side in (truth, left))


@pytest.mark.parametrize("name", present("tobacco_control_plant1", "tobacco_control_plant3"))
def test_leans_are_found(series, name):
    true, left = errors_of(tables_of(series(name)))
    assert (left[true > 20.0] < 20.0).mean() >= 0.5


@pytest.mark.parametrize("name", labelled("sorghum_control_plant2", "tomato2_control_plant3"))
def test_a_plant_that_stands_still_is_not_rotated(series, name):
    true, left = errors_of(tables_of(series(name)))
    assert left[true < 20.0].max() < 20.0
