"""Points spread evenly over the surface of a mesh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from baker.scans.cloud import Columns
from baker.scans.fields import COLOR_NAMES
from baker.scans.formats.faults import FormatError

FEWEST_POINTS, MOST_POINTS = 20_000, 100_000
"""A mesh gives as many points as it has vertices, but no fewer and no more than these."""

Faces = NDArray | Sequence[NDArray]
INTERPOLATED = {*"xyz", *(name for names in COLOR_NAMES for name in names)}


def points_on_surface(vertices: Mapping[str, NDArray], faces: Faces) -> Columns:
    """Sample the faces evenly: one point in each equal share of the surface.

    Parameters
    ----------
    vertices : mapping of str to (V,) ndarray
        The fields of the vertices.
    faces : (F, 3) ndarray, or sequence of F ndarrays of int
        Numbers of each face's corners; faces of more corners are fans of triangles.

    Returns
    -------
    Columns
        The same fields of the sampled points. Positions and colours are interpolated between a
        triangle's corners, others (labels) are those of the nearest corner. Where the faces have
        no area, the vertices themselves.

    Raises
    ------
    FormatError
        A face has a corner that is not among the vertices.
    """
    corners = _triangles(faces)
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

    wanted = int(np.clip(count, FEWEST_POINTS, MOST_POINTS))
    random = np.random.default_rng(0)
    places = (np.arange(wanted) + random.random(wanted)) / wanted * total[-1]
    chosen = corners[np.minimum(np.searchsorted(total, places, side="right"), len(total) - 1)]
    # Uniform in a triangle: R. Osada et al., Shape Distributions, ACM ToG 21, 2002, equation 1.
    root, along = np.sqrt(random.random(wanted)), random.random(wanted)
    weights = np.stack([1 - root, root * (1 - along), root * along], axis=1)
    nearest = chosen[np.arange(wanted), weights.argmax(axis=1)]
    columns: dict[str, NDArray] = {}
    for name, values in vertices.items():
        if name.lower() not in INTERPOLATED:
            columns[name] = values[nearest]
            continue
        mixed = (values[chosen] * weights).sum(axis=1)
        is_integer = values.dtype.kind in "iu"
        columns[name] = np.rint(mixed).astype(values.dtype) if is_integer else mixed
    note = f"a mesh of {len(corners)} triangles: {wanted} points sampled evenly on its surface."
    return Columns(columns, (note,))


def _triangles(faces: Faces) -> NDArray[np.int64]:
    if isinstance(faces, np.ndarray) and faces.ndim == 2 and faces.shape[1] == 3:
        return faces.astype(np.int64)
    fans = [(face[0], face[k], face[k + 1]) for face in faces for k in range(1, len(face) - 1)]
    return np.array(fans, np.int64).reshape(-1, 3)
