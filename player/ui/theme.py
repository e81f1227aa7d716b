"""The colours of what lies over the plant, one set for each ground, and Dear ImGui in them."""

from dataclasses import dataclass

from imgui_bundle import imgui

from player.view.style import GROUNDS

Color = tuple[float, float, float, float]  # sRGB and alpha, 0 to 1

CLEAR = (0.0, 0.0, 0.0, 0.0)
PADDING = 16.0  # of the panel, right and left


def color(hexadecimal: str, alpha: float = 1.0) -> Color:
    """A colour from "#rrggbb"."""
    red, green, blue = (int(hexadecimal[i : i + 2], 16) / 255 for i in (1, 3, 5))
    return red, green, blue, alpha


def rgb(channels: tuple[int, int, int], alpha: float = 1.0) -> Color:
    """A colour from numbers up to 255."""
    red, green, blue = (channel / 255 for channel in channels)
    return red, green, blue, alpha


def faint(color: Color, alpha: float) -> Color:
    """The same colour, less opaque."""
    return (*color[:3], alpha)


def packed(color: Color) -> int:
    """As ImGui's draw lists take it."""
    return int(imgui.get_color_u32(imgui.ImVec4(*color)))


@dataclass(frozen=True)
class Theme:
    """The colours of one ground's interface."""

    text: Color
    muted: Color  #: writing that stays back
    halo: Color  #: about writing that may lie over the plant
    accent: Color  #: what has passed on the timeline, and what the cursor is on
    on_accent: Color  #: writing and icons on the accent
    track: Color  #: the timeline's line, where it has not passed yet
    card: Color  #: bubbles, tips and the help
    edge: Color  #: their outline
    loss: Color  #: marks of lost organs
    hover: Color  #: behind the button under the cursor
    veil: Color  #: the ground's own colour, to calm it behind the timeline
    shade: Color  #: over everything else while the help is open
    axes: tuple[Color, Color, Color]  #: of x, y and z


DARK = Theme(
    text=color(GROUNDS["dark"].text),
    muted=color(GROUNDS["dark"].muted),
    halo=color("#000000", 0.43),
    accent=color("#7ddb8c"),
    on_accent=color("#0c1a12"),
    track=color("#ffffff", 0.24),
    card=color("#1d2624", 0.96),
    edge=color("#ffffff", 0.12),
    loss=color("#e8a06a"),
    hover=color("#ffffff", 0.12),
    veil=color("#0d1213"),
    shade=color("#060909", 0.66),
    axes=(color("#f07b80"), color("#7ccb7c"), color("#7ba6f2")),
)

LIGHT = Theme(
    text=color(GROUNDS["light"].text),
    muted=color(GROUNDS["light"].muted),
    halo=color("#ffffff", 0.47),
    accent=color("#1f8a4c"),
    on_accent=color("#ffffff"),
    track=color("#15201b", 0.24),
    card=color("#fdfdfb", 0.97),
    edge=color("#15201b", 0.14),
    loss=color("#b8581c"),
    hover=color("#15201b", 0.09),
    veil=color("#e3e4e0"),
    shade=color("#c9cdc9", 0.66),
    axes=(color("#b3262d"), color("#227a22"), color("#2257b8")),
)


def theme_of(ground: str) -> Theme:
    return LIGHT if ground == "light" else DARK


def dress(style: imgui.Style, theme: Theme) -> None:
    """Dear ImGui in the theme's colours."""
    style.window_padding = imgui.ImVec2(PADDING, 12.0)
    style.frame_padding, style.item_spacing = imgui.ImVec2(8.0, 3.0), imgui.ImVec2(8.0, 6.0)
    style.frame_rounding = style.grab_rounding = style.popup_rounding = 6.0
    style.window_border_size = style.window_rounding = style.child_rounding = 0.0
    style.scrollbar_size, style.grab_min_size = 10.0, 12.0
    style.font_size_base = 15.0
    soft, strong = faint(theme.text, 0.09), faint(theme.accent, 0.30)
    colors = {
        "text": theme.text,
        "text_disabled": theme.muted,
        "window_bg": faint(theme.veil, 1.0),
        "child_bg": CLEAR,
        "popup_bg": faint(theme.card, 1.0),
        "border": theme.edge,
        "frame_bg": soft,
        "frame_bg_hovered": theme.hover,
        "frame_bg_active": theme.hover,
        "button": soft,
        "button_hovered": theme.hover,
        "button_active": strong,
        "header": faint(theme.text, 0.05),
        "header_hovered": theme.hover,
        "header_active": strong,
        "check_mark": theme.accent,
        "slider_grab": faint(theme.accent, 0.75),
        "slider_grab_active": theme.accent,
        "plot_histogram": theme.accent,
        "scrollbar_bg": CLEAR,
        "scrollbar_grab": faint(theme.text, 0.18),
        "scrollbar_grab_hovered": faint(theme.text, 0.30),
        "scrollbar_grab_active": faint(theme.text, 0.40),
    }
    for name, paint in colors.items():
        style.set_color_(getattr(imgui.Col_, name), imgui.ImVec4(*paint))
    if hasattr(imgui.Col_, "checkbox_selected_bg"):  # newer versions alone
        style.set_color_(imgui.Col_.checkbox_selected_bg, imgui.ImVec4(*soft))
