"""Verification on a real series."""

from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from baker import Options
from baker.pipeline import bake_recorded
from baker.report.verification import overall, unit_length, verify


def test_rebuilt_scans_are_nearer_than_the_scans_before_them(shared_data: Path) -> None:
    options = Options(align="none", voxel=1.0, holdout=2)
    clip, record = bake_recorded([shared_data / "tomato2_control_plant3"], options)
    errors = verify(clip, record)
    assert [error.date for error in errors] == ["day 1", "day 3", "day 5", "day 7"]
    copied = [
        cKDTree(before.positions).query(held.keyframe.positions)[0].mean() / unit_length(record)
        for held, before in zip(record.held_out, record.keyframes, strict=False)
    ]
    made, missed = overall(errors)
    assert missed.mean < 0.8 * np.mean(copied)
    assert np.mean([error.spacing for error in errors]) / 2 < made.mean < 0.03
