"""Buttons and windows of Dear ImGui for the actions in keys.py, with their keys as tips.

What clips name is never a label to ImGui: a name can't change what a control is.
"""

from collections.abc import Iterator
from contextlib import contextmanager

from imgui_bundle import imgui, imgui_ctx

from player.ui import keys
from player.ui.theme import CLEAR
from player.view.state import Scene

FLAGS = imgui.WindowFlags_
BARE = FLAGS.no_decoration | FLAGS.no_background | FLAGS.no_move | FLAGS.no_saved_settings
BARE |= FLAGS.no_nav | FLAGS.no_focus_on_appearing
SOLID = BARE & ~FLAGS.no_background
CARD = SOLID | FLAGS.always_auto_resize | FLAGS.no_inputs | FLAGS.no_bring_to_front_on_focus
EDGE = 8.0  # what cards keep from the window's


def tip(name: str) -> None:
    """Over the control that was just drawn: what the action does, and the keys that do it too."""
    action = keys.ACTIONS[name]
    with imgui_ctx.push_style_var(imgui.StyleVar_.window_padding, (10.0, 6.0)):
        imgui.set_item_tooltip(f"{action.help}  ({', '.join(action.labels)})")


def button(scene: Scene, name: str, label: str, size: tuple[float, float]) -> Scene:
    """A button that does an action; gives the scene as it changed it."""
    with imgui_ctx.push_id(name):
        pressed = imgui.button(label, size)
    tip(name)
    return keys.ACTIONS[name].do(scene) if pressed else scene


@contextmanager
def bare_window(
    name: str, place: tuple[float, float], size: tuple[float, float], flags: int = 0
) -> Iterator[None]:
    """An ImGui window that is only its controls, whose buttons have no ground of their own."""
    imgui.set_next_window_pos(place)
    imgui.set_next_window_size(size)
    with (
        imgui_ctx.push_style_var(imgui.StyleVar_.window_padding, (0.0, 0.0)),
        imgui_ctx.push_style_var(imgui.StyleVar_.window_min_size, (1.0, 1.0)),
        imgui_ctx.push_style_var(imgui.StyleVar_.frame_rounding, 22.0),
        imgui_ctx.push_style_color(imgui.Col_.button, CLEAR),
        imgui_ctx.begin(name, None, BARE | flags),
    ):
        yield


@contextmanager
def card(
    name: str, place: tuple[float, float], pivot: tuple[float, float], right: float, flags: int = 0
) -> Iterator[None]:
    """An ImGui window as large as what is in it, which the mouse goes through.

    place: where the part of it stands that `pivot` names, from (0, 0) for its upper left corner to
           (1, 1); it is shifted to stay left of `right`.
    """
    imgui.set_next_window_pos(place, 0, pivot)
    ground = imgui.get_style_color_vec4(imgui.Col_.popup_bg)
    with (
        imgui_ctx.push_style_var(imgui.StyleVar_.window_rounding, 8.0),
        imgui_ctx.push_style_var(imgui.StyleVar_.window_border_size, 1.0),
        imgui_ctx.push_style_var(imgui.StyleVar_.window_padding, (12.0, 7.0)),
        imgui_ctx.push_style_color(imgui.Col_.window_bg, ground),
        imgui_ctx.begin(name, None, CARD | flags),
    ):
        (left, top), width = imgui.get_window_pos(), imgui.get_window_width()
        imgui.set_window_pos((max(min(left, right - EDGE - width), EDGE), top))
        yield
