"""Which fields of a file are positions and colours, and which may be labels."""

from collections.abc import Sequence
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError, excerpt
from baker.scans.formats import Columns
from baker.scans.labels import label_rank
from baker.scans.scan import Scan

COLOR_NAMES = tuple(
    tuple(names.split())
    for names in ("red green blue", "diffuse_red diffuse_green diffuse_blue", "r g b", "rf gf bf")
)
NO_LABELS = {*"xyz", "nx", "ny", "nz", *chain.from_iterable(COLOR_NAMES)}
MAX_SAMPLE, MAX_VALUES = 2_000, 200  # of a field whose name says nothing, that may be labels


def choose_fields(
    columns: Columns,
    path: Path,
    label_field: str | None = None,
    use_labels: bool = True,
    carried: Sequence[str] = (),
) -> Scan:
    """Positions and colours among the fields of a file, those to be carried into the clip, and all
    others that may be labels.

    `label_field` is then the only one, and without `use_labels` there is none. Colours that make no
    sense are left out with a note. Raises InputError: no x, y or z, no `label_field`, or none of a
    name in `carried`.
    """
    by_name = {name.lower(): name for name in reversed(columns.values)}  # the first of each counts
    asked = [label_field] if label_field is not None and use_labels else []
    missing = [name for name in [*"xyz", *asked, *carried] if name.lower() not in by_name]
    if missing:
        found = ", ".join(map(excerpt, list(columns.values)[:12])) or "none"
        raise InputError(f"'{path}' has no field '{missing[0]}'; the fields found: {found}.")
    used = [by_name[axis] for axis in "xyz"]
    points = np.stack([columns.values[name].astype(np.float64) for name in used], axis=1)
    notes = [f"positions from {_quoted(used)}"]

    scalars = {}
    for name in carried:
        values = columns.values[by_name[name.lower()]]
        if values.dtype.kind not in "iufb":
            raise InputError(f"'{path}': its field '{name}' holds words; --fields takes numbers.")
        scalars[name] = values.astype(np.float32)
    labels = [by_name[name.lower()] for name in asked]
    if use_labels and not asked:
        taken = NO_LABELS | {name.lower() for name in carried}
        rest = {n: values for n, values in columns.values.items() if n.lower() not in taken}
        labels = [n for n in rest if label_rank(n) is not None or _may_be_labels(rest[n])]

    colors = None
    triple = next((names for names in COLOR_NAMES if set(names) <= set(by_name)), ())
    if triple:
        used = [by_name[name] for name in triple]
        colors, scale = to_srgb([columns.values[name] for name in used])
        notes.append(f"colours from {_quoted(used)} ({scale})")

    notes = [*columns.notes, "; ".join(notes) + "."]
    fields = {name: columns.values[name] for name in labels}
    return Scan(points, None, colors, tuple(notes), fields, scalars, path)


def _may_be_labels(values: NDArray) -> bool:
    """Whether some of a field's values are whole numbers, and few."""
    some = values[:: -(-len(values) // MAX_SAMPLE)].astype(float)
    return bool((some == np.rint(some)).all() and len(np.unique(some)) <= MAX_VALUES)


def to_srgb(channels: Sequence[NDArray]) -> tuple[NDArray[np.uint8] | None, str]:
    """Red, green and blue in 8 bits, whatever numbers a file has them in, and how these were read.

    Bytes stay as they are. Other numbers count as 0–1 where none is above 1 and they are not of an
    integer type, as 8-bit where none is above 255, as 16-bit where none is above 65535. No colours
    where some are beyond that, negative or not finite.
    """
    is_integer = all(channel.dtype.kind in "iu" for channel in channels)
    if all(channel.dtype == np.uint8 for channel in channels):
        return np.stack(channels, axis=1), "8-bit"
    values = np.stack([channel.astype(np.float64) for channel in channels], axis=1)
    low, high = (values.min(), values.max()) if values.size else (0.0, 0.0)
    if not (np.isfinite(values).all() and low >= 0 and high <= 65535):
        return None, f"left out: values from {low:g} to {high:g} are no colours"
    if high <= 1 and not is_integer:
        return np.rint(values * 255).astype(np.uint8), "0–1"
    if high <= 255:
        return np.rint(values).astype(np.uint8), "8-bit"
    # By the high byte: right both for values scaled by 257 and, as LAS asks for, by 256.
    return (values / 256).astype(np.uint8), "16-bit"


def _quoted(names: Sequence[str]) -> str:
    return ", ".join(f"'{excerpt(name)}'" for name in names)
