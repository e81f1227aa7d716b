"""Data classes of the scans of one plant, and of what was found out about them."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal, Self

import numpy as np
from numpy.typing import NDArray

TOPICS = ("order", "days", "points", "unit", "ground", "up", "frame", "plant", "labels", "organs")


@dataclass(frozen=True)
class Finding:
    """One decision about a whole series, as `bake --list` and the first lines of a bake print it.

    topic:  one of TOPICS, in whose order findings are printed.
    found:  what was decided and by which rule, in a botanist's words: "z, as scans usually have".
    doubt:  what speaks against it, a clause without a full stop; "" where nothing does.
    option: the option that overrides it: "--up y". Given wherever there is a doubt.
    """

    topic: str
    found: str
    doubt: str = ""
    option: str = ""

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
    """One point cloud with a time.

    points:  (N, 3) positions in the unit of the scan: float64 world coordinates as read from the
             file, float32 relative to `origin` in a `Series`.
    labels:  (N,) int64, the organ of each point, or None where the scan has no labels.
    colors:  (N, 3) uint8 sRGB, or None where the scan has no colours.
    notes:   what reading and cleaning found, one sentence each (dropped points, fields used).
    fields:  name -> (N,) numbers or words, the fields of the file that may be labels.
    scalars: name -> (N,) float32, the fields that are carried into the clip.
    path:    the file that it was read from.
    name:    the file's name, preceded by its folder's where two files have the same name.
    time:    days: the number in the name, or days since the first scan where names are dates.
    date:    the time as text: "2020-03-08", "day 5", "2".
    origin:  (3,) float64, the world position of the local coordinates' zero.
    sha256:  digest of all files that the scan was read from (of images: colour, depth and labels).
    """

    points: NDArray
    labels: NDArray[np.int64] | None = None
    colors: NDArray[np.uint8] | None = None
    notes: tuple[str, ...] = ()
    fields: dict[str, NDArray] = field(default_factory=dict)
    scalars: dict[str, NDArray[np.float32]] = field(default_factory=dict)
    path: Path = Path()
    name: str = ""
    time: float = 0.0
    date: str = ""
    origin: NDArray[np.float64] = field(default_factory=lambda: np.zeros(3))
    sha256: str = ""

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
    """At least two scans of one plant in the order of time, with one `origin` unless far apart.

    unit:  "days" where times are known, "scans" where only their order is.
    fixed: whether the scans are from a fixed camera: they share one frame, with z up, and are not
           aligned.
    root:  "virtual" where no label is the stem of the others (section 3.2.1), else None.
    length: the unit of lengths, "" where unknown.
    label_field: the field that labels were read from, "" where there are none.
    label_words: label -> word, where the scans label organs by words.
    findings: what was decided on reading, for the whole series.
    ground_up: the direction away from the ground, such as "z", "" where no ground was found.
    """

    scans: tuple[Scan, ...]
    unit: str = "days"
    fixed: bool = False
    root: Literal["virtual"] | None = None
    length: str = ""
    label_field: str = ""
    label_words: dict[int, str] = field(default_factory=dict)
    findings: tuple[Finding, ...] = ()
    ground_up: str = ""
