"""Scans without labels: the organs found are those that people marked, or `grow` knows."""

import numpy as np
import pytest

from baker.alignment.stem_base import base_point
from baker.geometry.up_axis import Vertical
from baker.matching.segmentation_choice import choose_segmentations
from baker.segmentation.organs import candidate_organs
from tests.real.series import GROWN, labelled

SMALLEST_GROWN_ORGAN = 300  # points; `grow` also labels what still hides in the stem
SERIES = (
    "maize_control_plant1",
    "sorghum_control_plant1",
    "tobacco_heat_plant3",
    "tomato1_control2_plant1",
    "tomato2_control_plant3",
)


@pytest.mark.parametrize("name", labelled(*SERIES))
def test_organs_overlap_with_those_marked(series, name):
    tables = [np.loadtxt(path) for path in sorted(series(name).glob("*.txt"))]
    clouds = [table[:, :3] - tables[0][:, :3].mean(axis=0) for table in tables]
    bases = [base_point(cloud, Vertical.named("z")) for cloud in clouds]
    found = choose_segmentations(clouds, bases, list(map(candidate_organs, clouds, bases)))
    overlap = [
        max((own & (numbers == n)).sum() / (own | (numbers == n)).sum() for n in set(numbers[own]))
        for table, numbers in zip(tables, found, strict=True)
        for own in (table[:, 3] == label for label in np.unique(table[:, 3]))
        if name != GROWN or own.sum() >= SMALLEST_GROWN_ORGAN
    ]
    assert np.mean(overlap) > (0.75 if name == GROWN else 0.8)
