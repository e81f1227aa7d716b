"""Run the command `bake`: list what would be baked, or bake one plant or many."""

import sys
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from pathlib import Path
from shutil import get_terminal_size

from baker.batch.bake_all import bake_all
from baker.batch.cache import Cache
from baker.batch.plant import bake_into, with_corrections
from baker.batch.plants import find_plants
from baker.errors import InputError
from baker.geometry.parallel import thread_map, worker_count
from baker.options import Options, Outputs
from baker.pipeline import survey_series
from baker.report.summary import error_lines, summary_lines, verdict_line
from baker.scans.scan import TOPICS, Finding
from baker.transport.compile import compile_kernels
from corrections import corrections_file
from gclip.terminal import atomic
from gclip.terminal.progress import StageProgress
from gclip.text import Lossy, printable
from traits.plants import write_traits

UNWRAPPED = 10**6  # width of lines that are not printed to a terminal


def run(
    inputs: Sequence[Path], output: str, options: Options, outputs: Outputs, list_only: bool
) -> int:
    """List or bake scans, folders of scans, or folders of plants; return the exit code of `bake`.

    output: the argument of -o as it was typed, since a slash at its end means a folder. list_only:
    whether to print what would be baked instead of baking it.
    """
    if not output and not list_only:
        raise InputError("-o is missing: the clip to write, such as -o plant.gclip.")
    plants = find_plants(inputs, output)
    if outputs.traits is not None:
        _check_not_input(outputs.traits, [*(plants.values() or inputs), options.times])
    if list_only:
        list_plants(plants, inputs, options, outputs.quiet)
    elif plants:
        check_output(outputs.traits, True, "a table of traits", ".csv")  # it may exist
        return bake_all(plants, options, outputs)
    elif outputs.cluster:
        raise InputError("--cluster is for many plants, each a folder of scans; this is one.")
    else:
        bake_one(inputs, options, outputs)
    return 0


def check_output(path: Path | None, force: bool, kind: str, *suffixes: str) -> None:
    """Raise UserError if an output can't be written or has a wrong suffix; kind: "a clip"."""
    if path is None:
        return
    if path.suffix.lower() not in suffixes:
        raise InputError(f"{path}: the name of {kind} ends in {suffixes[0]}.")
    atomic.check_output(path, force)


def _check_not_input(table: Path, inputs: Iterable[Path | None]) -> None:
    """Raise InputError if a table would replace an input, or be in a folder of scans."""
    for path in filter(None, inputs):
        same = table.parent if path.is_dir() else table
        if same.exists() and path.exists() and same.samefile(path):
            raise InputError(f"{table} is among the inputs; write it elsewhere.")


def list_plants(
    plants: Mapping[str, Path], inputs: Sequence[Path], options: Options, quiet: bool = False
) -> None:
    """Print the scans of each plant, and what a bake would decide about them.

    plants: folders by name; empty if the `inputs` are of one plant. If one of many plants can't be
    read, the reason is printed instead.
    """
    out = Lossy(sys.stdout)
    for name, folder in plants.items():
        try:
            lines = _survey_lines([folder], options, quiet)
        except InputError as error:
            lines = [str(error)]
        out.write("\n".join([f"{printable(name)}:", *(f"    {line}" for line in lines), "\n"]))
    if not plants:
        out.write("\n".join([*_survey_lines(inputs, options, quiet), ""]))


def finding_lines(findings: Iterable[Finding]) -> list[str]:
    """Format findings as lines: topic, "sure" or "look at this", and what was found.

    On a terminal, long lines are wrapped and indented.
    """
    width, lines = get_terminal_size((UNWRAPPED, 0)).columns, []
    for finding in sorted(findings, key=lambda item: TOPICS.index(item.topic)):
        text = printable(f"{finding.found}: {finding.remark}" if finding.doubt else finding.found)
        head = f"{finding.topic:<8}{'look at this' if finding.doubt else 'sure':<14}"
        lines += textwrap.wrap(text, width, initial_indent=head, subsequent_indent=" " * len(head))
    return lines


def _survey_lines(inputs: Sequence[Path], options: Options, quiet: bool) -> list[str]:
    """The time, name and number of points of each scan, and the findings about the series."""
    with StageProgress(quiet) as progress, thread_map(worker_count(options.workers)) as map:
        survey = survey_series(inputs, options, progress, map)
    scans = survey.series.scans
    rows = [(scan.date, printable(scan.name), f"{len(scan):,} points") for scan in scans]
    d, n, p = (max(len(cell) for cell in column) for column in zip(*rows, strict=True))
    lines = [f"{date:<{d}}  {name:<{n}}  {points:>{p}}" for date, name, points in rows]
    return [*lines, "", *finding_lines(survey.findings)]


def bake_one(inputs: Sequence[Path], options: Options, outputs: Outputs) -> None:
    """Bake one plant, write its outputs and print a summary.

    Raises UserError before the bake if an output can't be written, or exists and may not be
    replaced; during the bake if the scans or options are wrong.
    """
    cache = Cache(outputs.cache) if outputs.cache else None
    check_output(outputs.clip, outputs.force, "a clip", ".gclip")
    check_output(outputs.report, outputs.force, "a report", ".html", ".htm")
    check_output(outputs.traits, outputs.force, "a table of traits", ".csv")
    corrected = with_corrections(options, outputs.clip)
    with StageProgress(outputs.quiet) as progress:
        doubted = list[str]()

        def report_findings(findings: Sequence[Finding]) -> None:
            doubted.extend(dict.fromkeys(item.topic for item in findings if item.doubt))
            for line in finding_lines(findings):
                progress.say(line)
            if corrected is not options:
                progress.say(f"corrections: {corrections_file(outputs.clip)}")
            compiling = partial(progress, "compiling the solver, once")
            if options.resolved().transport != "sinkhorn" and (note := compile_kernels(compiling)):
                progress.say(note)

        clip, errors = bake_into(outputs, inputs, corrected, cache, progress, report_findings)
        if outputs.traits is not None:
            write_traits(outputs.traits, clip, outputs.clip.stem, progress)
    lines = list(clip.provenance["notes"]) if outputs.verbose else []
    cached = cache.summary() if cache else ""
    lines += summary_lines(clip, outputs.clip, progress.seconds, cached, outputs.verbose)
    lines += error_lines(errors, clip.unit) if errors else []
    written = {"report": outputs.report, "traits": outputs.traits}
    lines += [f"{kind}: {path}" for kind, path in written.items() if path is not None]
    for line in [*lines, verdict_line(clip, outputs.clip, doubted)]:
        progress.say(line)
