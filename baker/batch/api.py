"""Bake scans from Python: files, NumPy arrays or Open3D point clouds."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
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
from baker.pipeline import Progress, bake_recorded
from gclip import Clip
from gclip.corrections import Correction

PointData = dict[str, NDArray]
"""Name of the array in an NPZ file -> array; ``"points"`` is (N, 3)."""


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
        Called with the name of a stage, the steps done and their total.
    times : sequence of float, str or datetime.date, optional
        The day or date of each scan; by default from the files' names, or their order.
    labels : sequence of (N,) int array or None, or str, optional
        The organ of each point, for each scan in memory; or the option of that name.
    colors : sequence of (N, 3) uint8 array or None, or str, optional
        The sRGB colours of each scan in memory; or the option of that name.
    corrections : path, or sequence of gclip.corrections.Correction, optional
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
    attributes: dict[str, Sequence[ArrayLike | None]] = {}
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
        choices = {"label_field": "label"} | choices  # labels that are given are never doubted
    options = replace(options or Options(), **choices)
    with _scan_files(scans, attributes) as paths:
        return bake_recorded(paths, options, progress, times=times)[0]


@contextmanager
def _scan_files(
    scans: str | PathLike[str] | Sequence[Any], attributes: Mapping[str, Sequence[ArrayLike | None]]
) -> Iterator[list[Path]]:
    """The files of the scans; those in memory are written to temporary files, with attributes."""
    if isinstance(scans, str | PathLike) or not isinstance(scans, Iterable):  # one point cloud
        scans = [scans]
    scans = list(scans)
    for name, values in attributes.items():
        if len(values) != len(scans):
            raise InputError(f"{name} holds {len(values)} arrays for {len(scans)} scans.")
    with TemporaryDirectory() as folder:
        paths = []
        for index, scan in enumerate(scans):
            data = {n: np.asarray(v[index]) for n, v in attributes.items() if v[index] is not None}
            paths.append(_scan_file(scan, data, Path(folder, f"scans[{index}]")))
        try:
            yield paths
        except InputError as error:
            message = re.sub(r"\]\.np[yz]", "]", str(error).replace(f"{folder}/", ""))
            raise InputError(message) from None


def _scan_file(scan: Any, attributes: PointData, path: Path) -> Path:
    """The file of a scan; one in memory is written to `path` with a suffix."""
    if isinstance(scan, str | PathLike):
        if attributes:
            found = f"'{fspath(scan)}' is a file"
            raise InputError(f"{min(attributes)} are for scans in memory; {found}.")
        return Path(scan)
    if hasattr(scan, "point") or hasattr(scan, "points"):
        data = _cloud_data(scan)
    else:
        table = np.asarray(scan)
        if table.ndim != 2 or table.shape[1] < 3 or table.dtype.kind not in "biuf":
            found = f"an array of shape {table.shape} and type {table.dtype}"
            raise InputError(
                f"{path.name} is {found}; points, (N, 3) numbers, or a path are needed."
            )
        if not attributes:  # the reader of NPY files names the columns
            np.save(f"{path}.npy", table)
            return Path(f"{path}.npy")
        data = {"points": table[:, :3]}
    arrays: Any = data | attributes
    np.savez(f"{path}.npz", **arrays)
    return Path(f"{path}.npz")


def _cloud_data(cloud: Any) -> PointData:
    """The arrays of an Open3D point cloud, a tensor one (with `.point`) or a legacy one."""
    if hasattr(cloud, "point"):
        arrays = {key: cloud.point[key].cpu().numpy() for key in cloud.point}
        return {"points": arrays.pop("positions")} | {
            key: _to_bytes(values) if key == "colors" else np.squeeze(values)
            for key, values in arrays.items()
            if key != "normals"
        }
    colors = {"colors": _to_bytes(np.asarray(cloud.colors))} if cloud.has_colors() else {}
    return {"points": np.asarray(cloud.points)} | colors


def _to_bytes(colors: NDArray) -> NDArray[np.uint8]:
    """Convert colours in [0, 1] to uint8; uint8 stays as it is."""
    if colors.dtype == np.uint8:
        return colors
    return np.round(255 * np.clip(colors, 0, 1)).astype(np.uint8)
