"""Commands that write, each started in a process of its own, and what they leave in a folder."""

from __future__ import annotations

import multiprocessing
import os
import re
import signal
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from multiprocessing.context import ForkServerProcess
from multiprocessing.synchronize import Event
from pathlib import Path

DRAFT = re.compile(r"\..+\.\w{8}\.part")
PATIENCE = 300.0  # seconds that a command may take
PRELOADED = [
    *("baker.cli", "grow.cli", "baker.pipeline", "baker.report.page", "traits.traits"),
    *("player.cli", "player.export", "scipy.spatial", "scipy.sparse.csgraph", "numba", "moderngl"),
    *("PIL.Image", "imageio_ffmpeg", "rich.progress", "safetensors.numpy", "ot"),
]
Files = dict[str, bytes]


@dataclass(frozen=True)
class Writer:
    """A command that writes.

    module:   whose `main` is called.
    old, new: its arguments, for an old output and for a new one.
    outputs:  relative paths; a folder's name stands for all files in it.
    varying:  those that tell how long things took: they are whole if they end as they should.
    """

    name: str
    module: str
    old: Sequence[str]
    new: Sequence[str]
    outputs: Sequence[str]
    varying: Sequence[str] = ()


def writers(series: Path, clip: Path) -> list[Writer]:
    """Commands that write into the folder that they are started in."""
    scans = [str(path) for path in sorted(series.glob("*.ply"))]
    also = ["--force", "--report", "report.html", "--traits", "traits.csv"]
    small = ["--size", "96x96", "--fps", "8"]
    found = [
        Writer(
            "bake",
            "baker.cli",
            ["-q", *scans[:2], "-o", "plant.gclip", *also],
            ["-q", *scans, "-o", "plant.gclip", *also],
            ["plant.gclip", "report.html", "traits.csv"],
            ["report.html"],
        ),
        Writer(
            "cache",
            "baker.cli",
            ["-q", *scans[:2], "-o", "plant.gclip"],
            ["-q", *scans, "-o", "plant.gclip", "--cache", "cache", "--force"],
            ["plant.gclip", "cache"],
            ["cache"],
        ),
    ]
    for name, output in (
        ("mp4", "film.mp4"),
        ("png", "frames/%04d.png"),
        ("html", "page.html"),
        ("ply", "clouds/%04d.ply"),
        ("glb", "plant.glb"),
        ("csv", "traits.csv"),
    ):
        export = [str(clip), "-q", "--force", "--export", output]
        export += small if name in ("mp4", "png") else []
        seconds = [["--seconds", s] if name in ("mp4", "png", "ply") else [] for s in ("1", "2")]
        other = {"html": ["--title", "old"], "csv": ["--day", "1"]}.get(name, [])
        place = output.partition("/")[0]
        old = [*export, *seconds[0], *other]
        found.append(Writer(name, "player.cli", old, [*export, *seconds[1]], [place]))
    check = ["check", *[str(clip)] * 300]
    return [*found, Writer("check", "gclip.cli", check, check, [])]


def make_series(folder: Path) -> tuple[Path, Path]:
    """A small plant's scans, and its clip."""
    series, clip = folder / "scans", folder / "plant.gclip"
    grown = ["maize", str(series), "--scans", "4", "--points", "500", "-q"]
    run_alone("grow.cli", grown, folder)
    run_alone("baker.cli", ["-q", str(series), "-o", str(clip)], folder)
    return series, clip


def start(module: str, arguments: Sequence[str], folder: Path) -> ForkServerProcess:
    """A process in which the command has begun."""
    processes = multiprocessing.get_context("forkserver")
    processes.set_forkserver_preload(PRELOADED)
    begun = processes.Event()
    process = processes.Process(target=_run, args=(module, list(arguments), folder, begun))
    process.start()
    begun.wait(PATIENCE)
    return process


def _run(module: str, arguments: list[str], folder: Path, begun: Event) -> None:
    os.chdir(folder)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    main = import_module(module).main
    signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored behind a shell's &
    begun.set()
    sys.argv[1:] = arguments
    code = main()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # what follows is not the command's
    sys.exit(code)


def run_alone(module: str, arguments: Sequence[str], folder: Path) -> None:
    """Let a command do all its work. Raises SystemExit where it fails."""
    process = start(module, arguments, folder)
    process.join(PATIENCE)
    if process.exitcode != 0:
        raise SystemExit(f"{module} {' '.join(arguments)}: exit code {process.exitcode}")


def contents(folder: Path, output: str) -> Files:
    """All files of an output, by their paths."""
    place = folder / output
    paths = [place] if place.is_file() else sorted(p for p in place.rglob("*") if p.is_file())
    whole = [path for path in paths if not any(DRAFT.fullmatch(part) for part in path.parts)]
    return {str(path.relative_to(folder)): path.read_bytes() for path in whole}


def is_whole(found: Files, olds: Path, news: Path, output: str) -> bool:
    """Whether each file of an output is the old or the new one, and none is missing.

    A sequence's are renamed one after the other.
    """
    old, new = contents(olds, output), contents(news, output)
    known = all(text in (old.get(name), new.get(name)) for name, text in found.items())
    return known and (old.keys() <= found.keys() or new.keys() <= found.keys())


def varied(writer: Writer, output: str, files: Files) -> bool:
    """Whether an output is one that varies, and is all there."""
    if output not in writer.varying:
        return False
    if output == "cache":
        return True  # what is broken in a cache is done again: that the clip is right tells
    return all(text.rstrip().endswith(b"</html>") for text in files.values())


def drafts(folder: Path) -> set[str]:
    """Names of what is still being written, or was left behind so."""
    names = (name for _, folders, files in os.walk(folder) for name in (*folders, *files))
    return {name for name in names if DRAFT.fullmatch(name)}


def leftovers(writer: Writer, folder: Path) -> set[str]:
    """What lies there and is no output."""
    others = {path.name for path in folder.iterdir() if path.name not in writer.outputs}
    return others | drafts(folder)
