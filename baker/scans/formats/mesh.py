"""Read meshes and sample points evenly on their surface.

Open3D reads STL, GLB and glTF. OBJ and OFF are read here: of both Open3D loses digits, and of an
OBJ the faces of more than three corners (docs/method.md).
"""

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.scans.formats import Columns, FormatError, require_count

MIN_POINTS, MAX_POINTS = 20_000, 100_000  # number of points that are sampled on a mesh

Mesh = tuple[NDArray, list[NDArray]]
"""(V, 3) vertices or, with red, green and blue, (V, 6) or more, and the faces of each size."""


def read(path: Path) -> Columns:
    """Sample x, y, z and, if the vertices are coloured, red, green, blue on the surface."""
    readers = {".obj": _read_obj, ".off": _read_off}
    vertices, faces = readers.get(path.suffix.lower(), _read_by_open3d)(path)
    if not len(vertices) or not any(map(len, faces)):
        raise FormatError(
            "holds no mesh that can be read, or is cut short; points without faces are exported as "
            "PLY."
        )
    names = ("x", "y", "z", "red", "green", "blue")[: 6 if vertices.shape[1] >= 6 else 3]
    return points_on_surface(dict(zip(names, vertices.T, strict=False)), faces)


def _read_by_open3d(path: Path) -> Mesh:
    """Read STL, GLB or glTF."""
    import open3d

    if re.search(rb'"uri"\s*:\s*"(?!data:)', path.read_bytes()):
        raise FormatError("refers to other files; export it as one GLB file.")
    with open3d.utility.VerbosityContextManager(open3d.utility.VerbosityLevel.Error):
        mesh = open3d.io.read_triangle_mesh(path)
    table = [mesh.vertices, mesh.vertex_colors] if mesh.has_vertex_colors() else [mesh.vertices]
    return np.hstack(list(map(np.asarray, table))), [np.asarray(mesh.triangles)]


def _rows(path: Path) -> list[list[bytes]]:
    """The words of each line of a text file, without comments and empty lines."""
    content = re.sub(rb"\\\r?\n", b" ", path.read_bytes())  # continued lines
    lines = (line.partition(b"#")[0].split() for line in content.splitlines())
    return [line for line in lines if line]


def _read_obj(path: Path) -> Mesh:
    """Read OBJ, with or without colours after the coordinates. Materials are not read.

    Format: https://paulbourke.net/dataformats/obj
    """
    vertices: list[list[bytes]] = []
    faces = defaultdict[int, list[list[int]]](list)
    for kind, *values in _rows(path):
        if kind == b"v":
            vertices.append(values)
        elif kind == b"f":
            corners = [int(value.partition(b"/")[0]) for value in values]
            # Negative numbers count back from the last vertex so far.
            faces[len(corners)].append([k - 1 if k > 0 else len(vertices) + k for k in corners])
    return np.array(vertices, float), list(map(np.array, faces.values()))


def _read_off(path: Path) -> Mesh:
    """Read OFF, or COFF with colours from 0 to 255, or to 1, after the coordinates.

    Format: http://www.geomview.org/docs/html/OFF.html
    """
    (kind, *counts), *rows = _rows(path)
    if kind not in (b"OFF", b"COFF"):
        raise FormatError("is not an OFF file: it doesn't begin with 'OFF' or 'COFF'.")
    counts = counts or rows.pop(0)  # which may stand in the first line
    vertex_count, face_count = int(counts[0]), int(counts[1])
    rows = rows[: vertex_count + face_count]
    require_count(vertex_count + face_count, len(rows), "lines")
    faces = defaultdict[int, list[list[bytes]]](list)
    for size, *corners in rows[vertex_count:]:
        faces[int(size)].append(corners[: int(size)])
    return np.array(rows[:vertex_count], float), [np.array(v, int) for v in faces.values()]


def points_on_surface(vertices: Mapping[str, NDArray], faces: Iterable[NDArray]) -> Columns:
    """Sample as many points on faces as there are vertices, one in each equal share of the surface.

    vertices: (V,) numbers by the name of their field. faces: arrays of (F, k), the indices of the
    vertices of F faces, which are divided into triangles. Colours, labels and other fields are
    those of the nearest corner. Returns the vertices if the faces have no area. Raises FormatError
    if a corner is not a vertex.
    """
    fans = [
        polygons[:, [(0, k, k + 1) for k in range(1, polygons.shape[1] - 1)]].reshape(-1, 3)
        for polygons in faces
        if polygons.shape[1] > 2
    ]
    triangles = np.concatenate([np.empty((0, 3)), *fans]).astype(np.int64)
    count = len(next(iter(vertices.values())))
    if not ((triangles >= 0) & (triangles < count)).all():
        raise FormatError(f"has faces with corners that are not among its {count} vertices.")
    if not set("xyz") <= set(vertices):
        return Columns(dict(vertices))
    corners = np.stack([vertices[axis] for axis in "xyz"], axis=1).astype(np.float64)[triangles]
    with np.errstate(all="ignore"):
        sides = np.diff(corners, axis=1)
        areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
        total = np.where(np.isfinite(areas), areas, 0.0).cumsum()
    if not 0.0 < total.max(initial=0.0) < np.inf:
        return Columns(dict(vertices))

    size = int(np.clip(count, MIN_POINTS, MAX_POINTS))
    random = np.random.default_rng(0)
    at_area = (np.arange(size) + random.random(size)) / size * total[-1]
    chosen = np.searchsorted(total[:-1], at_area, side="right")
    # Uniform in a triangle: R. Osada et al., Shape Distributions, ACM ToG 21, 2002, equation 1.
    root, fraction = np.sqrt(random.random(size)), random.random(size)
    weights = np.stack([1 - root, root * (1 - fraction), root * fraction], axis=1)
    nearest = triangles[chosen, weights.argmax(axis=1)]
    points = (corners[chosen] * weights[:, :, None]).sum(axis=1)
    columns = {name: values[nearest] for name, values in vertices.items()}
    columns |= dict(zip("xyz", points.T, strict=True))
    note = f"a mesh of {len(triangles)} triangles: {size} points sampled evenly on its surface."
    return Columns(columns, (note,))
