"""Lights the nearest surface by its depths and, if the clip has normals, by these."""

from typing import Any

import moderngl

from player.gl.framebuffer import GBuffer, textures_of
from player.gl.shader import Passes
from player.rendering.splats import SplatParams
from player.view.camera import axes
from player.view.style import GROUNDS, Style

DEPTH_CUE = 0.45  # share of the fog on what is farthest


def smooth_depths(passes: Passes, gbuffer: GBuffer, splats: SplatParams) -> None:
    """Filter the scanner's noise out of the depths."""
    _where_the_plant_is(gbuffer)
    for source, direction in enumerate(((1, 0), (0, 1))):
        gbuffer.filtered[1 - source].use()
        (depths,) = textures_of(gbuffer.filtered[source])
        passes.fill("bilateral", **splats.uniforms(), depths=depths, direction=direction)


def shade(passes: Passes, gbuffer: GBuffer, splats: SplatParams, style: Style) -> None:
    """Light the surface in the G-buffer, and blend it behind what has been lit before."""
    context = _where_the_plant_is(gbuffer)
    context.enable(moderngl.BLEND)
    context.blend_func = moderngl.ONE_MINUS_DST_ALPHA, moderngl.ONE
    gbuffer.lit.use()
    names = ("colors", "depths", "normals")
    surface: dict[str, Any] = dict(zip(names, textures_of(gbuffer.surface), strict=True))
    passes.fill("shade", **splats.uniforms(), **lights(splats, style), **surface)
    context.enable_only(moderngl.NOTHING)


def _where_the_plant_is(gbuffer: GBuffer) -> moderngl.Context:
    context = gbuffer.lit.ctx
    context.enable_only(moderngl.DEPTH_TEST)
    context.depth_func = "<"
    return context


def lights(splats: SplatParams, style: Style) -> dict[str, Any]:
    """The uniforms of shade.frag: lights and fog."""
    camera, colors = splats.camera, GROUNDS[style.ground]
    return {
        "eye_dome": style.eye_dome,
        "depth_cue": DEPTH_CUE * style.depth_cue,
        "up_dir": tuple(camera.view()[:3, :3] @ axes(camera.up)[2]),
        "ambient_top": colors.ambient_top,
        "ambient_bottom": colors.ambient_bottom,
        "key_light": colors.key_light,
        "fog_color": colors.fog_color,
    }
