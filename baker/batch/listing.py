"""List the scans and findings of plants, for `bake --list` and the first lines of every bake."""

import sys
import textwrap
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from shutil import get_terminal_size

from baker.errors import InputError
from baker.geometry.parallel import thread_map, worker_count
from baker.options import Options
from baker.pipeline import survey_series
from baker.scans import Finding, Scan
from baker.scans.scan import TOPICS
from gclip.terminal.progress import StageProgress
from gclip.text import Lossy, printable

UNWRAPPED = 10**6  # width of lines that are not printed to a terminal


def list_plants(
    plants: Mapping[str, Path], inputs: Sequence[Path], options: Options, quiet: bool = False
) -> None:
    """Print the scans of each plant, and what a bake would decide about them.

    plants: folders by name; empty if the `inputs` are of one plant. If one of many plants can't be
    read, the reason is listed instead.
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
    """Format findings as lines: topic, "sure" or "look at this", and what was found.

    On a terminal, long lines are wrapped and indented.
    """
    width, lines = get_terminal_size((UNWRAPPED, 0)).columns, []
    for each in sorted(findings, key=lambda finding: TOPICS.index(finding.topic)):
        text = printable(f"{each.found}: {each.remark}" if each.doubt else each.found)
        head = f"{each.topic:<8}{'look at this' if each.doubt else 'sure':<14}"
        lines += textwrap.wrap(text, width, initial_indent=head, subsequent_indent=" " * len(head))
    return lines


def _survey_lines(inputs: Sequence[Path], options: Options, quiet: bool) -> list[str]:
    with StageProgress(quiet) as progress, thread_map(worker_count(options.workers)) as map:
        survey = survey_series(inputs, options, progress, map)
    return [*_scan_lines(survey.series.scans), "", *finding_lines(survey.findings)]


def _scan_lines(scans: Iterable[Scan]) -> list[str]:
    """Format scans as aligned lines: time, name and number of points."""
    rows = [(scan.date, printable(scan.name), f"{len(scan):,} points") for scan in scans]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    return [f"{d:<{widths[0]}}  {n:<{widths[1]}}  {p:>{widths[2]}}" for d, n, p in rows]


def _print(lines: Iterable[str]) -> None:
    Lossy(sys.stdout).write("\n".join([*lines, ""]))
