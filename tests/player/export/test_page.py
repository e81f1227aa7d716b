"""The HTML page: the plant of the clip, in a real browser, with nothing from outside."""

from __future__ import annotations

import io
import json
import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import sync_playwright

import shaders
from gclip import Clip, Motion, ScanMark, Track
from player import render
from player.export import Film, export
from player.export.web import page
from player.export.web.encode import pack
from player.view.style import ColorMode, Style
from traits.curves import trait_curves

WEB = Path(page.__file__).parent
NASTY = "</script><script>window.hurt=1</script><img src=x onerror='window.hurt=1'>{{ 7*7 }}"
POSITIONS = """([day, shader]) => {
    const { renderer, clip } = viewer, { gl } = renderer, draw = gl.drawArrays.bind(gl);
    const program = (degree) => {
        const program = gl.createProgram();
        for (const [kind, text] of [
            [gl.VERTEX_SHADER, `#define DEGREE ${degree}\\n#define SCAN_COLORS 0\\n${shader}`],
            [gl.FRAGMENT_SHADER, "precision highp float;\\nvoid main() {}"],
        ]) {
            const made = gl.createShader(kind);
            gl.shaderSource(made, "#version 300 es\\n" + text);
            gl.compileShader(made);
            gl.attachShader(program, made);
        }
        gl.transformFeedbackVaryings(program, ["out_position"], gl.SEPARATE_ATTRIBS);
        gl.linkProgram(program);
        return { program, shaders: [], names: ["positions"], uniforms: null };
    };
    renderer.programs = ({ degree }) => ({ positions: program(degree) });
    gl.drawArrays = (...what) => {
        gl.beginTransformFeedback(gl.POINTS);
        draw(...what);
        gl.endTransformFeedback();
    };
    gl.enable(gl.RASTERIZER_DISCARD);
    const found = clip.layersAt(day).map((layer) => {
        const target = gl.TRANSFORM_FEEDBACK_BUFFER;
        const values = new Float32Array(3 * layer.group.count);
        const buffer = gl.createBuffer();
        gl.bindBuffer(target, buffer);
        gl.bufferData(target, values.byteLength, gl.STREAM_READ);
        gl.bindBufferBase(target, 0, buffer);
        renderer.drawPoints("positions", [layer], {}, 1);
        gl.bindBufferBase(target, 0, null);
        gl.bindBuffer(target, buffer);
        gl.getBufferSubData(target, 0, values);
        return Array.from(values);
    });
    gl.disable(gl.RASTERIZER_DISCARD);
    delete gl.drawArrays;
    delete renderer.programs;
    return found;
}"""
SOFTWARE_GL = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist")


@pytest.fixture(scope="module")
def browser(chromium: str) -> Iterator[Any]:
    with sync_playwright() as control:
        started = control.chromium.launch(
            executable_path=chromium, args=[*SOFTWARE_GL, "--no-sandbox"]
        )
        yield started
        started.close()


@contextmanager
def pages(browser: Any, folder: Path, density: float) -> Iterator[Any]:
    """Export a clip, open the page from disk, and see to it that it asks for nothing else."""
    context = browser.new_context(
        viewport={"width": 480, "height": 360},
        device_scale_factor=density,
        has_touch=True,
        reduced_motion="reduce",
    )
    tab = context.new_page()
    troubles: list[str] = []
    tab.on("pageerror", lambda error: troubles.append(str(error)))
    tab.on("console", lambda message: troubles.append(message.text))
    tab.on("request", lambda request: troubles.append(request.url))

    def open_(clip: Clip, film: Film | None = None) -> Any:
        path = folder / "plant.html"
        export(clip, film or Film(), path)
        tab.goto(path.as_uri())
        until(tab, "window.viewer !== undefined")
        tab.evaluate(f"viewer.seek({clip.times[-1]})")
        assert tab.text_content("#trouble") == ""
        assert troubles == [path.as_uri()], "the page itself, and nothing else"
        return tab

    yield open_
    context.close()


@pytest.fixture
def opened(browser: Any, tmp_path: Path) -> Iterator[Any]:
    """Open a clip's page on a coarse screen: its picture is drawn soon, and not looked at."""
    with pages(browser, tmp_path, density=0.25) as open_:
        yield open_


@pytest.fixture
def opened_sharp(browser: Any, tmp_path: Path) -> Iterator[Any]:
    """Open a clip's page where a pixel of its picture is one of the screen."""
    with pages(browser, tmp_path, density=1) as open_:
        yield open_


def until(tab: Any, what: str) -> None:
    """Wait for something to become true (playwright's own way would need `eval` in the page)."""
    for _ in range(600):
        if tab.evaluate(what):
            return
        tab.wait_for_timeout(50)
    raise AssertionError(f"never became true: {what}")


def screenshot(tab: Any) -> np.ndarray:
    from PIL import Image

    with Image.open(io.BytesIO(tab.screenshot())) as shot:
        return np.asarray(shot.convert("RGB")).astype(int)


@pytest.mark.parametrize(
    ("degree", "lost"), [(1, Motion.FALL), (2, Motion.FADE), (3, Motion.REMOVE)]
)
def test_the_browser_interpolates_as_the_clip_does(
    opened: Any, make_clip: Any, degree: int, lost: Motion
) -> None:
    clip = make_clip(degree=degree, lost=lost, colors=((200, 40, 30, 255), (30, 90, 200, 255)))
    tab = opened(clip)
    for day in (0.0, 2.2, 4.1, 5.0):
        tab.evaluate(f"viewer.seek({day})")
        shader = (
            shaders.resolved("point_attributes.glsl")
            + """
            out vec3 out_position;
            void main() {
                out_position = point_position();
            }"""
        )
        layers = tab.evaluate(POSITIONS, [day, shader])
        frame = clip.at(day)
        expected = [frame.local] if frame.litter is None else [frame.local, frame.litter.local]
        seen = np.concatenate([np.array(layer).reshape(-1, 3) for layer in layers])
        assert np.abs(seen - np.concatenate(expected)).max() <= clip.spacing / 60


def test_fingers_turn_and_pinch(opened: Any, make_clip: Any) -> None:
    tab = opened(make_clip())
    touch = tab.context.new_cdp_session(tab)

    def fingers(kind: str, *places: tuple[float, float]) -> None:
        points = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(places)]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    yaw, distance = tab.evaluate("[viewer.camera.yaw, viewer.camera.distance]")
    fingers("touchStart", (240, 150))
    for x in range(240, 301, 20):
        fingers("touchMove", (x, 150))
    fingers("touchEnd")
    until(tab, f"viewer.camera.yaw < {yaw} - 0.3")
    fingers("touchStart", (220, 150), (260, 150))
    for aside in range(0, 41, 10):
        fingers("touchMove", (220 - aside, 150), (260 + aside, 150))
    fingers("touchEnd")
    until(tab, f"viewer.camera.distance < 0.6 * {distance}")


def test_the_chosen_organ_s_curves_share_the_timeline(opened: Any, make_clip: Any) -> None:
    clip = make_clip()
    tab, curves = opened(clip), trait_curves(clip)
    assert curves
    assert not tab.is_visible("#curve"), "no organ is chosen"
    tab.evaluate(f"viewer.act('choose', {curves[0].track})")
    for _ in range(3):
        trait = tab.evaluate("viewer.look.trait")
        if any((one.track, one.trait) == (curves[0].track, trait) for one in curves):
            assert tab.text_content("#curve span").startswith(f"{trait}, 0 to")
            curve, line = (tab.locator(of).bounding_box() for of in ("#curve svg", "#timeline"))
            assert (curve["x"], curve["width"]) == pytest.approx((line["x"], line["width"]), abs=1)
        else:
            assert not tab.is_visible("#curve")
        tab.keyboard.press("l")
    assert tab.evaluate("viewer.look.trait") == "length"


def test_the_plot_of_an_organ_leaves_the_plant_free(opened: Any, make_clip: Any) -> None:
    clip = make_clip()
    tab, track = opened(clip), trait_curves(clip)[0].track
    tab.set_viewport_size({"width": 900, "height": 700})
    tab.evaluate("viewer.act('fit')")
    seen = """async () => {
        for (const _ of [1, 2]) await new Promise(requestAnimationFrame);  // until it is laid out
        const {camera} = viewer, slope = Math.tan(camera.field_of_view / 2);
        const at = camera.pose().inverse().transformPoint(new DOMPoint(...camera.home.target));
        return [at.y / (-at.z * slope), camera.distance]; }"""
    before = tab.evaluate(seen)
    tab.evaluate(f"viewer.act('choose', {track})")
    height, distance = tab.evaluate(seen)
    assert height > before[0] + 0.08, "higher in the picture"
    assert distance > 1.1 * before[1]
    tab.evaluate(f"viewer.act('choose', {track})")
    assert tab.evaluate(seen) == pytest.approx(before), "as it was"


def test_the_plot_of_an_organ_covers_nothing_on_a_phone(opened: Any, make_clip: Any) -> None:
    clip = make_clip()
    tab, track = opened(clip), trait_curves(clip)[0].track
    tab.set_viewport_size({"width": 390, "height": 780})
    tab.evaluate(f"viewer.act('choose', {track})")
    plot = tab.locator("#curve").bounding_box()
    for control in ("#play", "#moment", "#time"):
        assert plot["y"] + plot["height"] <= tab.locator(control).bounding_box()["y"], control


def test_the_help_names_every_key(opened: Any, make_clip: Any) -> None:
    told = set(re.findall(r"\w+", opened(make_clip()).text_content("#help")))
    keys = re.findall(r"\b(\w+): \[\"", (WEB / "page.js").read_text())
    assert {"f", "Home", "Escape"} <= set(keys)
    names = {"ArrowLeft": "a", "ArrowRight": "a", "PageUp": "PgUp", "PageDown": "PgDn"}
    names |= {"Escape": "Esc", "h": "a"}  # arrows are no words; H has opened the help
    assert {names.get(key, key.upper() if len(key) == 1 else key) for key in keys} <= told


def test_mouse_touch_keys_and_timeline(opened_sharp: Any, make_clip: Any) -> None:
    tab = opened_sharp(make_clip(colors=((200, 40, 30, 255), (200, 40, 30, 255))))
    assert not tab.is_visible("#scale"), "these colours mean nothing"
    first = screenshot(tab)
    plant = first[100:240, 140:340]
    assert (plant[..., 0] > plant[..., 2] + 60).mean() > 0.05, "the red plant is seen"

    yaw, pitch = tab.evaluate("[viewer.camera.yaw, viewer.camera.pitch]")
    tab.mouse.move(240, 150)
    tab.mouse.down()
    tab.mouse.move(330, 170, steps=3)
    tab.mouse.up()
    turned = tab.evaluate("[viewer.camera.yaw, viewer.camera.pitch]")
    assert turned[0] == pytest.approx(yaw - np.pi * 90 / 360)
    assert turned[1] == pytest.approx(pitch + np.pi * 20 / 360)
    tab.wait_for_timeout(400)
    assert np.abs(screenshot(tab) - first).mean() > 0.5

    distance = tab.evaluate("viewer.camera.distance")
    tab.mouse.wheel(0, -200)
    until(tab, f"viewer.camera.distance < {distance}")
    pinch = """([a, b, c, d]) => {
        const at = (id, x) => ({ pointerId: id, clientX: x, clientY: 150, bubbles: true });
        const canvas = document.getElementById("picture");
        canvas.setPointerCapture = () => {};
        const tell = (kind, id, x) => canvas.dispatchEvent(new PointerEvent(kind, at(id, x)));
        tell("pointerdown", 11, a); tell("pointerdown", 12, b);
        tell("pointermove", 11, c); tell("pointermove", 12, d);
        return viewer.camera.distance;
    }"""
    distance = tab.evaluate("viewer.camera.distance")
    assert tab.evaluate(pinch, [220, 260, 200, 280]) == pytest.approx(distance / 2)

    box = tab.locator("#time").bounding_box()
    tab.mouse.click(box["x"] + 0.4 * box["width"], box["y"] + 15)
    assert tab.evaluate("viewer.clock.day") == 2.0, "a click near a scan's mark goes to the scan"
    assert tab.locator(".mark").count() == 3
    tab.keyboard.press("Home")
    assert tab.evaluate("viewer.clock.day") == 0.0
    tab.keyboard.press("Space")
    until(tab, "viewer.clock.day > 0.2")
    tab.keyboard.press("Space")
    tab.wait_for_timeout(100)
    assert tab.text_content("#date").startswith("day ")

    tab.keyboard.press("f")
    tab.keyboard.press("g")
    tab.wait_for_timeout(300)
    assert screenshot(tab)[5, 5].min() > 150, "light ground"
    tab.keyboard.press("c")
    assert tab.evaluate("viewer.look.byTrack") is True


def test_fewer_movers_leave_no_gaps(opened_sharp: Any, make_clip: Any) -> None:
    clip = make_clip(colors=((200, 40, 30, 255), (200, 40, 30, 255)))
    tab = opened_sharp(clip)
    covered = """(every) => {
        const { renderer, camera, look } = viewer, { canvas, gl } = renderer;
        const { width, height } = canvas, bytes = new Uint8Array(4 * width * height);
        renderer.draw(0, camera, look, { every });
        gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
        let red = 0;
        for (let i = 0; i < bytes.length; i += 4) red += bytes[i] > bytes[i + 2] + 60;
        return red;
    }"""
    tab.evaluate("viewer.seek(0)")
    whole = tab.evaluate(covered, 1)
    assert whole > 2000
    for every in (2, 8):
        assert tab.evaluate(covered, every) == pytest.approx(whole, rel=0.25)


@pytest.mark.parametrize(("ground", "color"), [("dark", "scan"), ("light", "track")])
def test_page_and_film_show_the_same_picture(
    opened_sharp: Any, make_clip: Any, ground: str, color: str
) -> None:
    clip = make_clip(degree=2, colors=((200, 40, 30, 255), (30, 90, 200, 255)), lost=Motion.FADE)
    style, size = Style(ground=ground, color_by=ColorMode(color)), (480, 360)
    tab = opened_sharp(clip, Film(size=size, style=style))
    tab.add_style_tag(content="header, footer { visibility: hidden }")
    for day in (1.3, 3.0):
        tab.evaluate(f"""
            viewer.seek({day});
            Object.assign(viewer.camera, viewer.camera.home);
            viewer.act('go', viewer.clock.day);""")
        tab.wait_for_timeout(500)
        drawn = render(clip, day, size, style=style)[..., :3].astype(int)
        difference = np.abs(screenshot(tab) - drawn)
        assert difference.mean() < 0.3
        assert (difference.max(axis=2) > 24).mean() < 0.002


def test_less_is_drawn_while_things_move_on_a_slow_machine(
    opened_sharp: Any, make_clip: Any
) -> None:
    tab = opened_sharp(make_clip(colors=((200, 40, 30, 255), (200, 40, 30, 255))))
    whole = screenshot(tab)
    tab.evaluate("viewer.state.level = 4; viewer.act('turn')")
    until(tab, "viewer.renderer.canvas.width === Math.round(0.8 ** 4 * 480)")
    tab.evaluate("viewer.act('turn'); viewer.seek(5)")
    assert tab.evaluate("viewer.renderer.canvas.width") == 480, "sharp again"
    tab.evaluate("viewer.camera.yaw = viewer.camera.home.yaw; viewer.act('fit')")
    tab.wait_for_timeout(300)
    assert np.abs(screenshot(tab) - whole).mean() < 1.0


def test_the_page_explains_the_colors_of_errors(opened: Any, make_clip: Any) -> None:
    clip = make_clip()
    real = ScanMark("x.ply", 1.0, positions=clip.at(1.0).local + np.float32(2.0))
    tab = opened(replace(clip, held_out=(real,)), Film(style=Style(color_by="error")))
    assert tab.is_visible("#scale")
    assert "error against a scan left out" in tab.text_content("#scale")
    assert "mm" in tab.text_content("#scale small")
    tab.keyboard.press("c")
    assert not tab.is_visible("#scale"), "organs' colours mean something else"


def test_names_from_the_clip_are_text_and_nothing_else(
    opened: Any, make_clip: Any, tmp_path: Path
) -> None:
    clip = make_clip()
    table = tuple(replace(track, name=NASTY) for track in clip.track_table)
    scans = tuple(replace(scan, name=NASTY, date=NASTY) for scan in clip.scans)
    tab = opened(replace(clip, track_table=table, scans=scans), Film(title=NASTY))
    tab.evaluate("viewer.act('organs')")
    assert tab.evaluate("window.hurt") is None
    assert tab.title() == NASTY
    assert tab.text_content("#title") == NASTY
    assert NASTY in tab.text_content("#organs")


def test_the_page_is_the_same_every_time_and_needs_nothing(make_clip: Any, tmp_path: Path) -> None:
    for name in ("a.html", "b.html"):
        export(make_clip(), Film(title="x"), tmp_path / name)
    text = (tmp_path / "a.html").read_text()
    assert text == (tmp_path / "b.html").read_text()
    assert not re.search(r"""(src|href)=["']|https?://|@import|url\(""", text)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.html", "b.html"]
    json.loads(re.search(r'id="clip">(.*?)</script>', text, re.DOTALL)[1])


def test_packing_is_finer_than_the_eye_and_small(make_clip: Any) -> None:
    clip = make_clip(degree=2)
    interval = clip.intervals[0]
    data, layout = pack(interval, clip.spacing)
    assert max(layout["step"]) <= clip.spacing / 32
    assert len(data) < 0.8 * 20 * len(interval)


def test_more_tracks_than_16_bits_hold(opened: Any, make_clip: Any) -> None:
    clip = make_clip()
    many = tuple(Track(i, f"organ {i}", (i % 256, 80, 90)) for i in range(70_000))
    last = clip.intervals[-1]
    tracks = last.tracks.astype(np.uint32) + 69_990
    clip = replace(
        clip, track_table=many, intervals=(*clip.intervals[:-1], replace(last, tracks=tracks))
    )
    tab = opened(clip)
    assert tab.evaluate("viewer.clip.load(1).then((data) => Math.max(...data.tracks[0]))") == 69_991
