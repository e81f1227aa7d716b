"""Verification by leaving scans out."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

from baker import Options
from baker.pipeline import bake_with_survey
from tests.real.series import GROWN, labelled
from traits.holdout_error import overall, verify


@pytest.mark.parametrize("name", labelled("tomato2_control_plant3"))
def test_rebuilt_scans_are_nearer_than_the_scans_before_them(series, name):
    options = Options(align="none", voxel=1.0, holdout=2)
    clip, record = bake_with_survey([series(name)], options)
    errors = verify(clip)
    days = (3.5, 10.5) if name == GROWN else (1, 3, 5, 7)
    assert [error.date for error in errors] == [f"day {day}" for day in days]
    copied = [
        cKDTree(before.positions).query(held.positions)[0].mean()
        for held, before in zip(record.held_out, record.aligned.keyframes, strict=False)
    ]
    made, missed = overall(errors)
    assert missed.mean < 0.8 * np.mean(copied)
    size = np.ptp(clip.bounds, axis=0).max()
    assert np.mean([error.spacing for error in errors]) / 2 < made.mean < 0.03 * size
