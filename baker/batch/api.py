"""Bake scans from Python: files, NumPy arrays or Open3D point clouds."""

import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from datetime import date
from os import PathLike, fspath
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from baker.errors import InputError
from baker.options import Options, parse_corrections
from baker.pipeline import Progress, bake_with_survey
from corrections import Correction
from gclip import Clip

Attributes = dict[str, Sequence[ArrayLike | None]]
"""Arrays of each scan by their name in an NPZ file, such as "labels"."""


def bake(
    scans: str | PathLike[str] | Sequence[Any],
    options: Options | None = None,
    progress: Progress | None = None,
    *,
    times: Sequence[float | str | date] | None = None,
    labels: str | Sequence[ArrayLike | None] | None = None,
    colors: str | Sequence[ArrayLike | None] | None = None,
    corrections: str | PathLike[str] | Sequence[Correction] | None = None,
    **choices: Any,
) -> Clip:
    """Bake scans into a growth clip.

    Parameters
    ----------
    scans : path, or sequence of paths, arrays and Open3D point clouds
        A folder of scans, or the scans themselves: files, (N, 3) float arrays, or both.
    options : Options, optional
    progress : callable, optional
        Called with the name of a stage, the number of steps done and their total.
    times : sequence of float, str or datetime.date, optional
        The day or date of each scan; by default from the files' names, or their order.
    labels : sequence of (N,) int array or None, or str, optional
        The organ of each point, for each scan in memory; or the option of that name.
    colors : sequence of (N, 3) uint8 array or None, or str, optional
        The sRGB colours of each scan in memory; or the option of that name.
    corrections : path, or sequence of corrections.Correction, optional
        Corrections to the organs, such as the file that the player's window writes.
    **choices
        Fields of `Options`, such as ``align="none"``.

    Returns
    -------
    gclip.Clip

    Raises
    ------
    InputError
        If the scans or options can't be baked; the message is one sentence.

    Examples
    --------
    >>> clip = bake([first, second], times=[0, 2], unit="mm")  # doctest: +SKIP
    """
    attributes: Attributes = {}
    for name, value in (("labels", labels), ("colors", colors)):
        if isinstance(value, str):
            choices[name] = value
        elif value is not None:
            attributes[name] = value
    if isinstance(corrections, str | PathLike):
        choices["corrections"] = parse_corrections(fspath(corrections))
    elif corrections is not None:
        choices["corrections"] = tuple(corrections)
    if all(array is not None for array in attributes.get("labels", [None])):
        choices = {"label_field": "label"} | choices  # a field that the user names is not doubted
    options = replace(options or Options(), **choices)
    with _scan_files(scans, attributes) as paths:
        return bake_with_survey(paths, options, progress, times=times)[0]


@contextmanager
def _scan_files(scans: Any, attributes: Attributes) -> Iterator[list[Path]]:
    """Yield the files of the scans; scans in memory are written to temporary files."""
    is_one = isinstance(scans, str | PathLike) or not isinstance(scans, Iterable)
    scans = [scans] if is_one else list(scans)
    for name, values in attributes.items():
        if len(values) != len(scans):
            raise InputError(f"{name} holds {len(values)} arrays for {len(scans)} scans.")
    with TemporaryDirectory() as folder:
        paths = []
        for index, scan in enumerate(scans):
            own = {n: np.asarray(v[index]) for n, v in attributes.items() if v[index] is not None}
            paths.append(_scan_file(scan, own, Path(folder, f"scans[{index}]")))
        try:
            yield paths
        except InputError as error:
            message = re.sub(r"\]\.np[yz]", "]", str(error).replace(f"{folder}/", ""))
            raise InputError(message) from None


def _scan_file(scan: Any, attributes: dict[str, NDArray], path: Path) -> Path:
    """The path of a scan's file; a scan in memory is first written to `path` with a suffix."""
    if isinstance(scan, str | PathLike):
        if attributes:
            description = f"'{fspath(scan)}' is a file"
            raise InputError(f"{min(attributes)} are for scans in memory; {description}.")
        return Path(scan)
    if hasattr(scan, "point") or hasattr(scan, "points"):
        arrays = _cloud_arrays(scan)
    else:
        table = np.asarray(scan)
        if table.ndim != 2 or table.shape[1] < 3 or table.dtype.kind not in "biuf":
            description = f"an array of shape {table.shape} and type {table.dtype}"
            raise InputError(
                f"{path.name} is {description}; points, (N, 3) numbers, or a path are needed."
            )
        if not attributes:  # the reader of NPY files names the columns
            np.save(f"{path}.npy", table)
            return Path(f"{path}.npy")
        arrays = {"points": table[:, :3]}
    np.savez(f"{path}.npz", **(arrays | attributes))  # type: ignore[arg-type]
    return Path(f"{path}.npz")


def _cloud_arrays(cloud: Any) -> dict[str, NDArray]:
    """The arrays of an Open3D point cloud, under the names that the reader of NPZ files knows."""
    if not hasattr(cloud, "point"):  # of the legacy API
        import open3d

        cloud = open3d.t.geometry.PointCloud.from_legacy(cloud, open3d.core.float64)
    arrays = {name: cloud.point[name].cpu().numpy() for name in cloud.point if name != "normals"}
    colors = arrays.get("colors")
    if colors is not None and colors.dtype != np.uint8:
        arrays["colors"] = np.round(255 * np.clip(colors, 0, 1)).astype(np.uint8)
    return {name: v[:, 0] if v.shape[1:] == (1,) else v for name, v in arrays.items()}
