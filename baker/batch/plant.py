"""Bake one plant as the command does: its clip, its report and its traits, and what is told."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path
from shutil import rmtree
from typing import TYPE_CHECKING, Any

from baker.errors import InputError
from baker.options import Options
from gclip.terminal.text import Lossy

LONG = 64 * 2**20  # bytes of scans

if TYPE_CHECKING:
    from rich.console import Console

    from baker.batch.cache import IntervalCache
    from gclip import Clip


@dataclass(frozen=True)
class Wanted:
    """What to make of one plant's scans, and how.

    clip:    the file to write; report, traits: those beside it, where wanted.
    cluster: where a scheduler of dask.distributed listens; on this machine where None.
    cache:   the folder of finished intervals; where None, those of long bakes are kept beside the
             clip until it is written.
    """

    clip: Path
    report: Path | None = None
    traits: Path | None = None
    cluster: str | None = None
    cache: Path | None = None
    quiet: bool = False
    verbose: bool = False


def bake_one(inputs: Sequence[Path], options: Options, wanted: Wanted) -> None:
    """Bake, write and tell. Raises InputError before the work where an output can't be written."""
    check_clip(wanted.clip)
    if wanted.report is not None:
        check_beside(wanted.report, "a report", (".html", ".htm"))
    from rich.console import Console

    from baker.batch.forks import on_cores
    from baker.batch.progress import StageProgress
    from baker.geometry.parallel import thread_map
    from baker.options import worker_count
    from baker.scans.stage import read_scans

    stderr: Any = Lossy(sys.stderr)
    console = Console(file=stderr, quiet=wanted.quiet, soft_wrap=True)
    own = _begun(wanted.clip) if wanted.cache is None and _is_long(inputs) else None
    cache = wanted.cache or own
    kept = None if cache is None else _opened(cache)
    with ExitStack() as stack, StageProgress(wanted.quiet) as progress:
        workers = worker_count(options.workers)
        executor, _ = on_cores(workers)
        if wanted.cluster is not None:
            from baker.batch.cluster import intervals_on

            executor = stack.enter_context(intervals_on(wanted.cluster))
        map = stack.enter_context(thread_map(workers))
        scans = read_scans(inputs, options, progress, map)
        # Only now: they have been loaded beside the forks that read.
        from baker.pipeline import bake_series
        from baker.report.summary import print_summary
        from baker.report.verification import print_errors, verify

        clip, record = bake_series(scans, options, progress, executor, kept, map)
        progress("writing", 0, 1)
        clip.save(wanted.clip)
        progress("writing", 1, 1)
        rmtree(_begun(wanted.clip), ignore_errors=True)
        errors = verify(clip, record, progress)
        if wanted.report is not None:
            from baker.report import write_report

            write_report(
                wanted.report,
                clip,
                record,
                title=wanted.clip.name,
                errors=errors,
                seconds=progress.seconds,
                workers=options.workers,
                progress=progress,
            )
        if wanted.traits is not None:
            from baker.batch.traits import write_traits

            write_traits(wanted.traits, clip, wanted.clip.stem, progress)
    _print_notes(console, clip, wanted.verbose)
    told = kept if wanted.cache or (kept and kept.found) else None
    print_summary(console, clip, wanted.clip, progress.seconds, told)
    if errors:
        print_errors(console, errors)
    for what, path in (("report", wanted.report), ("traits", wanted.traits)):
        if path is not None:
            console.print(f"{what}: {path}", markup=False, highlight=False)


def _opened(folder: Path) -> IntervalCache:
    from baker.batch.cache import IntervalCache

    return IntervalCache(folder)


def _is_long(inputs: Sequence[Path]) -> bool:
    """Whether a bake takes minutes, by the bytes of its scans."""
    size = 0
    with suppress(OSError):  # reading them will say what is wrong
        for given in inputs:
            files = given.iterdir() if given.is_dir() else [given]
            size += sum(path.stat().st_size for path in files if path.is_file())
    return size >= LONG


def _begun(clip: Path) -> Path:
    """Where a long bake's finished intervals are until the clip is: the next run goes on there."""
    return clip.with_name(f".{clip.name}.begun")


def _print_notes(console: Console, clip: Clip, verbose: bool) -> None:
    """What was decided; with -v also what was found in each scan."""
    for note in clip.provenance["decisions"] + (clip.provenance["notes"] if verbose else []):
        console.print(note, markup=False, highlight=False)


def check_clip(output: Path) -> None:
    """Refuse before the work, not after it."""
    if output.suffix != ".gclip":
        raise InputError(f"{output}: a clip's name ends in .gclip.")
    if output.is_dir():
        raise InputError(f"{output} is a folder; a file's name is needed.")
    if not output.parent.is_dir():
        raise InputError(f"{output}: the folder {output.parent} does not exist.")


def check_beside(path: Path, what: str, suffixes: tuple[str, ...]) -> None:
    """Refuse what can't be written beside the clip."""
    if path.suffix.lower() not in suffixes:
        raise InputError(f"{path}: {what}'s name ends in {suffixes[0]}.")
    if path.is_dir():
        raise InputError(f"{path} is a folder; a file's name is needed.")
    if not path.parent.is_dir():
        raise InputError(f"{path}: the folder {path.parent} does not exist.")
