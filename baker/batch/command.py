"""The work of the command `bake`: a list of what would be baked, one plant or many."""

from collections.abc import Iterable, Sequence
from contextlib import ExitStack, suppress
from functools import cache
from pathlib import Path
from shutil import rmtree
from threading import Event

from baker.batch.bake_all import bake_all
from baker.batch.cache import Cache
from baker.batch.cluster import interval_solver
from baker.batch.listing import finding_lines, list_plants
from baker.batch.outputs import Outputs, check_apart, check_cache, check_output
from baker.batch.plant import bake_into, with_corrections
from baker.batch.plants import find_plants
from baker.batch.progress import StageProgress
from baker.errors import InputError
from baker.geometry.parallel import thread_map
from baker.options import Options
from baker.report.summary import summary_lines, verdict_line
from baker.report.verification import error_lines
from baker.scans import Finding
from baker.transport.compile import compile_kernels
from gclip.corrections import corrections_file
from traits.plants import write_traits

MIN_BYTES_TO_KEEP = 64 * 2**20  # of scans, from which on a bake takes minutes


def run(
    inputs: Sequence[Path], output: str, options: Options, outputs: Outputs, list_only: bool
) -> int:
    """List or bake what the inputs are; returns the exit code.

    output: the name after -o as it was typed, as a slash at its end means a folder.
    """
    if not output and not list_only:
        raise InputError("-o is missing: the clip to write, such as -o plant.gclip.")
    plants = find_plants(inputs, output)
    if outputs.traits is not None:
        check_apart(outputs.traits, [*(plants.values() or inputs), *filter(None, [options.times])])
    if list_only:
        list_plants(plants, inputs, options, outputs.quiet)
    elif plants:
        return bake_all(plants, options, outputs)
    else:
        bake_one(inputs, options, outputs)
    return 0


def bake_one(inputs: Sequence[Path], options: Options, outputs: Outputs) -> None:
    """Bake one plant, write what is wanted and print a summary.

    Raises UserError before the work where an output can't be written, or is there already and
    `outputs` do not force it; else for what the scans or options lack.
    """
    check_output(outputs.clip, outputs.force, "a clip", ".gclip")
    check_output(outputs.report, outputs.force, "a report", ".html", ".htm")
    check_output(outputs.traits, outputs.force, "a table of traits", ".csv")
    check_cache(outputs)
    begun = outputs.clip.with_name(f".{outputs.clip.name}.begun")
    folder = outputs.cache or (begun if _size(inputs) >= MIN_BYTES_TO_KEEP else None)
    kept_in = Cache(folder) if folder else None
    remarks: list[str | None] = []
    if (corrected := with_corrections(options, outputs.clip)) is not options:
        remarks.append(f"corrections: {corrections_file(outputs.clip)}")
        options = corrected
    is_compiled = not outputs.cluster and options.resolved().transport != "sinkhorn"
    with ExitStack() as stack, StageProgress(outputs.quiet) as progress:
        surveyed = Event()

        def tell(done: int, total: int) -> None:
            if surveyed.is_set():
                progress("compiling the solver, once", done, total)

        def announce(findings: Sequence[Finding]) -> None:
            for line in finding_lines(findings):
                progress.say(line)
            surveyed.set()
            remarks.extend(compiling())

        beside = stack.enter_context(thread_map(2))

        @cache
        def compiling() -> Iterable[str | None]:
            return beside(compile_kernels, [tell] if is_compiled else [])

        def report(stage: str, done: int, total: int) -> None:
            if stage == "aligning":  # all scans are sound: meanwhile the solver's code is read
                compiling()
            progress(stage, done, total)

        solve = stack.enter_context(interval_solver(outputs.cluster)) if outputs.cluster else None
        clip, errors = bake_into(outputs, inputs, options, kept_in, solve, report, announce)
        rmtree(begun, ignore_errors=True)
        if outputs.traits is not None:
            write_traits(outputs.traits, clip, outputs.clip.stem, progress)
    notes = clip.provenance["notes"] if outputs.verbose else []
    kept = kept_in.summary() if kept_in and (outputs.cache or kept_in.found) else ""
    lines = [*notes, *filter(None, remarks)]
    lines += summary_lines(clip, outputs.clip, progress.seconds, kept, outputs.verbose)
    lines += error_lines(errors, clip.unit) if errors else []
    written = {"report": outputs.report, "traits": outputs.traits}
    lines += [f"{what}: {path}" for what, path in written.items() if path is not None]
    for line in [*lines, verdict_line(clip, outputs.clip)]:
        progress.say(line)


def _size(inputs: Sequence[Path]) -> int:
    """Bytes of the scans."""
    size = 0
    with suppress(OSError):  # reading them will say what is wrong
        for given in inputs:
            files = given.iterdir() if given.is_dir() else [given]
            size += sum(path.stat().st_size for path in files if path.is_file())
    return size
