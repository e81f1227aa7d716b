"""Read meshes and sample points evenly on their surface.

Open3D reads STL, GLB and glTF. OBJ and OFF are read here: Open3D leaves out an OBJ's faces of more
than three corners, and crashes on damaged OFF files (docs/method.md).
"""

import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import excerpt
from baker.scans.fields import COLOR_NAMES
from baker.scans.formats import Columns, FormatError, require_count

MIN_POINTS, MAX_POINTS = 20_000, 100_000
"""As many points are sampled as the mesh has vertices, within these limits."""

INTERPOLATED = {*"xyz", *(name for names in COLOR_NAMES for name in names)}
Faces = NDArray | Sequence[Sequence[int]] | Sequence[NDArray]
Mesh = tuple[NDArray, Faces]
"""(V, 3) vertices or, with red, green and blue, (V, 6) or more, and faces."""


def read(path: Path) -> Columns:
    """Sample x, y, z and, if the vertices are coloured, red, green, blue on the surface.

    Raises FormatError: the file is damaged, or has no faces.
    """
    readers = {".obj": _read_obj, ".off": _read_off}
    vertices, faces = readers.get(path.suffix.lower(), _read_by_open3d)(path)
    if not len(vertices) or not len(faces):
        raise FormatError(
            "holds no mesh that can be read, or is cut short; points without faces are exported as "
            "PLY."
        )
    names = ("x", "y", "z", "red", "green", "blue")[: 6 if vertices.shape[1] >= 6 else 3]
    return points_on_surface(dict(zip(names, vertices.T, strict=False)), faces)


def _read_by_open3d(path: Path) -> Mesh:
    import open3d

    content, start, end = path.read_bytes(), 0, None
    if path.suffix.lower() == ".glb":
        start, end = 20, 20 + int.from_bytes(content[12:16], "little")
    if path.suffix.lower() != ".stl":
        json.loads(content[start:end], object_hook=_require_inside)
    with open3d.utility.VerbosityContextManager(open3d.utility.VerbosityLevel.Error):
        mesh = open3d.io.read_triangle_mesh(path)
    table = [mesh.vertices, mesh.vertex_colors] if mesh.has_vertex_colors() else [mesh.vertices]
    return np.hstack(list(map(np.asarray, table))), np.asarray(mesh.triangles)


def _require_inside(part: dict) -> None:
    """Refuse a part of a glTF document that refers to a file outside of the document's folder."""
    if ".." in re.split(r"[/\\]", part.get("uri", "")):
        raise FormatError(f"refers to '{excerpt(part['uri'])}', outside of its folder.")


def _rows(path: Path) -> list[list[bytes]]:
    """The words of each line that has some, without comments."""
    content = re.sub(rb"\\\r?\n", b" ", path.read_bytes())  # continued lines
    lines = (line.partition(b"#")[0].split() for line in content.splitlines())
    return [line for line in lines if line]


def _read_obj(path: Path) -> Mesh:
    """Read OBJ, with or without colours after the coordinates. Materials are not read.

    Format: https://paulbourke.net/dataformats/obj
    """
    vertices: list[list[bytes]] = []
    faces: list[list[int]] = []
    for kind, *values in _rows(path):
        if kind == b"v":
            vertices.append(values)
        elif kind == b"f":
            corners = [int(value.partition(b"/")[0]) for value in values]
            # Negative numbers count back from the last vertex so far.
            faces.append([k - 1 if k > 0 else len(vertices) + k for k in corners])
    return np.array(vertices, float), faces


def _read_off(path: Path) -> Mesh:
    """Read OFF, or COFF with colours from 0 to 255, or to 1, after the coordinates.

    Format: http://www.geomview.org/docs/html/OFF.html
    """
    rows = _rows(path)
    kind = rows[0].pop(0)
    if kind not in (b"OFF", b"COFF"):
        raise FormatError("is not an OFF file: it doesn't begin with 'OFF' or 'COFF'.")
    rows = rows if rows[0] else rows[1:]  # the counts may stand in the first line
    vertex_count, face_count = int(rows[0][0]), int(rows[0][1])
    rows = rows[1 : 1 + vertex_count + face_count]
    require_count(vertex_count + face_count, len(rows), "lines")
    faces = [[*map(int, row[1 : 1 + int(row[0])])] for row in rows[vertex_count:]]
    return np.array(rows[:vertex_count], float), faces


def points_on_surface(vertices: Mapping[str, NDArray], faces: Faces) -> Columns:
    """Sample points on faces by stratified sampling: one in each equal share of the surface.

    Positions and colours are interpolated in the triangle; other fields are those of the nearest
    corner. Larger faces are split into fans of triangles.

    Parameters
    ----------
    vertices : mapping
        Field name -> (V,) numbers, with "x", "y" and "z".
    faces : (F, 3) array, or sequence of F arrays
        Indices of the vertices.

    Returns
    -------
    Columns
        The vertices themselves, if the faces have no area.

    Raises
    ------
    FormatError
        If a face has a corner that is not a vertex.
    """
    if isinstance(faces, np.ndarray) and faces.ndim == 2 and faces.shape[1] == 3:
        corners = faces.astype(np.int64)
    else:
        fans = [(face[0], *face[k : k + 2]) for face in faces for k in range(1, len(face) - 1)]
        corners = np.array(fans, np.int64).reshape(-1, 3)
    count = len(next(iter(vertices.values())))
    if corners.size and not (corners.min() >= 0 and corners.max() < count):
        raise FormatError(f"has faces with corners that are not among its {count} vertices.")
    if not set("xyz") <= set(vertices):
        return Columns(dict(vertices))
    positions = np.stack([vertices[axis].astype(np.float64) for axis in "xyz"], axis=1)
    with np.errstate(all="ignore"):
        first, second, third = (positions[corners[:, k]] for k in range(3))
        areas = np.linalg.norm(np.cross(second - first, third - first), axis=1)
        areas[~np.isfinite(areas)] = 0.0
        total = areas.cumsum()
    if not len(total) or not 0.0 < total[-1] < np.inf:
        return Columns(dict(vertices))

    sampled = int(np.clip(count, MIN_POINTS, MAX_POINTS))
    random = np.random.default_rng(0)
    at_area = (np.arange(sampled) + random.random(sampled)) / sampled * total[-1]
    chosen = corners[np.minimum(np.searchsorted(total, at_area, side="right"), len(total) - 1)]
    # Uniform in a triangle: R. Osada et al., Shape Distributions, ACM ToG 21, 2002, equation 1.
    root, along = np.sqrt(random.random(sampled)), random.random(sampled)
    weights = np.stack([1 - root, root * (1 - along), root * along], axis=1)
    nearest = chosen[np.arange(sampled), weights.argmax(axis=1)]
    columns = {name: values[nearest] for name, values in vertices.items()}
    for name in (name for name in columns if name.lower() in INTERPOLATED):
        values, kind = vertices[name][chosen], vertices[name].dtype
        # Rounding must not lead out of the range of the values: 1.0000001 is no colour from 0 to 1.
        mixed = np.clip((values * weights).sum(axis=1), values.min(axis=1), values.max(axis=1))
        columns[name] = np.rint(mixed).astype(kind) if kind.kind in "iu" else mixed
    note = f"a mesh of {len(corners)} triangles: {sampled} points sampled evenly on its surface."
    return Columns(columns, (note,))
