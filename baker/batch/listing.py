"""What will be baked, as `bake --list` and the first lines of every bake tell it."""

import sys
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from shutil import get_terminal_size

from baker.batch.progress import StageProgress
from baker.errors import InputError
from baker.geometry.parallel import thread_map, worker_count
from baker.options import Options
from baker.pipeline import survey_series
from baker.scans import Finding, Scan
from baker.scans.scan import TOPICS
from gclip.text import Lossy, printable

UNWRAPPED = 10**6  # columns of what is no terminal


def list_plants(
    plants: Mapping[str, Path], inputs: Sequence[Path], options: Options, quiet: bool = False
) -> None:
    """Print for each plant what a bake would bake, and what it would decide by itself.

    plants: many plants; empty where the `inputs` are one plant's. A plant that can't be read is
    listed with the reason why.
    """
    for name, folder in plants.items():
        try:
            lines = _survey_lines([folder], options, quiet)
        except InputError as error:
            lines = [str(error)]
        _print([f"{printable(name)}:", *(f"    {line}" for line in lines), ""])
    if not plants:
        _print(_survey_lines(inputs, options, quiet))


def finding_lines(findings: Iterable[Finding]) -> list[str]:
    """A line a finding: its topic, "sure" or "look at this", and what was found.

    On a terminal a long line is wrapped, its continuation indented.
    """
    width, lines = get_terminal_size((UNWRAPPED, 0)).columns, []
    for one in sorted(findings, key=lambda finding: TOPICS.index(finding.topic)):
        text = printable(f"{one.found}: {one.remark}" if one.doubt else one.found)
        head = f"{one.topic:<8}{'look at this' if one.doubt else 'sure':<14}"
        lines += textwrap.wrap(text, width, initial_indent=head, subsequent_indent=" " * len(head))
    return lines


def _survey_lines(inputs: Sequence[Path], options: Options, quiet: bool) -> list[str]:
    with StageProgress(quiet) as progress, thread_map(worker_count(options.workers)) as map:
        survey = survey_series(inputs, options, progress, map)
    return [*_scan_lines(survey.series.scans), "", *finding_lines(survey.findings)]


def _scan_lines(scans: Iterable[Scan]) -> list[str]:
    """A line a scan: its time, its name and its number of points."""
    rows = [(scan.date, printable(scan.name), f"{len(scan):,} points") for scan in scans]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [f"{d:<{widths[0]}}  {n:<{widths[1]}}  {p:>{widths[2]}}" for d, n, p in rows]


def _print(lines: Iterable[str]) -> None:
    Lossy(sys.stdout).write("\n".join([*lines, ""]))
