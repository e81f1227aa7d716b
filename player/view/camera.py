"""The camera: turns about a target, with the plant's own up axis kept upright."""

import math
from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from gclip.evaluate import positions_on_curve

Vector = NDArray[np.float64]

STEEPEST = math.radians(89.0)  # pitch beyond which the view would tip over
MARGIN = 0.86  # share of the picture that a fitted plant fills
FIELD_OF_VIEW = math.radians(28.0)
OUTLINE = 60_000  # positions that the home view is fitted to, in all of a long series
TURNS = 32  # yaws that a plant is looked at from to have room for a full turn
DEEP = 4.0  # radii of the scene before the target and behind it that are seen
ORTHOGRAPHIC = math.radians(1.0)  # the field of view of a parallel projection, as files tell it
YAW, PITCH = math.radians(-60.0), math.radians(14.0)


def axes(up: str) -> Vector:
    """(3, 3) rows: two horizontal axes and the up axis ("x" to "-z"), right-handed."""
    index, sign = "xyz".index(up[-1]), -1.0 if up.startswith("-") else 1.0
    unit = np.eye(3)
    return np.array([unit[(index + 1) % 3], sign * unit[(index + 2) % 3], sign * unit[index]])


@dataclass(frozen=True)
class Camera:
    """A camera on a sphere about its target; every move gives a new one."""

    #: the point looked at, in the clip's local coordinates
    target: tuple[float, float, float] = (0.0, 0.0, 0.0)
    distance: float = 5.0  #: from the eye to the target, in the clip's length unit
    yaw: float = YAW  #: the eye's direction seen from the target, in radians
    pitch: float = PITCH  #: the same upwards; 0 is level
    #: the picture's height as an angle, in radians; so narrow a one as ORTHOGRAPHIC is a parallel
    #: projection of what is as high at the target
    field_of_view: float = FIELD_OF_VIEW
    up: str = "z"  #: x, y, z, -x, -y or -z
    radius: float = 1.0  #: of the scene, from which near and far plane follow

    @classmethod
    def home(cls, clip: Clip, aspect: float = 16 / 9, turning: bool = False) -> Self:
        """The view that a clip opens with: all of its movers in the picture, seen from where the
        plant looks widest.

        aspect:  width by height of the picture.
        turning: about the stem, with room for a full turn, so that the plant stays in the picture.
        """
        frame, points = axes(clip.up), outline(clip)
        middle = (points.min(axis=0) + points.max(axis=0)) / 2
        if turning:
            middle[:2] = stem(clip)
        radius = float(np.linalg.norm(points - middle, axis=1).max())
        # A plant may be one point, and far from the origin.
        radius = max(radius, 1e-6, 1e-9 * float(np.abs(middle).max()))
        # Along the narrowest spread, from the side that is nearer to the usual one.
        _, directions = np.linalg.eigh(np.cov(points[:, :2].T))
        yaw = math.atan2(directions[1, 0], directions[0, 0])
        yaw = yaw if math.cos(yaw - YAW) >= 0.0 else yaw + math.pi
        camera = cls(triple(middle @ frame), yaw=yaw, up=clip.up, radius=radius)
        fitted = camera.fitted_to_turns if turning else camera._centred
        return fitted(points @ frame, aspect)

    def fitted_to_turns(self, points: Vector, aspect: float) -> Self:
        """As near as all of (n, 3) points are in the picture from every yaw."""
        turns = np.linspace(0.0, 2.0 * math.pi, TURNS, endpoint=False).tolist()
        return replace(self, distance=max(self.orbit(t, 0.0)._least(points, aspect) for t in turns))

    def _centred(self, points: Vector, aspect: float) -> Self:
        """As near as all points are in the picture from this side, and in its middle."""
        camera = replace(self, distance=self._least(points, aspect))
        for _ in range(4):  # perspective moves the centre a little with every step nearer
            right, above, towards = camera._frame() @ (points - np.asarray(camera.target)).T
            away = np.maximum(camera.distance - towards, 1e-9 * camera.distance)
            middles = [(side.min() + side.max()) / 2 for side in (right / away, above / away)]
            shift = camera.distance * np.array([*middles, 0.0])
            camera = replace(camera, target=triple(camera.target + camera._frame().T @ shift))
            camera = replace(camera, distance=camera._least(points, aspect))
        return camera

    def _least(self, points: Vector, aspect: float) -> float:
        """The distance from which on all points are in the picture.

        A point (right, above, towards) is where |right| / aspect and |above| are at most
        slope × (distance - towards).
        """
        right, above, towards = self._frame() @ (points - np.asarray(self.target)).T
        slope = math.tan(self.field_of_view / 2) * MARGIN
        needed = towards + np.maximum(np.abs(right) / aspect, np.abs(above)) / slope
        return max(float(needed.max()), 0.1 * self.radius)

    def orbit(self, dyaw: float, dpitch: float) -> Self:
        """Turn about the target, in radians; the pitch stops short of straight up and down."""
        pitch = min(max(self.pitch + dpitch, -STEEPEST), STEEPEST)
        return replace(self, yaw=math.remainder(self.yaw + dyaw, 2 * math.pi), pitch=pitch)

    def pan(self, dx: float, dy: float) -> Self:
        """Shift the picture right and up by shares of its height, at the target's depth."""
        height = 2.0 * self.distance * math.tan(self.field_of_view / 2)
        right, above, _ = self._frame()
        target = self.target - height * (dx * right + dy * above)
        return replace(self, target=triple(target))

    def zoom(self, factor: float) -> Self:
        """Come nearer by a factor above 1, go away by one below."""
        slope = math.tan(FIELD_OF_VIEW / 2) / math.tan(self.field_of_view / 2)
        closest, farthest = 0.02 * self.radius * slope, 50.0 * self.radius * slope
        return replace(self, distance=min(max(self.distance / factor, closest), farthest))

    def zoom_at(self, factor: float, right: float, up: float) -> Self:
        """Zoom so that what is seen at a place stays there, at the target's depth.

        right, up: the place from the picture's middle, in shares of the picture's height.
        """
        nearer = self.zoom(factor)
        grown = self.distance / nearer.distance
        return nearer.pan(right * (1.0 - grown), up * (1.0 - grown))

    def looking(self, yaw: float, pitch: float) -> Self:
        """The same target from another side."""
        return replace(self, yaw=yaw, pitch=pitch).orbit(0.0, 0.0)

    @property
    def orthographic(self) -> bool:
        """Whether parallels stay parallel in the picture."""
        return self.field_of_view <= ORTHOGRAPHIC

    def with_orthographic(self, flat: bool) -> Self:
        """Orthographic, or in perspective; what lies at the target's depth keeps its size."""
        angle = ORTHOGRAPHIC if flat else FIELD_OF_VIEW
        if self.orthographic == flat:
            return self
        distance = self.distance * math.tan(self.field_of_view / 2) / math.tan(angle / 2)
        return replace(self, field_of_view=angle, distance=distance)

    @property
    def eye_distance(self) -> float:
        """From where depths are counted, to the target: parallels have no eye."""
        return DEEP * self.radius if self.orthographic else self.distance

    @property
    def near(self) -> float:
        least = 0.0 if self.orthographic else 0.02 * self.distance
        return max(self.eye_distance - DEEP * self.radius, least)

    @property
    def far(self) -> float:
        return self.eye_distance + DEEP * self.radius

    @property
    def eye(self) -> Vector:
        """(3,) the eye's position, local coordinates."""
        return np.asarray(self.target) + self.eye_distance * self._frame()[2]

    def view(self) -> Vector:
        """(4, 4) from local coordinates to the eye's (right, up, backwards): M @ column."""
        matrix = np.eye(4)
        matrix[:3, :3] = self._frame()
        matrix[:3, 3] = -matrix[:3, :3] @ self.eye
        return matrix

    def projection(self, aspect: float) -> Vector:
        """(4, 4) from the eye's coordinates to OpenGL's clip coordinates: M @ column."""
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
        """(4, 4) from local coordinates to OpenGL's clip coordinates: M @ column."""
        return self.projection(aspect) @ self.view()

    def _frame(self) -> Vector:
        """(3, 3) rows: right, above, and from the target to the eye."""
        first, second, upward = axes(self.up)
        outward = math.cos(self.yaw) * first + math.sin(self.yaw) * second
        backward = math.cos(self.pitch) * outward + math.sin(self.pitch) * upward
        right = np.cross(upward, outward)
        return np.array([right, np.cross(backward, right), backward])


def outline(clip: Clip) -> Vector:
    """(n, 3) some ten thousand positions of all intervals, in the axes of `axes`."""
    most = min(3000, max(200, OUTLINE // (3 * len(clip.intervals))))
    samples = [
        positions_on_curve(interval, slice(None, None, max(1, len(interval) // most)), share)
        for interval in clip.intervals
        for share in (0.0, 0.5, 1.0)
    ]
    return np.concatenate(samples).astype(float) @ axes(clip.up).T


def stem(clip: Clip) -> Vector:
    """(2,) where the stem stands, in the first two axes of `axes`: the root organ's median."""
    first = clip.at(clip.times[0])
    roots = [track.id for track in clip.track_table if track.parent is None]
    standing = np.isin(first.tracks, roots[:1])
    points = first.local[standing] if standing.any() else first.local
    return np.asarray(np.median(points @ axes(clip.up).T, axis=0)[:2])


def triple(vector: Vector) -> tuple[float, float, float]:
    """A vector of three numbers, as cameras hold them."""
    return float(vector[0]), float(vector[1]), float(vector[2])
