"""Draws the help: every key and mouse action, straight from the table in keys.py."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from player.ui import keys
from player.ui.canvas import BOLD, ICONS, Canvas

if TYPE_CHECKING:
    from player.ui.theme import Theme


@dataclass(frozen=True)
class Spacing:
    """Heights of a row, a section's name, and the title; the card's edge, and between columns."""

    row: float
    section: float
    head: float
    padding: float
    column: float


ROOMY = Spacing(29.0, 38.0, 48.0, 30.0, 44.0)
DENSE = Spacing(23.0, 28.0, 38.0, 20.0, 30.0)

Rows = list[tuple[tuple[str, ...], str]]

TITLE, TEXT, CAP = 22.0, 16.0, 14.0
TEXT_GAP = 14.0
LARGE_ENOUGH = 0.9  # scale from which roomy lines are preferred to larger letters
CAP_HEIGHT, CAP_PADDING, CAP_GAP = 22.0, 7.0, 4.0
SLACK = 1.04  # small letters are wider for their size: they snap to pixels
ARROWS = {"←": "\uf060", "→": "\uf061", "↑": "\uf062", "↓": "\uf063"}
COLUMNS = (
    (("Time", "Organs"), ("View", "Compare"), ("Look", "Window")),
    (("Time", "Organs", "Look"), ("View", "Compare", "Window")),
)


def draw_help(canvas: Canvas, theme: Theme, size: tuple[float, float]) -> None:
    """Over everything, in as many columns as show it largest, smaller where the window is small."""
    table = keys.sections()
    choices = [[[(name, table[name]) for name in column] for column in way] for way in COLUMNS]
    best: _Card | None = None
    for spacing in (ROOMY, DENSE):
        cards = [_Card(canvas, theme, columns, spacing) for columns in choices]
        card = max(cards, key=lambda card: card.scale(size))
        if best is None or (
            best.scale(size) < LARGE_ENOUGH and card.scale(size) > best.scale(size)
        ):
            best = card
    assert best is not None
    canvas.rectangle(0.0, 0.0, *size, theme.shade)
    best.draw(size)


class _Card:
    def __init__(
        self,
        canvas: Canvas,
        theme: Theme,
        columns: list[list[tuple[str, Rows]]],
        spacing: Spacing,
    ) -> None:
        self.spacing = spacing
        self.canvas = canvas
        self.theme = theme
        self.columns = columns
        every = [[row for _, rows in column for row in rows] for column in columns]
        self.cap_widths = [max(self._caps_width(labels) for labels, _ in rows) for rows in every]
        self.text_widths = [
            SLACK * max(canvas.width(text, TEXT) for _, text in rows) for rows in every
        ]
        self.width = (
            2 * self.spacing.padding
            + sum(self.cap_widths)
            + sum(self.text_widths)
            + TEXT_GAP * len(columns)
            + self.spacing.column * (len(columns) - 1)
        )
        heights = [
            sum(self.spacing.section + self.spacing.row * len(rows) for _, rows in column)
            + 10.0 * (len(column) - 1)
            for column in columns
        ]
        self.height = 2 * self.spacing.padding + self.spacing.head + max(heights) - 10.0

    def scale(self, size: tuple[float, float]) -> float:
        return min(1.0, (size[0] - 24.0) / self.width, (size[1] - 24.0) / self.height)

    def draw(self, size: tuple[float, float]) -> None:
        scale, canvas, theme = self.scale(size), self.canvas, self.theme
        width, height = scale * self.width, scale * self.height
        left, top = (size[0] - width) / 2, (size[1] - height) / 2
        canvas.rectangle(left, top, width, height, theme.card, 14.0 * scale)
        canvas.frame(left, top, width, height, theme.edge, 14.0 * scale)
        x, y = left + self.spacing.padding * scale, top + (self.spacing.padding + TITLE / 2) * scale
        canvas.text(x, y, "Keys and mouse", TITLE * scale, theme.text, BOLD)
        close = "Esc closes this"
        right = left + width - self.spacing.padding * scale
        canvas.text(right, y, close, TEXT * scale, theme.muted, align=1.0)
        for column, caps, texts in zip(
            self.columns, self.cap_widths, self.text_widths, strict=True
        ):
            self._draw_column(
                column, x, top + (self.spacing.padding + self.spacing.head) * scale, scale, caps
            )
            x += (caps + TEXT_GAP + texts + self.spacing.column) * scale

    def _draw_column(
        self, column: list[tuple[str, Rows]], x: float, y: float, scale: float, caps: float
    ) -> None:
        for name, rows in column:
            self.canvas.text(x, y + 8.0 * scale, name, TEXT * scale, self.theme.accent, BOLD)
            y += self.spacing.section * scale
            for labels, text in rows:
                self._draw_caps(labels, x, y, scale)
                text_x = x + (caps + TEXT_GAP) * scale
                self.canvas.text(text_x, y, text, TEXT * scale, self.theme.text)
                y += self.spacing.row * scale
            y += 10.0 * scale

    def _draw_caps(self, labels: tuple[str, ...], x: float, y: float, scale: float) -> None:
        canvas, theme, high = self.canvas, self.theme, CAP_HEIGHT * scale
        for label in labels:
            width = self._cap_width(label) * scale
            canvas.rectangle(x, y - high / 2, width, high, theme.hover, 5.0 * scale)
            canvas.frame(x, y - high / 2, width, high, theme.edge, 5.0 * scale)
            inner = x + CAP_PADDING * scale
            for word, font in _words(label):
                canvas.text(inner, y, word, CAP * scale, theme.text, font)
                inner += (canvas.width(word, CAP, font) + CAP_GAP) * scale
            x += width + CAP_GAP * scale

    def _caps_width(self, labels: tuple[str, ...]) -> float:
        return sum(self._cap_width(label) + CAP_GAP for label in labels) - CAP_GAP

    def _cap_width(self, label: str) -> float:
        words = [self.canvas.width(word, CAP, font) + CAP_GAP for word, font in _words(label)]
        return max(sum(words) - CAP_GAP + 2 * CAP_PADDING, CAP_HEIGHT)


def _words(label: str) -> list[tuple[str, str]]:
    """(text, font) pieces of a key's label; the text font has no arrows, the icons have."""
    return [(ARROWS[word], ICONS) if word in ARROWS else (word, BOLD) for word in label.split(" ")]
