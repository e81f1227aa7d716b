"""Splats without a GPU: discs sorted by the tiles of the picture that they cover.

Blending disc after disc into the picture is what a GPU is made for; a CPU spends most of such a
picture on fetching and storing samples. Here each sample asks for its tile's discs instead, and
sums them in registers: the same picture, but for rounding. Discs are sorted by distance, those of
equal distance stay in the movers' order: a sample stops at the first one that it doesn't see, and
the picture is the same from run to run.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from player.gl.framebuffer import texture
from player.gl.shader import give, program
from player.rendering.point_cloud import LOOK, Movers
from player.rendering.splat_params import Discs

if TYPE_CHECKING:
    import moderngl

    from player.gl.framebuffer import Targets
    from player.gl.scissor import Region
    from player.rendering.point_buffers import Portion

MOVERS = 500_000  # more are drawn as splats one by one
ENTRIES = 4_000_000  # discs of all tiles together; more, as close by, take longer than splats do
TILE = 8  # side in pixels of the smallest tiles
TILES = 1 << 16  # fewer are numbered with 16 bits, which are sorted fastest
WIDTH = 2048  # texels in a row of the texture that holds the discs


class TiledSplats:
    """Draws what `Splats` draws, unless that many discs are better blended: `draw` says so."""

    def __init__(self, movers: Movers, supersample: int = 1) -> None:
        self._movers = movers
        self._supersample = supersample
        self._programs: dict[int, moderngl.Program] = {}

    def draw(self, targets: Targets, portions: list[Portion], discs: Discs, region: Region) -> bool:
        """As every rasteriser does; False where it is not done, and splats have to do it."""
        import moderngl

        if sum(portion.count for portion in portions) > MOVERS:
            return False
        projection = discs.projection
        uniforms = discs.uniforms() | {
            "focal": (projection[0, 0], projection[1, 1]),
            "samples": tuple(map(float, discs.samples)),
            "depths": (discs.camera.near, discs.camera.far),
            "palette": 0,
        }
        self._movers.palette.use(0)
        found = self._movers.captured("discs", 4, portions, uniforms)
        found = found[found[:, 2] > 0.0]
        found = found[np.argsort(found[:, 2], kind="stable")]  # the nearest first
        radii = np.maximum(discs.radius * discs.magnification / found[:, 2], discs.smallest / 2)
        side = _tile_side(discs.samples, self._supersample)
        tiles = (-(-discs.samples[0] // side), -(-discs.samples[1] // side))
        order, runs = by_tile(found[:, :2], radii, tiles, side)
        if len(order) > ENTRIES:
            return False
        if len(order) == 0:
            return True
        context = self._movers.context
        words = np.empty((-(-len(order) // WIDTH) * WIDTH, 4), np.float32)
        np.take(found, order, axis=0, out=words[: len(order)], mode="clip")
        stored = texture(context, (WIDTH, len(words) // WIDTH), 4, "u4")
        stored.write(words)
        stored.use(0)
        buffer = context.buffer(runs.tobytes())
        shader = self._program(side)
        array = context.vertex_array(shader, [(buffer, "4i4", "in_tile")])

        targets.surface.scissor = region.scaled(targets.size, self._supersample).rectangle
        pixels = side // self._supersample
        targets.surface.viewport = (0, 0, pixels * tiles[0], pixels * tiles[1])
        targets.surface.use()
        context.enable_only(moderngl.DEPTH_TEST | moderngl.PROGRAM_POINT_SIZE)
        context.depth_func = "1"
        give(shader, **discs.uniforms(), tiles=tuple(map(float, tiles)), discs=0)
        array.render(moderngl.POINTS, vertices=len(runs))
        targets.surface.viewport = (0, 0, *targets.size)
        targets.surface.scissor = None  # type: ignore[assignment]
        for part in (array, buffer, stored):
            part.release()
        return True

    def _program(self, side: int) -> moderngl.Program:
        if side not in self._programs:
            chosen = LOOK | {"TILE": side, "SUPERSAMPLE": self._supersample}
            chosen |= {"WIDTH": WIDTH, "ROW": WIDTH.bit_length() - 1}
            self._programs[side] = program(self._movers.context, "tiled", "tiled", **chosen)
        return self._programs[side]

    def release(self) -> None:
        for made in self._programs.values():
            made.release()


def _tile_side(samples: tuple[int, int], supersample: int) -> int:
    """In samples."""
    side = TILE * supersample
    while -(-samples[0] // side) * -(-samples[1] // side) >= TILES:
        side *= 2
    return side


def by_tile(
    places: NDArray[np.float32], radii: NDArray[np.float32], tiles: tuple[int, int], side: int
) -> tuple[NDArray[np.intp], NDArray[np.int32]]:
    """Which discs each tile has to look at: those whose square reaches it.

    places: (N, 2), radii: (N,), in samples.
    tiles: (columns, rows), `side` samples wide and high.
    Returns the discs' numbers, tile after tile, each tile's in their own order; and (M, 4) for each
    tile that has some: column, row, where its first one stands, how many. More than ENTRIES are
    counted only.
    """
    last = np.array(tiles, np.float32) - 1
    low, high = (np.floor((places + way * radii[:, None]) / side) for way in (-1, 1))
    seen = np.flatnonzero((high >= 0).all(axis=1) & (low <= last).all(axis=1))
    low, high = (np.clip(corner[seen], 0, last).astype(np.int32) for corner in (low, high))
    wide, tall = (high - low + 1).T
    ends = np.cumsum(wide * tall, dtype=np.int64)
    total = int(ends[-1]) if len(ends) else 0
    if total > ENTRIES:
        return np.zeros(total, np.intp), np.zeros((0, 4), np.int32)
    which = np.repeat(np.arange(len(seen), dtype=np.int32), wide * tall)
    within = np.arange(total, dtype=np.int32) - (ends - wide * tall).astype(np.int32)[which]
    down = within // wide[which]
    first = low[:, 1] * tiles[0] + low[:, 0]
    tile = first[which] + within + down * (tiles[0] - wide)[which]
    order = np.argsort(tile.astype(np.uint16), kind="stable")
    lengths = np.bincount(tile, minlength=tiles[0] * tiles[1])
    held = np.flatnonzero(lengths)
    begins = np.cumsum(lengths) - lengths
    runs = np.column_stack([held % tiles[0], held // tiles[0], begins[held], lengths[held]])
    return seen[which[order]], runs.astype(np.int32)
