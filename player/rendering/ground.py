"""What is behind the plant: wall, floor, and the plant's shadow on it.

Wall and floor change with the view alone, the shadow with the plant. So the picture of a floor
without shadow is kept for as long as the view stands still, and each frame begins as a copy of it;
only where the shadow lies is the floor drawn anew. All of it is smooth: a small picture of it is
drawn, and spread over the whole one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from player.gl.framebuffer import texture
from player.gl.passes import Passes
from player.gl.scissor import Region, half_field, whole
from player.rendering.shadow import Shadow
from player.view.camera import Camera
from player.view.style import GROUNDS, Style

if TYPE_CHECKING:
    import moderngl

SHARE = 4  # sides of the picture to sides of the small one
NOTHING = Region(0, 0, 0, 0)


class Backdrop:
    """Draws into pictures of `size` = (width, height) pixels.

    small: the ground at a quarter of the resolution, sRGB, for the rims that it shines through.
    """

    def __init__(self, context: moderngl.Context, size: tuple[int, int], passes: Passes) -> None:
        self._context = context
        self._size = size
        self._passes = passes
        self._kept = texture(context, size, 4, "f1")
        self._keeping = context.framebuffer([self._kept])
        less = (max(size[0] // SHARE, 1), max(size[1] // SHARE, 1))
        self.small = texture(context, less, 4, "f4", linear=True)
        self._drawing = context.framebuffer([self.small])
        self._view: object = None
        self._shaded = NOTHING

    def draw(
        self,
        picture: moderngl.Framebuffer,
        camera: Camera,
        style: Style,
        shadow: Shadow,
        to_floor: NDArray[np.float64],
        region: Region,
    ) -> None:
        """Over all of `picture`.

        to_floor: (4, 4) from the eye's coordinates to the floor's square.
        region:   of the picture, where the shadow lies.
        """
        self._context.enable_only(0)
        uniforms = self._uniforms(camera, style, to_floor)
        shadow.use(1)
        self.small.use(2)
        view = (camera, style.ground, style.show_ground)
        if view != self._view:
            self._small(uniforms, 0.0, whole(self._size))
            self._keeping.use()
            self._passes.fill("spread", {"ground": 2})
            self._view, self._shaded = view, NOTHING
        self._context.copy_framebuffer(picture, self._keeping)
        if not style.show_ground:
            region = NOTHING
        drawn = region.joined(self._shaded)
        if drawn != NOTHING:
            self._small(uniforms, 1.0, drawn)
        if region != NOTHING:
            picture.scissor = region.rectangle
            picture.use()
            self._passes.fill("spread", {"ground": 2})
            picture.scissor = None  # type: ignore[assignment]
        self._shaded = region

    def _small(self, uniforms: dict[str, object], shadow_share: float, region: Region) -> None:
        self._drawing.scissor = region.scaled(self.small.size, SHARE, margin=2).rectangle
        self._drawing.use()
        self._passes.fill("ground", uniforms | {"shadow_share": shadow_share})

    def _uniforms(
        self, camera: Camera, style: Style, to_floor: NDArray[np.float64]
    ) -> dict[str, object]:
        colors = GROUNDS[style.ground]
        return {
            "shadow": 1,
            "half_field": half_field(camera, self._size[0] / self._size[1]),
            "to_floor": to_floor,
            "floor_share": 1.0 if style.show_ground else 0.0,
            "above_color": colors.above,
            "below_color": colors.below,
            "floor_color": colors.floor,
            "shadow_color": colors.shadow,
        }

    def release(self) -> None:
        for framebuffer in (self._keeping, self._drawing):
            framebuffer.release()
        for found in (self._kept, self.small):
            found.release()
