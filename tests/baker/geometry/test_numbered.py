"""Distinct labels are those that sorting finds."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from baker.geometry.numbered import numbered

ANY = st.integers(-(2**63), 2**63 - 1)


@given(
    st.one_of(arrays(np.int64, st.integers(0, 60), elements=e) for e in (st.integers(-9, 9), ANY))
)
def test_labels_are_numbered_as_by_sorting(labels):
    for mine, sorted_ones in zip(
        numbered(labels), np.unique(labels, return_inverse=True), strict=True
    ):
        np.testing.assert_array_equal(mine, sorted_ones)


def test_labels_as_far_apart_as_their_type_allows():
    labels = np.array([-128, 127] * 200, np.int8)
    np.testing.assert_array_equal(numbered(labels)[0], [-128, 127])


@pytest.mark.parametrize("dtype", [np.int8, np.uint8, np.int32, np.uint64, np.float64])
def test_labels_of_any_type(dtype):
    labels = np.array([3, 120, 3, 7, 7] * 60, dtype)
    names, owner = numbered(labels)
    assert names.dtype == dtype
    np.testing.assert_array_equal(names[owner], labels)
