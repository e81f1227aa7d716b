"""The pose of a plant: axes, frames and cross-sections of all parts at one time."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from grow.part import NODES, Part

Array = NDArray[np.float64]
Index = NDArray[np.intp]

COLUMNS = (
    *("azimuth", "birth", "duration", "length", "gradient", "lag", "opening", "upright"),
    *("bend_power", "turn", "spin", "clasp", "ruffle"),
)


def sigmoid(x: Array) -> Array:
    """A logistic curve, scaled to be exactly 0 at 0 and 1 at 1, constant outside."""
    steep = 2.5
    edge = 1 / (1 + np.exp(steep))
    return (1 / (1 + np.exp(-steep * (2 * np.clip(x, 0, 1) - 1))) - edge) / (1 - 2 * edge)


@dataclass(frozen=True)
class Pose:
    """All P parts at one time, sampled at K nodes along their axes; mm, z up.

    axis:     (P, K, 3) the midrib of a strip, the centre line of a tube.
    frame:    (P, K, 3, 3) unit rows: along the axis, across the strip, normal to it.
    spread:   (P, K) half-width of the strip, measured over its surface.
    roll:     (P, K) half of the angle over which the cross-section is bent.
    ruffle:   (P, K) height of the waves along the margins.
    growth:   (P, K) share of its final size that the tissue has reached, 0 to 1.
    age:      (P,) days since birth, negative before it.
    length:   (P,) length of the axis.
    """

    axis: Array
    frame: Array
    spread: Array
    roll: Array
    ruffle: Array
    growth: Array
    age: Array
    length: Array


class Body:
    """The P parts of a plant, parents before their children, as (P,) arrays."""

    def __init__(self, parts: Sequence[Part]) -> None:
        self.parts = tuple(parts)
        self.label = np.array([part.label for part in parts], np.int64)
        self.parent = np.array([part.parent for part in parts], np.intp)
        self.tube = np.array([part.tube for part in parts])
        self.at = self.column("at")
        self.fold = self.column("fold")
        self.waves = self.column("waves")
        self.phase = self.column("phase")

    def column(self, name: str) -> Array:
        """(P,) values of one field of all parts."""
        return np.array([getattr(part, name) for part in self.parts], np.float64)

    @cached_property
    def generations(self) -> list[Index]:
        """Indices of the parts, grouped by their number of ancestors."""
        depth = np.zeros(len(self.parts), np.intp)
        for index, parent in enumerate(self.parent):
            if parent >= 0:
                depth[index] = depth[parent] + 1
        return [np.flatnonzero(depth == level) for level in range(int(depth.max()) + 1)]

    @cached_property
    def _law(self) -> dict[str, Array]:
        """Parameters of the parts as (P, 1) columns, to be broadcast over the nodes."""
        law = {name: self.column(name)[:, None] for name in COLUMNS}
        none = np.zeros((NODES, 2))
        law["width"] = np.array([part.width for part in self.parts])
        law["wobble"] = np.array(
            [none if part.wobble is None else part.wobble for part in self.parts]
        )
        return law

    def _change(self, name: str, progress: Array) -> Array:
        young, mature = np.array([getattr(part, name) for part in self.parts]).T[:, :, None]
        return young + (mature - young) * progress

    def pose(self, day: float) -> Pose:
        """The pose at `day`; parts that are not born yet have length 0."""
        law = self._law
        along = np.linspace(0, 1, NODES)[None]
        age = day - law["birth"]
        late = np.abs(law["gradient"]) * np.where(law["gradient"] > 0, along, 1 - along)
        local = (age / law["duration"] - late) / (1 - np.abs(law["gradient"]))
        growth = sigmoid(local)
        step = law["length"] * (growth[:, 1:] + growth[:, :-1]) / 2 / (NODES - 1)

        # Young tissue of a stem is thin; a leaf of grass leaves the whorl in its full width.
        thickness = np.where(law["gradient"] > 0, growth, sigmoid(age / law["duration"]))
        thickness = thickness ** law["lag"]
        spread = law["width"] * thickness * np.where(self.tube[:, None], np.pi, 1)
        opened = sigmoid(age / law["opening"])
        roll = self._change("roll", opened) + law["clasp"] * (1 - along) ** 6
        roll = np.where(self.tube[:, None], np.pi, np.clip(roll, 0, 0.97 * np.pi))

        local_axis, local_frame = self._bare_axes(along, step, opened)
        axis = np.empty_like(local_axis)
        frame = np.empty_like(local_frame)
        for members in self.generations:
            base, position = self._bases(members, axis, frame, spread, opened)
            axis[members] = local_axis[members] @ base + position[:, None]
            frame[members] = local_frame[members] @ base[:, None]
        ruffle = law["ruffle"] * opened * thickness
        return Pose(axis, frame, spread, roll, ruffle, growth, age[:, 0], step.sum(1))

    def _bare_axes(self, along: Array, step: Array, opened: Array) -> tuple[Array, Array]:
        """Axes and frames relative to each part's base: x away from the parent, z along it."""
        law = self._law
        angle = self._change("lean", opened)
        angle = angle + self._change("bend", opened) * along ** law["bend_power"]
        zero = np.zeros_like(angle)
        tangent = np.stack([np.sin(angle), zero, np.cos(angle)], -1)
        tangent[..., 0] += law["wobble"][..., 0] * np.cos(angle)
        tangent[..., 1] += law["wobble"][..., 1]
        tangent[..., 2] -= law["wobble"][..., 0] * np.sin(angle)
        tangent = unit(tangent)
        across = np.zeros_like(tangent)
        across[..., 1] = 1
        across = unit(across - dot(across, tangent) * tangent)
        normal = np.cross(tangent, across)
        spin = law["spin"] + self._change("twist", opened) * along
        cos, sin = np.cos(spin)[..., None], np.sin(spin)[..., None]
        across, normal = cos * across + sin * normal, cos * normal - sin * across

        middle = (tangent[:, 1:] + tangent[:, :-1]) / 2
        axis = np.zeros_like(tangent)
        np.cumsum(middle * step[..., None], axis=1, out=axis[:, 1:])
        return axis, np.stack([tangent, across, normal], -2)

    def _bases(
        self, members: Index, axis: Array, frame: Array, spread: Array, opened: Array
    ) -> tuple[Array, Array]:
        """Base frames (rows x, y, z) and positions of parts whose parents' axes are known."""
        parent = self.parent[members]
        if parent[0] < 0:
            count = len(members)
            return np.broadcast_to(np.eye(3), (count, 3, 3)), np.zeros((count, 3))
        law = self._law
        where = self.at[members]
        center = at_node(axis, parent, where)
        tangent, across, normal = np.moveaxis(at_node(frame, parent, where), 1, 0)
        radius = at_node(spread, parent, where)[:, None] / np.pi
        azimuth = law["azimuth"][members]
        position = center + radius * (np.cos(azimuth) * normal + np.sin(azimuth) * across)

        turned = azimuth + law["turn"][members] * opened[members]
        away = np.cos(turned) * normal + np.sin(turned) * across
        upright = law["upright"][members]
        up = unit((1 - upright) * tangent + upright * np.array([0.0, 0.0, 1.0]))
        away = unit(away - dot(away, up) * up)
        return np.stack([away, np.cross(up, away), up], 1), position


def at_node(values: Array, part: Index, along: Array) -> Array:
    """Interpolate (P, K, ...) values of parts linearly at material coordinates."""
    position = np.clip(along, 0, 1) * (NODES - 1)
    node = np.minimum(position.astype(np.intp), NODES - 2)
    share = (position - node).reshape(position.shape + (1,) * (values.ndim - 2))
    return (1 - share) * values[part, node] + share * values[part, node + 1]


def unit(vectors: Array) -> Array:
    """Vectors (..., 3) scaled to length 1."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def dot(a: Array, b: Array) -> Array:
    """Scalar products (..., 1)."""
    return np.sum(a * b, axis=-1, keepdims=True)
