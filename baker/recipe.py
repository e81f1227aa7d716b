"""Two recipes for what the options leave open: our own, and the paper's (`--paper`)."""

from __future__ import annotations

from dataclasses import dataclass

from baker.matching.hierarchical import PAPER, GreedyRules
from baker.options import Options, Paths
from baker.transport.problem import TransportOptions
from baker.transport.tasks import MIN_ATTACHMENT_POINTS


@dataclass(frozen=True)
class Recipe:
    """The choices of docs/method.md's table, resolved.

    align:           how scans are brought together: auto, icp or none.
    whole:           no segments, one transport problem for the whole cloud (Figure 3).
    segment:         how scans without labels are segmented: whole, thin or organs.
    match_by_shape:  organs numbered anew are matched all at once; else down the hierarchies.
    rules:           of matching down the hierarchies.
    transport:       of each pair of segments.
    leaflets:        an organ's leaflets are matched and moved one by one.
    even:            movers to add at most where they would be sparse, as a share of all.
    paths:           how movers travel: straight or curved.
    min_attachment_points: that a new organ grows from.
    """

    align: str
    whole: bool
    segment: str
    match_by_shape: bool
    rules: GreedyRules
    transport: TransportOptions
    leaflets: bool
    even: float
    paths: str
    min_attachment_points: int


def recipe_for(options: Options) -> Recipe:
    """What to do under these options; `options.paper` turns "auto" into the paper's own way."""
    whole = options.transport == "whole"
    method = "auto" if whole else options.transport
    if options.paper:
        return Recipe(
            align="icp" if options.align == "auto" else options.align,
            whole=whole,
            segment=_segmentation(whole, options.segment, "thin"),
            match_by_shape=False,
            rules=PAPER,
            transport=TransportOptions(
                method="sinkhorn" if method == "auto" else method,
                power=1,
                neighbors=options.neighbors,
                feasible=False,
            ),
            leaflets=False,
            even=options.even or 0.0,
            paths=Paths.straight if options.paths == Paths.auto else options.paths,
            min_attachment_points=10,
        )
    paths = Paths.curved if options.paths == Paths.auto else options.paths
    usual = 0.0 if paths == Paths.straight else 1.0  # what is added travels on curves
    return Recipe(
        align=options.align,
        whole=whole,
        segment=_segmentation(whole, options.segment, "organs"),
        match_by_shape=True,
        rules=GreedyRules(),
        transport=TransportOptions(method=method, neighbors=options.neighbors),
        leaflets=method != "sinkhorn",
        even=usual if options.even is None else options.even,
        paths=paths,
        min_attachment_points=MIN_ATTACHMENT_POINTS,
    )


def _segmentation(whole: bool, requested: str, usual: str) -> str:
    """How scans without labels are segmented."""
    return "whole" if whole else usual if requested == "auto" else requested
