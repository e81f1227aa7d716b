"""Data classes of the scans of one plant, and of what was found out about them."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray

TOPICS = ("order", "days", "points", "unit", "ground", "up", "frame", "plant", "labels", "organs")


@dataclass(frozen=True)
class Finding:
    """One decision about a whole series, which `bake --list` prints as a line."""

    topic: str  # one of TOPICS, in whose order findings are printed
    found: str  # what was decided and by which rule: "z, as scans usually have it"
    doubt: str = ""  # what speaks against it, a clause without a full stop
    option: str = ""  # the option that overrides it, such as "--up y"; "" if there is none

    @property
    def remark(self) -> str:
        """The doubt and the option that settles it; "" where nothing is in doubt."""
        remedy = f"; to change it, use {self.option}" if self.doubt and self.option else ""
        return self.doubt + remedy

    @property
    def sentence(self) -> str:
        """The finding as a line of text."""
        doubt = f" Look at this: {self.remark}." if self.doubt else ""
        return f"{self.topic}: {self.found}.{doubt}"


@dataclass(frozen=True)
class Scan:
    """One point cloud of N points with a time.

    Its positions are float64 world coordinates as read from the file; in a `Series`, they are
    float32 and relative to `origin`.
    """

    points: NDArray  # (N, 3) positions in the unit of the scan
    labels: NDArray[np.int64] | None = None  # (N,) organ of each point
    colors: NDArray[np.uint8] | None = None  # (N, 3) sRGB
    notes: tuple[str, ...] = ()  # sentences of reading and cleaning (dropped points, fields used)
    fields: dict[str, NDArray] = field(default_factory=dict)  # (N,) each; they may be labels
    scalars: dict[str, NDArray[np.float32]] = field(default_factory=dict)  # (N,) each, for the clip
    path: Path = Path()  # of the file
    name: str = ""  # of the file, after that of its folder where two files have the same name
    time: float = 0.0  # days: the number in the name or, of dates, since the first scan
    date: str = ""  # the time as text: "2020-03-08", "day 5", "2"
    origin: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))  # (3,) in the world
    sha256: str = ""  # digest of all files of the scan (of images: colour, depth and labels)

    def __len__(self) -> int:
        return len(self.points)

    def take(self, chosen: NDArray) -> Self:
        """Select points, with all their attributes, by an index array or a mask."""
        return replace(
            self,
            points=self.points[chosen],
            labels=None if self.labels is None else self.labels[chosen],
            colors=None if self.colors is None else self.colors[chosen],
            fields={name: values[chosen] for name, values in self.fields.items()},
            scalars={name: values[chosen] for name, values in self.scalars.items()},
        )

    def noting(self, sentence: str) -> Self:
        """The scan with one more note."""
        return replace(self, notes=(*self.notes, sentence))


@dataclass(frozen=True)
class Series:
    """At least two scans of one plant in the order of time."""

    scans: tuple[Scan, ...]  # with one `origin`, unless their coordinates are far apart
    unit: str = "days"  # of times; "scans" where only their order is known
    fixed: bool = False  # from a fixed camera: they share one frame with z up, and stay in it
    root: Literal["virtual"] | None = None  # where no label is the stem of others (section 3.2.1)
    length: str = ""  # the unit of lengths, "" where unknown
    label_field: str = ""  # from which labels were read, "" without labels
    label_words: dict[int, str] = field(default_factory=dict)  # by label, where fields hold words
    findings: tuple[Finding, ...] = ()  # about reading the series
    ground_up: str = ""  # the direction away from the ground, such as "z"; "" without a ground
