"""The look of a picture: colours, size of points, shading and background."""

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

from player.view.color_modes import ColorMode
from shaders.effects import EFFECTS, Effects

if TYPE_CHECKING:
    from gclip import Clip

LinearColor = tuple[float, float, float]  # red, green and blue in linear light
STYLE_OPTIONS = " ".join(["color colormap field ground point_size", *(e.name for e in EFFECTS)])


class ColorMap(StrEnum):
    """Colour maps of values, by their names in `cmap`; AUTO is the default of the colour mode."""

    AUTO = "auto"
    VIRIDIS = "viridis"
    MAGMA = "magma"
    CIVIDIS = "cividis"
    BATLOW = "batlow"
    TURBO = "turbo"
    GREYS = "gray"


class GroundChoice(StrEnum):
    """Brightness of the background."""

    DARK = "dark"
    LIGHT = "light"


@dataclass(frozen=True)
class Style(Effects):
    """The look of a picture with its effects, independent of camera and time."""

    color_by: ColorMode = ColorMode.AUTO
    color_map: ColorMap = ColorMap.AUTO
    field: str = ""  #: name of the field for `ColorMode.FIELD`; by default the clip's first field
    ground: str = GroundChoice.DARK
    point_size: float = 1.0  #: factor on the size of points at which they close the surface
    picked: int | None = None  #: track that is highlighted; all others are dimmed
    second: int | None = None  #: another track that is highlighted
    hidden: frozenset[int] = frozenset()  #: tracks that are not drawn
    isolated: int | None = None  #: the only track that is drawn, if any

    def color_mode(self, clip: "Clip") -> ColorMode:
        """The colour mode for a clip: `ColorMode.AUTO` is resolved by whether it has colours."""
        mode = ColorMode(self.color_by)
        if mode in (ColorMode.AUTO, ColorMode.SCAN):
            return ColorMode.SCAN if clip.has_colors else ColorMode.TRACK
        return mode


@dataclass(frozen=True)
class Ground:
    """Colours of a background, and of the lights and texts that go with it.

    The names of the linear colours are those of the uniforms in ground.glsl and shade.frag.
    """

    top_color: LinearColor  #: of the wall, at the top of the picture
    bottom_color: LinearColor  #: of the wall, at the bottom of the picture
    floor_color: LinearColor  #: of the lit floor
    shadow_color: LinearColor  #: of the floor in full shadow
    fog_color: LinearColor  #: that distant parts of the plant fade into
    ambient_top: LinearColor  #: light on the plant from above
    ambient_bottom: LinearColor  #: light on the plant from below
    key_light: LinearColor
    text: str  #: colour of text, "#rrggbb" in sRGB
    muted: str  #: colour of secondary text, "#rrggbb" in sRGB


GROUNDS = {
    "dark": Ground(
        top_color=(0.0070, 0.0110, 0.0135),
        bottom_color=(0.0180, 0.0235, 0.0240),
        floor_color=(0.0560, 0.0660, 0.0620),
        shadow_color=(0.0035, 0.0050, 0.0055),
        fog_color=(0.0200, 0.0280, 0.0290),
        ambient_top=(0.56, 0.62, 0.70),
        ambient_bottom=(0.22, 0.22, 0.20),
        key_light=(1.02, 0.96, 0.84),
        text="#f2f5f3",
        muted="#a3b0ab",
    ),
    "light": Ground(
        top_color=(0.80, 0.84, 0.84),
        bottom_color=(0.72, 0.73, 0.71),
        floor_color=(0.93, 0.92, 0.89),
        shadow_color=(0.10, 0.12, 0.115),
        fog_color=(0.70, 0.73, 0.72),
        ambient_top=(0.56, 0.60, 0.64),
        ambient_bottom=(0.34, 0.34, 0.32),
        key_light=(0.86, 0.83, 0.76),
        text="#15201b",
        muted="#55625c",
    ),
}
