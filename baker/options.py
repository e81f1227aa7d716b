"""What a user may choose about a bake."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal


@dataclass(frozen=True)
class Options:
    """The options of `bake`, with its defaults; see `bake --help` for what they mean.

    Fields that do not change the clip (`workers`) stay out of its provenance.
    """

    align: str = "auto"
    labels: str = "auto"
    segment: str = "auto"
    up: str = "auto"
    root: tuple[float, float, float] | Literal["virtual"] | None = None
    times: Path | None = None
    label_field: str | None = None
    voxel: float | None = None
    outliers: float | None = None
    every: int = 1
    transport: str = "auto"
    neighbors: int = 15
    graph_neighbors: int = 15
    bifurcation: int | None = None
    paper: bool = False
    holdout: int | None = None
    bud: int | None = None
    decay: str = "fall"
    colors: str = "scan"
    precision: str = "auto"
    unit: str = ""
    workers: int = 0

    def provenance(self) -> dict[str, Any]:
        """The options that shape the clip, as JSON; paths only by name."""
        chosen = asdict(self)
        del chosen["workers"]
        chosen["times"] = None if self.times is None else self.times.name
        chosen["root"] = list(self.root) if isinstance(self.root, tuple) else self.root
        return chosen
