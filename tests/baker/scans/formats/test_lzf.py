"""LZF data: what other programs compress comes back; damaged data are refused."""

from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from baker.scans.formats.pcd import decompress
from tests.baker.sound_files import lzf_literals

TEXT = b"leaf leaf leaf stem " * 20 + bytes(range(64)) + b"\0" * 300
PACKED = bytes.fromhex(  # by liblzf
    "056c656166206ce00004037374656de0020e6018e0ff13810d61126004e14c171f0001020304"
    "05060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f1f20212223242526272829"
    "2a2b2c2d2e2f303132333435363738393a3b3c3d3e3f0000e0ff00e01800010000"
)


def test_data_of_another_program():
    assert decompress(PACKED, len(TEXT)) == TEXT


@given(st.binary(max_size=400))
def test_literal_bytes_come_back(data):
    assert decompress(lzf_literals(data), len(data)) == data


@given(st.integers(0, len(PACKED) - 1))
def test_what_is_cut_short_is_refused(length):
    with pytest.raises((ValueError, IndexError)):
        decompress(PACKED[:length], len(TEXT))


@given(st.binary(max_size=200), st.integers(0, 300))
def test_any_bytes_are_unpacked_to_the_size_or_refused(data, size):
    with suppress(ValueError, IndexError):
        assert len(decompress(data, size)) == size
