"""Two recipes for what the options leave open: our own, and the paper's (`--paper`)."""

from __future__ import annotations

from dataclasses import dataclass

from baker.match.greedy import PAPER, GreedyRules
from baker.options import Options
from baker.transport.plan import TransportOptions


@dataclass(frozen=True)
class Recipe:
    """The choices of docs/method.md's table, resolved.

    align:           how scans are brought together: auto, icp or none.
    whole:           no segments, one transport problem for the whole cloud (Figure 3).
    match_by_shape:  organs numbered anew are matched all at once; else down the hierarchies.
    rules:           of matching down the hierarchies.
    transport:       of each pair of segments.
    fill:            movers to add at most where they would be sparse, as a share of all.
    """

    align: str
    whole: bool
    match_by_shape: bool
    rules: GreedyRules
    transport: TransportOptions
    fill: float


def recipe_for(options: Options) -> Recipe:
    """What to do under these options; `options.paper` turns "auto" into the paper's own way."""
    whole = options.transport == "whole"
    method = "auto" if whole else options.transport
    if options.paper:
        return Recipe(
            align="icp" if options.align == "auto" else options.align,
            whole=whole,
            match_by_shape=False,
            rules=PAPER,
            transport=TransportOptions(
                method="sinkhorn" if method == "auto" else method,
                power=1,
                neighbors=options.neighbors,
                feasible=False,
            ),
            fill=options.fill or 0.0,
        )
    return Recipe(
        align=options.align,
        whole=whole,
        match_by_shape=True,
        rules=GreedyRules(),
        transport=TransportOptions(method=method, neighbors=options.neighbors),
        fill=1.0 if options.fill is None else options.fill,
    )
