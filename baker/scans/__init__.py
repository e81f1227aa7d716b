"""Find, order, time and read the scans of one plant.

    series = read_series([Path("scans/")], Options(voxel=0.5))

A folder or a list of files goes in, a `Series` of clean `Scan`s comes out; whatever stands in the
way is an `InputError` with one sentence. One module a format (ply, pcd, table, las) stands behind
the registry in `baker.scans.formats`. Importing this package costs nothing heavy.
"""

from baker.scans.finding import Finding
from baker.scans.read import read_series
from baker.scans.scan import Scan, Series

__all__ = ["Finding", "Scan", "Series", "read_series"]
