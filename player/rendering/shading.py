"""From the nearest surface to light: distances smoothed, lit, and put over the ground."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from player.gl.framebuffer import Targets, texture
from player.gl.passes import Passes
from player.gl.scissor import Region, half_field
from player.rendering.splat_params import Discs
from player.view.camera import axes
from player.view.style import GROUNDS, Style

if TYPE_CHECKING:
    import moderngl

DIRECTIONS, RINGS = 8, 3  # in which the surroundings are looked at
SMOOTHING = 1.3  # reach of the blur of distances, in disc radii
STEEP = 1.0  # depth over width of a pixel from which on its samples are lit one by one
WIDE = 6.0  # samples from which on the blur's places are whole pixels
TAPS = 4, 8  # places on either side, of narrow blurs and wide ones: fewer would leave stripes
FARTHEST = 8  # samples across which a slope is looked for
NEXT = 1.5  # samples up to which the blur reaches no farther than the next one


class Lighting:
    """Lights the plants that rasterisers leave in `targets`.

    picture: the finished one, sRGB; it has to hold the ground already.
    """

    def __init__(self, context: moderngl.Context, targets: Targets, passes: Passes) -> None:
        self._context = context
        self._targets = targets
        self._passes = passes
        self.texture = texture(context, targets.size, 4, "f1")
        self.picture = context.framebuffer([self.texture])
        self._lit = context.framebuffer([self.texture], targets.mask)
        self._lit.depth_mask = False

    def smooth(self, discs: Discs, region: Region) -> int:
        """Take the scanner's noise out of the distances; gives which of the two holds them then.

        region: of pixels, where the plant is.
        """
        self._test_mask(">")
        reach = SMOOTHING * discs.typical_radius
        if reach <= NEXT:
            self._smooth_once(discs, region, 0, (0, 0), cross=1)
            return 1
        self._smooth_once(discs, region, 0, (1, 0), cross=0)
        self._smooth_once(discs, region, 1, (0, 1), cross=0)
        return 0

    def _smooth_once(
        self, discs: Discs, region: Region, source: int, direction: tuple[int, int], cross: int
    ) -> None:
        target = self._targets.smoothed[1 - source]
        target.scissor = region.rectangle
        target.use()
        self._targets.distances[source].use(1)
        uniforms = {
            "distances": 1,
            "direction": direction,
            "radius": discs.radius,
            "magnification": discs.magnification,
            "smallest": discs.smallest,
        }
        wide = int(SMOOTHING * discs.typical_radius >= WIDE)
        chosen = {"CROSS": cross, "SMOOTHING": SMOOTHING, "WHOLE": wide, "TAPS": TAPS[wide]}
        self._passes.fill("smooth", uniforms, **chosen)
        target.scissor = None  # type: ignore[assignment]

    def light(
        self,
        discs: Discs,
        style: Style,
        region: Region,
        radius: float,
        ground: moderngl.Texture,
        distances: int,
    ) -> None:
        """radius: of the scene; ground: what shines through the rims; distances: which of two."""
        targets, camera, colors = self._targets, discs.camera, GROUNDS[style.ground]
        width, height = targets.size
        up = camera.view()[:3, :3] @ axes(camera.up)[2]
        key = up + np.array([-0.75, 0.10, 0.65])
        dome, steepness = _surroundings(max(1.0, 1.2 * height / 720), radius)
        uniforms = {
            "distances": 0,
            "ground": 1,
            "radius": discs.radius,
            "magnification": discs.magnification / targets.supersample,
            "half_field": half_field(camera, width / height),
            "sky": tuple(up),
            "key": tuple(key / np.linalg.norm(key)),
            "scale": radius,
            "middle": camera.distance,
            "dome": dome,
            "steepness": steepness,
            "eye_dome": style.eye_dome,
            "depth_cue": 0.45 if style.depth_cue else 0.0,
            "sky_light": colors.sky_light,
            "floor_light": colors.floor_light,
            "lamp_light": colors.lamp_light,
            "haze": colors.haze,
        }
        targets.distances[distances].use(0)
        ground.use(1)
        for number, light in enumerate(targets.light):
            light.use(2 + number)
            uniforms[f"light{number}"] = 2 + number
        chosen = {"DIRECTIONS": DIRECTIONS, "RINGS": RINGS}
        chosen["FARTHEST"] = FARTHEST // targets.supersample
        self._lit.scissor = region.rectangle
        if targets.supersample > 1:
            self._find_edges(discs)
            self._test_mask(">")
            self._passes.fill("shade", uniforms, BY_SAMPLE=0, DEPTH=0.25, **chosen)
            self._test_mask("==")
            self._passes.fill("shade", uniforms, BY_SAMPLE=1, DEPTH=0.5, **chosen)
        else:
            self._lit.use()
            self._test_mask(">")
            self._passes.fill("shade", uniforms, BY_SAMPLE=1, **chosen)
        self._lit.scissor = None  # type: ignore[assignment]

    def _find_edges(self, discs: Discs) -> None:
        """Raises the mask at edges to a half; inside of surfaces it stays 0, elsewhere 1."""
        self._lit.depth_mask, self._lit.color_mask = True, (False,) * 4
        self._lit.use()
        self._test_mask(">")
        steep = STEEP * self._targets.supersample / discs.magnification
        uniforms = {"distances": 0, "steep": steep}
        self._passes.fill("edges", uniforms, INSIDE=0.0, EDGE=0.5)
        self._lit.depth_mask, self._lit.color_mask = False, (True,) * 4
        self._lit.use()

    def _test_mask(self, function: str) -> None:
        import moderngl

        self._context.enable_only(moderngl.DEPTH_TEST)
        self._context.depth_func = function

    def release(self) -> None:
        for part in (self.picture, self._lit, self.texture):
            part.release()


def _surroundings(radius: float, scale: float) -> tuple[list[tuple[int, int]], tuple[float, ...]]:
    """Where eye-dome lighting looks, in pixels, and one by the depth that counts most there.

    radius: of the innermost ring, in pixels; scale: radius of the scene.
    """
    places = []
    for ring in range(RINGS):
        aside = radius * 2.8**ring
        for i in range(DIRECTIONS):
            angle = (i + 0.33 * ring) * 2.0 * math.pi / DIRECTIONS
            places.append((round(aside * math.cos(angle)), round(aside * math.sin(angle))))
    return places, tuple(1.0 / (scale * 0.012 * 2.2**ring) for ring in range(RINGS))
