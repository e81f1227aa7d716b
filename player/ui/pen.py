"""Writing and boxes on one of Dear ImGui's draw lists; what annotations are drawn with, too."""

from imgui_bundle import imgui, imgui_ctx

from player.ui.gui import Gui
from player.ui.theme import Color, faint, packed, rgb
from player.view.annotations import RGB

MAX_LINE = 200  # characters of any one line


class Pen:
    """A `player.view.annotations.Pen`, and for the interface's own shapes.

    sheet:  ImGui's draw list, behind all of its windows.
    size:   (width, height) of the picture that annotations stand in, in units.
    insets: (left, top, right, bottom) that they keep from its edges.
    """

    def __init__(
        self, gui: Gui, size: tuple[float, float], insets: tuple[float, float, float, float]
    ) -> None:
        self.theme, self.size, self.insets = gui.theme, size, insets
        self.sheet = imgui.get_background_draw_list()
        self._plain, self.bold = imgui.get_font(), gui.bold

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
