"""Find, order, time and read the scans of one plant: a `Series` of clean `Scan`s.

Input that can't be read raises `InputError`, whose message is one sentence. `baker.scans.formats`
has one module for each file format.
"""

from baker.scans.read import read_series
from baker.scans.scan import Finding, Scan, Series

__all__ = ["Finding", "Scan", "Series", "read_series"]
