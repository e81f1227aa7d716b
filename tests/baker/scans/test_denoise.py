"""Denoising flattens leaves and spares thin stems."""

from __future__ import annotations

import numpy as np
import pytest

from baker import InputError
from baker.options import Options
from baker.scans.clean import denoised
from baker.scans.cloud import Cloud

NOISE = 0.01


def noisy(points, seed=1):
    return points + np.random.default_rng(seed).normal(0, NOISE, points.shape)


def test_a_noisy_leaf_becomes_flat():
    flat = np.random.default_rng(0).random((4000, 3)) * [1, 1, 0]
    calm = denoised(Cloud(noisy(flat)), 30)
    assert calm.points[:, 2].std() < 0.5 * NOISE
    assert calm.points[:, :2] == pytest.approx(noisy(flat)[:, :2], abs=2 * NOISE)


def test_a_thin_stem_keeps_its_thickness():
    rng = np.random.default_rng(0)
    angle, height = rng.random(2000) * 2 * np.pi, rng.random(2000) * 20
    stem = np.c_[0.1 * np.cos(angle), 0.1 * np.sin(angle), height]
    calm = denoised(Cloud(stem), 20).points
    assert np.hypot(calm[:, 0], calm[:, 1]).mean() > 0.08


def test_labels_and_colors_stay_and_it_is_said():
    points = np.random.default_rng(0).random((100, 3))
    calm = denoised(Cloud(points, labels=np.arange(100)), 8)
    assert calm.labels.tolist() == list(range(100))
    assert calm.notes[-1].startswith("denoised: points moved by")


def test_too_few_points_are_left_alone():
    points = np.random.default_rng(0).random((5, 3))
    assert denoised(Cloud(points), 8).points is points


def test_impossible_numbers_are_refused():
    with pytest.raises(InputError, match="denoise is 3; at least 4 is needed"):
        Options(denoise=3)
    with pytest.raises(InputError, match="resample is 0; at least 10 is needed"):
        Options(resample=0)
