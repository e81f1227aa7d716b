"""Baking from Python: scans are paths, NumPy arrays or Open3D point clouds."""

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
"""Arrays by the names that an NPZ file has them under; ``"points"`` is (N, 3)."""


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
    corrections : path, or sequence of gclip.corrections.Correction, optional
        What was put right about the organs, such as the file that the window wrote.
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
    if isinstance(corrections, str | PathLike):
        choices["corrections"] = parse_corrections(fspath(corrections))
    elif corrections is not None:
        choices["corrections"] = tuple(corrections)
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
    if isinstance(scans, str | PathLike) or not isinstance(scans, Iterable):  # one point cloud
        scans = [scans]
    given = list(scans)
    for name, values in beside.items():
        if len(values) != len(given):
            raise InputError(f"{name} holds {len(values)} arrays for {len(given)} scans.")
    with TemporaryDirectory() as folder:
        paths = []
        for index, scan in enumerate(given):
            own = {n: np.asarray(v[index]) for n, v in beside.items() if v[index] is not None}
            if not isinstance(scan, str | PathLike):
                paths.append(_written(scan, own, Path(folder, f"scans[{index}]")))
            elif own:
                raise InputError(f"{min(own)} are for scans in memory; '{fspath(scan)}' is a file.")
            else:
                paths.append(Path(scan))
        try:
            yield paths
        except InputError as error:
            said = re.sub(r"\]\.np[yz]", "]", str(error).replace(f"{folder}/", ""))
            raise InputError(said) from None


def _written(scan: Any, beside: PointData, path: Path) -> Path:
    """The file of a scan in memory; `path` is its name without suffix."""
    if hasattr(scan, "point") or hasattr(scan, "points"):
        data = _cloud_data(scan)
    else:
        table = np.asarray(scan)
        if table.ndim != 2 or table.shape[1] < 3 or table.dtype.kind not in "biuf":
            what = f"an array of shape {table.shape} and type {table.dtype}"
            raise InputError(
                f"{path.name} is {what}; points, (N, 3) numbers, or a path are needed."
            )
        if not beside:  # what its columns are, the reader of such files tells
            np.save(f"{path}.npy", table)
            return Path(f"{path}.npy")
        data = {"points": table[:, :3]}
    arrays: Any = data | beside
    np.savez(f"{path}.npz", **arrays)
    return Path(f"{path}.npz")


def _cloud_data(cloud: Any) -> PointData:
    """The arrays of an Open3D point cloud, of tensors (`.point`) or of the older kind."""
    if hasattr(cloud, "point"):
        found = {key: cloud.point[key].cpu().numpy() for key in cloud.point}
        return {"points": found.pop("positions")} | {
            key: _bytes(values) if key == "colors" else np.squeeze(values)
            for key, values in found.items()
            if key != "normals"
        }
    colors = {"colors": _bytes(np.asarray(cloud.colors))} if cloud.has_colors() else {}
    return {"points": np.asarray(cloud.points)} | colors


def _bytes(colors: NDArray) -> NDArray[np.uint8]:
    """Colours in [0, 1] as bytes."""
    if colors.dtype == np.uint8:
        return colors
    return np.round(255 * np.clip(colors, 0, 1)).astype(np.uint8)
