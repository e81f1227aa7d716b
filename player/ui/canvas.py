"""A sheet to draw text, icons and shapes on, over the picture; Dear ImGui does the drawing.

All lengths are in units of 1/96 inch as the screen reports it: the same size on every display.
Text is drawn as it stands: nothing in it is a label, a format or a command.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import moderngl

Color = tuple[float, float, float, float]  # sRGB and alpha, 0 to 1

LONGEST = 200  # characters of any one line
PLAIN, BOLD, ICONS = "Roboto-Regular.ttf", "Roboto-Bold.ttf", "Font_Awesome_6_Free-Solid-900.otf"


@dataclass(frozen=True)
class Pointer:
    """The mouse, for what ImGui itself draws: the panel.

    at:    where it is, in units; None while it is elsewhere, or holds something else.
    down:  whether its left button is held.
    wheel: notches that it was turned since the last picture.
    """

    at: tuple[float, float] | None = None
    down: bool = False
    wheel: float = 0.0


def color(hexadecimal: str, alpha: float = 1.0) -> Color:
    """A colour from "#rrggbb"."""
    red, green, blue = (int(hexadecimal[i : i + 2], 16) / 255 for i in (1, 3, 5))
    return red, green, blue, alpha


class Canvas:
    """`begin`, draw, `finish`: once for every picture."""

    def __init__(self, context: moderngl.Context) -> None:
        import imgui_bundle
        from imgui_bundle import imgui

        from player.ui.imgui_renderer import ImguiRenderer

        self._imgui: Any = imgui
        self._own = imgui.create_context()
        imgui.set_current_context(self._own)
        io = imgui.get_io()
        io.set_ini_filename("")
        io.set_log_filename("")
        folder = Path(imgui_bundle.__file__).parent / "assets" / "fonts"
        found = {file.name: file for file in folder.rglob("*.[ot]tf")}
        self._fonts = {
            name: io.fonts.add_font_from_file_ttf(str(found[name]), 16.0)
            for name in (PLAIN, BOLD, ICONS)
        }
        self._renderer = ImguiRenderer(context)
        self._list: Any = None
        self._then = time.perf_counter()

    def begin(
        self, size: tuple[float, float], scale: float, pointer: Pointer | None = None
    ) -> None:
        """size: (width, height) of the sheet in units; scale: pixels in a unit."""
        self._imgui.set_current_context(self._own)
        io, pointer, now = self._imgui.get_io(), pointer or Pointer(), time.perf_counter()
        io.delta_time = min(max(now - self._then, 1e-4), 1.0)
        self._then = now
        io.add_mouse_pos_event(*(pointer.at or (-1e6, -1e6)))
        io.add_mouse_button_event(0, pointer.down)
        io.add_mouse_wheel_event(0.0, pointer.wheel)
        io.display_size = self._imgui.ImVec2(*size)
        io.display_framebuffer_scale = self._imgui.ImVec2(scale, scale)
        self._imgui.new_frame()
        self._list = self._imgui.get_background_draw_list()

    def to_front(self) -> None:
        """What is drawn from now on lies over the panel."""
        self._list = self._imgui.get_foreground_draw_list()

    @property
    def fonts(self) -> dict[str, Any]:
        """ImGui's fonts, by PLAIN, BOLD and ICONS."""
        return self._fonts

    @property
    def popup(self) -> bool:
        """Whether something of ImGui's is open that takes the mouse wherever it is."""
        every = self._imgui.PopupFlags_
        flags = every.any_popup_id.value | every.any_popup_level.value
        return bool(self._imgui.is_popup_open("", flags))

    def finish(self, framebuffer: moderngl.Framebuffer) -> None:
        """Draw the sheet over what `framebuffer` holds already."""
        self._imgui.render()
        self._renderer.draw(framebuffer)

    def release(self) -> None:
        self._imgui.set_current_context(self._own)
        self._renderer.release()
        self._imgui.destroy_context(self._own)

    def width(self, text: str, size: float, font: str = PLAIN) -> float:
        """How wide a line of text is, in units; between `begin` and `finish`."""
        self._imgui.push_font(self._fonts[font], size)
        width = self._imgui.calc_text_size(_one_line(text), False).x
        self._imgui.pop_font()
        return float(width)

    def fitted(self, text: str, size: float, room: float, font: str = PLAIN) -> str:
        """The text, or as much of it as `room` holds, with an ellipsis."""
        if len(text) <= LONGEST and self.width(text, size, font) <= room:
            return text
        text = text[:LONGEST]
        while text and self.width(text + "…", size, font) > room:
            text = text[:-1]
        return text.rstrip() + "…" if text else ""

    def wrapped(self, text: str, size: float, room: float, most: int = 4) -> list[str]:
        """As lines that fit, broken between words; what would be beyond `most` of them is cut."""
        lines = [""]
        for word in text.split():
            longer = f"{lines[-1]} {word}".strip()
            if not lines[-1] or self.width(longer, size) <= room or len(lines) == most:
                lines[-1] = longer
            else:
                lines.append(word)
        return [self.fitted(line, size, room) for line in lines]

    def text(
        self,
        x: float,
        y: float,
        text: str,
        size: float,
        color: Color,
        font: str = PLAIN,
        align: float = 0.0,
    ) -> None:
        """A line of text about the height `y`; `align` 0 starts, 0.5 centres, 1 ends it at `x`."""
        left = x - align * self.width(text, size, font)
        # Roboto's capitals stand a little above the middle of the line's box.
        top = y - size / 2 + (0.0 if font == ICONS else 0.02 * size)
        self._list.add_text(
            self._fonts[font], size, (left, top), self._packed(color), _one_line(text)
        )

    def rectangle(
        self, x: float, y: float, width: float, height: float, color: Color, radius: float = 0.0
    ) -> None:
        self._list.add_rect_filled((x, y), (x + width, y + height), self._packed(color), radius)

    def frame(
        self, x: float, y: float, width: float, height: float, color: Color, radius: float = 0.0
    ) -> None:
        """A rectangle's outline, one unit wide."""
        self._list.add_rect((x, y), (x + width, y + height), self._packed(color), radius)

    def gradient(
        self, x: float, y: float, width: float, height: float, top: Color, bottom: Color
    ) -> None:
        above, below = self._packed(top), self._packed(bottom)
        self._list.add_rect_filled_multi_color(
            (x, y), (x + width, y + height), above, above, below, below
        )

    def ramp(
        self, x: float, y: float, width: float, height: float, left: Color, right: Color
    ) -> None:
        start, end = self._packed(left), self._packed(right)
        self._list.add_rect_filled_multi_color(
            (x, y), (x + width, y + height), start, end, end, start
        )

    def disc(self, x: float, y: float, radius: float, color: Color) -> None:
        self._list.add_circle_filled((x, y), radius, self._packed(color), 48)

    def ring(self, x: float, y: float, radius: float, color: Color, thickness: float) -> None:
        self._list.add_circle((x, y), radius, self._packed(color), 48, thickness)

    def line(
        self, start: tuple[float, float], end: tuple[float, float], color: Color, thickness: float
    ) -> None:
        self._list.add_line(start, end, self._packed(color), thickness)

    def triangle(self, corners: list[tuple[float, float]], color: Color) -> None:
        self._list.add_triangle_filled(*corners, self._packed(color))

    def _packed(self, color: Color) -> int:
        return int(self._imgui.get_color_u32(self._imgui.ImVec4(*color)))


def _one_line(text: str) -> str:
    """Line breaks and control characters as spaces; icons (private use) stay."""
    return "".join(c if c.isprintable() or "\ue000" <= c <= "\uf8ff" else " " for c in text)
