"""What a frame of `play` costs, on screen, in a film and in the HTML page.

    python -m bench.frames draw [--movers 1e5,1e6] [--size 1280x720] [--clock wall]
    python -m bench.frames film CLIP... [--size 1920x1080]
    python -m bench.frames seek CLIP [--jumps 40]
    python -m bench.frames page [--movers 1e6]

draw  A frame of a synthetic plant on paths of degree 0 (a static cloud) to 3: the whole picture,
      and the pass over the movers alone, as OpenGL points and by a compute shader. `of copy` is
      the rate at which the pass reads movers against the rate at which the card copies. Then the
      passes of a frame one by one, by the card's own clock (timer queries).
film  A frame of a film: the encoder alone, fed with pictures drawn before, and the whole export.
seek  A picture after a jump to another day, and how much of it is loading movers.
page  A frame of the page in headless Chromium on its software renderer: at rest, while things
      move, and on a machine that is found to be slow; `to static` is against a static cloud.

Milliseconds of processor time of all threads and processes, the best of several rounds, as other
work may go on beside; `--clock wall` takes the clock's for drawing, which a GPU needs.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import moderngl
import numpy as np

import gclip
from bench.synthetic import growing, static
from gclip import Clip
from player.export import Film, export
from player.export.video import BT709, X264, encode
from player.gl.context import headless
from player.gl.timers import profile_table
from player.rendering.headless import Offscreen
from player.rendering.point_buffers import bytes_per_point
from player.rendering.points import RasterBackend
from player.rendering.renderer import Renderer
from player.view.camera import Camera
from player.view.style import Style
from player.window.app import LOADING
from player.window.dynamic_resolution import DynamicResolution

Size = tuple[int, int]
ROUNDS = 5
COPIED = 256 << 20  # bytes
FILMED = 30  # frames of a film that are measured
FILM_BEGIN = 0.4  # share of the film before them
PATHS = ("static", "straight", "degree 2", "degree 3")


def row(*cells: object) -> None:
    texts = (f"{cell:.1f}" if isinstance(cell, float) else str(cell) for cell in cells)
    print(f"| {' | '.join(texts)} |", flush=True)


def head(*names: str) -> None:
    row(*names)
    print("|---" * len(names) + "|")


def process_seconds() -> float:
    """Processor seconds of this process and of those it started that have ended."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def milliseconds(work: Callable[[], object], clock: Callable[[], float]) -> float:
    began = clock()
    work()
    return 1e3 * (clock() - began)


def draw(movers: list[int], size: Size, clock: Callable[[], float]) -> None:
    context = headless()
    source, target = (context.buffer(reserve=COPIED) for _ in range(2))
    copy = partial(_finished, context, lambda: context.copy_buffer(target, source))
    copied = 2e3 * COPIED / min(milliseconds(copy, time.perf_counter) for _ in range(6))
    print(f"{context.info['GL_RENDERER']}, {size[0]}x{size[1]}, copies {copied / 1e9:.1f} GB/s\n")
    head("movers", "paths", "B a mover", "frame", "to static", "points", "compute", "of copy")
    profiles = []
    for count in movers:
        baseline = 0.0
        for degree, path in enumerate(PATHS):
            clip = growing(count, degree) if degree else static(count)
            found, profile = _draw_times(context, clip, size, clock)
            baseline = baseline or found[0]
            size_each = bytes_per_point(clip.intervals[0])
            rate = 1e3 * size_each * count / min(time for time in found[1:] if time)
            ratio, share = f"{found[0] / baseline:.2f}", f"{100 * rate / copied:.0f} %"
            row(f"{count:,}", path, size_each, found[0], ratio, *found[1:], share)
            profiles.append((f"{count:,}, {path}", profile))
    for title, profile in profiles:
        print(f"\n{title}\n{profile}")


def _draw_times(
    context: moderngl.Context, clip: Clip, size: Size, clock: Callable[[], float]
) -> tuple[list[float], str]:
    """Of a frame, and of the pass over the movers either way; 0 where there is no such way. And a
    frame's passes, one by one.
    """
    renderer, framebuffer = Renderer(context, clip), context.simple_framebuffer(size)
    camera = Camera.home(clip, size[0] / size[1], turning=True)
    renderer.draw(framebuffer, 0.5, camera, Style(), size)

    def rasterise(backend: RasterBackend) -> None:
        ranges, splats = renderer._prepared(0.5, camera, Style(), size, 1, None)
        renderer._raster.backend = backend
        renderer._raster.rasterise(renderer._gbuffer_of(size), ranges, splats)

    works: list[Callable[[], object]] = [
        lambda: renderer.draw(framebuffer, 0.5, camera, Style(), size),
        partial(rasterise, RasterBackend.POINTS),
    ]
    works += [partial(rasterise, RasterBackend.COMPUTE)] * (context.version_code >= 430)
    best, profile = [0.0, 0.0, 0.0], ""
    for k, work in enumerate(works):
        _finished(context, work)  # compiles the shaders, uploads the movers
        renderer.timers.finish_frame()
        renderer.timers.frames = 0
        renderer.timers.totals.clear()
        times = [milliseconds(partial(_finished, context, work), clock) for _ in range(ROUNDS)]
        best[k] = min(times)
        if k == 0:
            renderer.timers.finish_frame()
            profile = profile_table([renderer.timers])
    renderer.release()
    return best, profile


def _finished(context: moderngl.Context, work: Callable[[], object]) -> None:
    context.finish()
    work()
    context.finish()


def film(clips: list[Path], size: Size) -> None:
    head("clip", "size", "encoder", "export", "of the encoder's rate")
    for path in clips:
        clip, whole = gclip.open(path), Film(size=size)
        days = whole.days(clip)
        days = days[int(FILM_BEGIN * len(days)) :][:FILMED]
        part = replace(whole, at=tuple(days))
        encoder, exported = [], []
        with tempfile.TemporaryDirectory() as folder, Offscreen(clip, size) as offscreen:
            output = Path(folder) / "film.mp4"
            for _ in range(ROUNDS):
                pictures = list(part.frames(clip, offscreen))
                codec = {"codec": "libx264", "arguments": [*X264, *BT709]}
                write = partial(encode, count=len(days), film=part, path=output, **codec)
                encoder.append(milliseconds(partial(write, pictures), process_seconds))
                frames = part.frames(clip, offscreen)
                exported.append(milliseconds(partial(write, frames), process_seconds))
        share = f"{100 * min(encoder) / min(exported):.0f} %"
        each = (min(times) / len(days) for times in (encoder, exported))
        row(path.stem, f"{size[0]}x{size[1]}", *each, share)


def seek(clips: list[Path], size: Size, jumps: int) -> None:
    head("clip", "", "median", "most, after the first")
    for path in clips:
        clip, context = gclip.open(path), headless()
        renderer, framebuffer = Renderer(context, clip), context.simple_framebuffer(size)
        camera = Camera.home(clip, size[0] / size[1])
        pace = DynamicResolution(max(len(interval) for interval in clip.intervals))
        loading, whole = [0.0] * jumps, []
        load = renderer._points.buffers.load

        def timed_load(*given: Any, load: Any = load, loading: list[float] = loading) -> Any:
            began = time.process_time()
            try:
                return load(*given)
            finally:
                loading[len(whole)] += 1e3 * (time.process_time() - began)  # noqa: B023

        renderer._points.buffers.load = timed_load  # type: ignore[method-assign]
        for day in np.random.default_rng(0).uniform(clip.times[0], clip.times[-1], jumps):
            stride, began = pace.detail(size).every, time.perf_counter()
            show = partial(renderer.draw, stride=stride, upload_budget=LOADING)
            picture = partial(show, framebuffer, day, camera, Style(), size)
            whole.append(milliseconds(partial(_finished, context, picture), time.process_time))
            pace.frame_took(time.perf_counter() - began)
        for name, times in (("loading", loading), ("whole picture", whole)):
            row(path.stem, name, float(np.median(times)), max(times[1:]))
        renderer.release()


SOFTWARE_GL = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist")
PAGE_FRAMES = """([count, still, moving]) => {
    const { renderer, camera, clip, look } = viewer, gl = renderer.gl;
    const [width, height] = [1280, 720].map((side) => Math.round(0.8 ** moving * side));
    Object.assign(renderer.canvas, { width, height });
    if (still) clip.intervals[0].degree = 0;
    for (let i = 0; i < count; ++i) {
        camera.orbit(0.01, 0);
        renderer.draw(still ? 0 : 0.5, camera, look, { every: 2 ** moving });
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    }
    return gl.getError();
}"""


def page(movers: list[int]) -> None:
    from playwright.sync_api import sync_playwright

    head("movers", "paths", "page, MB", "load", "at rest", "to static", "moving", "slow machine")
    with sync_playwright() as browsers, tempfile.TemporaryDirectory() as folder:
        program = shutil.which("chromium") or shutil.which("google-chrome")
        options = [*SOFTWARE_GL, "--no-sandbox"]
        browser = browsers.chromium.launch(executable_path=program, args=options)
        for count in movers:
            baseline, path = 0.0, Path(folder) / "page.html"
            for degree, name in enumerate(PATHS):
                clip = growing(count, degree) if degree else static(count, degree=1)
                export(clip, Film(), path)
                tab = browser.new_page(viewport={"width": 1280, "height": 720})
                load = milliseconds(partial(_open_page, tab, path), _browser_seconds)
                times = [_page_time(tab, degree == 0, level) for level in (0, 1, 4)]
                tab.close()
                baseline = baseline or times[0]
                size, ratio = path.stat().st_size / 1e6, f"{times[0] / baseline:.2f}"
                row(f"{count:,}", name, size, load, times[0], ratio, *times[1:])
        browser.close()


def _open_page(tab: Any, path: Path) -> None:
    tab.goto(path.as_uri())
    while not tab.evaluate("window.viewer !== undefined"):  # the page forbids waiting scripts
        tab.wait_for_timeout(100)
    tab.evaluate("viewer.seek(0.5)")


def _page_time(tab: Any, still: bool, level: int, count: int = 5) -> float:
    """Milliseconds a frame at a level of the page's detail; 0 draws everything."""

    def frames() -> None:
        assert tab.evaluate(PAGE_FRAMES, [count, still, level]) == 0

    frames()  # compiles the shaders
    return min(milliseconds(frames, _browser_seconds) / count for _ in range(ROUNDS))


def _browser_seconds() -> float:
    """Processor seconds of this process's children so far (Linux)."""
    ticks = 0
    for pid in _descendants(os.getpid()):
        fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
        ticks += int(fields[11]) + int(fields[12])
    return ticks / os.sysconf("SC_CLK_TCK")


def _descendants(parent: int) -> Iterator[int]:
    for task in Path(f"/proc/{parent}/task").glob("*/children"):
        for child in map(int, task.read_text().split()):
            yield child
            yield from _descendants(child)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=("draw", "film", "seek", "page"))
    parser.add_argument("clips", nargs="*", type=Path)
    parser.add_argument("--movers", default="1e6", help="of the synthetic plant")
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--jumps", type=int, default=40)
    parser.add_argument("--clock", choices=("cpu", "wall"), default="cpu")
    arguments = parser.parse_args()
    movers = [int(float(text)) for text in arguments.movers.split(",")]
    width, height = map(int, arguments.size.split("x"))
    if arguments.what == "draw":
        clock = time.process_time if arguments.clock == "cpu" else time.perf_counter
        draw(movers, (width, height), clock)
    elif arguments.what == "film":
        film(arguments.clips, (width, height))
    elif arguments.what == "seek":
        seek(arguments.clips, (width, height), arguments.jumps)
    else:
        page(movers)


if __name__ == "__main__":
    main()
