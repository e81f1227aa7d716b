"""Render a plant from above: colour, depth and organ of every pixel."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grow.color import shade
from grow.model import Plant
from grow.surface import Material, positions

ROWS, COLUMNS = 97, 33  # of the grid on every part, which is then interpolated
DENSITY = 1.7  # surface samples per pixel, along and across
SOIL = np.array([92.0, 72.0, 55.0])  # 8-bit sRGB


@dataclass(frozen=True)
class View:
    """A pinhole camera above the plant, looking down."""

    width: int  # pixels, like all but the last
    height: int
    focal: float
    cx: float
    cy: float
    distance: float  # mm above the ground

    @staticmethod
    def over(size: tuple[int, int], across: float = 215.0, distance: float = 500.0) -> View:
        """A view of `across` mm of the ground along the shorter side, slightly off-centre."""
        width, height = size
        focal = min(size) * distance / across
        return View(width, height, focal, 0.507 * width - 0.5, 0.495 * height - 0.5, distance)


@dataclass(frozen=True)
class Picture:
    """The images of a view."""

    color: NDArray[np.uint8]  # (H, W, 3) sRGB
    depth: NDArray[np.float64]  # (H, W) mm
    label: NDArray[np.int64]  # (H, W) organs, 0 outside leaves


def take_picture(plant: Plant, day: float, view: View, rng: np.random.Generator) -> Picture:
    """Render the plant on flat soil at z = 0, with hidden surfaces removed.

    rng: for the noise of the colours; depth and labels don't depend on it.
    """
    size = view.height * view.width
    color = SOIL * (1 + 0.12 * rng.standard_normal(size))[:, None]
    depth = np.full(size, view.distance)
    label = np.zeros(size, np.int64)

    samples = _surface(plant, day, view)
    u, v = (np.rint(samples[:, axis]).astype(np.intp) for axis in (0, 1))
    inside = (u >= 0) & (u < view.width) & (v >= 0) & (v < view.height)
    samples, pixel = samples[inside], (v * view.width + u)[inside]
    # Assignment to equal indices keeps the last value, that of the sample nearest to the camera.
    far_first = np.argsort(-samples[:, 2], kind="stable")
    samples, pixel = samples[far_first], pixel[far_first]
    depth[pixel] = samples[:, 2]
    label[pixel] = samples[:, 6].astype(np.int64)
    color[pixel] = samples[:, 3:6]

    grain = rng.normal(0, 3, (size, 1))
    grainy = np.clip(color + grain, 0, 255).astype(np.uint8)
    shape = (view.height, view.width)
    return Picture(grainy.reshape(*shape, 3), depth.reshape(shape), label.reshape(shape))


def _surface(plant: Plant, day: float, view: View) -> NDArray[np.float64]:
    """(S, 7) samples of all surfaces, closer than pixels: u, v, depth, red, green, blue, label."""
    body = plant._body
    pose = body.pose(day)
    along, across = np.meshgrid(np.linspace(0, 1, ROWS), np.linspace(-1, 1, COLUMNS), indexing="ij")
    parts = np.flatnonzero(body.column("birth") < day)
    part = np.repeat(parts, along.size)
    material = Material(
        part, np.tile(along.ravel(), len(parts)), np.tile(across.ravel(), len(parts))
    )

    x, y, z = positions(body, pose, material).T
    depth = view.distance - z
    u = view.cx + view.focal * x / depth
    v = view.cy - view.focal * y / depth
    paint = shade(body, pose, material, np.random.default_rng(0))
    columns = np.column_stack([u, v, depth, paint, plant.label_of(material)])
    return np.concatenate([_refine(grid) for grid in columns.reshape(len(parts), ROWS, COLUMNS, 7)])


def _refine(grid: NDArray[np.float64]) -> NDArray[np.float64]:
    """Interpolate the (ROWS, COLUMNS, C) grid of one part to (S, C) samples without gaps."""
    steps = [
        int(np.ceil(DENSITY * np.hypot(*np.diff(grid[..., :2], axis=axis).T).sum(1 - axis).max()))
        for axis in (0, 1)
    ]
    rows, columns = (_interpolation(n, max(m, 1)) for n, m in zip(grid.shape, steps, strict=False))
    fine = np.tensordot(rows, grid, (1, 0))
    return np.einsum("cb,rbk->rck", columns, fine, optimize=True).reshape(-1, grid.shape[2])


def _interpolation(count: int, steps: int) -> NDArray[np.float64]:
    """The (steps + 1, count) matrix that interpolates linearly between `count` values."""
    position = np.linspace(0, count - 1, steps + 1)
    node = np.minimum(position.astype(np.intp), count - 2)
    matrix = np.zeros((steps + 1, count))
    row = np.arange(steps + 1)
    matrix[row, node] = 1 - (position - node)
    matrix[row, node + 1] = position - node
    return matrix
