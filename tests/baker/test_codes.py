"""Morton codes of organs are those that clips are ordered by."""

import numpy as np
import pytest

from baker.codes import morton_codes
from gclip.pack import morton_codes as packed_codes


@pytest.mark.parametrize("size", [0.0, 1e-35, 1e-3, 1.0, 1e12])
@pytest.mark.parametrize("count", [0, 1, 2, 700])
def test_codes_are_those_of_clips(count, size):
    points = np.random.default_rng(0).normal(size=(count, 3)) * [1.0, 0.2, 3.0] * size
    wanted = packed_codes(points) if count else np.empty(0, np.uint64)
    np.testing.assert_array_equal(morton_codes(points), wanted)


def test_codes_of_short_numbers_are_as_those_of_long_ones():
    points = np.random.default_rng(1).normal(size=(500, 3)).astype(np.float32)
    np.testing.assert_array_equal(morton_codes(points), morton_codes(points.astype(np.float64)))
