"""Baking from Python: scans are paths, NumPy arrays or Open3D point clouds."""

from collections.abc import Iterator, Mapping, Sequence
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
from baker.options import Options
from baker.pipeline import Progress, bake_recorded
from gclip import Clip

PointData = dict[str, NDArray]
"""Arrays by the names that an NPZ file has them under; ``"points"`` is (N, 3)."""


def bake(
    scans: str | PathLike[str] | Sequence[Any],
    options: Options | None = None,
    progress: Progress | None = None,
    *,
    times: Sequence[float | str | date] | None = None,
    labels: str | Sequence[ArrayLike | None] | None = None,
    colors: str | Sequence[ArrayLike | None] | None = None,
    **choices: Any,
) -> Clip:
    """Bake scans into a growth clip.

    Parameters
    ----------
    scans : path, or sequence of paths, arrays and Open3D point clouds
        A folder of scans, or the scans themselves: files, (N, 3) float arrays in memory, or both.
    options : Options, optional
    progress : callable, optional
        Called with a stage's name, the steps done and the steps in all.
    times : sequence of float, str or datetime.date, optional
        Of each scan the day or the date; by default the names of files tell, or the order.
    labels : sequence of (N,) int array or None, or str, optional
        Of each scan in memory the organ of each point; or the option of that name.
    colors : sequence of (N, 3) uint8 array or None, or str, optional
        Of each scan in memory sRGB; or the option of that name.
    **choices
        Fields of `Options`, such as ``align="none"``.

    Returns
    -------
    gclip.Clip

    Raises
    ------
    InputError
        With one sentence for the user, where the scans or options can't be baked.

    Examples
    --------
    >>> clip = bake([first, second], times=[0, 2], unit="mm")  # doctest: +SKIP
    """
    beside: dict[str, Sequence[ArrayLike | None]] = {}
    for name, value in (("labels", labels), ("colors", colors)):
        if isinstance(value, str):
            choices[name] = value
        elif value is not None:
            beside[name] = value
    if all(own is not None for own in beside.get("labels", [None])):
        choices = {"label_field": "label"} | choices  # taken at their word
    options = replace(options or Options(), **choices)
    with _scan_files(scans, beside) as paths:
        return bake_recorded(paths, options, progress, times=times)[0]


@contextmanager
def _scan_files(
    scans: str | PathLike[str] | Sequence[Any],
    beside: Mapping[str, Sequence[ArrayLike | None]],
) -> Iterator[list[Path]]:
    """Paths of scans; those in memory are written, as NPZ files, for as long as it lasts.

    beside: labels and colours of the scans in memory, by the names of the arrays.
    """
    given = [scans] if isinstance(scans, str | PathLike) else list(scans)
    for name, values in beside.items():
        if len(values) != len(given):
            raise InputError(f"{name} holds {len(values)} arrays for {len(given)} scans.")
    with TemporaryDirectory() as folder:
        paths = []
        for index, scan in enumerate(given):
            own = {n: np.asarray(v[index]) for n, v in beside.items() if v[index] is not None}
            if not isinstance(scan, str | PathLike):
                paths.append(Path(folder, f"scans[{index}].npz"))
                arrays: Any = _point_data(scan, f"scans[{index}]") | own
                np.savez(paths[-1], **arrays)
            elif own:
                raise InputError(f"{min(own)} are for scans in memory; '{fspath(scan)}' is a file.")
            else:
                paths.append(Path(scan))
        try:
            yield paths
        except InputError as error:
            raise InputError(str(error).replace(f"{folder}/", "").replace("].npz", "]")) from None


def _point_data(scan: Any, name: str) -> PointData:
    if hasattr(scan, "point"):  # open3d.t.geometry.PointCloud
        found = {key: scan.point[key].cpu().numpy() for key in scan.point}
        return {"points": found.pop("positions")} | {
            key: _bytes(values) if key == "colors" else np.squeeze(values)
            for key, values in found.items()
            if key != "normals"
        }
    if hasattr(scan, "points"):  # open3d.geometry.PointCloud
        colors = {"colors": _bytes(np.asarray(scan.colors))} if scan.has_colors() else {}
        return {"points": np.asarray(scan.points)} | colors
    array = np.asarray(scan)
    if array.ndim != 2 or array.shape[1] < 3 or array.dtype.kind not in "biuf":
        what = f"an array of shape {array.shape} and type {array.dtype}"
        raise InputError(f"{name} is {what}; points, (N, 3) numbers, or a path are needed.")
    rest = {"labels": array[:, 3]} if array.shape[1] == 4 else {}
    if array.shape[1] > 4:
        rest = {"colors": array[:, 3:6]} | ({"labels": array[:, 6]} if array.shape[1] > 6 else {})
    return {"points": array[:, :3]} | rest


def _bytes(colors: NDArray) -> NDArray[np.uint8]:
    """Colours in [0, 1] as bytes."""
    if colors.dtype == np.uint8:
        return colors
    return np.round(255 * np.clip(colors, 0, 1)).astype(np.uint8)
