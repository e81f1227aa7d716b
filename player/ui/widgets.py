"""Buttons and other controls for the actions in keys.py: Dear ImGui's own, with the key as a tip.

What clips name is never a label to ImGui: a name can't change what a control is.
"""

from collections.abc import Iterator
from contextlib import contextmanager

from imgui_bundle import imgui, imgui_ctx

from player.ui import keys
from player.ui.theme import CLEAR, Color
from player.view.state import Scene

ARROWS = str.maketrans({"←": "\uf060", "→": "\uf061", "↑": "\uf062", "↓": "\uf063"})
BARE = (
    imgui.WindowFlags_.no_decoration
    | imgui.WindowFlags_.no_background
    | imgui.WindowFlags_.no_move
    | imgui.WindowFlags_.no_saved_settings
    | imgui.WindowFlags_.no_nav
    | imgui.WindowFlags_.no_focus_on_appearing
)


def key_labels(labels: tuple[str, ...]) -> list[str]:
    """As the fonts can write them: they have arrows among their icons only."""
    return [label.translate(ARROWS) for label in labels]


def tip(name: str, row: bool = False) -> None:
    """Over the control that was just drawn: what the action does, and the keys that do it too.

    row: what it does together with its neighbour, as a slider.
    """
    if imgui.is_item_hovered(imgui.HoveredFlags_.for_tooltip):
        action = keys.action(name)
        text = action.row if row and action.row else action.help
        imgui.push_style_var(imgui.StyleVar_.window_padding, (10.0, 6.0))
        imgui.set_tooltip(f"{text}  ({', '.join(key_labels(action.labels))})")
        imgui.pop_style_var()


def button(
    scene: Scene,
    name: str,
    label: str,
    size: tuple[float, float],
    ground: Color | None = None,
    text: Color | imgui.ImVec4 | None = None,
) -> Scene:
    """A button that does an action; gives the scene as it changed it."""
    with imgui_ctx.push_id(name):
        for part, color in ((imgui.Col_.button, ground), (imgui.Col_.text, text)):
            imgui.push_style_color(part, color or imgui.get_style_color_vec4(part))
        pressed = imgui.button(label, size)
        imgui.pop_style_color(2)
    tip(name)
    return keys.action(name).do(scene) if pressed else scene


def icon_button(scene: Scene, name: str, icon: str, on: bool = False) -> Scene:
    """One without a ground of its own; switches that are on have the accent's colour."""
    accent = imgui.get_style_color_vec4(imgui.Col_.check_mark) if on else None
    return button(scene, name, icon, (32.0, 32.0), CLEAR, accent)


@contextmanager
def bare_window(name: str, place: tuple[float, float], size: tuple[float, float]) -> Iterator[None]:
    """An ImGui window that is only its controls."""
    imgui.set_next_window_pos(place)
    imgui.set_next_window_size(size)
    imgui.push_style_var(imgui.StyleVar_.window_padding, (0.0, 0.0))
    imgui.push_style_var(imgui.StyleVar_.window_min_size, (1.0, 1.0))
    imgui.begin(name, None, BARE)
    yield
    imgui.end()
    imgui.pop_style_var(2)
