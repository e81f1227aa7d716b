"""Means over movers that share an end."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from baker.geometry.twins import mean_of_twins


@given(arrays(np.intp, st.integers(0, 30), elements=st.integers(0, 6)))
def test_each_has_the_mean_of_all_with_its_end(ends):
    values = np.random.default_rng(0).random((len(ends), 3))
    means = mean_of_twins(ends, np.argsort(ends, kind="stable"), values)
    for mean, end in zip(means, ends, strict=True):
        np.testing.assert_allclose(mean, values[ends == end].mean(axis=0), rtol=1e-12)
