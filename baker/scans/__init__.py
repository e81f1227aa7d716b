"""Find, order, time and read the scans of one plant: a `Series` of clean `Scan`s.

Input that can't be read raises `InputError`, whose message is one sentence. `baker.scans.formats`
has one module for each file format.
"""
