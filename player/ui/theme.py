"""The colours of what lies over the plant, one set for each ground."""

from dataclasses import dataclass

from player.ui.canvas import Color, color
from player.view.style import GROUNDS


@dataclass(frozen=True)
class Theme:
    """text, muted:  writing, and writing that stays back.
    accent:       what has passed on the timeline, and what the cursor is on.
    on_accent:    writing and icons on the accent.
    track:        the timeline's line, where it has not passed yet.
    card, edge:   bubbles, tips and the help, and their outline.
    loss:         marks of lost organs.
    hover:        behind the button under the cursor.
    veil:         the ground's own colour, to calm it behind the timeline.
    shade:        over everything else while the help is open.
    """

    text: Color
    muted: Color
    accent: Color
    on_accent: Color
    track: Color
    card: Color
    edge: Color
    loss: Color
    hover: Color
    veil: Color
    shade: Color


DARK = Theme(
    text=color(GROUNDS["dark"].text),
    muted=color(GROUNDS["dark"].muted),
    accent=color("#7ddb8c"),
    on_accent=color("#0c1a12"),
    track=color("#ffffff", 0.24),
    card=color("#1d2624", 0.96),
    edge=color("#ffffff", 0.12),
    loss=color("#e8a06a"),
    hover=color("#ffffff", 0.12),
    veil=color("#0d1213"),
    shade=color("#060909", 0.66),
)

LIGHT = Theme(
    text=color(GROUNDS["light"].text),
    muted=color(GROUNDS["light"].muted),
    accent=color("#1f8a4c"),
    on_accent=color("#ffffff"),
    track=color("#15201b", 0.24),
    card=color("#fdfdfb", 0.97),
    edge=color("#15201b", 0.14),
    loss=color("#b8581c"),
    hover=color("#15201b", 0.09),
    veil=color("#e3e4e0"),
    shade=color("#c9cdc9", 0.66),
)
