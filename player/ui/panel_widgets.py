"""The panel's controls: Dear ImGui's own, in the window's look, each with the key that does it too.

Texts are never labels to ImGui: names from clips can't change what a control is.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from player.ui import keys
from player.ui.canvas import BOLD, ICONS, PLAIN, Color

if TYPE_CHECKING:
    from player.ui.canvas import Canvas
    from player.ui.theme import Theme

TEXT, SMALL = 15.0, 13.0
PADDING, LABEL, KEY, ROW = 16.0, 74.0, 26.0, 25.0
EYE, EYE_CLOSED = "\uf06e", "\uf070"


class Widgets:
    """A context: what is called within it is drawn from the top of the panel to its end."""

    def __init__(
        self, canvas: Canvas, theme: Theme, place: tuple[float, float, float, float]
    ) -> None:
        from imgui_bundle import imgui

        self._imgui: Any = imgui
        self._fonts = canvas.fonts
        self._canvas = canvas
        self._theme = theme
        self._place = place

    def __enter__(self) -> Self:
        imgui, (x, y, width, height) = self._imgui, self._place
        self._dress()
        imgui.set_next_window_pos((x, y))
        imgui.set_next_window_size((width, height))
        imgui.push_font(self._fonts[PLAIN], TEXT)
        flags = imgui.WindowFlags_
        imgui.begin(
            "panel",
            None,
            flags.no_decoration.value & ~flags.no_scrollbar.value
            | flags.no_move.value
            | flags.no_saved_settings.value
            | flags.no_nav.value,
        )
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._imgui.end()
        self._imgui.pop_font()

    def section(self, title: str, opened: bool) -> bool:
        """A heading that opens and closes what follows; whether it is open."""
        imgui = self._imgui
        imgui.push_font(self._fonts[BOLD], TEXT)
        imgui.set_next_item_open(opened, imgui.Cond_.once.value)
        shown = imgui.collapsing_header(title)
        imgui.pop_font()
        return bool(shown)

    def choice(self, label: str, names: Sequence[str], now: int, action: str) -> int | None:
        """One of several; the number of the one that was just chosen."""
        imgui, found = self._imgui, None
        self._label(label)
        imgui.set_next_item_width(self._room(action))
        if imgui.begin_combo(f"##{label}", names[now]):
            for number, name in enumerate(names):
                if imgui.selectable(name, number == now)[0]:
                    found = number
            imgui.end_combo()
        self._key(action)
        return found

    def slider(
        self,
        label: str,
        value: float,
        low: float,
        high: float,
        action: str,
        text: str,
        logarithmic: bool = True,
    ) -> float | None:
        """A number; the new one while it is being changed. `text` is how it reads."""
        imgui = self._imgui
        self._label(label)
        imgui.set_next_item_width(self._room(action))
        flags = imgui.SliderFlags_
        flag = (flags.logarithmic.value if logarithmic else 0) | flags.no_input.value
        shown = text.replace("%", "%%")
        changed, new = imgui.slider_float(f"##{label}", value, low, high, shown, flag)
        self._key(action)
        return float(new) if changed else None

    def switch(self, label: str, on: bool, action: str) -> bool:
        """Whether it was turned."""
        imgui = self._imgui
        turned, _ = imgui.checkbox(f"##{action}", on)
        imgui.same_line()
        imgui.text_unformatted(label)
        if imgui.is_item_clicked():
            turned = True
        self._key(action)
        return bool(turned)

    def buttons(self, actions: Sequence[tuple[str, str]], active: str = "") -> str:
        """Buttons in a row, (action, label); the action whose button was pressed, or ""."""
        imgui, pressed = self._imgui, ""
        gap = imgui.get_style().item_spacing.x
        width = (imgui.get_content_region_avail().x - gap * (len(actions) - 1)) / len(actions)
        for number, (action, label) in enumerate(actions):
            if number:
                imgui.same_line()
            if action == active:
                imgui.push_style_color(imgui.Col_.button.value, (*self._theme.accent[:3], 0.35))
            if imgui.button(f"{label}##{action}", (width, 0.0)):
                pressed = action
            if action == active:
                imgui.pop_style_color()
            self._tip(action)
        return pressed

    @contextmanager
    def rows(self, count: int, most: int) -> Iterator[Iterator[int]]:
        """A list of `count` rows, `most` in sight; gives the numbers of those to draw."""
        imgui = self._imgui
        imgui.begin_child("list", (0.0, most * ROW + 4.0))
        imgui.push_style_var(imgui.StyleVar_.item_spacing.value, (0.0, 0.0))
        clipper = imgui.ListClipper()
        clipper.begin(count, ROW)

        def shown() -> Iterator[int]:
            while clipper.step():
                yield from range(clipper.display_start, clipper.display_end)

        yield shown()
        clipper.end()
        imgui.pop_style_var()
        imgui.end_child()

    def organ(
        self, row: int, name: str, color: tuple[int, int, int], picked: bool, visible: bool
    ) -> str:
        """A row of the organs' list; "name" or "eye", whichever was clicked, else ""."""
        imgui, theme = self._imgui, self._theme
        imgui.push_id(row)
        x, y = imgui.get_cursor_screen_pos()
        width = imgui.get_content_region_avail().x
        paint = theme.text if visible else theme.muted
        clicked = "name" if imgui.invisible_button("name", (width - KEY, ROW)) else ""
        over = imgui.is_item_hovered()
        drawn = imgui.get_window_draw_list()
        if over or picked:
            fill = theme.hover if not picked else (*theme.accent[:3], 0.22)
            drawn.add_rect_filled((x, y), (x + width, y + ROW), self._packed(fill), 6.0)
        imgui.same_line(0.0, 0.0)
        clicked = "eye" if imgui.invisible_button("eye", (KEY, ROW)) else clicked
        dot = tuple(channel / 255.0 for channel in color)
        middle = y + ROW / 2
        alpha = 1.0 if visible else 0.3
        drawn.add_circle_filled((x + 11.0, middle), 5.5, self._packed((*dot, alpha)), 24)  # type: ignore[arg-type]
        text = self._canvas.fitted(name, TEXT, width - KEY - 34.0)
        self._write(drawn, PLAIN, TEXT, (x + 25.0, middle - TEXT / 2), paint, text)
        icon = EYE if visible else EYE_CLOSED
        eye = theme.text if imgui.is_item_hovered() else theme.muted
        self._write(drawn, ICONS, SMALL, (x + width - 22.0, middle - SMALL / 2), eye, icon)
        imgui.pop_id()
        return clicked

    def progress(self, done: int, total: int) -> None:
        imgui = self._imgui
        imgui.progress_bar(done / total if total else 0.0, (-1.0, 8.0), "")

    def _label(self, label: str) -> None:
        imgui = self._imgui
        imgui.align_text_to_frame_padding()
        imgui.push_style_color(imgui.Col_.text.value, self._theme.muted)
        imgui.text_unformatted(label)
        imgui.pop_style_color()
        imgui.same_line(PADDING + LABEL)

    def _room(self, action: str) -> float:
        """Width between a label and its key."""
        taken = max(KEY, self._canvas.width(keys.action(action).labels[0], SMALL) + 12.0)
        return float(self._imgui.get_content_region_avail().x) - taken

    def _key(self, action: str) -> None:
        """The key that does the same, at the end of the row."""
        imgui = self._imgui
        self._tip(action)
        label = keys.action(action).labels[0]
        left = imgui.get_window_width() - PADDING - self._scrollbar()
        width = self._canvas.width(label, SMALL)
        imgui.same_line(left - width)
        imgui.push_font(self._fonts[PLAIN], SMALL)
        imgui.push_style_color(imgui.Col_.text.value, (*self._theme.muted[:3], 0.75))
        imgui.text_unformatted(label)
        imgui.pop_style_color()
        imgui.pop_font()

    def _tip(self, action: str) -> None:
        imgui, chosen = self._imgui, keys.action(action)
        if imgui.is_item_hovered(imgui.HoveredFlags_.delay_normal.value):
            imgui.set_tooltip(f"{chosen.row or chosen.help}  ({', '.join(chosen.labels)})")

    def _scrollbar(self) -> float:
        imgui = self._imgui
        return float(imgui.get_style().scrollbar_size) if imgui.get_scroll_max_y() > 0 else 0.0

    def _write(
        self, drawn: Any, font: str, size: float, at: tuple[float, float], color: Color, text: str
    ) -> None:
        drawn.add_text(self._fonts[font], size, at, self._packed(color), text)

    def _packed(self, color: Color) -> int:
        return int(self._imgui.get_color_u32(self._imgui.ImVec4(*color)))

    def _dress(self) -> None:
        """Dear ImGui in the theme's colours."""
        imgui, theme = self._imgui, self._theme
        style, column = imgui.get_style(), imgui.Col_
        style.window_padding = (PADDING, 12.0)
        style.frame_padding = (8.0, 3.0)
        style.item_spacing = (8.0, 6.0)
        style.frame_rounding = style.grab_rounding = style.popup_rounding = 6.0
        style.window_border_size = 0.0
        style.window_rounding = style.child_rounding = 0.0
        style.scrollbar_size, style.grab_min_size = 10.0, 12.0
        clear = (0.0, 0.0, 0.0, 0.0)
        soft = (*theme.text[:3], 0.09)
        softer, strong = (*theme.text[:3], 0.05), (*theme.accent[:3], 0.30)
        for name, paint in {
            "text": theme.text,
            "text_disabled": theme.muted,
            "window_bg": (*theme.veil[:3], 1.0),
            "child_bg": clear,
            "popup_bg": (*theme.card[:3], 1.0),
            "border": theme.edge,
            "frame_bg": soft,
            "frame_bg_hovered": theme.hover,
            "frame_bg_active": theme.hover,
            "button": soft,
            "button_hovered": theme.hover,
            "button_active": strong,
            "header": softer,
            "header_hovered": theme.hover,
            "header_active": strong,
            "check_mark": theme.accent,
            "checkbox_selected_bg": soft,  # newer versions alone
            "slider_grab": (*theme.accent[:3], 0.45),
            "slider_grab_active": (*theme.accent[:3], 0.65),
            "plot_histogram": theme.accent,
            "scrollbar_bg": clear,
            "scrollbar_grab": (*theme.text[:3], 0.18),
            "scrollbar_grab_hovered": (*theme.text[:3], 0.30),
            "scrollbar_grab_active": (*theme.text[:3], 0.40),
        }.items():
            if hasattr(column, name):
                style.set_color_(getattr(column, name).value, imgui.ImVec4(*paint))
