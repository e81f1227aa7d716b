"""An orbit camera about a target; the plant's up axis stays vertical in the picture."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from gclip.evaluate import positions_on_curve
from traits.upright import upright_axes

Vector = NDArray[np.float64]

MAX_PITCH = math.radians(89.0)  # the view would flip at 90 degrees
FITTED_SHARE = 0.86  # share of the picture's width or height that a fitted plant fills
FIELD_OF_VIEW = math.radians(28.0)
MAX_SAMPLED_POSITIONS = 60_000
TURNTABLE_YAWS = 32  # directions from which a plant must fit for a full turn
DEPTH_RADII = 4.0  # near and far plane lie so many scene radii before and behind the target
ORTHOGRAPHIC_FIELD = math.radians(1.0)  # field of view that stands for a parallel projection
HOME_YAW, HOME_PITCH = math.radians(-60.0), math.radians(14.0)


@dataclass(frozen=True)
class Camera:
    """An immutable orbit camera; methods that move it return a new camera."""

    #: the point looked at, in the clip's local coordinates
    target: tuple[float, float, float] = (0.0, 0.0, 0.0)
    distance: float = 5.0  #: from the eye to the target, in the clip's unit of length
    yaw: float = HOME_YAW  #: direction from the target to the eye about the up axis, in radians
    pitch: float = HOME_PITCH  #: elevation of the eye above the horizontal, in radians
    #: vertical field of view in radians; at most ORTHOGRAPHIC_FIELD: parallel projection, with the
    #: same height at the target
    field_of_view: float = FIELD_OF_VIEW
    up: str = "z"  #: "x", "y", "z", "-x", "-y" or "-z"
    radius: float = 1.0  #: of the scene, in the clip's unit; sets the near and the far plane

    @classmethod
    def home(cls, clip: Clip, aspect: float = 16 / 9, turning: bool = False) -> Self:
        """The camera that a clip is first shown with: all positions of its movers are visible, from
        the side on which the plant is widest.

        aspect:  width of the picture divided by its height.
        turning: whether the camera will turn about the stem, so that every yaw must be fitted.
        """
        basis, points = upright_axes(clip.up), sampled_positions(clip)
        center = (points.min(axis=0) + points.max(axis=0)) / 2
        if turning:
            center[:2] = stem_position(clip)
        radius = float(np.linalg.norm(points - center, axis=1).max())
        # A plant may consist of one point, and lie far from the origin.
        radius = max(radius, 1e-6, 1e-9 * float(np.abs(center).max()))
        # Look along the direction of least variance, from the side nearer to HOME_YAW.
        _, directions = np.linalg.eigh(np.cov(points[:, :2].T))
        yaw = math.atan2(directions[1, 0], directions[0, 0])
        yaw = yaw if math.cos(yaw - HOME_YAW) >= 0.0 else yaw + math.pi
        camera = cls(as_tuple(center @ basis), yaw=yaw, up=clip.up, radius=radius)
        fit = camera.fitted_to_turns if turning else camera._fitted_and_centered
        return fit(points @ basis, aspect)

    def fitted_to_turns(self, points: Vector, aspect: float) -> Self:
        """The nearest camera that sees all of (n, 3) points from every yaw."""
        yaws = np.linspace(0.0, 2.0 * math.pi, TURNTABLE_YAWS, endpoint=False).tolist()
        distances = [self.orbit(yaw, 0.0)._fitting_distance(points, aspect) for yaw in yaws]
        return replace(self, distance=max(distances))

    def _fitted_and_centered(self, points: Vector, aspect: float) -> Self:
        """The nearest camera of this yaw and pitch that sees all points, centred in the picture."""
        camera = replace(self, distance=self._fitting_distance(points, aspect))
        for _ in range(4):  # the projected centre shifts a little whenever the distance changes
            right, above, towards = camera._eye_axes @ (points - np.asarray(camera.target)).T
            depth = np.maximum(camera.distance - towards, 1e-9 * camera.distance)
            centers = [(side.min() + side.max()) / 2 for side in (right / depth, above / depth)]
            shift = camera.distance * np.array([*centers, 0.0])
            camera = replace(camera, target=as_tuple(camera.target + camera._eye_axes.T @ shift))
            camera = replace(camera, distance=camera._fitting_distance(points, aspect))
        return camera

    def _fitting_distance(self, points: Vector, aspect: float) -> float:
        """The smallest distance from which all points are in the picture.

        A point with offsets (right, above, towards) from the target is in the picture if
        |right| / aspect and |above| are at most slope × (distance - towards).
        """
        right, above, towards = self._eye_axes @ (points - np.asarray(self.target)).T
        slope = math.tan(self.field_of_view / 2) * FITTED_SHARE
        needed = towards + np.maximum(np.abs(right) / aspect, np.abs(above)) / slope
        return max(float(needed.max()), 0.1 * self.radius)

    def orbit(self, dyaw: float, dpitch: float) -> Self:
        """Turn about the target by angles in radians; the pitch is limited to MAX_PITCH."""
        pitch = min(max(self.pitch + dpitch, -MAX_PITCH), MAX_PITCH)
        return replace(self, yaw=math.remainder(self.yaw + dyaw, 2 * math.pi), pitch=pitch)

    def pan(self, dx: float, dy: float) -> Self:
        """Shift the picture right and up by shares of its height, at the target's depth."""
        height = 2.0 * self.distance * math.tan(self.field_of_view / 2)
        right, above, _ = self._eye_axes
        target = self.target - height * (dx * right + dy * above)
        return replace(self, target=as_tuple(target))

    def zoom(self, factor: float) -> Self:
        """Divide the distance by a factor, within limits that depend on the scene's radius."""
        slope = math.tan(FIELD_OF_VIEW / 2) / math.tan(self.field_of_view / 2)
        closest, farthest = 0.02 * self.radius * slope, 50.0 * self.radius * slope
        return replace(self, distance=min(max(self.distance / factor, closest), farthest))

    def zoom_at(self, factor: float, right: float, up: float) -> Self:
        """Zoom about a position in the picture: what is seen there at the target's depth stays.

        right, up: offset of the position from the picture's centre, in shares of its height.
        """
        zoomed = self.zoom(factor)
        scale = self.distance / zoomed.distance
        return zoomed.pan(right * (1.0 - scale), up * (1.0 - scale))

    def looking_from(self, yaw: float, pitch: float) -> Self:
        """Look at the same target from another direction, in radians."""
        return replace(self, yaw=yaw, pitch=pitch).orbit(0.0, 0.0)

    @property
    def orthographic(self) -> bool:
        """Whether the projection is parallel."""
        return self.field_of_view <= ORTHOGRAPHIC_FIELD

    def with_orthographic(self, orthographic: bool) -> Self:
        """Switch to a parallel or a perspective projection, of the same scale at the target."""
        angle = ORTHOGRAPHIC_FIELD if orthographic else FIELD_OF_VIEW
        if self.orthographic == orthographic:
            return self
        distance = self.distance * math.tan(self.field_of_view / 2) / math.tan(angle / 2)
        return replace(self, field_of_view=angle, distance=distance)

    @property
    def eye_distance(self) -> float:
        """Distance from the plane of depth 0 to the target; a parallel projection has no eye."""
        return DEPTH_RADII * self.radius if self.orthographic else self.distance

    @property
    def near(self) -> float:
        """Depth of the near plane."""
        min_depth = 0.0 if self.orthographic else 0.02 * self.distance
        return max(self.eye_distance - DEPTH_RADII * self.radius, min_depth)

    @property
    def far(self) -> float:
        """Depth of the far plane."""
        return self.eye_distance + DEPTH_RADII * self.radius

    @property
    def eye(self) -> Vector:
        """(3,) position of the eye in local coordinates."""
        return np.asarray(self.target) + self.eye_distance * self._eye_axes[2]

    def view(self) -> Vector:
        """(4, 4) matrix from local to eye coordinates (right, up, back), for column vectors."""
        matrix = np.eye(4)
        matrix[:3, :3] = self._eye_axes
        matrix[:3, 3] = -matrix[:3, :3] @ self.eye
        return matrix

    def projection(self, aspect: float) -> Vector:
        """(4, 4) matrix from eye coordinates to OpenGL's clip coordinates, for column vectors."""
        near, far, slope = self.near, self.far, math.tan(self.field_of_view / 2)
        depth = near - far
        if self.orthographic:
            half = slope * self.distance
            matrix = np.diag([1.0 / (half * aspect), 1.0 / half, 2.0 / depth, 1.0])
            matrix[2, 3] = (near + far) / depth
        else:
            matrix = np.diag([1.0 / (slope * aspect), 1.0 / slope, (near + far) / depth, 0.0])
            matrix[2, 3], matrix[3, 2] = 2.0 * near * far / depth, -1.0
        return matrix

    def matrix(self, aspect: float) -> Vector:
        """(4, 4) matrix from local to OpenGL's clip coordinates, for column vectors."""
        return self.projection(aspect) @ self.view()

    @cached_property
    def _eye_axes(self) -> Vector:
        """(3, 3) unit vectors in rows: right, above, and from the target to the eye."""
        first, second, upward = upright_axes(self.up)
        outward = math.cos(self.yaw) * first + math.sin(self.yaw) * second
        right = math.cos(self.yaw) * second - math.sin(self.yaw) * first
        cos, sin = math.cos(self.pitch), math.sin(self.pitch)
        return np.array([right, cos * upward - sin * outward, cos * outward + sin * upward])


def sampled_positions(clip: Clip) -> Vector:
    """(n, 3) positions of some movers at the start, middle and end of every interval.

    Coordinates are along the rows of ``upright_axes(clip.up)``, so the last one is the height.
    """
    count = min(3000, max(200, MAX_SAMPLED_POSITIONS // (3 * len(clip.intervals))))
    samples = [
        positions_on_curve(interval, slice(None, None, max(1, len(interval) // count)), share)
        for interval in clip.intervals
        for share in (0.0, 0.5, 1.0)
    ]
    return np.concatenate(samples).astype(float) @ upright_axes(clip.up).T


def stem_position(clip: Clip) -> Vector:
    """(2,) horizontal position of the stem along the `upright_axes`: its median at the start."""
    first, roots = clip.intervals[0], [t.id for t in clip.track_table if t.parent is None]
    some = slice(None, None, max(1, len(first) // MAX_SAMPLED_POSITIONS))
    on_stem = np.isin(first.tracks[some], roots[:1])
    points = positions_on_curve(first, some, 0.0)[on_stem if on_stem.any() else slice(None)]
    return np.asarray(np.median(points @ upright_axes(clip.up).T, axis=0)[:2])


def as_tuple(vector: Vector) -> tuple[float, float, float]:
    """Convert a (3,) vector to the type of `Camera.target`."""
    return float(vector[0]), float(vector[1]), float(vector[2])
