"""What a finished bake is told as: one short table for people."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path

    from rich.console import Console

    from gclip import Clip


def print_summary(
    console: Console,
    clip: Clip,
    path: Path,
    seconds: dict[str, float],
    kept: str = "",
) -> None:
    """Print scans, points, segments, births, losses, movers, clip size and seconds per stage.

    kept: how many intervals came from a cache, if any.
    """
    from rich.markup import escape
    from rich.table import Table

    events = Counter(pair.event for k in clip.intervals for pair in k.segments)
    solvers = Counter(pair.solver for k in clip.intervals for pair in k.segments)
    worst = max((pair.marginal_error for k in clip.intervals for pair in k.segments), default=0.0)
    first, last = clip.scans[0], clip.scans[-1]
    table = Table(show_header=False, box=None, padding=(0, 2, 0, 0))
    for name, value in {
        "scans": f"{len(clip.scans)}, {first.date} to {last.date}",
        "points": f"{sum(scan.points for scan in clip.scans):,}",
        "organs": f"{len(clip.track_table)}",
        "segment pairs": f"{events['match']:,} matched, {events['birth']:,} births, "
        f"{events['loss']:,} losses",
        "movers": f"{sum(len(interval) for interval in clip.intervals):,}",
        "transport": ", ".join(f"{n} x {solver}" for solver, n in sorted(solvers.items()))
        + f"; marginal error at most {worst:.1g}",
        **({"from the cache": kept} if kept else {}),
        "up": clip.up,
        "seconds": ", ".join(f"{stage} {s:.1f}" for stage, s in seconds.items())
        + f"; {sum(seconds.values()):.1f} in all",
        "written": f"{path} ({path.stat().st_size / 1e6:.1f} MB)",
    }.items():
        table.add_row(name, escape(value))
    console.print(table, highlight=False)
