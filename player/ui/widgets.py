"""Buttons with tooltips, and windows of Dear ImGui.

Names from clips are never labels of ImGui: characters such as "##" change a control's identity.
"""

from collections.abc import Iterator
from contextlib import contextmanager

from imgui_bundle import imgui, imgui_ctx

from player.ui import keys
from player.ui.theme import CLEAR
from player.view.state import Scene

Point = tuple[float, float]  # x and y, or width and height, in units of 1/96 inch

FLAGS = imgui.WindowFlags_
BARE = FLAGS.no_decoration | FLAGS.no_background | FLAGS.no_move | FLAGS.no_saved_settings
BARE |= FLAGS.no_nav | FLAGS.no_focus_on_appearing
SOLID = BARE & ~FLAGS.no_background
CARD = SOLID | FLAGS.always_auto_resize | FLAGS.no_inputs | FLAGS.no_bring_to_front_on_focus
EDGE = 8.0  # smallest distance of cards from the window's edge, in units


def tip(name: str) -> None:
    """Set the tooltip of the last control: what an action does, and its keys."""
    action = keys.ACTIONS[name]
    labels = f"  ({', '.join(action.labels)})" if action.keys else ""
    with imgui_ctx.push_style_var(imgui.StyleVar_.window_padding, (10.0, 6.0)):
        imgui.set_item_tooltip(action.help + labels)


def button(scene: Scene, name: str, label: str, size: tuple[float, float]) -> Scene:
    """Draw a button for an action, and return the scene as the action changed it."""
    with imgui_ctx.push_id(name):
        pressed = imgui.button(label, size)
    tip(name)
    return keys.ACTIONS[name].do(scene) if pressed else scene


@contextmanager
def bare_window(name: str, position: Point, size: Point, flags: int = 0) -> Iterator[None]:
    """An ImGui window without decoration, background and margins."""
    imgui.set_next_window_pos(position)
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
def card(name: str, position: Point, pivot: Point, right: float, flags: int = 0) -> Iterator[None]:
    """An ImGui window that fits its contents and ignores the mouse.

    position: of the card's point `pivot`, which is (0, 0) for its upper left corner and (1, 1) for
              the lower right one; the card is shifted to stay left of `right`.
    """
    imgui.set_next_window_pos(position, 0, pivot)
    background = imgui.get_style_color_vec4(imgui.Col_.popup_bg)
    with (
        imgui_ctx.push_style_var(imgui.StyleVar_.window_rounding, 8.0),
        imgui_ctx.push_style_var(imgui.StyleVar_.window_border_size, 1.0),
        imgui_ctx.push_style_var(imgui.StyleVar_.window_padding, (12.0, 7.0)),
        imgui_ctx.push_style_color(imgui.Col_.window_bg, background),
        imgui_ctx.begin(name, None, CARD | flags),
    ):
        (left, top), width = imgui.get_window_pos(), imgui.get_window_width()
        imgui.set_window_pos((max(min(left, right - EDGE - width), EDGE), top))
        yield
