"""The panel's part about corrections: the chosen organs, what to say of them, what was said."""

from collections.abc import Sequence
from dataclasses import replace

from imgui_bundle import imgui, imgui_ctx

from gclip import Track
from player.ui import actions
from player.ui.pen import Pen
from player.ui.theme import CLEAR
from player.ui.widgets import button
from player.view.choices import sentence
from player.view.state import Scene

SMALL = 14.0
REMOVE = "\uf00d"
KINDS = (("same", "Same"), ("different", "Not same"), ("cut", "Cut"))
HOW = "Click an organ, on another day or beside it one more with Shift held."


def draw_corrections(scene: Scene, pen: Pen) -> Scene:
    """Draw it in the panel, and give the scene as the mouse changed it."""
    gap, theme = imgui.get_style().item_spacing.x, pen.theme
    lines = [f"{place.organ} in {place.scan}" for place in scene.chosen] or [HOW]
    edits = scene.edits
    with imgui_ctx.push_font(None, SMALL):
        imgui.push_style_color(imgui.Col_.text, theme.muted)
        for line in lines:
            imgui.text_wrapped(line)
        imgui.pop_style_color()
    width = (imgui.get_content_region_avail().x - gap * (len(KINDS) - 1)) / len(KINDS)
    for kind, label in KINDS:
        scene = button(scene, kind, label, (width, 0.0))
        imgui.same_line()
    imgui.new_line()
    for row, one in enumerate(edits.now if edits else ()):
        with imgui_ctx.push_id(str(row)), imgui_ctx.push_font(None, SMALL):
            imgui.push_style_color(imgui.Col_.button, CLEAR)
            if imgui.button(REMOVE) and edits:
                kept = (*edits.now[:row], *edits.now[row + 1 :])
                scene = replace(scene, edits=edits.changed(kept))
            imgui.pop_style_color()
            imgui.same_line()
            imgui.align_text_to_frame_padding()
            room = imgui.get_content_region_avail().x
            imgui.text_unformatted(pen.fitted(sentence(one), SMALL, room))
            if imgui.is_item_hovered():
                imgui.set_tooltip(", ".join(place.scan for place in one.places))
    if edits and not edits.is_baked:
        with imgui_ctx.push_font(None, SMALL):
            imgui.text_wrapped("Bake again, as before and with --force, to see it.")
    return scene


def draw_name(scene: Scene, tracks: Sequence[Track]) -> Scene:
    """A field for the picked organ's name."""
    picked, edits = scene.style.picked, scene.edits
    if picked is None or edits is None or not scene.chosen:
        return scene
    now, flags = tracks[picked].name, imgui.InputTextFlags_
    imgui.set_next_item_width(-1.0)
    with imgui_ctx.push_id(str(picked)):
        how = flags.enter_returns_true | flags.auto_select_all
        entered, name = imgui.input_text_with_hint("##called", "name of the organ", now, how)
        name = name.strip()
        if entered and name not in ("", now):
            if any(track.name == name for track in tracks):
                return scene.with_notice(f"Another organ is called {name}; choose another name.")
            scene = actions.correct("name", name)(scene)
    return scene
