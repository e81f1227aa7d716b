"""How the plant is to look: what the user chooses, apart from camera and time."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    from gclip import Clip

Light = tuple[float, float, float]


class ColorMode(StrEnum):
    """What movers are coloured by."""

    label: str  #: what users read
    #: of a value's colours, as `cmap` names it; "" for the scans' and the organs' own
    colormap: str

    def __new__(cls, value: str, label: str = "", colormap: str = "") -> Self:
        mode = str.__new__(cls, value)
        mode._value_, mode.label, mode.colormap = value, label, colormap
        return mode

    AUTO = "auto", "the scans' colours, or organs"
    SCAN = "scan", "scan colours"
    TRACK = "track", "organs"
    AGE = "age", "age", "crameri:imola_r"
    GROWTH = "growth", "growth rate", "colorbrewer:YlOrRd"
    SPEED = "speed", "speed of motion", "colorbrewer:YlOrRd"
    HEIGHT = "height", "height", "viridis"
    FIELD = "field", "field of the scans", "viridis"
    ERROR = "error", "error", "plasma"

    @property
    def painted(self) -> bool:
        """Whether a clip is given the values' colours as its own (player/view/colors.py)."""
        return self in (ColorMode.GROWTH, ColorMode.FIELD, ColorMode.ERROR)

    def lacking(self, clip: Clip) -> str:
        """Why a clip can't be coloured so, and how it could; "" where it can."""
        if self is ColorMode.FIELD and not clip.fields:
            return "the clip carries no field of its scans; bake it with --fields NAMES."
        if self is ColorMode.ERROR and not clip.held_out:
            return "the clip holds no scan that was left out of it; bake it with --holdout 2."
        return ""


class ColorMap(StrEnum):
    """The colours of values: those that suit the value, or a map by its name in `cmap`."""

    AUTO = "auto"
    VIRIDIS = "viridis"
    MAGMA = "magma"
    CIVIDIS = "cividis"
    BATLOW = "batlow"
    TURBO = "turbo"
    GREYS = "gray"


class GroundChoice(StrEnum):
    """The background."""

    DARK = "dark"
    LIGHT = "light"


@dataclass(frozen=True)
class Style:
    """The look of a picture."""

    #: the scans' own colours, one for each organ, or by value (player/view/colors.py)
    color_by: ColorMode = ColorMode.AUTO
    color_map: ColorMap = ColorMap.AUTO  #: the colours of values
    field: str = ""  #: that is coloured by; the clip's first one where it has none of that name
    ground: str = GroundChoice.DARK  #: the background
    point_size: float = 1.0  #: factor on the clip's natural point size, 1 closes the surfaces
    depth_cue: bool = True  #: far parts recede into the background
    #: strength of the shading found from depth alone, 0 switches it off (Boucheny 2009, eye-dome
    #: lighting)
    eye_dome: float = 1.0
    show_ground: bool = True  #: a soft floor with the plant's shadow
    picked: int | None = None  #: the track that is highlighted: all others stand back
    second: int | None = None  #: another one that is highlighted
    hidden: frozenset[int] = frozenset()  #: tracks that are not drawn
    alone: int | None = None  #: the only track that is drawn

    def color_mode(self, clip: Clip) -> ColorMode:
        """The colouring that it comes to with a clip."""
        mode = ColorMode(self.color_by)
        if mode in (ColorMode.AUTO, ColorMode.SCAN):
            return ColorMode.SCAN if clip.has_colors else ColorMode.TRACK
        return mode

    @property
    def marked(self) -> bool:
        """Whether organs are told apart beyond their colours."""
        return bool(self.hidden) or self.picked is not None or self.alone is not None


@dataclass(frozen=True)
class Ground:
    """A background's colours and the lights that go with them, all in linear light."""

    top_color: Light  #: of the wall
    bottom_color: Light
    floor_color: Light  #: where it is lit
    shadow_color: Light  #: of the floor where the plant keeps all light away
    fog_color: Light  #: what far parts of the plant recede into
    ambient_top: Light  #: light on the plant from above
    ambient_bottom: Light
    key_light: Light  #: from the lamp
    text: str  #: what is written over it, #rrggbb
    muted: str  #: what of that stays back


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
