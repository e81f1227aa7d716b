"""Voxel sampling of the full-resolution tomato: how the two scans of this folder were made.

Usage: ``python examples/tomato/make.py FOLDER_OF_THE_FULL_SCANS``
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from plyfile import PlyData, PlyElement

VOXEL_SIDE = 0.3  # mm: 12,000 points a scan on average


def voxel_sample(points: np.ndarray, side: float) -> np.ndarray:
    """Of each occupied voxel, the index of the point nearest to its centre.

    Parameters
    ----------
    points : (N, 3) array, mm
    side : float
        Edge of a voxel, mm. The grid starts at the coordinates' origin, so that two scans of one
        frame are sampled on one grid.

    Returns
    -------
    (M,) array of int, ascending
    """
    voxels = np.floor(points / side)
    distances = np.linalg.norm(points / side - voxels - 0.5, axis=1)
    nearest_first = np.argsort(distances, kind="stable")
    _, first = np.unique(voxels[nearest_first], axis=0, return_index=True)
    return np.sort(nearest_first[first])


def main(source: Path) -> None:
    for path in sorted(source.glob("*.ply")):
        full = PlyData.read(path)["vertex"]
        points = np.column_stack([full[axis] for axis in "xyz"])
        kept = points[voxel_sample(points.astype(np.float64), VOXEL_SIDE)].astype("<f4")
        vertices = kept.view([(axis, "<f4") for axis in "xyz"])[:, 0]
        PlyData(
            [PlyElement.describe(vertices, "vertex")],
            byte_order="<",
            comments=["PRBonn/4d_plant_registration, MIT licence; sampled on voxels of 0.3 mm"],
        ).write(Path(__file__).parent / path.name)
        print(f"{path.name}: {len(kept):,} of {len(points):,} points")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
