"""What jumping about in a clip waits for: loading by itself, without the drawing.

    python -m bench.scrubbing CLIP [--jumps 40] [--clock cpu]

Jumps from day to day as a hand on the timeline does, and draws a picture after each jump as the
window does while things move. Printed are how long that took in all, and how much of it bringing
movers to the GPU and measuring the discs took: what a small clip would not have waited for.
"""

from __future__ import annotations

import argparse
import time

import numpy as np

import gclip
from player.camera import Camera
from player.context import headless
from player.detail import Pace
from player.renderer import Renderer
from player.style import Style
from player.window import LOADING

SIZE = (1280, 720)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("clip")
    parser.add_argument("--jumps", type=int, default=40)
    parser.add_argument("--clock", choices=("wall", "cpu"), default="wall")
    arguments = parser.parse_args()
    clock = time.process_time if arguments.clock == "cpu" else time.perf_counter
    clip, context = gclip.open(arguments.clip), headless()
    renderer, framebuffer = Renderer(context, clip), context.simple_framebuffer(SIZE)
    camera = Camera.home(clip, SIZE[0] / SIZE[1])
    pace = Pace(max(len(interval) for interval in clip.intervals))
    waited: list[float] = []

    def counted(name: str, owner: object) -> None:
        inner = getattr(owner, name)

        def outer(*values: object) -> object:
            began = clock()
            result = inner(*values)
            waited[-1] += clock() - began
            return result

        setattr(owner, name, outer)

    counted("load", renderer._movers.store)
    counted("at", renderer._closing)
    taken = []
    days = np.random.default_rng(0).uniform(clip.times[0], clip.times[-1], arguments.jumps)
    for day in days:
        waited.append(0.0)
        began, wall = clock(), time.perf_counter()
        every = pace.detail(SIZE).every
        renderer.draw(framebuffer, day, camera, Style(), SIZE, every=every, patience=LOADING)
        context.finish()
        taken.append(clock() - began)
        pace.took(time.perf_counter() - wall)
    print(f"| {arguments.clock}, ms | median | most, after the first |\n|---|---|---|")
    for name, values in (("loading", waited), ("whole picture", taken)):
        print(f"| {name} | {1e3 * np.median(values):.1f} | {1e3 * max(values[1:]):.1f} |")
    renderer.release()


if __name__ == "__main__":
    main()
