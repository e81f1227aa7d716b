"""What a user may choose about a bake."""

import os
from dataclasses import asdict, dataclass, field, fields, replace
from math import inf
from pathlib import Path
from typing import Any, Literal, Self, get_args, get_origin, get_type_hints

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


MAX_COORDINATE = 1e12  # beyond is no place of a plant
MAX_UNIT_LENGTH = 100  # characters


def option(default: Any, help: str, **settings: Any) -> Any:
    """A field that is an option of `bake`.

    `settings` are typer's, which may bound it by `min` and `max`; or it must be `positive`.
    """
    return field(default=default, metadata={"help": help, **settings})


def parse_root(text: str) -> tuple[float, float, float] | Literal["virtual"]:
    """What `--root` says. Raises InputError where that is neither a place nor "virtual"."""
    if text == "virtual":
        return "virtual"
    try:
        x, y, z = (float(part) for part in text.split(","))
    except ValueError:
        raise InputError(
            f'--root is "{text}"; three numbers, like 0,0,-12.5, or virtual is needed.'
        ) from None
    return x, y, z


@dataclass(frozen=True)
class Options:
    """What may be chosen about a bake, with its defaults, in the words of `bake --help`.

    Fields that do not change the clip (`workers`) stay out of its provenance.
    """

    align: Align = option("auto", "Bring scans into one frame; auto leaves those that share one.")
    labels: Labels = option("auto", "Do labels name the same organs in all scans?")
    segment: Segment = option(
        "auto",
        "auto takes labels where there are any, else organs: stem, blades and branches; thin cuts "
        "at forks.",
    )
    up: Up = option("auto", "The axis along which the plant grows.")
    root: tuple[float, float, float] | Literal["virtual"] | None = option(
        None, "The stem's base, or virtual: no label is a stem.", parser=parse_root, metavar="X,Y,Z"
    )
    times: Path | None = option(None, "Lines of: scan's name, day or date.", metavar="FILE")
    label_field: str | None = option(None, "The field that holds the labels.", metavar="NAME")
    drop_label: str = option("", "Leave out the points of label L; of more: L,M.", metavar="L")
    columns: str = option("", "What a text's columns are, as x,y,z,r,g,b,-,label.", metavar="NAMES")
    scale: float = option(1.0, "Multiply all coordinates by this.", metavar="FACTOR", positive=True)
    ground: Ground = option("auto", "Soil or table under the plant: taken out (auto), or kept.")
    voxel: float | None = option(
        None, "Keep one point per organ and cube of this size.", metavar="SIZE", positive=True
    )
    outliers: float | None = option(
        None, "Drop points R standard deviations too far off; try 2.", metavar="R", positive=True
    )
    resample: int | None = option(
        None, "Keep about N points of a scan, evenly spread.", metavar="N", min=10
    )
    every: int = option(1, "Use only each N-th scan.", metavar="N", min=1)
    transport: Transport = option("auto", "How transport is solved; whole: without any segments.")
    neighbors: int = option(15, "Neighbours in the transport's support (k).", metavar="K", min=1)
    gamma: float = option(
        0.3, "Sinkhorn's regularisation, in median costs.", metavar="SHARE", positive=True
    )
    tolerance: float = option(
        1e-3, "Sinkhorn stops at this error of the marginals.", metavar="ERROR", positive=True
    )
    iterations: int = option(2000, "Sinkhorn's, at most.", metavar="N", min=1)
    graph_neighbors: int = option(
        15, "Neighbours in the graph of segment thin (k).", metavar="K", min=1
    )
    bifurcation: int | None = option(
        None, "A branch longer than N edges makes a fork (segment thin).", metavar="N", min=0
    )
    paper: bool = option(False, "Choose as Golla et al. (2020) do, throughout.")
    holdout: int | None = option(
        None, "Leave every Nth scan out, but the ends, and compare the film.", metavar="N", min=2
    )
    bud: int | None = option(
        None, "Points a new organ unfolds from; 1 % of what it grows on.", metavar="L", min=1
    )
    even: float | None = option(
        None, "Movers to add at most, a share of all; usually 1.", metavar="SHARE", min=0, max=10
    )
    smooth: bool = option(False, "Steady organs that sway; scans are then not met exactly.")
    decay: Decay = option("fall", "What organs do that a later scan no longer has.")
    paths: Paths = option("auto", "How points travel: straight, or curved as organs bend (usual).")
    colors: Colors = option(
        "scan", "Colours to carry: the scans' own, one for each scan's segments, or none."
    )
    precision: Precision = option(
        "auto", "auto stores 16 bits a coordinate where that is fine enough."
    )
    unit: str = option("", "The scans' length unit, e.g. mm.")
    workers: int = option(0, "Cores to use; 0 takes all.", metavar="N", min=0)

    def __post_init__(self) -> None:
        """Raises InputError naming the field, what was found and what is allowed."""
        kinds = get_type_hints(Options)
        for one in fields(Options):
            value, allowed = getattr(self, one.name), get_args(kinds[one.name])
            least, most = one.metadata.get("min", -inf), one.metadata.get("max", inf)
            needed = ""
            if get_origin(kinds[one.name]) is Literal and value not in allowed:
                needed = f"one of {', '.join(allowed)}"
            elif one.metadata.get("positive") and value is not None and not 0 < value < inf:
                needed = "a number above 0"
            elif (least, most) != (-inf, inf) and value is not None and not least <= value <= most:
                needed = f"at least {least}" if most == inf else f"from {least} to {most}"
            if needed:
                raise InputError(f"{one.name} is {value}; {needed} is needed.")
        if isinstance(self.root, tuple) and not max(map(abs, self.root)) <= MAX_COORDINATE:
            raise InputError(
                f"--root is {','.join(f'{axis:g}' for axis in self.root)}; numbers from "
                f"{-MAX_COORDINATE:g} to {MAX_COORDINATE:g} are allowed."
            )
        if len(self.unit) > MAX_UNIT_LENGTH:
            raise InputError(
                f"--unit has {len(self.unit)} characters; at most {MAX_UNIT_LENGTH} are allowed."
            )
        named = [name for name in self.columns.split(",") if name not in ("-", "_", "")]
        if named and (len(set(named)) < len(named) or not {"x", "y", "z"} <= set(named)):
            raise InputError(
                f"--columns is {self.columns}; x, y, z and other names, each once, are needed, and "
                "- for a column that is not used."
            )

    @property
    def whole(self) -> bool:
        """Whether the cloud is transported as one, without segments (the paper's Figure 3)."""
        return self.transport == "whole"

    def for_series(
        self,
        fixed_frame: bool,
        unit: str,
        root: tuple[float, float, float] | Literal["virtual"] | None,
    ) -> Self:
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

    def resolved(self) -> Self:
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
