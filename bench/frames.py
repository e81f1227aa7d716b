"""Time of a frame of `play` on screen and in films.

    python -m bench.frames draw [--movers 1e5,1e6] [--size 1280x720] [--clock wall]
    python -m bench.frames film CLIP... [--size 1920x1080]
    python -m bench.frames seek CLIP [--jumps 40]

draw  A frame of a synthetic plant without motion, and on curves of degree 1 to 3: the picture,
      and the pass over the movers alone, by OpenGL's points and by a compute shader. "of copy" is
      the rate at which this pass reads movers, relative to the rate of copies in GPU memory, and
      "main" the main thread's processor time for a whole frame: with the variable GALLIUM_NOOP=1
      Mesa draws nothing, and this is what giving the commands takes. Then the render passes of a
      frame one by one, measured by timer queries of the GPU.
film  A frame of a film: encoding of pictures that were drawn before, and the whole export.
seek  A picture after a jump to another day, and the share of it that uploads movers.

Times are milliseconds of processor time of all threads and processes, the least of several rounds,
so that other load on the machine matters little. For drawing on a GPU, `--clock wall` measures wall
time instead.
"""

from __future__ import annotations

import argparse
import math
import resource
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import moderngl
import numpy as np

import gclip
from bench.synthetic import growing, static
from gclip import Clip
from player.export import Film
from player.export.video import BT709, X264, encode
from player.gl.context import headless
from player.gl.timers import PassTimers, profile_table
from player.rendering.headless import Offscreen
from player.rendering.point_buffers import bytes_per_point
from player.rendering.renderer import Renderer
from player.view.camera import Camera
from player.view.style import Style
from player.window.app import UPLOAD_SECONDS
from player.window.dynamic_resolution import DynamicResolution

Size = tuple[int, int]  # (width, height) in pixels
ROUNDS = 5  # of each measurement, of which the fastest counts
LOAD_SECONDS = 0.2  # of drawing in a row
COPY_SIZE, COPIES = 128 << 20, 16  # bytes of a buffer, and number of copies in a row
COPY = """
#version 430
layout(local_size_x = 256) in;
layout(std430, binding = 0) readonly buffer Source { uvec4 source[]; };
layout(std430, binding = 1) writeonly buffer Target { uvec4 target[]; };

void main() {
    target[gl_GlobalInvocationID.x] = source[gl_GlobalInvocationID.x];
}
"""
FILM_FRAMES = 30  # frames of a film that are measured
FILM_START = 0.4  # share of the film before these frames
PATHS = ("static", "straight", "degree 2", "degree 3")


def print_row(*cells: object) -> None:
    """Print a row of a Markdown table."""
    texts = (f"{cell:.1f}" if isinstance(cell, float) else str(cell) for cell in cells)
    print(f"| {' | '.join(texts)} |", flush=True)


def print_head(*names: str) -> None:
    """Print the head of a Markdown table."""
    print_row(*names)
    print("|---" * len(names) + "|")


def process_seconds() -> float:
    """Processor seconds of this process and of its children that have ended."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def milliseconds(work: Callable[[], object], clock: Callable[[], float]) -> float:
    """Duration of a function call by a clock in seconds."""
    began = clock()
    work()
    return 1e3 * (clock() - began)


def draw(movers: list[int], size: Size, clock: Callable[[], float]) -> None:
    """Measure frames of synthetic plants of several sizes."""
    context = headless()
    copied = copy_rate(context)
    print(f"{context.info['GL_RENDERER']}, {size[0]}x{size[1]}, copies {copied / 1e9:.1f} GB/s\n")
    names = "B a mover", "frame", "to static", "points", "compute", "of copy", "main"
    print_head("movers", "paths", *names)
    profiles = []
    for count in movers:
        baseline = 0.0
        for degree, path in enumerate(PATHS):
            clip = growing(count, degree) if degree else static(count)
            *times, main, profile = _draw_times(context, clip, size, clock)
            baseline = baseline or times[0]
            mover_size = bytes_per_point(clip.intervals[0])
            rate = 1e3 * mover_size * count / min(time for time in times[1:] if time)
            ratio, share = f"{times[0] / baseline:.2f}", f"{100 * rate / copied:.0f} %"
            cells = (*times[1:], share, f"{main:.2f}")
            print_row(f"{count:,}", path, mover_size, times[0], ratio, *cells)
            profiles.append((f"{count:,}, {path}", profile))
    for title, profile in profiles:
        print(f"\n{title}\n{profile}")


def copy_rate(context: moderngl.Context) -> float:
    """Bytes a second that a compute shader, or without them the driver, reads and writes."""
    buffers = source, target = tuple(context.buffer(reserve=COPY_SIZE) for _ in range(2))
    copy: Callable[[], object] = partial(context.copy_buffer, target, source)
    if context.version_code >= 430:
        for binding, buffer in enumerate(buffers):
            buffer.bind_to_storage_buffer(binding)
        copy = partial(context.compute_shader(COPY).run, COPY_SIZE // (16 * 256))
    copies = partial(_finished, context, lambda: [copy() for _ in range(COPIES)])
    seconds = 1e-3 * min(milliseconds(copies, time.perf_counter) for _ in range(ROUNDS))
    return 2.0 * COPIES * COPY_SIZE / seconds


def _draw_times(
    context: moderngl.Context, clip: Clip, size: Size, clock: Callable[[], float]
) -> tuple[float, float, float, float, str]:
    """Measure a frame and the pass over the movers.

    Returns
    -------
    frame, points, compute : float
        Milliseconds of the whole frame, and of the pass over the movers by OpenGL's points and by a
        compute shader; 0 without compute shaders.
    main : float
        Milliseconds of the whole frame on the main thread.
    profile : str
        A table of the render passes of a frame.
    """
    timers, framebuffer = PassTimers(context), context.simple_framebuffer(size)
    renderer = Renderer(context, clip, timers=timers)
    camera = Camera.home(clip, size[0] / size[1], turning=True)

    def draw() -> None:
        timers.finish_frame()
        renderer.draw(framebuffer, 0.5, camera, Style(), size)

    def rasterise(compute: bool) -> None:
        ranges, splats = renderer._prepare(0.5, camera, Style(), size, 1, None)
        renderer._raster.compute = compute
        renderer._raster.rasterise(renderer._gbuffer_of(size), ranges, splats)

    draw()
    works: list[Callable[[], object]] = [draw, partial(rasterise, False)]
    works += [partial(rasterise, True)] * (context.version_code >= 430)
    best = [0.0, 0.0, 0.0]
    for k, work in enumerate(works):
        _finished(context, work)  # compiles the shaders, uploads the movers
        best[k] = min(_repeated(context, work, clock) for _ in range(ROUNDS))
    main = min(_repeated(context, works[0], time.thread_time) for _ in range(ROUNDS))
    while timers.finish_frame():  # frames drawn so far
        pass
    timers.frames = 0
    timers.totals.clear()
    for _ in range(ROUNDS):
        draw()
    while timers.finish_frame():
        pass
    renderer.release()
    return best[0], best[1], best[2], main, profile_table(timers)


def _repeated(
    context: moderngl.Context, work: Callable[[], object], clock: Callable[[], float]
) -> float:
    """Mean milliseconds of a function called in a row; GPUs raise their clock rate only then."""
    once = milliseconds(partial(_finished, context, work), time.perf_counter)
    count = math.ceil(1e3 * LOAD_SECONDS / once)
    row = partial(_finished, context, lambda: [work() for _ in range(count)])
    return milliseconds(row, clock) / count


def _finished(context: moderngl.Context, work: Callable[[], object]) -> None:
    """Call a function, and wait until the GPU has completed its commands."""
    context.finish()
    work()
    context.finish()


def film(clips: list[Path], size: Size) -> None:
    """Measure the export of films."""
    print_head("clip", "size", "encoder", "export", "share of encoding")
    for path in clips:
        clip, whole = gclip.open(path), Film(size=size)
        days = whole.days(clip)
        days = days[int(FILM_START * len(days)) :][:FILM_FRAMES]
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
        per_frame = (min(times) / len(days) for times in (encoder, exported))
        print_row(path.stem, f"{size[0]}x{size[1]}", *per_frame, share)


def seek(clips: list[Path], size: Size, jumps: int) -> None:
    """Measure pictures after jumps to random days."""
    print_head("clip", "", "median", "longest but the first")
    for path in clips:
        clip, context = gclip.open(path), headless()
        renderer, framebuffer = Renderer(context, clip), context.simple_framebuffer(size)
        camera = Camera.home(clip, size[0] / size[1])
        resolution = DynamicResolution(max(len(interval) for interval in clip.intervals))
        loading, whole = [0.0] * jumps, []
        load = renderer._points.buffers.load

        def timed_load(*arguments: Any, load: Any = load, loading: list[float] = loading) -> Any:
            began = time.process_time()
            try:
                return load(*arguments)
            finally:
                loading[len(whole)] += 1e3 * (time.process_time() - began)  # noqa: B023

        renderer._points.buffers.load = timed_load  # type: ignore[method-assign]
        for day in np.random.default_rng(0).uniform(clip.times[0], clip.times[-1], jumps):
            stride, began = resolution.detail(size).stride, time.perf_counter()
            show = partial(renderer.draw, stride=stride, upload_budget=UPLOAD_SECONDS)
            picture = partial(show, framebuffer, day, camera, Style(), size)
            whole.append(milliseconds(partial(_finished, context, picture), time.process_time))
            resolution.record_frame(time.perf_counter() - began)
        for name, times in (("loading", loading), ("whole picture", whole)):
            print_row(path.stem, name, float(np.median(times)), max(times[1:]))
        renderer.release()


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("what", choices=("draw", "film", "seek"))
    parser.add_argument("clips", nargs="*", type=Path)
    parser.add_argument("--movers", default="1e6", help="numbers of movers of the synthetic plant")
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
    else:
        seek(arguments.clips, (width, height), arguments.jumps)


if __name__ == "__main__":
    main()
