"""What a frame costs: curves against a static cloud, points against compute, on any OpenGL.

    python -m bench.frames [--movers 1e6,1e7] [--size 1280x720] [--clock cpu] [--out table.md]

For each number of movers and each degree of paths (0 is a static cloud): the whole frame as `play`
draws it, and the pass over the movers alone by either way. All are drawn in turns, round after
round, and each figure is the best of the rounds. `--clock cpu` counts the CPU's work instead, of
all threads: that is what software OpenGL costs, also where other work goes on beside it. Bandwidth
is what the pass must read, positions and tracks, against what the card copies (read and written),
measured in the same run.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path

import moderngl

from bench.moving import growing
from gclip.evaluate import layers_at
from player.camera import Camera
from player.chunks import estimate
from player.context import headless
from player.dots import Way
from player.renderer import Renderer
from player.style import Style

Clock = Callable[[], float]
COPIED = 256 << 20  # bytes
DEGREES = (0, 1, 2, 3)


def copy_bandwidth(context: moderngl.Context) -> float:
    """Bytes read and written a second when one buffer is copied to another."""
    source, target = (context.buffer(reserve=COPIED) for _ in range(2))
    seconds = min(timed(context, lambda: context.copy_buffer(target, source)) for _ in range(6))
    source.release()
    target.release()
    return 2.0 * COPIED / seconds


def timed(
    context: moderngl.Context, work: Callable[[], object], clock: Clock = time.perf_counter
) -> float:
    context.finish()
    began = clock()
    work()
    context.finish()
    return clock() - began


class Case:
    """A clip of one degree, drawn either way or as a whole frame."""

    def __init__(
        self,
        context: moderngl.Context,
        count: int,
        degree: int,
        size: tuple[int, int],
        clock: Clock,
    ) -> None:
        self.context, self.degree, self._clock = context, degree, clock
        clip = growing(count, degree)
        self.bytes = estimate(clip.intervals[0])
        self._size = size
        self._camera = Camera.fit(clip.bounds, aspect=size[0] / size[1])
        self._framebuffer = context.simple_framebuffer(size)
        self._renderer = Renderer(context, clip)
        self.ways = [Way.POINTS] + [Way.COMPUTE] * (context.version_code >= 430)
        self.seconds: dict[str, float] = {}
        self.frame(0.5)

    def frame(self, day: float) -> None:
        self._renderer.draw(self._framebuffer, day, self._camera, Style(), self._size)

    def round(self, day: float) -> None:
        self._keep("frame", timed(self.context, lambda: self.frame(day), self._clock))
        for way in self.ways:
            work = partial(self._scatter, way, day)
            self._keep(way.value, timed(self.context, work, self._clock))

    def _scatter(self, way: Way, day: float) -> None:
        """The pass over the movers alone."""
        renderer = self._renderer
        portions = renderer._portions(layers_at(renderer.clip, day), 1, None)
        discs = renderer._discs(day, self._camera, Style(), self._size, portions, True)
        renderer._dots.scatter(way, portions, discs)

    def _keep(self, name: str, seconds: float) -> None:
        self.seconds[name] = min(self.seconds.get(name, seconds), seconds)

    def release(self) -> None:
        # What is bound must outlive what is released: moderngl binds it again later on.
        self._framebuffer.use()
        self._renderer.release()


def table(
    context: moderngl.Context, count: int, size: tuple[int, int], rounds: int, clock: Clock
) -> list[str]:
    """Rows of a Markdown table."""
    copied = copy_bandwidth(context)
    cases = [Case(context, count, degree, size, clock) for degree in DEGREES]
    for number in range(rounds + 1):
        for case in cases:
            case.round(0.5)  # where the static cloud is
        if number == 0:  # compiling, uploading
            for case in cases:
                case.seconds.clear()
    rows = []
    for case in cases:
        best = min(case.seconds[way.value] for way in case.ways)
        read = case.bytes * count / best
        ratio = case.seconds["frame"] / cases[0].seconds["frame"]
        cells = [f"{count:,}", "static" if case.degree == 0 else f"degree {case.degree}"]
        cells += [str(case.bytes), f"{1e3 * case.seconds['frame']:.1f}", f"{ratio:.2f}"]
        for way in (Way.POINTS, Way.COMPUTE):
            cells.append(f"{1e3 * case.seconds[way]:.1f}" if way in case.seconds else "-")
        cells += [f"{best / min(cases[0].seconds[w.value] for w in cases[0].ways):.2f}"]
        cells += [f"{read / 1e9:.2f}", f"{100 * read / copied:.0f} %"]
        rows.append(f"| {' | '.join(cells)} |")
    for case in cases:
        case.release()
    return rows


COLUMNS = (
    "movers", "paths", "B a mover", "frame, ms", "to static", "points, ms", "compute, ms",
    "to static", "read, GB/s", "of copy",
)  # fmt: skip
HEAD = f"| {' | '.join(COLUMNS)} |", "|---" * len(COLUMNS) + "|"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--movers", default="1e5,1e6")
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--clock", choices=("wall", "cpu"), default="wall")
    parser.add_argument("--out", type=Path, help="a Markdown file for the table")
    arguments = parser.parse_args()
    clock = time.process_time if arguments.clock == "cpu" else time.perf_counter
    width, height = map(int, arguments.size.split("x"))
    context = headless()
    lines = [
        f"{context.info['GL_RENDERER']}, OpenGL {context.version_code / 100:.1f}, "
        f"{width}x{height}, copies {copy_bandwidth(context) / 1e9:.1f} GB/s, "
        f"{arguments.clock} time",
        "",
        *HEAD,
    ]
    print("\n".join(lines), flush=True)
    for text in arguments.movers.split(","):
        rows = table(context, int(float(text)), (width, height), arguments.rounds, clock)
        print("\n".join(rows), flush=True)
        lines += rows
    if arguments.out:
        arguments.out.write_text("\n".join([*lines, ""]), "utf-8")


if __name__ == "__main__":
    main()
