"""Lights the nearest surface by its depths and, if the clip has normals, by these."""

import math
from typing import Any

import moderngl
import numpy as np

from player.gl.framebuffer import GBuffer
from player.gl.shader import Passes
from player.rendering.splats import SplatParams
from player.view.camera import axes
from player.view.style import GROUNDS, Style

DIRECTIONS, RINGS = 8, 3  # samples of the surroundings for eye-dome lighting (shade.frag)


def smooth_depths(passes: Passes, gbuffer: GBuffer, splats: SplatParams) -> None:
    """Filter the scanner's noise out of the depths."""
    _where_the_plant_is(gbuffer)
    for source, direction in enumerate(((1, 0), (0, 1))):
        gbuffer.filtered[1 - source].use()
        gbuffer.depths[source].use(1)
        passes.fill("bilateral", **splats.uniforms(), depths=1, direction=direction)


def shade(passes: Passes, gbuffer: GBuffer, splats: SplatParams, style: Style) -> None:
    """Light the surface in the G-buffer, and blend it behind what has been lit before."""
    context = _where_the_plant_is(gbuffer)
    context.enable(moderngl.BLEND)
    context.blend_func = moderngl.ONE_MINUS_DST_ALPHA, moderngl.ONE
    gbuffer.lit.use()
    for unit, one in enumerate((gbuffer.colors, gbuffer.depths[0], gbuffer.normals)):
        one.use(unit)
    uniforms = splats.uniforms() | lights(splats, style) | {"colors": 0, "depths": 1, "normals": 2}
    passes.fill("shade", **uniforms)
    context.enable_only(moderngl.NOTHING)


def _where_the_plant_is(gbuffer: GBuffer) -> moderngl.Context:
    context = gbuffer.lit.ctx
    context.enable_only(moderngl.DEPTH_TEST)
    context.depth_func = "<"
    return context


def lights(splats: SplatParams, style: Style) -> dict[str, Any]:
    """The uniforms of shade.frag: lights, fog and the samples of the surroundings."""
    camera, colors = splats.camera, GROUNDS[style.ground]
    up = camera.view()[:3, :3] @ axes(camera.up)[2]
    key_light = up + np.array([-0.75, 0.10, 0.65])
    return {
        "dome": dome_offsets(max(1.0, 1.2 * splats.samples[1] / 720)),
        "eye_dome": style.eye_dome,
        "depth_cue": 0.45 if style.depth_cue else 0.0,
        "up_dir": tuple(up),
        "key_light_dir": tuple(key_light / np.linalg.norm(key_light)),
        "ambient_top": colors.ambient_top,
        "ambient_bottom": colors.ambient_bottom,
        "key_light": colors.key_light,
        "fog_color": colors.fog_color,
    }


def dome_offsets(radius_px: float) -> list[tuple[int, int]]:
    """Offsets in samples for eye-dome lighting, ring by ring; radius_px: of the innermost ring."""
    offsets = []
    for ring in range(RINGS):
        aside = radius_px * 2.8**ring
        for i in range(DIRECTIONS):
            angle = (i + 0.33 * ring) * 2.0 * math.pi / DIRECTIONS
            offsets.append((round(aside * math.cos(angle)), round(aside * math.sin(angle))))
    return offsets
