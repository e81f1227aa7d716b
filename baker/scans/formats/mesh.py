"""Meshes: OBJ, STL, GLB and glTF by Open3D, OFF here; points are sampled on their surface.

Open3D's reader of OFF ends the process at damaged files (docs/method.md).
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.scans.cloud import Columns
from baker.scans.formats.faults import FormatError, library_faults
from baker.scans.formats.surface import Faces, points_on_surface

Mesh = tuple[NDArray, NDArray, Faces]
"""(V, 3) vertices, (V, 3) uint8 colours or none, and faces."""


def read(path: Path) -> Columns:
    """x, y, z and, where the vertices are coloured, red, green and blue of points on the surface.

    Raises FormatError: not sound, or no faces to sample points on.
    """
    read_mesh = _read_off if path.suffix.lower() == ".off" else _reader_of_open3d()
    with library_faults(path.suffix[1:].upper()):
        vertices, colors, faces = read_mesh(path)
        if not len(vertices) or not len(faces):
            raise FormatError(
                f"holds no mesh: {len(vertices)} vertices and {len(faces)} faces found; export "
                "points without faces as PLY."
            )
        columns = dict(zip("xyz", vertices.T, strict=True))
        if len(colors) == len(vertices):
            columns |= dict(zip(("red", "green", "blue"), colors.T, strict=True))
        return points_on_surface(columns, faces)


def _reader_of_open3d() -> Callable[[Path], Mesh]:
    import open3d

    def read_mesh(path: Path) -> Mesh:
        if path.suffix.lower() == ".glb":  # room is made for as much as its first chunk announces
            with path.open("rb") as file:
                announced = int.from_bytes(file.read(16)[12:], "little")
            if announced > path.stat().st_size:
                raise FormatError(f"is cut short: its first chunk announces {announced} bytes.")
        with open3d.utility.VerbosityContextManager(open3d.utility.VerbosityLevel.Error):
            mesh = open3d.io.read_triangle_mesh(path)
        colors = np.rint(np.clip(np.asarray(mesh.vertex_colors), 0, 1) * 255).astype(np.uint8)
        return np.asarray(mesh.vertices), colors, np.asarray(mesh.triangles)

    return read_mesh


def _read_off(path: Path) -> Mesh:
    """OFF and COFF (colours from 0 to 255, or to 1, behind the coordinates).

    Format: http://www.geomview.org/docs/html/OFF.html
    """
    lines = [line.partition(b"#")[0].split() for line in path.read_bytes().splitlines()]
    rows = [line for line in lines if line]
    kind = rows[0].pop(0)
    if kind not in (b"OFF", b"COFF"):
        raise FormatError("is not an OFF file: it doesn't begin with 'OFF' or 'COFF'.")
    rows = rows if rows[0] else rows[1:]  # the counts may stand in the first line
    vertex_count, face_count = int(rows[0][0]), int(rows[0][1])
    rows = rows[1:]
    if vertex_count + face_count > len(rows):
        raise FormatError(
            f"is cut short, or its header is wrong: it announces {vertex_count} vertices and "
            f"{face_count} faces, but {len(rows)} lines follow."
        )
    vertices = np.array(rows[:vertex_count], float)
    corners = rows[vertex_count : vertex_count + face_count]
    faces = [np.array(row[1 : 1 + int(row[0])], int) for row in corners]
    colors = vertices[:, 3:6] if vertices.shape[1] >= 6 else np.empty((0, 3))
    scale = 255 if colors.size and colors.max() <= 1 else 1
    return vertices[:, :3], np.clip(colors * scale, 0, 255).astype(np.uint8), faces
