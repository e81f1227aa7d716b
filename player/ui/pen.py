"""Writing and boxes on one of Dear ImGui's draw lists; what annotations are drawn with, too."""

from imgui_bundle import imgui

from player.ui.gui import Gui
from player.ui.theme import Color, faint, packed, rgb
from player.view.annotations import RGB

MAX_LINE = 200  # characters of any one line
CARD_PADDING = (10.0, 6.0)


class Pen:
    """A `player.view.annotations.Pen`, and for the interface's own shapes.

    sheet:  ImGui's draw list.
    size:   (width, height) of the picture that annotations stand in, in units.
    insets: (left, top, right, bottom) that they keep from its edges.
    """

    def __init__(
        self,
        gui: Gui,
        sheet: imgui.ImDrawList,
        size: tuple[float, float],
        insets: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0),
    ) -> None:
        self.theme, self.sheet, self.size, self.insets = gui.theme, sheet, size, insets
        self._plain, self._bold = imgui.get_font(), gui.bold

    def text(
        self, x: float, y: float, text: str, size: float, bold: bool = False, muted: bool = False
    ) -> None:
        """As `player.view.annotations.Pen` says; over the plant, so with a halo."""
        color = self.theme.muted if muted else self.theme.text
        text = one_line(text)
        x, y = self._corner(x, y, self.width(text, size, bold), size)
        for right, down in ((-1, 0), (1, 0), (0, -1), (0, 1)):
            self._write(x + right, y + down, text, size, faint(self.theme.halo, 0.3), bold)
        self._write(x, y, text, size, color, bold)

    def box(self, x: float, y: float, width: float, height: float, color: RGB | None) -> None:
        """As `player.view.annotations.Pen` says."""
        x, y = self._corner(x, y, width, height)
        paint = self.theme.text if color is None else rgb(color)
        self.sheet.add_rect_filled((x, y), (x + width, y + height), packed(paint))

    def write(
        self,
        x: float,
        y: float,
        text: str,
        size: float,
        color: Color,
        bold: bool = False,
        align: float = 0.0,
    ) -> None:
        """A line about the height `y`; `align` 0 starts, 0.5 centres, 1 ends it at `x`."""
        text = one_line(text)
        left = x - align * self.width(text, size, bold)
        self._write(left, y - size / 2, text, size, color, bold)

    def card(self, x: float, y: float, text: str, size: float, room: float) -> None:
        """Text on a card, its top at `y`, about `x` but in the window; lines are `room` long."""
        text = one_line(text, 4 * MAX_LINE)
        imgui.push_font(self._plain, size)
        wide, high = imgui.calc_text_size(text, wrap_width=room)
        imgui.pop_font()
        across, down = CARD_PADDING
        width, height = wide + 2 * across, high + 2 * down
        left = min(max(x - width / 2, 8.0), self.size[0] - 8.0 - width)
        self.panel(left, y, width, height, 7.0)
        paint = packed(self.theme.text)
        self.sheet.add_text(self._plain, size, (left + across, y + down), paint, text, room + 1.0)

    def panel(
        self,
        x: float,
        y: float,
        width: float,
        height: float,
        radius: float,
        edge: Color | None = None,
    ) -> None:
        """A card's ground and outline."""
        corners = (x, y), (x + width, y + height)
        self.sheet.add_rect_filled(*corners, packed(self.theme.card), radius)
        self.sheet.add_rect(*corners, packed(edge or self.theme.edge), radius)

    def width(self, text: str, size: float, bold: bool = False) -> float:
        """How wide a line of text is, in units."""
        imgui.push_font(self._bold if bold else self._plain, size)
        width = imgui.calc_text_size(text).x
        imgui.pop_font()
        return float(width)

    def fitted(self, text: str, size: float, room: float, bold: bool = False) -> str:
        """The text, or as much of it as `room` holds, with an ellipsis."""
        text = one_line(text)
        if self.width(text, size, bold) <= room:
            return text
        while text and self.width(text + "…", size, bold) > room:
            text = text[:-1]
        return text.rstrip() + "…" if text else ""

    def _corner(self, x: float, y: float, width: float, height: float) -> tuple[float, float]:
        """The upper left one of what stands (x, y) inwards from the nearest corner."""
        left, top, right, bottom = self.insets
        return (
            self.size[0] - right + x + 1 - width if x < 0 else left + x,
            self.size[1] - bottom + y + 1 - height if y < 0 else top + y,
        )

    def _write(self, x: float, y: float, text: str, size: float, color: Color, bold: bool) -> None:
        font = self._bold if bold else self._plain
        self.sheet.add_text(font, size, (x, y), packed(color), text)


def one_line(text: str, longest: int = MAX_LINE) -> str:
    """Line breaks and control characters as spaces; icons (private use) stay."""
    if len(text) > longest:
        text = text[: longest - 1] + "…"
    return "".join(c if c.isprintable() or "\ue000" <= c <= "\uf8ff" else " " for c in text)
