"""Colours of the user interface for both backgrounds, and a pen for Dear ImGui's draw lists."""

from collections.abc import Iterable
from dataclasses import dataclass

from imgui_bundle import imgui, imgui_ctx

from player.view import annotations
from player.view.style import GROUNDS

Color = imgui.ImVec4  # sRGB and alpha from 0 to 1

to_u32 = imgui.get_color_u32  # packs a colour into 32 bits for ImGui's draw lists
CLEAR = Color(0.0, 0.0, 0.0, 0.0)
PADDING = 16.0  # units at the left and right of the panel
MAX_LINE_LENGTH = 200  # characters


def rgb(channels: Iterable[int], alpha: float = 1.0) -> Color:
    """Convert red, green and blue from 0 to 255."""
    red, green, blue = (channel / 255 for channel in channels)
    return Color(red, green, blue, alpha)


def with_alpha(color: Color, alpha: float) -> Color:
    """The same colour with another opacity."""
    return Color(color.x, color.y, color.z, alpha)


@dataclass(frozen=True)
class Theme:
    """Colours of the interface over one background."""

    text: Color
    muted: Color  #: secondary text
    accent: Color  #: active controls, and the timeline up to the current day
    card: Color  #: cards, tooltips and the help
    loss: Color  #: marks of lost organs
    veil: Color  #: colour of the background, drawn behind text to make it legible
    axes: tuple[Color, ...]  #: of x, y and z
    track: Color  #: the timeline after the current day


def _theme(ground: str, *colors: str) -> Theme:
    """Make a theme from "#rrggbb" colours of accent, card, loss, veil and axes."""
    texts = GROUNDS[ground].text, GROUNDS[ground].muted
    text, muted, accent, card, loss, veil, *axes = (
        rgb(bytes.fromhex(color[1:])) for color in (*texts, *colors)
    )
    card, track = with_alpha(card, 0.96), with_alpha(text, 0.24)
    return Theme(text, muted, accent, card, loss, veil, tuple(axes), track)


DARK = _theme("dark", "#7ddb8c", "#1d2624", "#e8a06a", "#0d1213", "#f07b80", "#7ccb7c", "#7ba6f2")
LIGHT = _theme("light", "#1f8a4c", "#fdfdfb", "#b8581c", "#e3e4e0", "#b3262d", "#227a22", "#2257b8")


def apply_theme(style: imgui.Style, theme: Theme) -> None:
    """Set colours, sizes and spacings of Dear ImGui."""
    (imgui.style_colors_light if theme is LIGHT else imgui.style_colors_dark)(style)
    style.window_padding = imgui.ImVec2(PADDING, 12.0)
    style.frame_padding, style.item_spacing = imgui.ImVec2(8.0, 3.0), imgui.ImVec2(8.0, 6.0)
    style.frame_rounding = style.grab_rounding = style.popup_rounding = 6.0
    style.window_border_size = style.window_rounding = 0.0
    style.scrollbar_size, style.grab_min_size = 10.0, 12.0
    style.font_size_base = 15.0
    for color, parts in (
        (theme.text, "text"),
        (theme.muted, "text_disabled"),
        (theme.veil, "window_bg"),
        (theme.card, "popup_bg"),
        (CLEAR, "scrollbar_bg"),
        (theme.accent, "check_mark plot_histogram"),
        (with_alpha(theme.accent, 0.5), "slider_grab slider_grab_active"),
        (with_alpha(theme.accent, 0.30), "button_active header_active"),
        (with_alpha(theme.text, 0.09), "frame_bg button header checkbox_selected_bg"),
        (with_alpha(theme.text, 0.13), "border frame_bg_hovered frame_bg_active"),
        (with_alpha(theme.text, 0.13), "button_hovered header_hovered"),
    ):
        for part in parts.split():
            style.set_color_(getattr(imgui.Col_, part), color)


class Pen(annotations.Pen):
    """Draws on ImGui's draw list behind all windows (`sheet`).

    size:   (width, height) of the area for annotations, in units.
    insets: (left, top, right, bottom) margins between annotations and the area's edges.
    """

    def __init__(
        self, theme: Theme, bold: imgui.ImFont,
        size: tuple[float, float], insets: tuple[float, float, float, float],
    ) -> None:  # fmt: skip
        self.theme, self.size, self.insets = theme, size, insets
        self.sheet = imgui.get_background_draw_list()
        self._regular, self.bold = imgui.get_font(), bold

    def text(
        self, x: float, y: float, text: str, size: float, bold: bool = False, muted: bool = False
    ) -> None:
        """Draw text with a halo; see `player.view.annotations.Pen`."""
        left, top = self.corner(x, y, self.width(one_line(text), size, bold), size)
        halo = with_alpha(self.theme.veil, 0.3)
        color = self.theme.muted if muted else self.theme.text
        for right, down in ((-1, 0), (1, 0), (0, -1), (0, 1)):
            self.write(left + right, top + down + size / 2, text, size, halo, bold)
        self.write(left, top + size / 2, text, size, color, bold)

    def box(
        self, x: float, y: float, width: float, height: float, color: annotations.RGB | None
    ) -> None:
        """Draw a box; see `player.view.annotations.Pen`."""
        x, y = self.corner(x, y, width, height)
        fill = self.theme.text if color is None else rgb(color)
        self.sheet.add_rect_filled((x, y), (x + width, y + height), to_u32(fill))

    def write(
        self, x: float, y: float, text: str, size: float, color: Color,
        bold: bool = False, align: float = 0.0,
    ) -> None:  # fmt: skip
        """Draw text centred at height y; at x it starts (align 0), is centred (0.5) or ends (1)."""
        text, font = one_line(text), self.bold if bold else self._regular
        left = x - align * self.width(text, size, bold)
        self.sheet.add_text(font, size, (left, y - size / 2), to_u32(color), text)

    def width(self, text: str, size: float, bold: bool = False) -> float:
        """Width of a line of text in units."""
        with imgui_ctx.push_font(self.bold if bold else self._regular, size):
            return float(imgui.calc_text_size(text).x)


def one_line(text: str, longest: int = MAX_LINE_LENGTH) -> str:
    """Shorten a text, and replace line breaks and control characters by spaces.

    Icons are characters of the private use area, and are kept.
    """
    if len(text) > longest:
        text = text[: longest - 1] + "…"
    return "".join(c if c.isprintable() or "\ue000" <= c <= "\uf8ff" else " " for c in text)
