"""Write the report of a bake: gather its contents and fill in the HTML template."""

import os
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from math import ceil, floor, log10
from pathlib import Path
from typing import Any

from baker.options import Options
from baker.pipeline import Survey
from baker.report.pictures import MAX_DOUBTS_PICTURED, NoPicture, scans_pictured, take_pictures
from baker.verdict.doubt import command_for, group_by_interval, headline, interval_dates
from gclip import Clip
from gclip.terminal.atomic import atomic_file
from gclip.text import printable
from traits.curves import TraitCurve, curve_names, trait_curves
from traits.doubts import doubts_of
from traits.holdout_error import HoldoutError, overall

MAX_TICKS = 5  # number of steps of the axis of growth curves
MAX_CURVES = 40  # of a chart; more lines can't be distinguished


def write_report(
    path: str | os.PathLike[str],
    clip: Clip,
    survey: Survey,
    errors: Sequence[HoldoutError],
    *,
    title: str = "growth clip",
    report_progress: Callable[[str, int, int], None] = lambda stage, done, total: None,
) -> None:
    """Write the report of a bake as one self-contained HTML file, or no file if that fails.

    If the player can't render pictures, the report gives the reason instead.

    survey: the aligned series, and the decisions about it. errors: as `verify` returns them. title:
    such as the clip's file name. report_progress: called with the name of a stage, the number of
    steps done and their total. Raises UserError if the file can't be written.
    """
    title, doubts = printable(title), doubts_of(clip)  # a file name may not be valid UTF-8
    by_interval = group_by_interval(doubts)
    report_progress("report", 0, 1)
    with atomic_file(Path(path)) as part:
        pictures, no_pictures = None, ""
        try:
            pictures = take_pictures(clip, by_interval, part.parent, survey.options.workers)
        except NoPicture as error:
            no_pictures = str(error)
        measured = trait_curves(clip, largest_organs(clip))
        curves = {trait: [c for c in measured if c.trait == trait] for trait in curve_names(clip)}
        page = _template().render(
            title=title,
            clip=clip,
            survey=survey,
            headline=headline(clip, doubts),
            doubts=[(interval_dates(clip, group[0]), group) for group in by_interval],
            command=partial(command_for, path=title),
            pictures=pictures,
            pictured=MAX_DOUBTS_PICTURED,
            no_pictures=no_pictures,
            shown=scans_pictured(clip),
            curves=curves["length"],
            charts=[
                (trait, sorted(group, key=lambda curve: -curve.values[-1]), ticks(group))
                for trait, group in curves.items()
                if trait not in ("area", "angle")
            ],
            errors=errors,
            overall=overall(errors) if errors else None,
            defaults=Options().provenance(),
            dates_of={scan.time: scan.date for scan in clip.scans},
            zip=zip,
            colors={track.id: "#" + bytes(track.color).hex() for track in clip.track_table},
        )
        part.write_bytes(page.encode())
    report_progress("report", 1, 1)


def largest_organs(clip: Clip) -> list[int]:
    """Track ids of the `MAX_CURVES` organs with the most points."""
    sizes = Counter({track.id: 0 for track in clip.track_table})
    for pair in (pair for interval in clip.intervals for pair in interval.segments):
        sizes[pair.track] = max(sizes[pair.track], pair.start_points, pair.end_points)
    return sorted(track for track, _ in sizes.most_common(MAX_CURVES))


def ticks(curves: Sequence[TraitCurve]) -> list[float]:
    """Round values for the axis of a chart, from below to above all of its curves."""
    low = min((curve.bottom for curve in curves), default=0.0)
    high = max((curve.top for curve in curves), default=1.0)
    high = high if high > low else low + (abs(low) or 1.0)
    power = 10.0 ** floor(log10((high - low) / MAX_TICKS))
    step = next(n * power for n in (1, 2, 5, 10) if n * power * MAX_TICKS >= high - low)
    return [step * k for k in range(floor(low / step), ceil(high / step) + 1)]


def _template() -> Any:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("baker.report"), autoescape=True, undefined=StrictUndefined
    )
    environment.trim_blocks = environment.lstrip_blocks = True
    environment.filters.update(significant=_significant, sentence=_sentence)
    return environment.get_template("report.html.j2")


def _significant(number: float) -> str:
    return f"{number:,.0f}" if abs(number) >= 1000 else f"{number:.3g}"


def _sentence(note: str) -> str:
    """Make a note a sentence: with a capital letter and a full stop."""
    return note[:1].upper() + note[1:] + ("" if note.endswith((".", "!", "?")) else ".")
