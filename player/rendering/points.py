"""Movers as dots, one sample each, closed to a surface afterwards: for many movers, small discs.

One pass over the movers finds the nearest in every sample, by OpenGL's own points (3.3) or by a
compute shader with one atomic operation a mover (4.3; after Schütz et al. 2021, "Rendering point
clouds with compute shaders and vertex order optimization"). Both leave the same dots, but where
two are equally near.
"""

from __future__ import annotations

import time
from dataclasses import replace
from enum import StrEnum
from typing import TYPE_CHECKING, Any

from player.errors import PlayerError
from player.gl.scissor import Region, whole
from player.gl.shader import give, program
from player.rendering.point_cloud import LOOK, Movers
from player.rendering.splat_params import Discs

if TYPE_CHECKING:
    import moderngl

    from player.gl.framebuffer import Targets
    from player.rendering.point_buffers import Portion

LARGEST = 2.0  # disc radius in samples up to which a centre may be rounded to a sample
EMPTY = 0xFFFFFFFF  # the number of a sample without dots
NAMED = 1024  # segments that a dot's ten bits tell apart
TRIAL = 200_000  # movers that the two ways of drawing are compared with
TILE = 16  # side in samples of the tiles that the empty parts of a picture are skipped by


class Way(StrEnum):
    """What puts the dots into the picture."""

    AUTO = "auto"
    POINTS = "points"
    COMPUTE = "compute"


class Dots:
    """Draws dots and closes the surface between them.

    way: AUTO tries both at the second picture and stays with the faster one; the first one is
         there sooner without.
    """

    def __init__(self, movers: Movers, way: Way = Way.AUTO, supersample: int = 1) -> None:
        self._movers = movers
        self._supersample = supersample
        self.way = Way.POINTS if movers.context.version_code < 430 else way
        self._opened = False
        self._targets: DotTargets | None = None
        self._screen: dict[tuple[str, int, int], moderngl.VertexArray] = {}

    def draw(self, targets: Targets, portions: list[Portion], discs: Discs, region: Region) -> None:
        if self.way is Way.AUTO and self._opened:
            self.way = self._faster_way(portions, discs)
        self._opened = True
        try:
            way = Way.COMPUTE if self.way is Way.AUTO else self.way
            self.scatter(way, portions, discs, region)
        except PlayerError:  # a driver that promises compute shaders and can't compile ours
            if self.way is Way.POINTS:
                raise
            self.way = Way.POINTS
            self.scatter(self.way, portions, discs, region)
        self._gather(targets, discs, region)

    def scatter(
        self, way: Way, portions: list[Portion], discs: Discs, region: Region | None = None
    ) -> None:
        """Find the nearest mover in every sample: the one pass over all of them.

        region: of samples, that holds them all; else it may be the whole picture.
        """
        import moderngl

        context, dots = self._movers.context, self._targets_for(discs.samples)
        drawn = region or whole(discs.samples)
        emptied_part = drawn.joined(dots.drawn).rectangle
        dots.drawn = drawn
        uniforms, named = self._uniforms(discs), self._ten_bits_name_colors(discs)
        framebuffer = dots.named if named else dots.picked_too
        self._movers.palette.use(2)
        if way is Way.POINTS:
            framebuffer.scissor = emptied_part
            framebuffer.use()
            context.enable_only(moderngl.DEPTH_TEST | moderngl.PROGRAM_POINT_SIZE)
            context.depth_func = "1"
            self._fill("empty")
            framebuffer.scissor = None  # type: ignore[assignment]
            context.depth_func = "<"
            self._movers.draw("dots", portions, uniforms)
            return
        context.enable_only(0)
        for emptied in (dots.nearest_alone,) if named else (dots.nearest_alone, dots.picked_alone):
            emptied.scissor = emptied_part
            emptied.use()
            self._fill("none", number=EMPTY if emptied is dots.nearest_alone else 0)
            emptied.scissor = None  # type: ignore[assignment]
        dots.nearest.bind_to_image(0, read=True, write=True)
        self._movers.compute("dots", portions, uniforms, PICK=0)
        if not named:
            dots.picked.bind_to_image(1, read=True, write=True)
            self._movers.compute("dots", portions, uniforms, PICK=1)

    def _gather(self, targets: Targets, discs: Discs, region: Region) -> None:
        import moderngl

        dots, reach = self._targets_for(discs.samples), 1 if discs.typical_radius <= 1.5 else 2
        dots.nearest.use(0)
        dots.picked.use(1)
        dots.tiled.clear()
        dots.tiled.scissor = region.scaled(dots.tiles.size, TILE, margin=1).rectangle
        dots.tiled.use()
        self._movers.context.enable_only(0)
        self._fill("tiles", reach, nearest=0)

        # Points are clipped by their middles: the last ones may lie beyond the picture.
        (across, up), side = dots.tiles.size, TILE // self._supersample
        targets.surface.viewport = (0, 0, across * side, up * side)
        targets.surface.use()
        self._movers.context.enable_only(moderngl.DEPTH_TEST | moderngl.PROGRAM_POINT_SIZE)
        self._movers.context.depth_func = "1"
        dots.tiles.use(3)
        self._fill(
            "gather",
            reach,
            across * up,
            int(self._ten_bits_name_colors(discs)),
            **self._uniforms(discs),
            occupied=3,
            nearest=0,
            picked=1,
        )
        targets.surface.viewport = (0, 0, *targets.size)

    def _ten_bits_name_colors(self, discs: Discs) -> bool:
        clip = self._movers.clip
        by_track = not discs.by_value and (discs.by_track or not clip.has_colors)
        return len(clip.track_table) <= NAMED and by_track

    def _faster_way(self, portions: list[Portion], discs: Discs) -> Way:
        """Draw some of the movers both ways, once to compile and once to measure."""
        context = self._movers.context
        share = min(TRIAL / max(sum(portion.count for portion in portions), 1), 1.0)
        some = [replace(portion, count=int(share * portion.count)) for portion in portions]
        seconds = {}
        for way in (Way.POINTS, Way.COMPUTE):
            for _ in range(2):
                context.finish()
                began = time.perf_counter()
                self.scatter(way, some, discs)
                context.finish()
                seconds[way] = time.perf_counter() - began
        return min(seconds, key=lambda way: seconds[way])

    def _uniforms(self, discs: Discs) -> dict[str, Any]:
        projection = discs.projection
        return discs.uniforms() | {
            "focal": (projection[0, 0], projection[1, 1]),
            "samples": discs.samples,
            "depths": (discs.camera.near, discs.camera.far),
            "palette": 2,
        }

    def _fill(
        self, name: str, reach: int = 1, tiles: int = 0, by_segment: int = 0, **uniforms: Any
    ) -> None:
        """Draw over the whole picture, or over as many tiles as are not empty."""
        import moderngl

        key = (name, reach, by_segment)
        if key not in self._screen:
            context, vertex = self._movers.context, "tile" if tiles else "screen"
            chosen = LOOK | {"REACH": reach, "TILE": TILE, "BY_SEGMENT": by_segment}
            chosen["SUPERSAMPLE"] = self._supersample
            self._screen[key] = context.vertex_array(program(context, vertex, name, **chosen), [])
        array = self._screen[key]
        give(array.program, **uniforms)
        array.render(moderngl.POINTS if tiles else moderngl.TRIANGLES, vertices=tiles or 3)

    def _targets_for(self, size: tuple[int, int]) -> DotTargets:
        if self._targets is None or self._targets.nearest.size != size:
            if self._targets is not None:
                self._targets.release()
            self._targets = DotTargets(self._movers.context, size)
        return self._targets

    def release(self) -> None:
        if self._targets is not None:
            self._targets.release()
        for array in self._screen.values():
            array.program.release()
            array.release()


class DotTargets:
    """The nearest dot's number in every sample (dot.glsl), and its colour where that needs room."""

    def __init__(self, context: moderngl.Context, size: tuple[int, int]) -> None:
        import moderngl

        self.nearest, self.picked = (context.texture(size, 1, dtype="u4") for _ in range(2))
        for texture in (self.nearest, self.picked):
            texture.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self._depth = context.depth_renderbuffer(size)
        self.tiles = context.texture((-(-size[0] // TILE), -(-size[1] // TILE)), 1)
        self.tiles.filter = (moderngl.NEAREST, moderngl.NEAREST)
        self.tiled = context.framebuffer([self.tiles])
        self.drawn = whole(size)  # where it may not be empty
        self.named = context.framebuffer([self.nearest], self._depth)
        self.picked_too = context.framebuffer([self.nearest, self.picked], self._depth)
        self.nearest_alone, self.picked_alone = (
            context.framebuffer([texture]) for texture in (self.nearest, self.picked)
        )

    def release(self) -> None:
        parts = (self.named, self.picked_too, self.nearest_alone, self.picked_alone, self.tiled)
        for part in parts:
            part.release()
        for texture in (self.nearest, self.picked, self.tiles, self._depth):
            texture.release()
