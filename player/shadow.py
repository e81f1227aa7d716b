"""The plant's soft shadow on the floor."""

from __future__ import annotations

from typing import TYPE_CHECKING

from numpy.typing import NDArray

from player.glsl import give, program
from player.movers import Movers

if TYPE_CHECKING:
    from player.chunks import Portion

SIDE = 128  # texels along each side of the floor
CONTACT, AMBIENT = 1.3, 6.0  # widths of the blurs, in texels
BLURRED = 2 * 16.5 / SIDE  # how far the blur reaches, in halves of the floor's side
CONTACT_REACH = 0.12  # height over which a contact shadow fades, as a share of the floor's half
MOVERS = 20_000  # as many as are enough for a shadow


class Shadow:
    """Two squares that the shadow's blur goes to and fro between; the first holds the result."""

    def __init__(self, movers: Movers) -> None:
        import moderngl

        context = movers.context
        self._movers = movers
        self._textures = [context.texture((SIDE, SIDE), 2, dtype="f4") for _ in range(2)]
        for texture in self._textures:
            texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
            texture.repeat_x = texture.repeat_y = False
        self._framebuffers = [context.framebuffer([texture]) for texture in self._textures]
        self._blur = context.vertex_array(program(context, "screen", "blur"), [])

    def cast(
        self, portions: list[Portion], from_above: NDArray, half_side: float, area: float
    ) -> None:
        """from_above: (4, 4) local coordinates to the floor's square, height in z.
        half_side: half the floor's side.
        area: what one mover covers where all of them are drawn.
        """
        import moderngl

        context, (first, second) = self._movers.context, self._framebuffers
        first.use()
        first.clear()
        context.enable_only(moderngl.PROGRAM_POINT_SIZE | moderngl.BLEND)
        context.blend_func = moderngl.ONE, moderngl.ONE
        drawn = sum(portion.count / portion.every for portion in portions)
        there = sum(portion.layer.group.count for portion in portions)
        fewer = max(int(drawn) // MOVERS, 1)
        uniforms = {
            "from_above": from_above,
            "reach": CONTACT_REACH * half_side,
            "cover": fewer * there / max(drawn, 1.0) * area / (2.0 * half_side / SIDE) ** 2,
        }
        self._movers.draw("shadow", portions, uniforms, fewer)
        context.enable_only(0)
        for target, source, direction in ((second, 0, (1.0, 0.0)), (first, 1, (0.0, 1.0))):
            target.use()
            self._textures[source].use(0)
            give(
                self._blur.program,
                source=0,
                direction=(direction[0] / SIDE, direction[1] / SIDE),
                width=(CONTACT, AMBIENT),
                saturate=source == 0,
            )
            self._blur.render(vertices=3)

    def use(self, unit: int) -> None:
        self._textures[0].use(unit)

    def release(self) -> None:
        for framebuffer in self._framebuffers:
            framebuffer.release()
        for texture in self._textures:
            texture.release()
        self._blur.program.release()
        self._blur.release()
