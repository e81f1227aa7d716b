"""Summarise a finished bake for the terminal in a short table."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from baker.verdict.doubt import command_for, group_by_interval
from gclip import Clip
from traits.doubts import doubts_of
from traits.holdout_error import HoldoutError, overall

VISIBLE_ERROR = 0.01  # marginal error of a transport plan above which the summary warns


def summary_lines(
    clip: Clip, path: Path, seconds: dict[str, float], cached: str = "", verbose: bool = False
) -> list[str]:
    """Summarise a clip, which was written to `path`, in aligned lines of text.

    seconds: the duration of each stage. cached: how many intervals came from a cache, "" where
    there is none. verbose: whether to add details of the transport and of the stages.
    """
    pairs = [pair for interval in clip.intervals for pair in interval.segments]
    events, solvers = Counter(p.event for p in pairs), Counter(p.solver for p in pairs if p.solver)
    inexact = sum(pair.marginal_error > VISIBLE_ERROR for pair in pairs)
    worst = max((pair.marginal_error for pair in pairs), default=0.0)
    points, first, last = sum(scan.points for scan in clip.scans), clip.scans[0], clip.scans[-1]
    born = f"{events['birth']} born and {events['loss']} lost in the series"
    rows = {
        "scans": f"{len(clip.scans)}, {first.date} to {last.date}, {points:,} points",
        "organs": f"{len(clip.track_table)}; {born}",
        "up": clip.up,
    }
    if inexact:  # half of the marginals' L1 error is the mass that is moved to a wrong place
        rows["transport"] = (
            f"inexact for {inexact} of {len(pairs)} segment pairs: up to {50 * worst:.0f}% of a "
            "segment's points may move to a wrong place"
        )
    if verbose:
        rows["segment pairs"] = f"{events['match']:,} matched, of {len(pairs):,}"
        rows["movers"] = f"{sum(len(interval) for interval in clip.intervals):,}"
        solved = ", ".join(f"{n} x {solver}" for solver, n in sorted(solvers.items()))
        rows["solvers"] = f"{solved}; marginal error {worst:.1g} at most"
        rows["stages"] = ", ".join(f"{stage} {s:.1f} s" for stage, s in seconds.items())
    if cached:
        rows["from the cache"] = cached
    kilobytes = path.stat().st_size / 1e3
    size = f"{kilobytes / 1e3:.1f} MB" if kilobytes >= 100 else f"{kilobytes:.0f} kB"
    rows["written"] = f"{path} ({size}) after {sum(seconds.values()):.1f} s"
    width = max(map(len, rows))
    return [f"{name:<{width}}  {value}" for name, value in rows.items()]


def verdict_line(clip: Clip, path: Path, doubted: Sequence[str] = ()) -> str:
    """The verdict on a clip, and the command that plays the most doubtful interval, if any.

    doubted: topics of the findings about the series that are to be looked at first.
    """
    line, doubts = clip.provenance["verdict"]["line"], group_by_interval(doubts_of(clip))
    command = f" Look: {command_for(doubts[0][0], path)}" if doubts else ""
    above = f" First check what is said above about: {', '.join(doubted)}." if doubted else ""
    return f"{line}{above}{command}"


def error_lines(errors: Sequence[HoldoutError], unit: str) -> list[str]:
    """Format the errors as a table, with a row for each scan and one for all together."""
    rows = [(f"{error.date}, {error.name}", error.distances) for error in errors]
    rows += [("all", overall(errors))] if len(errors) > 1 else []
    title = f"left out{unit and f' ({unit})'}"
    width = max(len(title), *(len(name) for name, _ in rows))
    return [
        f"{'':<{width}}{'reconstruction to scan':>30}{'scan to reconstruction':>30}",
        f"{title:<{width}}" + f"{'mean':>10}{'std':>10}{'max':>10}" * 2,
        *(f"{n:<{width}}" + "".join(f"{v:>10.3g}" for v in (*a, *b)) for n, (a, b) in rows),
    ]
