"""How the plant is to look: what the user chooses, apart from camera and time."""

from dataclasses import dataclass

COLOR_CHOICES = ("auto", "scan", "track")
GROUND_CHOICES = ("dark", "light")


@dataclass(frozen=True)
class Style:
    """The look of a picture.

    color_by:    "scan" for the scans' own colours, "track" for one colour an organ, "auto" for the
                 scans' colours where there are any. "scan" falls back to "track" without any.
    ground:      "dark" or "light", the background.
    point_size:  factor on the clip's natural point size, 1 closes the surfaces.
    depth_cue:   far parts recede into the background.
    eye_dome:    strength of the shading found from depth alone, 0 switches it off
                 (Boucheny 2009, eye-dome lighting).
    show_ground: a soft floor with the plant's shadow.
    """

    color_by: str = "auto"
    ground: str = "dark"
    point_size: float = 1.0
    depth_cue: bool = True
    eye_dome: float = 1.0
    show_ground: bool = True
