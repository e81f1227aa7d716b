"""Find, order, time and read the scans of one plant: a `Series` of clean `Scan`s.

Whatever stands in the way is an `InputError` with one sentence. One module a format stands behind
the registry in `baker.scans.formats`. Importing this package costs nothing heavy.
"""

from baker.scans.read import read_series
from baker.scans.scan import Finding, Scan, Series

__all__ = ["Finding", "Scan", "Series", "read_series"]
