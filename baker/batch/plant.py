"""One plant, baked as the command does it: its clip, its report and its traits."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from functools import partial
from pathlib import Path
from shutil import rmtree
from typing import Any

from baker.alignment import align
from baker.batch.cache import Cache
from baker.batch.cluster import interval_solver
from baker.batch.listing import finding_lines
from baker.batch.outputs import Outputs, check_output
from baker.batch.progress import StageProgress
from baker.batch.traits import write_traits
from baker.geometry.parallel import thread_map
from baker.interpolation.interval_job import IntervalSolver, solve_intervals
from baker.options import Options, worker_count
from baker.pipeline import Register, bake_series
from baker.report import write_report
from baker.report.summary import print_summary, print_verdict
from baker.report.verification import print_errors, verify
from baker.scans import Finding, read_series
from baker.transport.compile import compile_kernels
from gclip.terminal.text import Lossy

MIN_BYTES_TO_KEEP = 64 * 2**20  # of scans, from which on a bake takes minutes


def bake_one(inputs: Sequence[Path], options: Options, outputs: Outputs) -> None:
    """Bake one plant, write what is wanted and print a summary.

    Raises
    ------
    InputError
        Before the work where an output can't be written; else what the scans or options lack.
    """
    from rich.console import Console

    check_output(outputs.clip, "a clip", ".gclip")
    if outputs.report is not None:
        check_output(outputs.report, "a report", ".html", ".htm")
    begun = outputs.clip.with_name(f".{outputs.clip.name}.begun")
    folder = outputs.cache or (begun if _size(inputs) >= MIN_BYTES_TO_KEEP else None)
    cache = Cache(folder) if folder else None
    workers = worker_count(options.workers)
    stderr: Any = Lossy(sys.stderr)
    console = Console(file=stderr, quiet=outputs.quiet, soft_wrap=True)
    with ExitStack() as stack, StageProgress(outputs.quiet) as progress:
        map = stack.enter_context(thread_map(workers))
        register: Register = align
        solve: IntervalSolver = partial(solve_intervals, workers=workers)
        if outputs.cluster is not None:
            solve = stack.enter_context(interval_solver(outputs.cluster))
        if cache is not None:
            register, solve = cache.kept(register), cache.kept_intervals(solve)
        scans = read_series(inputs, options, partial(progress, "reading"), map)
        not_kept = None
        if outputs.cluster is None and options.resolved().transport != "sinkhorn":
            not_kept = compile_kernels(partial(progress, "compiling the solver, once"))
        announce = partial(_announce, progress)
        clip, record = bake_series(scans, options, progress, map, register, solve, announce)
        progress("writing", 0, 1)
        clip.save(outputs.clip)
        progress("writing", 1, 1)
        rmtree(begun, ignore_errors=True)
        errors = verify(clip, record, progress)
        if outputs.report is not None:
            write = partial(write_report, title=outputs.clip.name, report_progress=progress)
            write(outputs.report, clip, record, errors)
        if outputs.traits is not None:
            write_traits(outputs.traits, clip, outputs.clip.stem, progress)
    say = partial(console.print, markup=False, highlight=False)
    for note in clip.provenance["notes"] * outputs.verbose:
        say(note)
    if not_kept:
        say(not_kept)
    kept = cache.summary() if cache and (outputs.cache or cache.found) else ""
    print_summary(
        console, clip, outputs.clip, progress.seconds, cached=kept, verbose=outputs.verbose
    )
    if errors:
        print_errors(console, errors)
    for what, path in (("report", outputs.report), ("traits", outputs.traits)):
        if path is not None:
            say(f"{what}: {path}")
    print_verdict(console, clip, outputs.clip)


def _announce(progress: StageProgress, findings: Sequence[Finding]) -> None:
    """Print what was decided, above the bars of the stages to come."""
    for line in finding_lines(findings):
        progress.say(line)


def _size(inputs: Sequence[Path]) -> int:
    """Bytes of the scans."""
    size = 0
    with suppress(OSError):  # reading them will say what is wrong
        for given in inputs:
            files = given.iterdir() if given.is_dir() else [given]
            size += sum(path.stat().st_size for path in files if path.is_file())
    return size
