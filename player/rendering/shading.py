"""Deferred shading: lighting of the surface in the G-buffer."""

from player.gl.framebuffer import GBuffer, textures_of
from player.rendering.splats import SplatParams
from player.view.style import GROUNDS, Style
from traits.upright import upright_axes


def smooth_depths(gbuffer: GBuffer, splats: SplatParams) -> None:
    """Remove the scanner's noise from depths by a separable bilateral filter."""
    for source, direction in enumerate(((1, 0), (0, 1))):
        uniforms = splats.uniforms | textures_of(gbuffer.filtered[source])
        gbuffer.run("bilateral", gbuffer.filtered[1 - source], "<", **uniforms, direction=direction)


def shade(gbuffer: GBuffer, splats: SplatParams, style: Style) -> None:
    """Light the surface in the G-buffer.

    Normals are those of the clip, or derived from depths if it has none.
    """
    gbuffer.run(
        "shade",
        gbuffer.lit,
        "<",
        **splats.uniforms,
        **textures_of(gbuffer.surface),
        **vars(GROUNDS[style.ground]),
        **style.uniforms,
        up_dir=tuple(splats.uniforms["view"][:3, :3] @ upright_axes(splats.camera.up)[2]),
    )
