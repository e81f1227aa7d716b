"""The panel at the window's right: every choice in sight, and each of them has a key as well."""

from dataclasses import replace
from operator import attrgetter

from imgui_bundle import imgui, imgui_ctx

from player.ui import actions, keys
from player.ui.gui import Gui
from player.ui.keys import Choice
from player.ui.theme import CLEAR, one_line, rgb
from player.ui.widgets import FLAGS, SOLID, tip
from player.view.choices import sentence
from player.view.organ_place import organ_place
from player.view.state import Scene

WIDTH = 272.0
SMALL = 13.5  # size of notes
LABEL, VALUE = 68.0, 46.0  # widths: of what stands before lists and sliders, and beside these
DOT, SEEN, HIDDEN, REMOVE = "\uf111", "\uf06e", "\uf070", "\uf00d"  # icons
HOW = "Click an organ, on another day or beside it one more with Shift held."


def panel_width(scene: Scene) -> float:
    """What the panel takes from a window's width."""
    return WIDTH if scene.panel else 0.0


def draw_panel(scene: Scene, gui: Gui, size: tuple[float, float]) -> Scene:
    """Draw it in a window of (width, height), and give the scene as the mouse changed it."""
    imgui.set_next_window_pos((size[0] - WIDTH, 0.0))
    imgui.set_next_window_size((WIDTH, size[1]))
    with imgui_ctx.begin("panel", None, SOLID & ~FLAGS.no_scrollbar):
        for title in ("Look", "View", "Compare", "Export", "Corrections", "Organs"):
            imgui.set_next_item_open(title in ("Look", "Export", "Organs"), imgui.Cond_.once)
            if title == "Corrections" and len(scene.chosen) > 1:
                imgui.set_next_item_open(True)
            with imgui_ctx.push_font(gui.bold, 15.0):
                shown = imgui.collapsing_header(title)
            if shown:
                scene = _controls(scene, title)
            if shown and title == "Corrections":
                scene = _corrections(scene)
            if shown and title == "Organs":
                scene = _organs(scene)
    return scene


def _controls(scene: Scene, section: str) -> Scene:
    """A section's actions, and the keys that do the same."""
    with imgui_ctx.begin_table(section, 2):
        imgui.table_setup_column("control", imgui.TableColumnFlags_.width_stretch)
        imgui.table_setup_column("key", imgui.TableColumnFlags_.width_fixed)
        for action in keys.TABLE[section]:
            choice = action if isinstance(action, Choice) else None
            if action.repeats or (choice and len(choice.values(scene)) < 2):
                continue  # it is for keys alone, or there is nothing to choose
            imgui.table_next_column()
            if choice:
                draw = _slider if isinstance(choice.now(scene), float) else _list
                scene = draw(scene, choice)
            elif action.on:
                changed, _ = imgui.checkbox(action.help.capitalize(), action.on(scene))
                scene = action.do(scene) if changed else scene
            elif imgui.button(action.name.capitalize(), (-1.0, 0.0)):
                scene = action.do(scene)
            tip(action.name)
            imgui.table_next_column()
            imgui.align_text_to_frame_padding()
            imgui.text_disabled(action.labels[0])
    return scene


def _label(label: str, beside: float = 0.0) -> None:
    """Before a control, beside whose end some width is left."""
    imgui.align_text_to_frame_padding()
    imgui.text_disabled(label)
    imgui.same_line(LABEL)
    imgui.set_next_item_width(-beside - 1.0)


def _slider(scene: Scene, choice: Choice) -> Scene:
    """From the first number to the last, and what lies between; beside it how that reads."""
    (low, *_, high), now = choice.values(scene), attrgetter(choice.field)(scene)
    flags = imgui.SliderFlags_.no_input | (imgui.SliderFlags_.logarithmic if low else 0)
    _label(choice.label, VALUE)
    text = f"{choice.text(now)}###{choice.field}"
    changed, value = imgui.slider_float(text, now, low, high, "", flags)
    return scene.changed(choice.field, value) if changed else scene


def _list(scene: Scene, choice: Choice) -> Scene:
    """To choose from."""
    now = choice.now(scene)
    _label(choice.label)
    if imgui.begin_combo(f"##{choice.field}", choice.text(now)):
        for value in choice.values(scene):
            if imgui.selectable(choice.text(value), value == now)[0]:
                scene = choice.choose(scene, value)
        imgui.end_combo()
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
            imgui.text_unformatted(one_line(sentence(one)))
            imgui.set_item_tooltip(", ".join(place.scan for place in one.places))
        if edits and not edits.is_baked:
            imgui.text_wrapped("Bake again, as before and with --force, to see it.")
    return scene


def _organs(scene: Scene) -> Scene:
    """A field for the picked organ's name, and a list: a click on a name picks, one on an eye
    hides.
    """
    picked = scene.style.picked
    if picked is not None and scene.edits is not None and scene.chosen:
        scene = _name(scene, picked)
    clipper = imgui.ListClipper()
    clipper.begin(len(scene.clip.track_table))
    while clipper.step():
        for number in range(clipper.display_start, clipper.display_end):
            with imgui_ctx.push_id(str(number)):
                scene = _organ(scene, number)
    return scene


def _name(scene: Scene, picked: int) -> Scene:
    now, flags = scene.clip.track_table[picked].name, imgui.InputTextFlags_
    imgui.set_next_item_width(-1.0)
    with imgui_ctx.push_id(str(picked)):
        how = flags.enter_returns_true | flags.auto_select_all
        entered, name = imgui.input_text_with_hint("##called", "name of the organ", now, how)
    is_new = entered and name.strip() not in ("", now)
    return actions.correct(scene, "name", name.strip()) if is_new else scene


def _organ(scene: Scene, number: int) -> Scene:
    style, organ = scene.style, scene.clip.track_table[number]
    visible = style.alone == number if style.alone is not None else number not in style.hidden
    if _icon(SEEN if visible else HIDDEN):
        scene = scene.with_style(hidden=style.hidden ^ {number}, alone=None)
    imgui.same_line()
    imgui.text_colored(rgb(organ.color, 1.0 if visible else 0.3), DOT)
    imgui.same_line()
    left, paint = imgui.get_cursor_pos_x(), imgui.get_style_color_vec4(imgui.Col_.header_active)
    with imgui_ctx.push_style_color(imgui.Col_.header, paint):
        if imgui.selectable("##name", style.picked == number)[0]:
            place = organ_place(scene.clip, number, scene.timeline.day)
            scene = actions.pick(scene, number, place, imgui.get_io().key_shift)
    imgui.same_line(left)
    text = imgui.text_unformatted if visible else imgui.text_disabled
    text(one_line(organ.name))
    return scene


def _icon(icon: str) -> bool:
    """A button that is an icon; whether it is pressed."""
    with imgui_ctx.push_style_color(imgui.Col_.button, CLEAR):
        return bool(imgui.small_button(icon))
