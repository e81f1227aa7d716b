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
    """All P parts at one time, sampled at K nodes along their axes; mm, z up."""

    axis: Array  # (P, K, 3) the midrib of a strip, the centre line of a tube
    frame: Array  # (P, K, 3, 3) unit rows: along the axis, across the strip, normal to it
    spread: Array  # (P, K) half-width of the strip, measured over its surface
    roll: Array  # (P, K) half of the angle over which the cross-section is bent
    ruffle: Array  # (P, K) height of the waves along the margins
    growth: Array  # (P, K) share of its final size that the tissue has reached, 0 to 1
    age: Array  # (P,) days since birth, negative before it
    length: Array  # (P,) length of the axis


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
    def _parameters(self) -> dict[str, Array]:
        """Fields of the parts as (P, 1) columns, to be broadcast over the nodes."""
        fields = {name: self.column(name)[:, None] for name in COLUMNS}
        no_deviation = np.zeros((NODES, 2))
        fields["width"] = np.array([part.width for part in self.parts])
        fields["deviations"] = np.array(
            [no_deviation if part.deviations is None else part.deviations for part in self.parts]
        )
        return fields

    def _change(self, name: str, progress: Array) -> Array:
        """(P, K) values of a field of type `Change` at a progress from 0 to 1."""
        young, mature = np.array([getattr(part, name) for part in self.parts]).T[:, :, None]
        return young + (mature - young) * progress

    def pose(self, day: float) -> Pose:
        """The pose at `day`; parts that are not born yet have length 0."""
        fields = self._parameters
        along = np.linspace(0, 1, NODES)[None]
        age = day - fields["birth"]
        delay = np.abs(fields["gradient"]) * np.where(fields["gradient"] > 0, along, 1 - along)
        local = (age / fields["duration"] - delay) / (1 - np.abs(fields["gradient"]))
        growth = sigmoid(local)
        step = fields["length"] * (growth[:, 1:] + growth[:, :-1]) / 2 / (NODES - 1)

        # Young tissue of a stem is thin; a leaf of grass leaves the whorl in its full width.
        thickness = np.where(fields["gradient"] > 0, growth, sigmoid(age / fields["duration"]))
        thickness = thickness ** fields["lag"]
        spread = fields["width"] * thickness * np.where(self.tube[:, None], np.pi, 1)
        opened = sigmoid(age / fields["opening"])
        roll = self._change("roll", opened) + fields["clasp"] * (1 - along) ** 6
        roll = np.where(self.tube[:, None], np.pi, np.clip(roll, 0, 0.97 * np.pi))

        local_axis, local_frame = self._bare_axes(along, step, opened)
        axis = np.empty_like(local_axis)
        frame = np.empty_like(local_frame)
        for members in self.generations:
            base, position = self._bases(members, axis, frame, spread, opened)
            axis[members] = local_axis[members] @ base + position[:, None]
            frame[members] = local_frame[members] @ base[:, None]
        ruffle = fields["ruffle"] * opened * thickness
        return Pose(axis, frame, spread, roll, ruffle, growth, age[:, 0], step.sum(1))

    def _bare_axes(self, along: Array, step: Array, opened: Array) -> tuple[Array, Array]:
        """Axes and frames relative to each part's base: x away from the parent, z along it."""
        fields = self._parameters
        angle = self._change("lean", opened)
        angle = angle + self._change("bend", opened) * along ** fields["bend_power"]
        zero = np.zeros_like(angle)
        tangent = np.stack([np.sin(angle), zero, np.cos(angle)], -1)
        tangent[..., 0] += fields["deviations"][..., 0] * np.cos(angle)
        tangent[..., 1] += fields["deviations"][..., 1]
        tangent[..., 2] -= fields["deviations"][..., 0] * np.sin(angle)
        tangent = unit(tangent)
        across = np.zeros_like(tangent)
        across[..., 1] = 1
        across = unit(across - dot(across, tangent) * tangent)
        normal = np.cross(tangent, across)
        spin = fields["spin"] + self._change("twist", opened) * along
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
        fields = self._parameters
        at = self.at[members]
        center = at_node(axis, parent, at)
        tangent, across, normal = np.moveaxis(at_node(frame, parent, at), 1, 0)
        radius = at_node(spread, parent, at)[:, None] / np.pi
        azimuth = fields["azimuth"][members]
        position = center + radius * (np.cos(azimuth) * normal + np.sin(azimuth) * across)

        turned = azimuth + fields["turn"][members] * opened[members]
        outward = np.cos(turned) * normal + np.sin(turned) * across
        upright = fields["upright"][members]
        up = unit((1 - upright) * tangent + upright * np.array([0.0, 0.0, 1.0]))
        outward = unit(outward - dot(outward, up) * up)
        return np.stack([outward, np.cross(up, outward), up], 1), position


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
