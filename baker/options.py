"""The options of a bake."""

from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from math import inf
from pathlib import Path
from typing import Any, Literal, Self, get_args, get_origin, get_type_hints

from msgspec import to_builtins

from baker.errors import InputError, excerpt, input_errors
from corrections import Correction, Corrections, read_corrections

MAX_COORDINATE = 1e12  # of the plant base, in the unit of the scans
DEFAULTS = {"segment": "organs", "paths": "curved"}  # of options that are "auto"; see `resolved`
PAPER_DEFAULTS = {"align": "icp", "segment": "thin", "transport": "sinkhorn", "paths": "straight"}

Check = tuple[Callable[[Any], Any], str]
"""A predicate of allowed values, and the words for them in the error message."""

Root = tuple[float, float, float] | Literal["virtual"] | None

POSITIVE: Check = (lambda number: 0 < number < inf, "a number above 0")
NAMES: Check = (lambda text: not text or text.strip(", "), "a name")
SHORT: Check = (lambda text: len(text) <= 100, "one of at most 100 characters")


def option(default: Any, help: str, check: Check | None = None, **settings: Any) -> Any:
    """Declare a dataclass field that is an option of `bake`.

    help: the text of `bake --help`. check: of the value; by default all values are allowed or, with
    `min` and `max`, all numbers in that range. settings: arguments of `typer.Option`.
    """
    if "min" in settings:
        low, high = settings["min"], settings.get("max", inf)
        needed = f"at least {low}" if high == inf else f"from {low} to {high}"
        check = (lambda number: low <= number <= high), needed
        settings = {"metavar": "N"} | settings
    return field(default=default, metadata={"check": check, "settings": {"help": help, **settings}})


def positive(default: float | None, metavar: str, help: str) -> Any:
    """Declare an option that is a number above 0."""
    return option(default, help, POSITIVE, metavar=metavar)


def _is_root(root: Any) -> bool:
    is_position = isinstance(root, tuple) and len(root) == 3
    return root == "virtual" or (is_position and all(abs(x) <= MAX_COORDINATE for x in root))


def _are_columns(text: str) -> bool:
    named = [name for name in text.split(",") if name not in ("-", "_", "")]
    return not text or (len(set(named)) == len(named) and {"x", "y", "z"} <= set(named))


def parse_root(text: str) -> tuple[float, ...] | str:
    """Parse the argument of --root: coordinates, or a word, which `Options` then checks."""
    try:
        return tuple(float(part) for part in text.split(","))
    except ValueError:
        return text


def parse_corrections(text: str) -> Corrections:
    """Read the file that --corrections names, or raise InputError; "none" stands for no file."""
    with input_errors(Path(text)):
        return Corrections() if text == "none" else read_corrections(Path(text))


@dataclass(frozen=True)
class Options:
    """The options of a bake and their defaults, with the texts of `bake --help`."""

    align: Literal["auto", "turn", "icp", "none"] = option(
        "auto",
        "Bring the scans into one frame: auto leaves those that share one; turn turns each about "
        "the vertical, onto the one before; icp aligns as the paper does; none moves no scan.",
    )
    labels: Literal["auto", "consistent", "independent", "ignore"] = option(
        "auto",
        "What the labels mean: consistent, an organ has the same one in all scans; independent, "
        "organs are numbered anew in each scan; ignore finds organs without them.",
    )
    segment: Literal["auto", "organs", "thin"] = option(
        "auto",
        "How organs are found: auto takes the labels where there are any; organs finds stem, "
        "leaves and branches; thin cuts at forks, as the paper does.",
    )
    up: Literal["auto", "x", "y", "z", "-x", "-y", "-z"] = option(
        "auto", "The axis along which the plant grows up."
    )
    root: Root = option(
        None,
        "Where the stem leaves the ground, as coordinates; or virtual if no organ is a stem.",
        (_is_root, "a place, like 0,0,-12.5, or virtual"),
        parser=parse_root,
        metavar="X,Y,Z",
    )
    times: Path | None = option(
        None,
        "A text file of the scans' days: on each line a scan's name and its day or date.",
        metavar="FILE",
    )
    label_field: str | None = option(
        None, "The column or field of the scans that holds the labels of organs.", metavar="NAME"
    )
    drop_label: str = option(
        "", "Leave out points with label L, such as a pot's; with several: L,M.", NAMES, metavar="L"
    )
    columns: str = option(
        "",
        "The columns of scans that are text, such as x,y,z,r,g,b,-,label; - skips one.",
        (_are_columns, "each of x, y, z and other names once, - for a column that is not used,"),
        metavar="NAMES",
    )
    fields: str = option(
        "", "Scalar fields to add to the clip, such as ndvi,temperature.", NAMES, metavar="NAMES"
    )
    corrections: tuple[Correction, ...] | None = option(
        None,
        "A file of corrections to organs, which the window of `play` writes; by default "
        "OUT.corrections.toml if there is one; none ignores it.",
        parser=parse_corrections,
        metavar="FILE",
    )
    scale: float = positive(1.0, "FACTOR", "Multiply all coordinates by this.")
    ground: Literal["auto", "keep"] = option(
        "auto", "Soil or a table under the plant: auto removes it, keep leaves it."
    )
    voxel: float | None = positive(
        None, "SIZE", "Thin the scans to one point of each organ in each cube of this edge length."
    )
    outliers: float | None = positive(
        None, "R", "Remove points whose neighbours are R standard deviations too far away; try 2."
    )
    resample: int | None = option(
        None, "Thin the scans to about N points each, evenly spread.", min=10
    )
    every: int = option(1, "Use every N-th scan only.", min=1)
    transport: Literal["auto", "exact", "sinkhorn", "whole"] = option(
        "auto",
        "How points are paired within organs: exact, at the least cost; sinkhorn, nearly so, as in "
        "the paper; whole, exactly, but over the whole plant at once. auto is exact.",
    )
    neighbors: int = option(
        15, "For --transport sinkhorn: nearest points that each may be paired with.", min=1
    )
    gamma: float = positive(
        0.3, "SHARE", "For --transport sinkhorn: its regularisation, as a share of the median cost."
    )
    tolerance: float = positive(
        1e-3, "ERROR", "For --transport sinkhorn: it stops below this share of misplaced mass."
    )
    iterations: int = option(2000, "For --transport sinkhorn: the most iterations.", min=1)
    graph_neighbors: int = option(
        15, "For --segment thin: the neighbours that each point is linked with.", min=1
    )
    bifurcation: int | None = option(
        None, "For --segment thin: a branch longer than N links begins a new segment.", min=0
    )
    paper: bool = option(False, "Use the methods of Golla et al. (2020) throughout.")
    holdout: int | None = option(
        None, "Leave every N-th scan out, and measure how far the film is from it.", min=2
    )
    bud: int | None = option(
        None, "Points of the parent that a new organ unfolds from; usually 1 % of them.", min=1
    )
    even: float | None = option(
        None,
        "Add points where organs grow, so that none gets sparse: at most this share of the points, "
        "usually 1.",
        metavar="SHARE",
        min=0,
        max=10,
    )
    smooth: bool = option(
        False, "Calm organs that sway; the film then passes near the scans, not through them."
    )
    decay: Literal["fall", "fade", "remove"] = option(
        "fall", "What an organ does that is not in the next scan."
    )
    paths: Literal["auto", "straight", "curved"] = option(
        "auto", "How points travel: straight, or curved as organs bend."
    )
    colors: Literal["scan", "segment", "none"] = option(
        "scan", "Colours of the points: scan, the scans' own; segment, one for each organ; or none."
    )
    precision: Literal["auto", "float32"] = option(
        "auto", "How the clip stores coordinates: auto in 16 bits where that is fine enough."
    )
    unit: str = option("", "The scans' unit of length, such as mm.", SHORT, metavar="UNIT")
    workers: int = option(0, "How many cores to use; 0 takes all.", min=0)

    def __post_init__(self) -> None:
        """Raise InputError for a wrong value, naming the option and what is allowed."""
        hints = get_type_hints(Options)
        for option_field in fields(Options):
            value, choices = getattr(self, option_field.name), get_args(hints[option_field.name])
            check = option_field.metadata["check"]
            if get_origin(hints[option_field.name]) is Literal:
                check = choices.__contains__, f"one of {', '.join(choices)}"
            if check and value is not None and not check[0](value):
                shown = excerpt(f"{value:g}" if isinstance(value, float) else str(value))
                name = option_field.name.replace("_", "-")
                raise InputError(f"--{name} is {shown}; {check[1]} is needed.")
        if self.corrections and (self.paper or self.whole or self.segment == "thin"):
            raise InputError(
                "Corrections are of organs that are followed, not for --paper, --segment thin or "
                "--transport whole; --corrections none bakes without them."
            )

    @property
    def whole(self) -> bool:
        """Whether the plant is transported as a whole, without segments (the paper's Figure 3)."""
        return self.transport == "whole"

    def for_series(self, fixed_frame: bool, unit: str, root: Root) -> Self:
        """Fill in the options that the user left open and that the series determines.

        fixed_frame: whether the scans are from a fixed camera: they share one frame with z up.
        unit: of length, "" where unknown. root: "virtual" if no label is the stem of the others.
        """
        return replace(
            self,
            align="none" if fixed_frame and self.align == "auto" else self.align,
            up="z" if fixed_frame and self.up == "auto" else self.up,
            unit=self.unit or unit,
            root=root if self.root is None else self.root,
        )

    def resolved(self) -> Self:
        """Replace "auto" by the default of this program or, with --paper, by that of the paper."""
        defaults = PAPER_DEFAULTS if self.paper else DEFAULTS
        chosen: dict[str, Any] = {k: v for k, v in defaults.items() if getattr(self, k) == "auto"}
        if self.whole or self.segment != "auto":
            chosen["labels"] = "ignore"
        if self.even is None:  # added movers follow curved paths next to those of others
            is_curved = chosen.get("paths", self.paths) == "curved"
            chosen["even"] = 1.0 if is_curved and not self.paper else 0.0
        return replace(self, **chosen)

    def provenance(self) -> dict[str, Any]:
        """The options that influence the clip, as JSON; files are named without their folders."""
        complete = replace(self, corrections=tuple(self.corrections or ()))
        document: dict[str, Any] = to_builtins(complete, enc_hook=lambda path: path.name)
        del document["workers"]
        return document


def parse_folder(text: str) -> Path:
    """Parse the argument of --cache."""
    if not text:  # an empty shell variable, which would mean the working directory
        raise InputError("--cache has no name of a folder.")
    return Path(text)


@dataclass(frozen=True)
class Outputs:
    """What to write, and how; the fields other than `clip` are options of `bake`."""

    clip: Path  # the file; of many plants the folder of their clips
    report: Path | None = option(
        None, "Write a report with pictures; of many plants, a folder of them.", metavar="OUT.html"
    )
    traits: Path | None = option(
        None, "Write a table of lengths, areas, angles and growth.", metavar="OUT.csv"
    )
    cluster: str | None = option(
        None,
        "Bake many plants on many machines: the address of a dask scheduler.",
        metavar="ADDRESS",
    )
    cache: Path | None = option(
        None, "Keep finished work there for later bakes.", parser=parse_folder, metavar="DIR"
    )
    force: bool = option(False, "Overwrite what exists; of many plants, bake all again.")
    quiet: bool = option(False, "Say nothing but errors.", short=["-q"])
    verbose: bool = option(False, "Say what was found in each scan.", short=["-v"])
