"""What a user may choose about a bake."""

from __future__ import annotations

import os
from dataclasses import asdict, dataclass, replace
from math import inf
from pathlib import Path
from typing import Any, Literal, get_args, get_origin, get_type_hints

from baker.errors import InputError

Align = Literal["auto", "turn", "icp", "none"]
Labels = Literal["auto", "consistent", "independent", "ignore"]
Segment = Literal["auto", "organs", "thin"]
Up = Literal["auto", "x", "y", "z", "-x", "-y", "-z"]
Transport = Literal["auto", "exact", "sinkhorn", "whole"]
Decay = Literal["fall", "fade", "remove"]
Paths = Literal["auto", "straight", "curved"]
Colors = Literal["scan", "segment", "none"]
Ground = Literal["auto", "keep"]
Precision = Literal["auto", "float32"]


def worker_count(requested: int) -> int:
    """`requested` cores, or where that is 0 as many as this process may use."""
    if requested:
        return requested
    # Not every system can tie a process to some of its cores.
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


FARTHEST = 1e12  # coordinates beyond are no place of a plant
LONGEST_UNIT = 100  # characters
LEAST = {
    **dict.fromkeys(("every", "neighbors", "graph_neighbors", "bud"), 1),
    "denoise": 4,
    "resample": 10,
}


@dataclass(frozen=True)
class Options:
    """The options of `bake`, with its defaults; see `bake --help` for what they mean.

    Fields that do not change the clip (`workers`) stay out of its provenance.
    """

    align: Align = "auto"
    labels: Labels = "auto"
    segment: Segment = "auto"
    up: Up = "auto"
    root: tuple[float, float, float] | Literal["virtual"] | None = None
    times: Path | None = None
    label_field: str | None = None
    drop_label: str = ""
    columns: str = ""
    scale: float = 1.0
    ground: Ground = "auto"
    voxel: float | None = None
    outliers: float | None = None
    denoise: int | None = None
    resample: int | None = None
    every: int = 1
    transport: Transport = "auto"
    neighbors: int = 15
    graph_neighbors: int = 15
    bifurcation: int | None = None
    paper: bool = False
    holdout: int | None = None
    bud: int | None = None
    even: float | None = None
    smooth: bool = False
    decay: Decay = "fall"
    paths: Paths = "auto"
    colors: Colors = "scan"
    precision: Precision = "auto"
    unit: str = ""
    workers: int = 0

    def __post_init__(self) -> None:
        """Raises InputError naming the field, what was found and what is allowed."""
        for name, kind in get_type_hints(Options).items():
            value, allowed = getattr(self, name), get_args(kind)
            if get_origin(kind) is Literal and value not in allowed:
                raise InputError(f'{name} is "{value}"; one of {", ".join(allowed)} is allowed.')
        if self.even is not None and not 0 <= self.even <= 10:
            raise InputError(f"even is {self.even}; from 0 to 10 is allowed.")
        if isinstance(self.root, tuple) and not all(abs(axis) <= FARTHEST for axis in self.root):
            raise InputError(
                f"--root is {','.join(f'{axis:g}' for axis in self.root)}; numbers from "
                f"{-FARTHEST:g} to {FARTHEST:g} are allowed."
            )
        if len(self.unit) > LONGEST_UNIT:
            raise InputError(
                f"--unit has {len(self.unit)} characters; at most {LONGEST_UNIT} are allowed."
            )
        named = [name for name in self.columns.split(",") if name not in ("-", "_", "")]
        if named and (len(set(named)) < len(named) or not {"x", "y", "z"} <= set(named)):
            raise InputError(
                f"--columns is {self.columns}; x, y, z and other names, each once, are needed, and "
                "- for a column that is not used."
            )
        for name in ("voxel", "outliers", "scale"):
            value = getattr(self, name)
            if value is not None and not 0 < value < inf:
                raise InputError(f"{name} is {value}; a number above 0 is needed.")
        for name, least in LEAST.items():
            value = getattr(self, name)
            if value is not None and value < least:
                raise InputError(f"{name} is {value}; at least {least} is needed.")

    @property
    def whole(self) -> bool:
        """Whether the cloud is transported as one, without segments (the paper's Figure 3)."""
        return self.transport == "whole"

    def for_series(
        self,
        fixed_frame: bool,
        unit: str,
        root: tuple[float, float, float] | Literal["virtual"] | None,
    ) -> Options:
        """The options, with what a series itself knows where they leave it open.

        Parameters
        ----------
        fixed_frame : bool
            The scans were taken by one camera: they share a frame, and z is up.
        unit, root
            The series' own length unit and plant base, where it has them.
        """
        return replace(
            self,
            align="none" if fixed_frame and self.align == "auto" else self.align,
            up="z" if fixed_frame and self.up == "auto" else self.up,
            unit=self.unit or unit,
            root=root if self.root is None else self.root,
        )

    def resolved(self) -> Options:
        """The options, with "auto" replaced by the paper's choices or by our own (`--paper`)."""
        straight = self.paper if self.paths == "auto" else self.paths == "straight"
        # Additional movers travel beside others on their curves.
        even = 0.0 if self.paper or straight else 1.0
        segment: Segment = "thin" if self.paper else "organs"
        return replace(
            self,
            align="icp" if self.paper and self.align == "auto" else self.align,
            labels="ignore" if self.whole or self.segment != "auto" else self.labels,
            segment=segment if self.segment == "auto" else self.segment,
            transport="sinkhorn" if self.paper and self.transport == "auto" else self.transport,
            paths="straight" if straight else "curved",
            even=even if self.even is None else self.even,
        )

    def provenance(self) -> dict[str, Any]:
        """The options that shape the clip, as JSON; paths only by name."""
        chosen = asdict(self)
        del chosen["workers"]
        chosen["times"] = None if self.times is None else self.times.name
        chosen["root"] = list(self.root) if isinstance(self.root, tuple) else self.root
        return chosen
