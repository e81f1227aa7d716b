"""Coarse alignment of the scans of a series: the up axis and a common frame (section 3.1)."""
