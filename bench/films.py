"""How near an export comes to its encoder: `python -m bench.films CLIP... [--size 1920x1080]`.

Some successive frames out of the middle of the film that `play CLIP --export film.mp4` makes. Three
times they go into a film: drawn beforehand, so that this is what the encoder takes; drawn as an
export does it; and the whole export's rate is the share of the encoder's that is left. All in CPU
milliseconds a frame, of all threads and processes: that is what a machine without a GPU has to
share out. `frames` is the film's length and `drawn` how many of them are pictures of their own: a
film rests on its first and last scan.
"""

from __future__ import annotations

import argparse
import resource
import tempfile
import time
from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import groupby, islice
from pathlib import Path

from numpy.typing import NDArray

import gclip
from gclip import Clip
from player.export import Film
from player.export.video import write_mp4
from player.offscreen import Offscreen

BEGIN = 0.4  # share of the film that passes before the frames that are measured


def cpu_seconds() -> float:
    """Of this process and of those that it started and that have ended."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def encoded(pictures: Iterable[NDArray], film: Film, path: Path, count: int) -> float:
    """CPU milliseconds a frame."""
    before = cpu_seconds()
    write_mp4(pictures, film, path)
    return 1000.0 * (cpu_seconds() - before) / count


def row(name: str, clip: Clip, size: tuple[int, int], count: int, rounds: int) -> str:
    film = Film(size=size)
    days = film.days(clip)
    some = days[int(BEGIN * len(days)) :][:count]
    part = replace(film, at=tuple(some))
    drawn = len(list(groupby(days)))

    def frames(offscreen: Offscreen) -> Iterator[NDArray]:
        return part.frames(clip, offscreen)

    with tempfile.TemporaryDirectory() as folder, Offscreen(clip, size) as offscreen:
        path = Path(folder) / "film.mp4"
        list(islice(frames(offscreen), 2))  # compiles the shaders, uploads the movers
        ready, whole = [], []
        for _ in range(rounds):
            whole.append(encoded(frames(offscreen), film, path, len(some)))
            pictures = list(frames(offscreen))
            ready.append(encoded(pictures, film, path, len(some)))
    encoder, export = min(ready), min(whole)
    # What rests is encoded for next to nothing, and not drawn: the film's own share.
    film_share = encoder / (encoder + (export - encoder) * drawn / len(days))
    cells = [name, f"{size[0]}x{size[1]}", f"{encoder:.0f}", f"{export:.0f}"]
    cells += [f"{100 * encoder / export:.0f} %", str(len(days)), str(drawn)]
    return f"| {' | '.join([*cells, f'{100 * film_share:.0f} %'])} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("clips", nargs="+", type=Path)
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--count", type=int, default=30, help="frames that are measured")
    parser.add_argument("--rounds", type=int, default=2)
    chosen = parser.parse_args()
    width, height = map(int, chosen.size.split("x"))
    columns = ("clip", "size", "encoder, ms", "export, ms", "of its rate", "frames", "drawn")
    print(f"| {' | '.join([*columns, 'whole film'])} |")
    print("|---" * (len(columns) + 1) + "|")
    for path in chosen.clips:
        clip = gclip.open(path)
        print(row(path.stem, clip, (width, height), chosen.count, chosen.rounds), flush=True)


if __name__ == "__main__":
    main()
