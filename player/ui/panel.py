"""The panel at the window's right: every choice in sight, and each of them has a key as well."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

from imgui_bundle import imgui, imgui_ctx

from player.ui import actions, keys
from player.ui.actions import Choice
from player.ui.gui import Gui
from player.ui.keys import Action
from player.ui.pen import fitted
from player.ui.theme import CLEAR, PADDING, rgb
from player.ui.widgets import button, tip
from player.view.choices import sentence
from player.view.organ_place import organ_place
from player.view.state import Scene
from player.view.style import ColorMode

WIDTH = 272.0
LEAST_BESIDE = 300.0  # what it leaves to the plant
LEAST_HEIGHT = 200.0  # below which it takes the whole window's
SMALL = 13.5  # size of keys and of notes
LABEL, VALUE, EYE = 74.0, 46.0, 26.0  # widths
POINT_SIZES, STRONGEST = (0.2, 5.0), 2.0  # of points and of the shading, at the sliders' ends
SLIDERS = {"larger": "Points", "shading": "Shading"}  # in place of the actions
DOT, SEEN, HIDDEN, REMOVE = "\uf111", "\uf06e", "\uf070", "\uf00d"  # icons
HOW = "Click an organ, on another day or beside it one more with Shift held."


def stands_beside(width: float) -> bool:
    """Whether a window is wide enough for the panel beside the plant; else it lies over it."""
    return width >= WIDTH + LEAST_BESIDE


def panel_width(scene: Scene, width: float) -> float:
    """What the panel takes from a window's width: nothing where it would leave too little."""
    return WIDTH if scene.panel and not scene.kiosk and stands_beside(width) else 0.0


def draw_panel(
    scene: Scene, gui: Gui, size: tuple[float, float], strips: tuple[float, float]
) -> Scene:
    """Draw it in a window of (width, height), and give the scene as the mouse changed it.

    strips: heights of what it leaves free above and below where it lies over the plant.
    """
    (width, height), top = size, strips[0]
    between = height - sum(strips)
    if stands_beside(width) or between < LEAST_HEIGHT:
        top, between = 0.0, height
    imgui.set_next_window_pos((max(width - WIDTH, 0.0), top))
    imgui.set_next_window_size((min(WIDTH, width), between))
    flags = imgui.WindowFlags_
    unmoved = (flags.no_decoration & ~flags.no_scrollbar) | flags.no_move | flags.no_nav
    with imgui_ctx.begin("panel", None, unmoved | flags.no_saved_settings):
        for title, section in SECTIONS.items():
            imgui.set_next_item_open(title in ("Look", "Export", "Organs"), imgui.Cond_.once)
            if title == "Corrections" and len(scene.chosen) > 1:
                imgui.set_next_item_open(True)
            with imgui_ctx.push_font(gui.bold, 15.0):
                shown = imgui.collapsing_header(title)
            if shown:
                scene = _controls(scene, title)
                scene = section(scene) if section else scene
    return scene


def _controls(scene: Scene, section: str) -> Scene:
    """A section's actions as sliders, lists, checkboxes, and buttons in rows."""
    right, in_row = imgui.get_cursor_screen_pos().x + imgui.get_content_region_avail().x, False
    for action in keys.TABLE[section]:
        label, is_button = action.name.capitalize(), False
        if action.name in SLIDERS:
            scene = _slider(scene, action.name)
        elif action.choice:
            scene = _choice(scene, action.choice, action.name)
        elif action.on:
            scene = _switch(scene, action)
        elif not action.repeats:  # what repeats is for keys alone
            if in_row and imgui.get_item_rect_max().x + _button_width(label) <= right:
                imgui.same_line()
            scene, is_button = button(scene, action.name, label), True
        in_row = is_button
        if action.name == "color" and scene.color_mode is ColorMode.FIELD:
            scene = _choice(scene, actions.FIELD, action.name)
    return scene


def _corrections(scene: Scene) -> Scene:
    """The chosen organs, what to say of them, and what was said."""
    edits = scene.edits
    with imgui_ctx.push_font(None, SMALL):
        for line in [f"{place.organ} in {place.scan}" for place in scene.chosen] or [HOW]:
            imgui.text_wrapped(line)
        for row, one in enumerate(edits.now if edits else ()):
            with imgui_ctx.push_id(str(row)):
                if _icon(REMOVE) and edits:
                    kept = (*edits.now[:row], *edits.now[row + 1 :])
                    scene = replace(scene, edits=edits.changed(kept))
            imgui.same_line()
            imgui.text_unformatted(fitted(sentence(one), imgui.get_content_region_avail().x))
            imgui.set_item_tooltip(", ".join(place.scan for place in one.places))
        if edits and not edits.is_baked:
            imgui.text_wrapped("Bake again, as before and with --force, to see it.")
    return scene


def _organs(scene: Scene) -> Scene:
    scene = _name(scene)
    clipper = imgui.ListClipper()
    clipper.begin(len(scene.clip.track_table))
    while clipper.step():
        for number in range(clipper.display_start, clipper.display_end):
            with imgui_ctx.push_id(str(number)):
                scene = _organ(scene, number)
    return scene


def _name(scene: Scene) -> Scene:
    """A field for the picked organ's name."""
    picked = scene.style.picked
    if picked is None or scene.edits is None or not scene.chosen:
        return scene
    now, flags = scene.clip.track_table[picked].name, imgui.InputTextFlags_
    imgui.set_next_item_width(-1.0)
    with imgui_ctx.push_id(str(picked)):
        how = flags.enter_returns_true | flags.auto_select_all
        entered, name = imgui.input_text_with_hint("##called", "name of the organ", now, how)
    is_new = entered and name.strip() not in ("", now)
    return actions.correct(scene, "name", name.strip()) if is_new else scene


def _organ(scene: Scene, number: int) -> Scene:
    """A row of the list: a click on the name picks the organ, one on the eye hides it."""
    style, organ = scene.style, scene.clip.track_table[number]
    visible = style.alone == number if style.alone is not None else number not in style.hidden
    width = imgui.get_content_region_avail().x - EYE
    picked = imgui.get_style_color_vec4(imgui.Col_.header_active)
    with imgui_ctx.push_style_color(imgui.Col_.header, picked):
        row = (width, imgui.get_frame_height())
        if imgui.selectable("##name", style.picked == number, 0, row)[0]:
            place = organ_place(scene.clip, number, scene.timeline.day)
            scene = actions.pick(scene, number, place, imgui.get_io().key_shift)
    imgui.same_line(PADDING + 6.0)
    imgui.align_text_to_frame_padding()
    imgui.text_colored(imgui.ImVec4(*rgb(organ.color, 1.0 if visible else 0.3)), DOT)
    imgui.same_line(PADDING + 25.0)
    text = imgui.text_unformatted if visible else imgui.text_disabled
    text(fitted(organ.name, width - 34.0))
    imgui.same_line(PADDING + width)
    if _icon(SEEN if visible else HIDDEN):
        scene = scene.with_style(hidden=style.hidden ^ {number}, alone=None)
    return scene


SECTIONS = {
    "Look": None,
    "View": None,
    "Compare": None,
    "Export": None,
    "Corrections": _corrections,
    "Organs": _organs,
}


def _button_width(label: str) -> float:
    """The width of a button, and of the gap before it."""
    style = imgui.get_style()
    return imgui.calc_text_size(label).x + 2 * style.frame_padding.x + style.item_spacing.x


def _icon(icon: str) -> bool:
    """A button that is an icon; whether it is pressed."""
    with imgui_ctx.push_style_color(imgui.Col_.button, imgui.ImVec4(*CLEAR)):
        return bool(imgui.button(icon))


@contextmanager
def _row(label: str, action: str, kept: float = 0.0) -> Iterator[None]:
    """A label, a control, and the key that does the same; `kept` is left beside the control."""
    imgui.align_text_to_frame_padding()
    imgui.text_disabled(label)
    imgui.same_line(PADDING + LABEL)
    key = imgui.calc_text_size(keys.ACTIONS[action].labels[0]).x
    imgui.set_next_item_width(-kept - 12.0 - max(key, 14.0))
    yield
    _key(action)


def _key(action: str) -> None:
    """The key that does the same, at the end of the row."""
    imgui.same_line()
    with imgui_ctx.push_font(None, SMALL):
        label = keys.ACTIONS[action].labels[0]
        left = imgui.get_content_region_avail().x - imgui.calc_text_size(label).x
        imgui.set_cursor_pos_x(imgui.get_cursor_pos_x() + left)
        imgui.text_disabled(label)


def _choice(scene: Scene, choice: Choice, action: str) -> Scene:
    """A list to choose from."""
    now = choice.now(scene)
    with _row(choice.label, action):
        if imgui.begin_combo(f"##{choice.field}", choice.name(now)):
            for value in choice.values(scene):
                if imgui.selectable(choice.name(value), value == now)[0]:
                    scene = choice.choose(scene, value)
            imgui.end_combo()
        tip(action)
    return scene


def _slider(scene: Scene, name: str) -> Scene:
    """For the strength of the shading or the size of points, and beside it how that reads."""
    style, flags = scene.style, imgui.SliderFlags_
    if name == "shading":
        field, low, high, text = "eye_dome", 0.0, STRONGEST, f"{style.eye_dome:.0%}"
    elif style.pixels is not None:
        field, low, high, text = "pixels", actions.FEWEST, actions.MOST, f"{style.pixels:.1f} px"
    else:
        field, low, high, text = "point_size", *POINT_SIZES, f"{style.point_size:.0%}"
    how = flags.no_input | (flags.logarithmic if low else flags.none)
    with _row(SLIDERS[name], name, VALUE):
        changed, value = imgui.slider_float(f"##{name}", getattr(style, field), low, high, "", how)
        tip(name)
        imgui.same_line()
        imgui.text_unformatted(text)
    return scene.changed(f"style.{field}", value) if changed else scene


def _switch(scene: Scene, action: Action) -> Scene:
    """A checkbox for what an action turns on and off."""
    on = bool(action.on and action.on(scene))
    changed, _ = imgui.checkbox(f"{action.help.capitalize()}###{action.name}", on)
    tip(action.name)
    _key(action.name)
    return action.do(scene) if changed else scene
