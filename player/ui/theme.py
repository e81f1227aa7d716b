"""The colours of what lies over the plant, one set for each ground: of Dear ImGui, and of a pen
that writes and draws boxes on its draw lists, as annotations do.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from imgui_bundle import imgui, imgui_ctx

from player.view.annotations import RGB
from player.view.style import GROUNDS

Color = imgui.ImVec4  # sRGB and alpha, 0 to 1

CLEAR = Color(0.0, 0.0, 0.0, 0.0)
PADDING = 16.0  # of the panel, right and left
MAX_LINE = 200  # characters of any one line


def rgb(channels: Iterable[int], alpha: float = 1.0) -> Color:
    """A colour from numbers up to 255."""
    red, green, blue = (channel / 255 for channel in channels)
    return Color(red, green, blue, alpha)


def faint(color: Color, alpha: float) -> Color:
    """The same colour, less opaque."""
    return Color(color.x, color.y, color.z, alpha)


def packed(color: Color) -> int:
    """As ImGui's draw lists take it."""
    return int(imgui.get_color_u32(color))


@dataclass(frozen=True)
class Theme:
    """The colours of one ground's interface."""

    text: Color
    muted: Color  #: writing that stays back
    accent: Color  #: what has passed on the timeline, and what the cursor is on
    card: Color  #: bubbles, tips and the help
    loss: Color  #: marks of lost organs
    veil: Color  #: the ground's own colour, to calm it behind the timeline and about writing
    axes: tuple[Color, ...]  #: of x, y and z
    track: Color  #: the timeline's line, where it has not passed yet


def _theme(ground: str, *colors: str) -> Theme:
    """From the colours of accent, card, loss, veil and axes."""
    known = GROUNDS[ground].text, GROUNDS[ground].muted
    text, muted, accent, card, loss, veil, *axes = (
        rgb(bytes.fromhex(color[1:])) for color in (*known, *colors)
    )
    card, track = faint(card, 0.96), faint(text, 0.24)
    return Theme(text, muted, accent, card, loss, veil, tuple(axes), track)


DARK = _theme("dark", "#7ddb8c", "#1d2624", "#e8a06a", "#0d1213", "#f07b80", "#7ccb7c", "#7ba6f2")
LIGHT = _theme("light", "#1f8a4c", "#fdfdfb", "#b8581c", "#e3e4e0", "#b3262d", "#227a22", "#2257b8")


def dress(style: imgui.Style, theme: Theme) -> None:
    """Dear ImGui in the theme's colours."""
    (imgui.style_colors_light if theme is LIGHT else imgui.style_colors_dark)(style)
    style.window_padding = imgui.ImVec2(PADDING, 12.0)
    style.frame_padding, style.item_spacing = imgui.ImVec2(8.0, 3.0), imgui.ImVec2(8.0, 6.0)
    style.frame_rounding = style.grab_rounding = style.popup_rounding = 6.0
    style.window_border_size = style.window_rounding = 0.0
    style.scrollbar_size, style.grab_min_size = 10.0, 12.0
    style.font_size_base = 15.0
    for paint, parts in (
        (theme.text, "text"),
        (theme.muted, "text_disabled"),
        (theme.veil, "window_bg"),
        (theme.card, "popup_bg"),
        (CLEAR, "scrollbar_bg"),
        (theme.accent, "check_mark plot_histogram"),
        (faint(theme.accent, 0.5), "slider_grab slider_grab_active"),
        (faint(theme.accent, 0.30), "button_active header_active"),
        (faint(theme.text, 0.09), "frame_bg button header checkbox_selected_bg"),
        (faint(theme.text, 0.13), "border frame_bg_hovered frame_bg_active"),
        (faint(theme.text, 0.13), "button_hovered header_hovered"),
    ):
        for part in parts.split():
            style.set_color_(getattr(imgui.Col_, part), paint)


class Pen:
    """A `player.view.annotations.Pen`, and for the interface's own shapes.

    sheet:  ImGui's draw list, behind all of its windows.
    size:   (width, height) of the picture that annotations stand in, in units.
    insets: (left, top, right, bottom) that they keep from its edges.
    """

    def __init__(
        self, theme: Theme, bold: imgui.ImFont,
        size: tuple[float, float], insets: tuple[float, float, float, float],
    ) -> None:  # fmt: skip
        self.theme, self.size, self.insets = theme, size, insets
        self.sheet = imgui.get_background_draw_list()
        self._plain, self.bold = imgui.get_font(), bold

    def text(
        self, x: float, y: float, text: str, size: float, bold: bool = False, muted: bool = False
    ) -> None:
        """As `player.view.annotations.Pen` says; over the plant, so with a halo."""
        left, top = self._corner(x, y, self.width(one_line(text), size, bold), size)
        halo, color = faint(self.theme.veil, 0.3), self.theme.muted if muted else self.theme.text
        for right, down in ((-1, 0), (1, 0), (0, -1), (0, 1)):
            self.write(left + right, top + down + size / 2, text, size, halo, bold)
        self.write(left, top + size / 2, text, size, color, bold)

    def box(self, x: float, y: float, width: float, height: float, color: RGB | None) -> None:
        """As `player.view.annotations.Pen` says."""
        x, y = self._corner(x, y, width, height)
        paint = self.theme.text if color is None else rgb(color)
        self.sheet.add_rect_filled((x, y), (x + width, y + height), packed(paint))

    def write(
        self, x: float, y: float, text: str, size: float, color: Color,
        bold: bool = False, align: float = 0.0,
    ) -> None:  # fmt: skip
        """A line about the height `y`; `align` 0 starts, 0.5 centres, 1 ends it at `x`."""
        text, font = one_line(text), self.bold if bold else self._plain
        left = x - align * self.width(text, size, bold)
        self.sheet.add_text(font, size, (left, y - size / 2), packed(color), text)

    def width(self, text: str, size: float, bold: bool = False) -> float:
        """How wide a line of text is, in units."""
        with imgui_ctx.push_font(self.bold if bold else self._plain, size):
            return float(imgui.calc_text_size(text).x)

    def _corner(self, x: float, y: float, width: float, height: float) -> tuple[float, float]:
        """The upper left one of what stands (x, y) inwards from the nearest corner."""
        left, top, right, bottom = self.insets
        return (
            self.size[0] - right + x + 1 - width if x < 0 else left + x,
            self.size[1] - bottom + y + 1 - height if y < 0 else top + y,
        )


def one_line(text: str, longest: int = MAX_LINE) -> str:
    """As much of a text as may be seen, line breaks and control characters as spaces; icons
    (private use) stay.
    """
    if len(text) > longest:
        text = text[: longest - 1] + "…"
    return "".join(c if c.isprintable() or "\ue000" <= c <= "\uf8ff" else " " for c in text)
