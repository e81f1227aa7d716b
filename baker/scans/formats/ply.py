"""PLY (Stanford polygon format) by plyfile: the vertices, or points on the surface of a mesh.

Not by Open3D, whose reader ends the process at damaged ascii files (docs/method.md).
"""

import re
from io import BytesIO
from pathlib import Path

import numpy as np

from baker.errors import excerpt
from baker.scans.cloud import Columns
from baker.scans.formats import FormatError, require_room
from baker.scans.formats.mesh import Faces, points_on_surface

MAX_HEADER_BYTES = 1 << 20
CORNERS = ("vertex_indices", "vertex_index")  # of a face; both names are in use


def read(path: Path) -> Columns:
    """The properties of the vertices that are no lists; of a mesh, of points sampled on its faces.

    Raises FormatError: not PLY, no vertices, or a body that doesn't hold what the header announces.
    """
    from plyfile import PlyData, PlyElementParseError

    header = _sound_header(path)
    known = re.sub(rb"^(property\s+)bool\b", rb"\1uchar", header, flags=re.MULTILINE)
    body = b"" if known == header else path.read_bytes()[len(header) :]  # plyfile has no bool
    try:  # triangles, which need no loop over the faces
        triangles = {"face": dict.fromkeys(CORNERS, 3)}
        elements = PlyData.read(BytesIO(known + body) if body else path, known_list_len=triangles)
    except PlyElementParseError:
        elements = PlyData.read(BytesIO(known + body) if body else path)
    names = [element.name for element in elements]
    if "vertex" not in names:
        found = excerpt(", ".join(names)) or "none"
        raise FormatError(f"has no element 'vertex' (it has {found}).")
    vertices = elements["vertex"].data
    columns = {name: np.asarray(vertices[name]) for name in vertices.dtype.names or ()}
    columns = {name: values for name, values in columns.items() if values.dtype.kind != "O"}
    faces: Faces = ()
    if "face" in names:
        kinds = elements["face"].data.dtype.names or ()
        faces = next((elements["face"][name] for name in CORNERS if name in kinds), ())
    return points_on_surface(columns, faces)


def _sound_header(path: Path) -> bytes:
    """The header; refused where it is none, or announces more than the file can hold."""
    with path.open("rb") as file:
        header = file.read(MAX_HEADER_BYTES)
    if not re.match(rb"ply\s", header):
        raise FormatError("is not a PLY file: its first line isn't 'ply'.")
    end = re.search(rb"^end_header\b", header, re.MULTILINE)
    if not end:
        raise FormatError("has a PLY header without an end ('end_header').")
    counts = re.findall(rb"^element\s+\S+\s+(\d{1,18})\b", header[: end.start()], re.MULTILINE)
    for count in filter(None, map(int, counts)):
        require_room(count, 1, path.stat().st_size - end.end())
    return header[: end.end()]
