"""Makes the gallery's pictures, from grown plants only.

    python docs/gallery/make.py WORK [NAME...]

WORK keeps scans and clips from one run to the next; NAMEs choose pictures. The window's picture
needs Xvfb and xdotool, the page's playwright and a Chromium.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from PIL import Image, ImageGrab

import gclip
from gclip import Clip
from player.export import Film, export
from player.export.annotations import annotated
from player.rendering.headless import Offscreen
from player.view.annotations import Annotations
from player.view.camera import Camera
from player.view.style import Style

HERE = Path(__file__).parent
GAP = 6  # pixels between the parts of a picture


@dataclass(frozen=True)
class Plant:
    """What is grown and baked for the pictures."""

    grow: tuple[str, ...]
    bake: tuple[str, ...] = ("--unit", "mm")


PLANTS = {
    "tomato": Plant(("tomato", "--points", "60000", "--scans", "8", "--seed", "2")),
    "tree": Plant(("tree", "--points", "60000", "--scans", "8", "--seed", "2")),
    "maize": Plant(
        ("maize", "--points", "40000", "--scans", "9", "--seed", "3"),
        ("--unit", "mm", "--holdout", "2"),
    ),
}


def clip_of(name: str, work: Path) -> Path:
    """A plant's clip, grown and baked if it isn't in `work` yet."""
    plant, scans, clip = PLANTS[name], work / name, work / f"{name}.gclip"
    if not clip.exists():
        grow = [sys.executable, "-m", "grow", *plant.grow, str(scans), "--force", "-q"]
        bake = [sys.executable, "-m", "baker", str(scans), "-o", str(clip), *plant.bake, "-q"]
        subprocess.run(grow, check=True)
        subprocess.run(bake, check=True)
    return clip


def growing(work: Path) -> None:
    """The first thing that people see: a tomato plant grows, and turns a little."""
    clip, size = gclip.open(clip_of("tomato", work)), (720, 460)
    film = Film(size=size, fps=15, seconds=6.0, annotations=Annotations(date=True, scale_bar=True))
    days, home = film.days(clip), Camera.home(clip, film.aspect)
    frames = []
    with Offscreen(clip, size) as offscreen:
        for number, day in enumerate(days):
            yaw = 0.9 * (number / (len(days) - 1) - 1.0)
            camera = home.orbit(yaw, 0.0)
            picture = annotated(offscreen.picture(day, camera), day, camera, film, clip, None)
            frames.append(Image.fromarray(picture).convert("RGB"))
    first, *others = frames
    first.save(
        HERE / "tomato.webp", save_all=True, append_images=others, duration=1000 // film.fps,
        loop=0, quality=58, method=6,
    )  # fmt: skip


def stages(work: Path) -> None:
    """A tree from its first scan to its last, six moments side by side."""
    clip, size = gclip.open(clip_of("tree", work)), (330, 420)
    first, last = clip.times[0], clip.times[-1]
    film = Film(size=size, style=Style(ground="light"), annotations=Annotations(date=True))
    days = tuple(first + (last - first) * (0.1 + 0.9 * step / 4) for step in range(5))
    with Offscreen(clip, size) as offscreen:
        pictures = list(replace(film, at=days).frames(clip, offscreen))
    parts = [Image.fromarray(picture).convert("RGB") for picture in pictures]
    saved(beside(parts), "tree.jpg")


def colors(work: Path) -> None:
    """The same plant in the colours of its organs and of three values."""
    clip = gclip.open(clip_of("maize", work))
    parts = []
    for color in ("track", "age", "growth", "error"):
        film = Film(
            size=(560, 420),
            at=(12.25,),
            style=Style(color_by=color),
            annotations=Annotations(legend=True),
        )
        parts.append(_still(clip, film, work))
    rows = [beside(parts[:2]), beside(parts[2:])]
    saved(above(rows), "colors.jpg")


def window(work: Path) -> None:
    """The window under Xvfb: a scan and the state in between, with the panel open."""
    clip = clip_of("tomato", work)
    with _display(1280, 760) as environment:
        settings = {**environment, "XDG_CONFIG_HOME": str(work / "settings")}
        player = subprocess.Popen(
            [sys.executable, "-m", "player", str(clip), "--size", "1280x760"], env=settings
        )
        try:
            found = ["xdotool", "search", "--sync", "--onlyvisible", "--name", "tomato"]
            subprocess.run(found, env=settings, check=True)
            _press(settings, 8.0, "space", "Home", *("shift+Right",) * 4, *("Right",) * 6)
            _press(settings, 5.0, *("n",) * 6)
            subprocess.run(["xdotool", "mousemove", "300", "300"], env=settings, check=True)
            time.sleep(8.0)
            picture = ImageGrab.grab(xdisplay=settings["DISPLAY"])
        finally:
            player.kill()
            player.wait()
    saved(picture, "window.jpg")


def page(work: Path) -> None:
    """The HTML export in a browser, and in one as small as a telephone's."""
    from playwright.sync_api import sync_playwright

    clip, file = gclip.open(clip_of("tree", work)), work / "tree.html"
    export(clip, Film(title="Tree", style=Style(ground="light")), file)
    with sync_playwright() as browsers:
        browser = browsers.chromium.launch(
            executable_path=_chromium(),
            args=["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
        )
        parts = []
        for width, share in ((800, 0.75), (340, 1.0)):
            view = browser.new_page(viewport={"width": width, "height": 600}, has_touch=True)
            view.goto(file.as_uri())
            while not view.evaluate("window.viewer !== undefined"):
                view.wait_for_timeout(100)
            view.evaluate(f"viewer.seek({share * clip.times[-1]})")
            view.wait_for_timeout(2000)
            view.screenshot(path=work / "page.png")
            parts.append(Image.open(work / "page.png").convert("RGB"))
        browser.close()
    saved(beside(parts), "page.jpg")


def report(work: Path) -> None:
    """What `bake --report` tells."""
    from playwright.sync_api import sync_playwright

    clip_of("maize", work)
    folder = work / "report"
    folder.mkdir(exist_ok=True)
    file, clip = folder / "report.html", folder / "maize.gclip"
    bake = [sys.executable, "-m", "baker", str(work / "maize"), "-o", str(clip)]
    subprocess.run(
        [*bake, *PLANTS["maize"].bake, "--report", str(file), "-q", "--force"], check=True
    )
    with sync_playwright() as browsers:
        browser = browsers.chromium.launch(executable_path=_chromium(), args=["--no-sandbox"])
        view = browser.new_page(viewport={"width": 1140, "height": 980})
        view.goto(file.as_uri())
        view.screenshot(path=work / "report.png")
        browser.close()
    saved(Image.open(work / "report.png").convert("RGB"), "report.jpg")


def _chromium() -> str | None:
    return shutil.which("chromium") or shutil.which("google-chrome")


def _still(clip: Clip, film: Film, work: Path) -> Image.Image:
    export(clip, film, work / "still.png")
    return Image.open(work / "still.png").convert("RGB")


def beside(parts: list[Image.Image]) -> Image.Image:
    width = sum(part.width for part in parts) + GAP * (len(parts) - 1)
    whole, x = Image.new("RGB", (width, parts[0].height), "white"), 0
    for part in parts:
        whole.paste(part, (x, 0))
        x += part.width + GAP
    return whole


def above(rows: list[Image.Image]) -> Image.Image:
    height = sum(row.height for row in rows) + GAP * (len(rows) - 1)
    whole, y = Image.new("RGB", (rows[0].width, height), "white"), 0
    for row in rows:
        whole.paste(row, (0, y))
        y += row.height + GAP
    return whole


def saved(picture: Image.Image, name: str) -> None:
    picture.save(HERE / name, quality=86, optimize=True, progressive=True)


@contextmanager
def _display(width: int, height: int) -> Any:
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", "1", "-screen", "0", f"{width}x{height}x24", "-noreset"],
        stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
    )  # fmt: skip
    assert server.stdout is not None
    try:
        yield {**os.environ, "DISPLAY": f":{server.stdout.readline().strip()}"}
    finally:
        server.terminate()
        server.wait()


def _press(environment: dict[str, str], wait: float, *keys: str) -> None:
    time.sleep(wait)
    subprocess.run(["xdotool", "key", "--delay", "300", *keys], env=environment, check=True)


PICTURES: dict[str, Callable[[Path], None]] = {
    "growing": growing, "stages": stages, "colors": colors, "window": window, "page": page,
    "report": report,
}  # fmt: skip


def main(work: Path, names: list[str]) -> None:
    work.mkdir(parents=True, exist_ok=True)
    for name in names or PICTURES:
        PICTURES[name](work)


if __name__ == "__main__":
    if len(sys.argv) < 2 or not set(sys.argv[2:]) <= PICTURES.keys():
        sys.exit(f"{(__doc__ or '').strip()}\n\nNAMEs: {', '.join(PICTURES)}")
    main(Path(sys.argv[1]), sys.argv[2:])
