"""Time of a frame of the HTML page, in headless Chromium with software rendering.

    python -m bench.page [--movers 1e6]

A frame at rest, while the view moves, and at the lowest level of detail; "to static" is relative to
a static cloud. Times are milliseconds of processor time of all of the browser's threads, the least
of several rounds.
"""

from __future__ import annotations

import argparse
import os
import shutil
import tempfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

from bench.frames import PATHS, ROUNDS, milliseconds, print_head, print_row
from bench.synthetic import growing, static
from player.export import Film, export

SOFTWARE_GL = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist")
PAGE_FRAMES = """([count, still, moving]) => {
    const { renderer, camera, clip, look } = viewer, gl = renderer.gl;
    const [width, height] = [1280, 720].map((side) => Math.round(0.8 ** moving * side));
    Object.assign(renderer.canvas, { width, height });
    if (still) clip.intervals[0].degree = 0;
    for (let i = 0; i < count; ++i) {
        camera.orbit(0.01, 0);
        renderer.draw(still ? 0 : 0.5, camera, look, { stride: 2 ** moving });
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    }
    return gl.getError();
}"""


def page(movers: list[int]) -> None:
    """Measure frames of pages with synthetic plants of several sizes."""
    from playwright.sync_api import sync_playwright

    print_head(
        "movers", "paths", "page, MB", "load", "at rest", "to static", "moving", "least detail"
    )
    with sync_playwright() as browsers, tempfile.TemporaryDirectory() as folder:
        program = shutil.which("chromium") or shutil.which("google-chrome")
        options = [*SOFTWARE_GL, "--no-sandbox"]
        browser = browsers.chromium.launch(executable_path=program, args=options)
        for count in movers:
            baseline, path = 0.0, Path(folder) / "page.html"
            for degree, name in enumerate(PATHS):
                clip = growing(count, degree) if degree else static(count)
                export(clip, Film(), path)
                tab = browser.new_page(viewport={"width": 1280, "height": 720})
                load = milliseconds(partial(_open_page, tab, path), _browser_seconds)
                times = [_page_time(tab, degree == 0, level) for level in (0, 1, 4)]
                tab.close()
                baseline = baseline or times[0]
                size, ratio = path.stat().st_size / 1e6, f"{times[0] / baseline:.2f}"
                print_row(f"{count:,}", name, size, load, times[0], ratio, *times[1:])
        browser.close()


def _open_page(tab: Any, path: Path) -> None:
    """Open a page, and wait until it has drawn the plant."""
    tab.goto(path.as_uri())
    while not tab.evaluate(
        "window.viewer !== undefined"
    ):  # its security policy forbids wait_for_function
        tab.wait_for_timeout(100)
    tab.evaluate("viewer.seek(0.5)")


def _page_time(tab: Any, still: bool, level: int, count: int = 5) -> float:
    """Milliseconds per frame at a level of detail of the page; level 0 draws everything.

    still: whether to draw a static cloud; count: number of frames per round.
    """

    def frames() -> None:
        assert tab.evaluate(PAGE_FRAMES, [count, still, level]) == 0

    frames()  # compiles the shaders
    return min(milliseconds(frames, _browser_seconds) / count for _ in range(ROUNDS))


def _browser_seconds() -> float:
    """Processor seconds of all running descendants of this process (Linux)."""
    ticks = 0
    for pid in _descendants(os.getpid()):
        fields = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
        ticks += int(fields[11]) + int(fields[12])
    return ticks / os.sysconf("SC_CLK_TCK")


def _descendants(parent: int) -> Iterator[int]:
    """Yield the process ids of all descendants of a process."""
    for task in Path(f"/proc/{parent}/task").glob("*/children"):
        for child in map(int, task.read_text().split()):
            yield child
            yield from _descendants(child)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--movers", default="1e6", help="numbers of movers of the synthetic plant")
    page([int(float(text)) for text in parser.parse_args().movers.split(",")])


if __name__ == "__main__":
    main()
