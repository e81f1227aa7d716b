"""The panel at the right of the window: controls for all choices, with their keys."""

from dataclasses import replace
from operator import attrgetter

from imgui_bundle import imgui, imgui_ctx

from corrections.history import describe
from player.ui import actions, keys
from player.ui.gui import Gui
from player.ui.keys import Choice
from player.ui.theme import CLEAR, one_line, rgb
from player.ui.widgets import FLAGS, SOLID, tip
from player.view.organ_place import organ_place
from player.view.state import Scene

WIDTH = 272.0  # units of 1/96 inch, as all lengths
NOTE_SIZE = 13.5  # font size of notes
LABEL_WIDTH, VALUE_WIDTH = 84.0, 46.0  # left of lists and sliders, and right of sliders
DOT, VISIBLE, HIDDEN, REMOVE = "\uf111", "\uf06e", "\uf070", "\uf00d"  # icons
PICKING_HINT = "Click an organ; then click a second one with Shift held, on any day."


def panel_width(scene: Scene) -> float:
    """Width in units that the panel takes from the window."""
    return WIDTH if scene.panel else 0.0


def draw_panel(scene: Scene, gui: Gui, size: tuple[float, float]) -> Scene:
    """Draw the panel in a window of `size` units, and return the scene as the mouse changed it."""
    imgui.set_next_window_pos((size[0] - WIDTH, 0.0))
    imgui.set_next_window_size((WIDTH, size[1]))
    with imgui_ctx.begin("panel", None, SOLID & ~FLAGS.no_scrollbar):
        for title in ("Look", "View", "Compare", "Export", "Corrections", "Organs"):
            imgui.set_next_item_open(title in ("Look", "Export", "Organs"), imgui.Cond_.once)
            if title == "Corrections" and len(scene.clicked_places) > 1:
                imgui.set_next_item_open(True)
            with imgui_ctx.push_font(gui.bold, 15.0):
                is_open = imgui.collapsing_header(title)
            if is_open:
                scene = _draw_controls(scene, title)
            if is_open and title == "Corrections":
                scene = _draw_corrections(scene)
            if is_open and title == "Organs":
                scene = _draw_organs(scene)
    return scene


def _draw_controls(scene: Scene, section: str) -> Scene:
    """Draw the controls of a section, and their keys."""
    with imgui_ctx.begin_table(section, 2):
        imgui.table_setup_column("control", imgui.TableColumnFlags_.width_stretch)
        imgui.table_setup_column("key", imgui.TableColumnFlags_.width_fixed)
        for action in keys.TABLE[section]:
            choice = action if isinstance(action, Choice) else None
            if action.repeats or (choice and len(choice.values(scene)) < 2):
                continue  # an action for keys only, or nothing to choose from
            imgui.table_next_column()
            if choice:
                draw = _draw_slider if isinstance(choice.current(scene), float) else _draw_list
                scene = draw(scene, choice)
            elif action.on:
                changed, _ = imgui.checkbox(action.help.capitalize(), action.on(scene))
                scene = action.do(scene) if changed else scene
            elif imgui.button(action.name.capitalize(), (-1.0, 0.0)):
                scene = action.do(scene)
            tip(action.name)
            imgui.table_next_column()
            imgui.align_text_to_frame_padding()
            imgui.text_disabled("".join(action.labels[:1]))
    return scene


def _draw_label(label: str, right: float = 0.0) -> None:
    """Draw the label of the next control, which leaves a width free at its right."""
    imgui.align_text_to_frame_padding()
    imgui.text_disabled(label)
    imgui.same_line(LABEL_WIDTH)
    imgui.set_next_item_width(-right - 1.0)


def _draw_slider(scene: Scene, choice: Choice) -> Scene:
    """Draw a slider from the first to the last value of a choice."""
    (low, *_, high), value = choice.values(scene), attrgetter(choice.field)(scene)
    flags = imgui.SliderFlags_.no_input | (imgui.SliderFlags_.logarithmic if low else 0)
    _draw_label(choice.label, VALUE_WIDTH)
    text = f"{choice.text(value)}###{choice.field}"
    changed, value = imgui.slider_float(text, value, low, high, "", flags)
    return scene.changed(choice.field, value) if changed else scene


def _draw_list(scene: Scene, choice: Choice) -> Scene:
    """Draw a list to select from."""
    current = choice.current(scene)
    _draw_label(choice.label)
    if imgui.begin_combo(f"##{choice.field}", choice.text(current)):
        for value in choice.values(scene):
            if imgui.selectable(choice.text(value), value == current)[0]:
                scene = choice.choose(scene, value)
        imgui.end_combo()
    return scene


def _draw_corrections(scene: Scene) -> Scene:
    """List the picked organs and the corrections, each with a button that removes it."""
    edits = scene.edits
    with imgui_ctx.push_font(None, NOTE_SIZE):
        places = [f"{place.organ} in {place.scan}" for place in scene.clicked_places]
        for line in places or [PICKING_HINT]:
            imgui.text_wrapped(line)
        for row, correction in enumerate(edits.current if edits else ()):
            with imgui_ctx.push_id(str(row)):
                if _icon_button(REMOVE) and edits:
                    kept = (*edits.current[:row], *edits.current[row + 1 :])
                    scene = replace(scene, edits=edits.changed(kept))
            imgui.same_line()
            imgui.text_unformatted(one_line(describe(correction)))
            imgui.set_item_tooltip(", ".join(place.scan for place in correction.places))
        if edits and not edits.is_baked:
            imgui.text_wrapped("Bake again, as before and with --force, to see it.")
    return scene


def _draw_organs(scene: Scene) -> Scene:
    """Draw a text field for the picked organ's name, and a list to pick and hide organs in."""
    picked = scene.style.picked
    if picked is not None and scene.edits is not None and scene.clicked_places:
        scene = _draw_name_field(scene, picked)
    clipper = imgui.ListClipper()
    clipper.begin(len(scene.clip.track_table))
    while clipper.step():
        for track in range(clipper.display_start, clipper.display_end):
            with imgui_ctx.push_id(str(track)):
                scene = _draw_organ_row(scene, track)
    return scene


def _draw_name_field(scene: Scene, track: int) -> Scene:
    current, hint = scene.clip.track_table[track].name, "name of the organ"
    flags = imgui.InputTextFlags_.enter_returns_true | imgui.InputTextFlags_.auto_select_all
    imgui.set_next_item_width(-1.0)
    with imgui_ctx.push_id(str(track)):
        entered, name = imgui.input_text_with_hint("##called", hint, current, flags)
    is_new = entered and name.strip() not in ("", current)
    return actions.correct(scene, "name", name.strip()) if is_new else scene


def _draw_organ_row(scene: Scene, track: int) -> Scene:
    style, organ = scene.style, scene.clip.track_table[track]
    visible = style.isolated == track if style.isolated is not None else track not in style.hidden
    if _icon_button(VISIBLE if visible else HIDDEN):
        scene = scene.with_style(hidden=style.hidden ^ {track}, isolated=None)
    imgui.same_line()
    imgui.text_colored(rgb(organ.color, 1.0 if visible else 0.3), DOT)
    imgui.same_line()
    left, color = imgui.get_cursor_pos_x(), imgui.get_style_color_vec4(imgui.Col_.header_active)
    with imgui_ctx.push_style_color(imgui.Col_.header, color):
        if imgui.selectable("##name", style.picked == track)[0]:
            place = organ_place(scene.clip, track, scene.timeline.day)
            scene = actions.pick(scene, track, place, imgui.get_io().key_shift)
    imgui.same_line(left)
    text = imgui.text_unformatted if visible else imgui.text_disabled
    text(one_line(organ.name))
    return scene


def _icon_button(icon: str) -> bool:
    """Draw a button with an icon; returns whether it was pressed."""
    with imgui_ctx.push_style_color(imgui.Col_.button, CLEAR):
        return bool(imgui.small_button(icon))
