"""Bakes and exports killed at random moments: is the old output intact, or the new one whole?

    python -m tests.kill [--count 200] [--seed 0] [--only bake,mp4,...]
        [--signals SIGKILL,SIGINT]

Every way out runs in a process of its own, forked from one that has imported all it needs, and is
killed (SIGKILL), half of the time at any moment, half of the time within 50 ms after its draft
appears, which is when it writes. This goes on until each has been killed so many times: a run that
ends before it is killed does not count.
Each file at the output must then be what was there before, or what a run that is left alone writes;
nothing else but its draft. Then as many are stopped by Ctrl-C (SIGINT): they must end with exit
code 130 and leave no draft either. Now and then a run is left alone: it must come out right
whatever killed ones have left, and leave nothing itself.
"""

from __future__ import annotations

import argparse
import multiprocessing
import os
import random
import re
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from importlib import import_module
from multiprocessing.context import ForkServerProcess
from multiprocessing.synchronize import Event
from pathlib import Path

DRAFT = re.compile(r"\..+\.\w{8}\.part")
SOON = 0.05  # seconds after a draft appears
BEGUN = 0.05  # seconds after which a command can be stopped
EVERY = 10  # kills, after which a run is left alone
PATIENCE = 300.0
INTERRUPTED = 130  # exit code
PRELOADED = [
    *("baker.cli", "grow.cli", "baker.pipeline", "baker.report.page", "traits.traits"),
    *("player.cli", "player.export", "scipy.spatial", "scipy.sparse.csgraph", "numba", "moderngl"),
    *("PIL.Image", "imageio_ffmpeg", "rich.progress", "safetensors.numpy", "ot"),
]
Files = dict[str, bytes]


@dataclass(frozen=True)
class WayOut:
    """Something that writes.

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


def ways_out(series: Path, clip: Path) -> list[WayOut]:
    """Ways out that write into the folder that they are started in."""
    scans = [str(path) for path in sorted(series.glob("*.ply"))]
    also = ["--force", "--report", "report.html", "--traits", "traits.csv"]
    small = ["--size", "96x96", "--fps", "8"]
    found = [
        WayOut(
            "bake",
            "baker.cli",
            ["-q", *scans[:2], "-o", "plant.gclip", *also],
            ["-q", *scans, "-o", "plant.gclip", *also],
            ["plant.gclip", "report.html", "traits.csv"],
            ["report.html"],
        ),
        WayOut(
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
        found.append(WayOut(name, "player.cli", old, [*export, *seconds[1]], [place]))
    check = ["check", *[str(clip)] * 300]
    return [*found, WayOut("check", "gclip.cli", check, check, [])]


def stopped(
    way: WayOut, folder: Path, duration: float, chance: random.Random, stop: signal.Signals
) -> tuple[int | None, float]:
    """Start the way out and stop it; its exit code, and how many seconds it ran."""
    before = _drafts(folder)
    at_draft, due = chance.random() < 0.5, chance.uniform(BEGUN, max(BEGUN, duration))
    process = _started(way.module, way.new, folder)
    began = time.monotonic()
    while process.is_alive():
        late = time.monotonic() - began
        if at_draft and _drafts(folder) - before:
            at_draft, due = False, late + chance.uniform(0, SOON)
        if not at_draft and late >= due:
            with suppress(ProcessLookupError):  # it has just ended
                os.kill(process.pid, stop)
            break
        time.sleep(0.001)
    process.join(PATIENCE)
    return process.exitcode, time.monotonic() - began


def _drafts(folder: Path) -> set[str]:
    names = (name for _, folders, files in os.walk(folder) for name in (*folders, *files))
    return {name for name in names if DRAFT.fullmatch(name)}


def contents(folder: Path, output: str) -> Files:
    """All files of an output, by their paths."""
    place = folder / output
    paths = [place] if place.is_file() else sorted(p for p in place.rglob("*") if p.is_file())
    whole = [path for path in paths if not any(DRAFT.fullmatch(part) for part in path.parts)]
    return {str(path.relative_to(folder)): path.read_bytes() for path in whole}


def whole(found: Files, olds: Path, news: Path, output: str) -> bool:
    """Whether each file of an output is the old or the new one, and none is missing.

    A sequence's are renamed one after the other.
    """
    old, new = contents(olds, output), contents(news, output)
    known = all(text in (old.get(name), new.get(name)) for name, text in found.items())
    return known and (old.keys() <= found.keys() or new.keys() <= found.keys())


def varied(way: WayOut, output: str, files: Files) -> bool:
    """Whether an output is one that varies, and is all there."""
    if output not in way.varying:
        return False
    if output == "cache":
        return True  # what is broken in a cache is done again: that the clip is right tells
    return all(text.rstrip().endswith(b"</html>") for text in files.values())


def try_out(way: WayOut, count: int, seed: int, signals: Sequence[str]) -> Counter[str]:
    """Stop it so many times by each signal.

    Counts these, and what was left: old, new or broken outputs, and litter.
    """
    chance = random.Random(f"{seed} {way.name}")
    left: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as name:
        folder, olds, news = (Path(name) / part for part in ("here", "old", "new"))
        for place, arguments in ((olds, way.old), (news, way.new)):
            place.mkdir()
            began = time.monotonic()
            _finished(way.module, arguments, place)
            duration = time.monotonic() - began
        shutil.copytree(olds, folder)
        for stop in signals:
            while left[stop] < count:
                before = _strange(way, folder)
                code, seconds = stopped(way, folder, duration, chance, signal.Signals[stop])
                duration = duration if code else seconds  # as the machine is busy now
                hit = code == (INTERRUPTED if stop == "SIGINT" else -signal.SIGKILL)
                left[stop if hit else "wrong exit" if code else "too late"] += 1
                if code and not hit:
                    print(f"{way.name}: exit code {code} after {stop}", flush=True)
                left.update(_looked_at(way, folder, olds, news))
                if stop != "SIGKILL":
                    left["litter"] += _counted(way, _strange(way, folder) - before)
                alone = hit and (left[stop] % EVERY == 0 or left[stop] == count)
                if alone:
                    left["litter"] += _litter(way, folder, news)
                for output in way.outputs:
                    if alone or output != "cache":  # which other runs are to go on with
                        _restore(folder, olds, output)
    return left


def _looked_at(way: WayOut, folder: Path, olds: Path, news: Path) -> Counter[str]:
    """How many outputs are old, new and broken."""
    found: Counter[str] = Counter()
    for output in way.outputs:
        files = contents(folder, output)
        if files == contents(olds, output):
            found["old"] += 1
        elif whole(files, olds, news, output) or varied(way, output, files):
            found["new"] += 1
        else:
            found["broken"] += 1
            print(f"{way.name}: {output} is broken", flush=True)
    return found


def _litter(way: WayOut, folder: Path, news: Path) -> int:
    """How much a run that is left alone leaves beside the outputs; checks that it is right."""
    before = {path.name for path in folder.rglob("*")}
    _finished(way.module, way.new, folder)
    for output in way.outputs:
        if output not in way.varying and contents(folder, output) != contents(news, output):
            raise SystemExit(f"{way.name}: {output} is wrong after a run that was left alone")
    return _counted(way, _strange(way, folder) - before)


def _counted(way: WayOut, strange: set[str]) -> int:
    if strange:
        print(f"{way.name}: litter: {', '.join(sorted(strange))}", flush=True)
    return len(strange)


def _strange(way: WayOut, folder: Path) -> set[str]:
    """What lies there and is no output."""
    return {path.name for path in folder.iterdir() if path.name not in way.outputs} | _drafts(
        folder
    )


def _restore(folder: Path, olds: Path, output: str) -> None:
    place, old = folder / output, olds / output
    if place.is_dir():
        shutil.rmtree(place)
    place.unlink(missing_ok=True)
    if old.is_dir():
        shutil.copytree(old, place)
    elif old.exists():
        shutil.copy(old, place)


def _started(module: str, arguments: Sequence[str], folder: Path) -> ForkServerProcess:
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
    code = main(arguments)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # what follows is not the command's
    sys.exit(code)


def _finished(module: str, arguments: Sequence[str], folder: Path) -> None:
    process = _started(module, arguments, folder)
    process.join(PATIENCE)
    if process.exitcode != 0:
        raise SystemExit(f"{module} {' '.join(arguments)}: exit code {process.exitcode}")


def make_series(folder: Path) -> tuple[Path, Path]:
    """A small plant's scans, and its clip."""
    series, clip = folder / "scans", folder / "plant.gclip"
    grown = ["maize", str(series), "--scans", "4", "--points", "500", "-q"]
    _finished("grow.cli", grown, folder)
    _finished("baker.cli", ["-q", str(series), "-o", str(clip)], folder)
    return series, clip


def main(argv: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--count", type=int, default=200, help="of each, by each signal")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="", help="names, with commas between")
    parser.add_argument("--signals", default="SIGKILL,SIGINT")
    asked = parser.parse_args(argv)
    with tempfile.TemporaryDirectory() as name:
        ways = ways_out(*make_series(Path(name)))
        if asked.only:
            ways = [way for way in ways if way.name in asked.only.split(",")]
        total: Counter[str] = Counter()
        for way in ways:
            left = try_out(way, asked.count, asked.seed, asked.signals.split(","))
            print(f"{way.name}: {_told(left)}", flush=True)
            total += left
    print(f"all: {_told(total)}")
    return 1 if total["wrong exit"] or total["broken"] or total["litter"] else 0


def _told(left: Counter[str]) -> str:
    names = ("SIGKILL", "SIGINT", "too late", "wrong exit", "old", "new", "broken", "litter")
    return ", ".join(f"{left[name]} {name}" for name in names)


if __name__ == "__main__":
    sys.exit(main())
