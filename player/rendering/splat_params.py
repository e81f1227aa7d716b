"""From movers to the nearest surface in every sample: what each way of drawing them has to do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from player.view.camera import Camera

if TYPE_CHECKING:
    from player.gl.framebuffer import Targets
    from player.gl.scissor import Region
    from player.rendering.point_buffers import Portion

THICKNESS = 1.6  # depth, in disc radii, over which discs count as one surface


@dataclass(frozen=True)
class Discs:
    """How movers are seen: as round, world-sized discs that face the eye.

    samples:       (width, height) of the picture.
    radius:        of a disc, in the clip's unit.
    magnification: samples that one unit takes up at distance 1.
    smallest:      diameter in samples below which no disc shrinks.
    by_track:      coloured by track, else by the scans' colours where there are any.
    by_value:      coloured by a value of each mover instead.
    """

    camera: Camera
    samples: tuple[int, int]
    radius: float
    magnification: float
    smallest: float
    by_track: bool
    by_value: bool = False

    @property
    def typical_radius(self) -> float:
        """In samples, in the middle of the scene."""
        return max(self.radius * self.magnification / self.camera.distance, self.smallest / 2)

    def uniforms(self) -> dict[str, Any]:
        return {
            "view": self.camera.view(),
            "radius": self.radius,
            "magnification": self.magnification,
            "smallest": self.smallest,
            "thickness": THICKNESS,
            "by_track": self.by_track,
        }

    @property
    def projection(self) -> Any:
        return self.camera.projection(self.samples[0] / self.samples[1])


class Rasteriser(Protocol):
    """Leaves the nearest surface in the cleared targets' `surface` (leave.glsl).

    region: the samples that the discs may cover.
    """

    def draw(
        self, targets: Targets, portions: list[Portion], discs: Discs, region: Region
    ) -> None: ...

    def release(self) -> None: ...
