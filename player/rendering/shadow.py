"""The plant's soft shadow on the floor."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from player.gl.passes import Passes
from player.gl.scissor import Region
from player.rendering.point_cloud import Movers

if TYPE_CHECKING:
    import moderngl

    from player.rendering.point_buffers import Portion

SIDE = 128  # texels along each side of the floor
CONTACT, AMBIENT = 1.3, 6.0  # widths of the blurs, in texels
LOOKS = 17  # of the blur, two texels apart
BLURRED = 2 * LOOKS / SIDE  # how far the blur reaches, in halves of the floor's side
CONTACT_REACH = 0.12  # height over which a contact shadow fades, as a share of the floor's half
MOVERS = 10_000  # as many as are enough for a shadow


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
        self._passes = Passes(context, LOOKS=LOOKS)
        aside = 2.0 * np.arange(-(LOOKS // 2), LOOKS // 2 + 1)[:, None] + 0.5
        weights = np.exp(-0.5 * (aside / (CONTACT, AMBIENT)) ** 2)
        self._weights = [tuple(pair) for pair in (weights / weights.sum(axis=0)).tolist()]

    def cast(
        self,
        portions: list[Portion],
        from_above: NDArray,
        half_side: float,
        area: float,
        plant: Region,
    ) -> None:
        """from_above: (4, 4) local coordinates to the floor's square, height in z.
        half_side: half the floor's side.
        area: what one mover covers where all of them are drawn.
        plant: the texels of the floor, `SIDE` along each side, that the plant is above.
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
        shadow = plant.grown(LOOKS, (SIDE, SIDE))
        self._blurred(second, 0, (1.0 / SIDE, 0.0), shadow, saturate=1)
        self._blurred(first, 1, (0.0, 1.0 / SIDE), shadow, saturate=0)

    def _blurred(
        self,
        target: moderngl.Framebuffer,
        source: int,
        direction: tuple[float, float],
        region: Region,
        saturate: int,
    ) -> None:
        target.clear()
        target.scissor = region.rectangle
        target.use()
        self._textures[source].use(0)
        uniforms = {"source": 0, "direction": direction, "weights": self._weights}
        self._passes.fill("blur", uniforms, SATURATE=saturate)
        target.scissor = None  # type: ignore[assignment]

    def use(self, unit: int) -> None:
        self._textures[0].use(unit)

    def release(self) -> None:
        for framebuffer in self._framebuffers:
            framebuffer.release()
        for texture in self._textures:
            texture.release()
        self._passes.release()
