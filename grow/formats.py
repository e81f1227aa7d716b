"""Write point clouds: one function for each format, listed in `WRITERS`.

Fields of missing labels or colours are left out. Equal clouds give equal bytes.
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Record = NDArray[np.void]


def record(
    points: NDArray[np.float32], labels: NDArray[np.int64] | None, colors: NDArray[np.uint8] | None
) -> Record:
    """(N,) structured array of the points, with fields x y z [red green blue] [label]."""
    fields: list[tuple[str, str]] = [(axis, "<f4") for axis in "xyz"]
    columns: list[NDArray] = list(points.T)
    if colors is not None:
        fields += [(name, "u1") for name in ("red", "green", "blue")]
        columns += list(colors.T)
    if labels is not None:
        fields.append(("label", "<i4"))
        columns.append(labels)
    rows = np.empty(len(points), fields)
    for (name, _), column in zip(fields, columns, strict=True):
        rows[name] = column
    return rows


def write_ply(path: Path, rows: Record) -> None:
    """Write binary little-endian PLY."""
    kinds = {"f4": "float", "u1": "uchar", "i4": "int"}
    properties = [
        f"property {kinds[rows.dtype[name].str[1:]]} {name}\n" for name in rows.dtype.names or ()
    ]
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(rows)}\n"
        f"{''.join(properties)}end_header\n"
    )
    path.write_bytes(header.encode() + rows.tobytes())


def write_pcd(path: Path, rows: Record) -> None:
    """Write binary PCD 0.7, with colours as three fields of one byte."""
    names = rows.dtype.names or ()
    kinds = [rows.dtype[name] for name in names]
    header = (
        "VERSION 0.7\n"
        f"FIELDS {' '.join(names)}\n"
        f"SIZE {' '.join(str(kind.itemsize) for kind in kinds)}\n"
        f"TYPE {' '.join(kind.kind.upper() for kind in kinds)}\n"
        f"COUNT {' '.join('1' for _ in names)}\n"
        f"WIDTH {len(rows)}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
        f"POINTS {len(rows)}\nDATA binary\n"
    )
    path.write_bytes(header.encode() + rows.tobytes())


def write_table(path: Path, rows: Record) -> None:
    """Write text with one point on each line, and as CSV with a header if the suffix is .csv."""
    names = rows.dtype.names or ()
    comma = path.suffix == ".csv"
    with path.open("w", encoding="ascii", newline="\n") as file:
        if comma:
            file.write(",".join(names) + "\n")
        np.savetxt(
            file,
            rows,
            fmt=["%.4f" if rows.dtype[name].kind == "f" else "%d" for name in names],
            delimiter="," if comma else " ",
        )


def write_las(path: Path, rows: Record) -> None:
    """Write LAS 1.2, or LAZ by the suffix, in mm; labels are an extra dimension `label`."""
    from datetime import date

    import laspy

    names = rows.dtype.names or ()
    header = laspy.LasHeader(point_format=2 if "red" in names else 0, version="1.2")
    header.creation_date = date(2000, 1, 1)
    header.scales = np.full(3, 1e-4)
    if "label" in names:
        header.add_extra_dim(laspy.ExtraBytesParams("label", np.int32))
    cloud = laspy.LasData(header)
    for name in names:
        value = rows[name]
        # LAS colours have 16 bits.
        cloud[name] = value.astype(np.uint16) * 257 if value.dtype == np.uint8 else value
    cloud.write(path)


WRITERS: dict[str, Callable[[Path, Record], None]] = {
    "ply": write_ply,
    "txt": write_table,
    "xyz": write_table,
    "csv": write_table,
    "pcd": write_pcd,
    "las": write_las,
    "laz": write_las,
}
