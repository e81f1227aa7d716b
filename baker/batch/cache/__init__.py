"""Finished intervals, kept from bake to bake (`bake --cache DIR`)."""

from baker.batch.cache.intervals import IntervalCache

__all__ = ["IntervalCache"]
