"""What graphics drivers do to a player: a sentence, and where there is one the slower way."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import moderngl
import pytest

from player.cli import main
from player.errors import PlayerError
from player.gl.gl_errors import ContextLost, OutOfGpuMemory, check_context, max_supersample
from player.rendering.headless import Offscreen, render
from player.rendering.point_buffers import Chunk, PointBuffers, bytes_per_point
from player.rendering.renderer import Renderer
from player.view.camera import Camera
from player.view.style import Style
from tests.player.conftest import ClipMaker
from tests.player.drawn import read_pixels
from tests.player.shown import Shown

SIZE = (96, 72)


@pytest.fixture
def saved(make_clip: ClipMaker, tmp_path: Path) -> Path:
    path = tmp_path / "plant.gclip"
    make_clip().save(path)
    return path


def report(monkeypatch: pytest.MonkeyPatch, *errors: str) -> list[str]:
    """Have all contexts report these errors, one at each look; gives those that are left."""
    left = list(errors)
    real = moderngl.Context.error.fget  # type: ignore[attr-defined]

    def error(self: moderngl.Context) -> str:
        return left.pop(0) if left else real(self)

    monkeypatch.setattr(moderngl.Context, "error", property(error))
    return left


def sentence(capsys: pytest.CaptureFixture[str], *arguments: object) -> str:
    assert main([str(argument) for argument in arguments]) == 2
    output, said = capsys.readouterr()
    assert (output, said.count("\n")) == ("", 1)
    assert said.startswith("play: ")
    assert said.endswith(".\n")
    return said


def test_errors_are_told_apart() -> None:
    check_context(SimpleNamespace(error="GL_NO_ERROR"))  # type: ignore[arg-type]
    for error, raised in (
        ("GL_OUT_OF_MEMORY", OutOfGpuMemory),
        ("GL_CONTEXT_LOST", ContextLost),
        ("GL_INVALID_OPERATION", RuntimeError),
    ):
        with pytest.raises(raised):
            check_context(SimpleNamespace(error=error))  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "driver",
    [{"MESA_GL_VERSION_OVERRIDE": "3.1"}, {"__EGL_VENDOR_LIBRARY_DIRS": "/nowhere"}],
    ids=["OpenGL 3.1", "no EGL"],
)
def test_a_driver_that_will_not_do_is_a_sentence(saved: Path, driver: dict[str, str]) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "player", saved, "--export", saved.with_name("x.png")],
        env=os.environ | driver, capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 2
    assert "apt-get install libegl1 libgl1" in done.stderr
    assert done.stderr.count("\n") == 1


def test_a_gpu_that_fails_leaves_the_work_to_the_next_device(
    monkeypatch: pytest.MonkeyPatch, make_clip: ClipMaker
) -> None:
    real, asked = moderngl.create_context, []

    def broken_first(**settings: Any) -> moderngl.Context:
        asked.append(settings["device_index"])
        if settings["device_index"] == 0:
            raise RuntimeError("eglInitialize failed (0x3001)")
        return real(**settings | {"device_index": 0})

    monkeypatch.setattr(moderngl, "create_context", broken_first)
    assert render(make_clip(), 1.0, SIZE).shape == (72, 96, 4)
    with pytest.raises(ValueError, match="99 is outside the series"):
        render(make_clip(), 99.0, SIZE)
    assert sorted(set(asked)) == [0, 1]


def test_a_picture_that_no_driver_draws_is_a_sentence(
    saved: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    output = saved.with_name("x.png")
    monkeypatch.setattr("player.gl.gl_errors.total_gpu_memory", lambda context: 100_000_000)
    said = sentence(capsys, saved, "--export", output, "--size", "16384x2048")
    assert "16384x2048" in said
    assert "GB" in said
    assert list(saved.parent.iterdir()) == [saved]


def test_large_pictures_take_fewer_samples(
    context: moderngl.Context, monkeypatch: pytest.MonkeyPatch
) -> None:
    longest = context.info["GL_MAX_TEXTURE_SIZE"]
    assert max_supersample(context, (640, 480), 2) == 2
    assert max_supersample(context, (longest // 2, 16), 2) == 2
    assert max_supersample(context, (longest // 2 + 1, 16), 2) == 1
    assert max_supersample(context, (longest, 16), 2) == 1
    with pytest.raises(PlayerError, match=f"at most {longest} pixels"):
        max_supersample(context, (16, longest + 1), 1)
    memory = "player.gl.gl_errors.total_gpu_memory"
    monkeypatch.setattr(memory, lambda context: 60 * 640 * 480 * 4 - 1)
    assert max_supersample(context, (640, 480), 2) == 1
    monkeypatch.setattr(memory, lambda context: 60 * 640 * 480 - 1)
    with pytest.raises(PlayerError, match="GPU's memory"):
        max_supersample(context, (640, 480), 2)


def test_a_wide_picture_is_drawn(make_clip: ClipMaker) -> None:
    """Twice its width is more than textures hold: it has one sample a pixel."""
    picture = render(make_clip(), 1.0, (9000, 20))
    assert picture.shape == (20, 9000, 4)


def test_out_of_memory_is_tried_again_with_less(
    make_clip: ClipMaker, monkeypatch: pytest.MonkeyPatch
) -> None:
    clip = make_clip()
    with Offscreen(clip, SIZE, supersample=1) as offscreen:
        coarse = offscreen.picture(1.0)
    real, failed = Renderer.draw, []

    def failing(self: Renderer, *arguments: Any, **named: Any) -> bool:
        if self.supersample > 1:
            failed.append(self)
            raise OutOfGpuMemory("full")
        return real(self, *arguments, **named)

    monkeypatch.setattr(Renderer, "draw", failing)
    with Offscreen(clip, SIZE) as offscreen:
        assert (offscreen.picture(1.0) == coarse).all()
        assert (offscreen.picture(1.0) == coarse).all()
    assert len(failed) == 1


def test_out_of_memory_for_good_is_a_sentence(
    saved: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    report(monkeypatch, *["GL_OUT_OF_MEMORY"] * 100)
    said = sentence(capsys, saved, "--export", saved.with_name("x.png"), "--size", "96x72")
    assert "memory" in said
    assert list(saved.parent.iterdir()) == [saved]


def test_a_reset_driver_is_begun_with_anew(
    make_clip: ClipMaker, monkeypatch: pytest.MonkeyPatch
) -> None:
    clip = make_clip()
    whole = render(clip, 1.0, SIZE)
    left = report(monkeypatch, "GL_CONTEXT_LOST")
    assert (render(clip, 1.0, SIZE) == whole).all()
    assert left == []
    report(monkeypatch, *["GL_CONTEXT_LOST"] * 9)
    with pytest.raises(ContextLost, match=r"reset.*\.$"):
        render(clip, 1.0, SIZE)


def test_a_driver_that_does_not_come_back_is_a_sentence(
    make_clip: ClipMaker, monkeypatch: pytest.MonkeyPatch
) -> None:
    with Offscreen(make_clip(), SIZE) as offscreen:

        def gone() -> None:
            raise PlayerError("there is no driver any more.")

        monkeypatch.setattr("player.rendering.headless.headless", gone)
        report(monkeypatch, "GL_CONTEXT_LOST")
        with pytest.raises(PlayerError, match="no driver any more"):
            offscreen.picture(1.0)


def test_movers_make_room_on_a_full_gpu(
    context: moderngl.Context, make_clip: ClipMaker, monkeypatch: pytest.MonkeyPatch
) -> None:
    clip = make_clip()
    buffers = PointBuffers(context, clip, 1 << 30)
    chunks = [Chunk(0, first, 100) for first in (0, 100, 200)]
    for chunk in chunks[:2]:
        buffers.fetch(chunk, 100)
    report(monkeypatch, "GL_OUT_OF_MEMORY")
    assert buffers.fetch(chunks[2], 100).resident == 100
    assert buffers.size() < 3 * 100 * bytes_per_point(clip.intervals[0]) + 1000
    assert buffers.size() > 2 * 100 * bytes_per_point(clip.intervals[0]), (
        "one made room for the last"
    )
    report(monkeypatch, *["GL_OUT_OF_MEMORY"] * 9)
    with pytest.raises(OutOfGpuMemory):
        buffers.fetch(Chunk(1, 0, 100), 100)
    monkeypatch.undo()


def test_compute_shaders_that_fail_leave_the_work_to_points(
    make_clip: ClipMaker, monkeypatch: pytest.MonkeyPatch, compute_context: moderngl.Context
) -> None:
    tries = []

    def broken(self: moderngl.Context, source: str) -> None:
        tries.append(source)
        raise moderngl.Error("GLSL Compiler failed\n\ncompute_shader\n==\n0:1(1): error: no\n")

    clip = make_clip()
    renderers = [Renderer(compute_context, clip, compute=way) for way in (False, True)]
    framebuffer, camera = compute_context.simple_framebuffer(SIZE, 3), Camera.home(clip, 4 / 3)
    monkeypatch.setattr(moderngl.Context, "compute_shader", broken)
    pictures = []
    for renderer in (*renderers, renderers[1]):
        renderer.draw(framebuffer, 1.0, camera, Style(point_size=0.3), SIZE)
        pictures.append(read_pixels(framebuffer))
    assert len(tries) == 1, "once is enough"
    assert (pictures[0].max(axis=2) > 60).sum() > 300
    assert (pictures[1] == pictures[0]).all()
    assert (pictures[2] == pictures[0]).all()


def test_shaders_that_do_not_compile_are_a_sentence(
    saved: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(self: moderngl.Context, **sources: str) -> None:
        raise moderngl.Error("GLSL Compiler failed\n\nfragment_shader\n====\n0:1(1): error: no\n")

    monkeypatch.setattr(moderngl.Context, "program", broken)
    said = sentence(capsys, saved, "--export", saved.with_name("x.png"))
    assert "LIBGL_ALWAYS_SOFTWARE" in said


def test_a_window_without_its_driver_is_drawn_by_the_cpu(
    display: dict[str, str], clip_file: Path
) -> None:
    """Its first attempt finds no driver; what the second one relies on is put right by the test."""
    before = (
        "import glfw, os\n"
        "end = glfw.terminate\n"
        "glfw.terminate = lambda: (os.environ.pop('LIBGL_DRIVERS_PATH', None), end())\n"
    )
    shown = Shown(display | {"LIBGL_DRIVERS_PATH": "/nowhere"}, clip_file, (320, 240), before)
    shown.end()


def test_a_window_whose_context_is_lost_goes_on(
    display: dict[str, str], clip_file: Path, tmp_path: Path
) -> None:
    log, lose = tmp_path / "windows", tmp_path / "lose"
    before = (
        "import glfw, moderngl, pathlib\n"
        "real, create = moderngl.Context.error.fget, glfw.create_window\n"
        f"log, lose = open({str(log)!r}, 'a', buffering=1), pathlib.Path({str(lose)!r})\n"
        "def error(self):\n"
        "    if not lose.exists():\n"
        "        return real(self)\n"
        "    lose.unlink()\n"
        "    return 'GL_CONTEXT_LOST'\n"
        "moderngl.Context.error = property(error)\n"
        "def created(*wishes):\n"
        "    handle = create(*wishes)\n"
        "    if handle:\n"
        "        print('window', file=log)\n"
        "    return handle\n"
        "glfw.create_window = created\n"
    )
    shown = Shown(display, clip_file, (320, 240), before)
    shown.key("g")
    shown.until(lambda state: state["ground"] == "light")
    windows = log.read_text().count("window")
    lose.touch()
    shown.until(lambda state: log.read_text().count("window") == windows + 1)
    count = len(shown.states)
    state = shown.until(lambda state: len(shown.states) > count + 5)
    assert state["ground"] == "light", "where the lost one was"
    shown.end()
