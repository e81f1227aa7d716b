"""What a finished bake says in the terminal: one short table."""

from collections import Counter
from pathlib import Path

from baker.verdict.doubt import command_for, doubts_in, grouped
from gclip import Clip

VISIBLE_ERROR = 0.01  # marginal error of a transport plan, above which the film is worth a warning


def summary_lines(
    clip: Clip,
    path: Path,
    seconds: dict[str, float],
    cached: str = "",
    verbose: bool = False,
) -> list[str]:
    """What was baked, for the terminal.

    Parameters
    ----------
    clip : gclip.Clip
    path : Path
        Of the clip's file.
    seconds : dict of str to float
        What each stage took.
    cached : str
        How many intervals came from a cache; empty where there is none.
    verbose : bool
        Also what the transport and each stage did.

    Returns
    -------
    list of str
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
    if inexact:  # half of the L1 distance is what goes astray
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
    size = path.stat().st_size / 1e6
    rows["written"] = f"{path} ({size:.1f} MB) after {sum(seconds.values()):.1f} s"
    width = max(map(len, rows))
    return [f"{name:<{width}}  {value}" for name, value in rows.items()]


def verdict_line(clip: Clip, path: Path) -> str:
    """Which intervals look right, and how to look at the most doubtful one."""
    line, doubts = clip.provenance["verdict"]["line"], grouped(doubts_in(clip))
    look = f" Look: {command_for(doubts[0][0], path)}" if doubts else ""
    return str(line + look)
