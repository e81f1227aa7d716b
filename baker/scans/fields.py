"""Choose the fields of a file that are positions, colours and scalars, or may be labels."""

from collections.abc import Sequence
from itertools import chain
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError, excerpt
from baker.scans.formats import Columns
from baker.scans.labels import label_rank
from baker.scans.scan import Scan

COLORS = "red green blue", "diffuse_red diffuse_green diffuse_blue", "r g b", "rf gf bf"
COLOR_NAMES = [names.split() for names in COLORS]
NO_LABELS = {*"xyz", "nx", "ny", "nz", *chain.from_iterable(COLOR_NAMES)}
# A field of any other name may be labels if MAX_SAMPLE of its points have at most MAX_VALUES
# distinct values.
MAX_SAMPLE, MAX_VALUES = 2_000, 200


def choose_fields(
    columns: Columns,
    path: Path,
    label_field: str | None = None,
    use_labels: bool = True,
    clip_fields: Sequence[str] = (),
) -> Scan:
    """Make a scan from the fields of a file; its labels are chosen later, among its `fields`.

    Only `label_field` may be labels or, by default, all fields that look like labels; none if
    `use_labels` is False. The `clip_fields` become scalars of the clip; values that are infinite,
    or too large for a float32, become NaN. Raises InputError if one of these fields, or of x, y, z,
    is missing.
    """
    by_name = {name.lower(): name for name in reversed(columns.values)}  # of equal names the first
    label_names = [label_field] if label_field is not None and use_labels else []
    missing = [name for name in [*"xyz", *label_names, *clip_fields] if name.lower() not in by_name]
    if missing:
        known_names = ", ".join(map(excerpt, list(columns.values)[:12])) or "none"
        raise InputError(f"'{path}' has no field '{missing[0]}'; the fields found: {known_names}.")
    used = [by_name[axis] for axis in "xyz"]
    points = np.stack([columns.values[name].astype(np.float64) for name in used], axis=1)
    note = f"positions from {excerpt(', '.join(used))}"

    scalars = {}
    for name in clip_fields:
        values = columns.values[by_name[name.lower()]]
        if values.dtype.kind not in "iufb":
            raise InputError(f"'{path}': its field '{name}' holds words; --fields takes numbers.")
        with np.errstate(over="ignore"):
            values = values.astype(np.float32)
        scalars[name] = np.where(np.isfinite(values), values, np.float32(np.nan))
    labels = [by_name[name.lower()] for name in label_names]
    if use_labels and not label_names:
        used_names = NO_LABELS | {name.lower() for name in clip_fields}
        rest = {n: values for n, values in columns.values.items() if n.lower() not in used_names}
        labels = [n for n in rest if label_rank(n) is not None or _may_be_labels(rest[n])]

    colors = None
    if color_names := next((names for names in COLOR_NAMES if set(names) <= set(by_name)), None):
        used = [by_name[name] for name in color_names]
        colors, scale = to_srgb([columns.values[name] for name in used])
        note += f"; colours from {excerpt(', '.join(used))} ({scale})"
    fields = {name: columns.values[name] for name in labels}
    return Scan(points, None, colors, (*columns.notes, f"{note}."), fields, scalars, path)


def _may_be_labels(values: NDArray) -> bool:
    """Whether a sample of a field's values has only whole numbers, and few different ones."""
    sample = values[:: -(-len(values) // MAX_SAMPLE)].astype(float)
    return bool((sample == np.rint(sample)).all() and len(np.unique(sample)) <= MAX_VALUES)


def to_srgb(channels: Sequence[NDArray]) -> tuple[NDArray[np.uint8] | None, str]:
    """Convert red, green and blue, (N,) each, to (N, 3) 8-bit sRGB; name the range, for a note.

    Floats of at most 1 are taken as 0-1, other numbers of at most 255 as 8-bit, of at most 65535 as
    16-bit. None where a value is larger, negative or not finite.
    """
    colors = np.stack(channels, axis=1)
    if colors.dtype == np.uint8:
        return colors, "8-bit"
    values = colors.astype(np.float64)
    low, high = (values.min(), values.max()) if values.size else (0.0, 0.0)
    if not (np.isfinite(values).all() and low >= 0 and high <= 65535):
        return None, f"left out: values from {low:g} to {high:g} are no colours"
    if high <= 1 and colors.dtype.kind == "f":
        return np.rint(values * 255).astype(np.uint8), "0–1"
    if high <= 255:
        return np.rint(values).astype(np.uint8), "8-bit"
    # The high byte is right for 8-bit values scaled by 257 and, as in LAS, by 256.
    return (values / 256).astype(np.uint8), "16-bit"
