"""The reading stage: what the options ask of it, and what the scans say where options are silent.

Apart from the other stages, so that these can be loaded while the scans are read.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

from baker.geometry.parallel import MapLike
from baker.options import Options
from baker.scans import ReadOptions, Series, read_series


def read_scans(
    paths: Sequence[Path],
    options: Options,
    tell: Callable[[str, int, int], None],
    map: MapLike = map,
) -> Series:
    """`baker.scans.read_series`, as the bake's options want it."""
    return read_series(
        paths, read_options(options), lambda done, total, name: tell("reading", done, total), map
    )


def read_options(options: Options) -> ReadOptions:
    """How a bake with these options reads its scans."""
    return ReadOptions(
        label_field=options.label_field,
        times_file=options.times,
        outliers=options.outliers,
        voxel=options.voxel,
        denoise=options.denoise,
        resample=options.resample,
        use_labels=options.labels != "ignore",
        every=options.every,
    )


def told_by(series: Series, options: Options) -> Options:
    """The options, with what the series itself knows where they leave it open."""
    if series.fixed:
        align = "none" if options.align == "auto" else options.align
        options = replace(options, align=align, up="z" if options.up == "auto" else options.up)
    options = replace(options, unit=options.unit or series.length)
    return options if options.root is not None else replace(options, root=series.root)
