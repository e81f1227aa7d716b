"""The pose in which an organ of one scan is registered non-rigidly with the next scan."""

import numpy as np

from baker.geometry.rigid import fit_rotation
from baker.interpolation.deformation import MAX_WIDENING, Landmarks, spine_deformation
from baker.interpolation.organ_shapes import OrganShape
from baker.interpolation.spine import Points

MIN_NODES = 2  # other organs on an organ that is moved with its attachments
STIFFNESS = 0.01  # see `fit_rotation`


def starting_pose(source: OrganShape, target: OrganShape, landmarks: Landmarks) -> Points:
    """Move the points of an organ to about where they are in the other scan.

    They are moved along the spine or, if they are then nearer to the other scan, as a whole with
    the attachments: a stem that loses its top or a petiole has another spine.
    """
    along = spine_deformation(source.points, target.points, source.spine, target.spine, landmarks)
    if len(landmarks[0]) < MIN_NODES:
        return along
    poses = along, moved_with_attachments(source, target, landmarks)
    return min(poses, key=lambda pose: _distance(pose, target.points))


def moved_with_attachments(source: OrganShape, target: OrganShape, landmarks: Landmarks) -> Points:
    """Rotate, scale and shift an organ's points by its attachment and those of others on it."""
    sides = zip((source, target), landmarks, strict=True)
    places = [np.vstack([shape.attachment, shape.points[nodes]]) for shape, nodes in sides]
    centers = [side.mean(axis=0) for side in places]
    before, after = (side - center for side, center in zip(places, centers, strict=True))
    scale = np.linalg.norm(after) / max(float(np.linalg.norm(before)), 1e-30)
    scale = np.clip(scale, 1 / MAX_WIDENING, MAX_WIDENING)
    rotation = fit_rotation(before, after, STIFFNESS)
    return np.asarray(scale * (source.points - centers[0]) @ rotation.T + centers[1])


def _distance(first: Points, second: Points) -> float:
    """Sum of the mean distances from the points of each cloud to the nearest of the other."""
    from scipy.spatial import cKDTree

    sides = (first, second), (second, first)
    return sum(float(cKDTree(a).query(b)[0].mean()) for a, b in sides)
