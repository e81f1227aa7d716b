"""What a frame of the HTML page costs: `python -m bench.page [--movers 1e6]`.

A grown clip of so many movers is exported, opened from disk in headless Chromium on its software
renderer (SwiftShader), and drawn over and over at 1280 x 720. Given is the CPU time of all the
browser's threads in milliseconds, the best of several rounds, for the machine is shared: for a
picture at rest, its ratio to the same points drawn by the same page without any interpolation, and
for the first and the last level of what the page draws while things move. `starting` is the longest
time, by the clock, that making the graphics context kept the page from answering, `unpacking` the
longest until the plant is there.
"""

from __future__ import annotations

import argparse
import os
import shutil
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from bench.moving import growing
from gclip import Clip
from player.export import Film, export

SOFTWARE_GL = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist")
FRAMES = """([count, still, moving]) => {
    const { renderer, clip, camera, look, clock } = viewer, gl = renderer.gl;
    const day = still ? 0 : 0.5;
    const [pixels, every, passes] = moving ? viewer.levels[moving] : [1, 1, 2];
    const size = [1280 * pixels, 720 * pixels].map(Math.round);
    Object.assign(renderer.canvas, { width: size[0], height: size[1] });
    if (still) renderer.buffers.get(0).degree = 0;
    for (let i = 0; i < count; ++i) {
        camera.orbit(0.01, 0);
        renderer.shadowDay = null;
        renderer.draw(day, camera, look, size, every, passes === 1);
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    }
    return gl.getError();
}"""
# Tasks that keep the page from answering, in milliseconds: with the graphics context, and others.
WATCH = """
    window.starting = 0;
    window.unpacking = 0;
    const make = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (...asked) {
        const before = performance.now(), made = make.apply(this, asked);
        window.starting = performance.now() - before;
        return made;
    };
    new PerformanceObserver((list) => {
        for (const { duration } of list.getEntries()) {
            const rest = duration < window.starting ? duration : duration - window.starting;
            window.unpacking = Math.max(window.unpacking, rest);
        }
    }).observe({ type: "longtask", buffered: true });
"""
KINDS = ("static", "straight", "degree 2", "degree 3")


def clip_of(kind: str, movers: int) -> Clip:
    """What stays where the others are half-way; or straight, or curved."""
    if kind != "static":
        return growing(movers, KINDS.index(kind))
    clip = growing(movers, 0)
    (interval,) = clip.intervals
    here = interval.start_positions
    moving = growing(movers, 1).intervals[0]
    still = replace(moving, box=interval.box, start_positions=here, end_positions=here)
    return replace(clip, intervals=(still,))


def browser_seconds(parent: int) -> float:
    """CPU seconds of the browser's processes so far."""
    ticks = 0
    for pid in _family(parent):
        try:
            fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
        except OSError:
            continue
        ticks += int(fields[11]) + int(fields[12])
    return ticks / os.sysconf("SC_CLK_TCK")


def _family(parent: int) -> Iterator[int]:
    yield parent
    for task in Path(f"/proc/{parent}/task").glob("*/children"):
        for child in task.read_text().split():
            yield from _family(int(child))


def measured(tab: Any, count: int, rounds: int, still: bool, moving: int = 0) -> float:
    """CPU milliseconds a frame, the best of some rounds; moving: at a level of page.js's LEVELS."""
    best = np.inf
    for _ in range(rounds + 1):  # the first compiles the shaders
        before = browser_seconds(os.getpid())
        assert tab.evaluate(FRAMES, [count, still, moving]) == 0
        best = min(best, (browser_seconds(os.getpid()) - before) / count)
    return 1000.0 * best


def main() -> None:
    from playwright.sync_api import sync_playwright

    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--movers", type=float, nargs="*", default=[1e6])
    parser.add_argument("--frames", type=int, default=5)
    parser.add_argument("--rounds", type=int, default=3)
    chosen = parser.parse_args()
    columns = ("movers", "paths", "page, MB", "load", "at rest", "to static", "moving")
    columns += ("on a slow machine", "starting", "unpacking")
    print(f"| {' | '.join(columns)} |")
    print("|---" * len(columns) + "|")
    with sync_playwright() as browsers, tempfile.TemporaryDirectory() as folder:
        program = shutil.which("chromium") or shutil.which("google-chrome")
        browser = browsers.chromium.launch(
            executable_path=program, args=[*SOFTWARE_GL, "--no-sandbox"]
        )
        for movers in chosen.movers:
            static = 0.0
            for kind in KINDS:
                path = Path(folder) / "page.html"
                export(clip_of(kind, int(movers)), Film(), path)
                tab = browser.new_page(
                    viewport={"width": 1280, "height": 720}, reduced_motion="reduce"
                )
                tab.add_init_script(WATCH)
                before = browser_seconds(os.getpid())
                tab.goto(path.as_uri())
                while not tab.evaluate("window.viewer !== undefined"):
                    tab.wait_for_timeout(100)
                tab.evaluate("viewer.seek(0.5)")
                loaded = browser_seconds(os.getpid()) - before
                starting, unpacking = tab.evaluate("[starting, unpacking]")
                still = kind == "static"
                last = tab.evaluate("viewer.levels.length") - 1
                took, moving, slow = (
                    measured(tab, chosen.frames, chosen.rounds, still, level)
                    for level in (0, 1, last)
                )
                tab.close()
                static = took if still else static
                size = path.stat().st_size / 1e6
                print(
                    f"| {int(movers):,} | {kind} | {size:.1f} | {1000 * loaded:.0f} "
                    f"| {took:.0f} | {took / static:.2f} | {moving:.0f} | {slow:.0f} "
                    f"| {starting:.0f} | {unpacking:.0f} |",
                    flush=True,
                )
        browser.close()


if __name__ == "__main__":
    main()
