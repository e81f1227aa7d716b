"""Small clips made by hand."""

from collections.abc import Callable

import numpy as np
import pytest

from baker.interpolation.packing import Movers, pack_interval
from gclip import Clip, Motion, ScanMark, Track

ClipMaker = Callable[..., Clip]


@pytest.fixture
def make_clip() -> ClipMaker:
    """Three scans of a random cloud of two organs; the second interval begins with a loss."""

    def make(
        degree: int = 1,
        colors: bool = False,
        precision: str = "auto",
        lost: Motion = Motion.FALL,
        origin: tuple[float, float, float] = (0.0, 0.0, 0.0),
    ) -> Clip:
        rng = np.random.default_rng(7)
        scans = [rng.random((300, 3)) * 100 for _ in range(3)]
        tracks = np.repeat([0, 1], 150)

        def movers(start: np.ndarray, end: np.ndarray, motion: Motion, ids: np.ndarray) -> Movers:
            controls = [rng.random(start.shape) * 100 for _ in range(degree - 1)]
            paint = [rng.integers(0, 256, (len(start), 4), np.uint8) for _ in range(2)]
            start_colors, end_colors = paint if colors else (None, None)
            return Movers(motion, (start, *controls, end), ids, start_colors, end_colors)

        first = [movers(scans[0], scans[1], Motion.MOVE, tracks)]
        stays, goes = slice(0, 150), slice(150, 300)
        floor = scans[1][goes] * [1, 1, 0]
        second = [
            movers(scans[1][stays], scans[2][stays], Motion.MOVE, tracks[stays]),
            movers(scans[1][goes], floor, lost, tracks[goes]),
        ]
        return Clip(
            scans=(
                ScanMark("a.ply", 0.0, "day 0", 300),
                ScanMark("b.ply", 2.0, "day 2", 300),
                ScanMark("c.ply", 5.0, "day 5", 150),
            ),
            intervals=(
                pack_interval(0.0, 2.0, first, spacing=5.0, precision=precision),
                pack_interval(2.0, 5.0, second, spacing=5.0, precision=precision),
            ),
            track_table=(
                Track(0, "stem", (150, 124, 92), kind="root"),
                Track(1, "leaf", (63, 144, 218), parent=0, lost=5.0),
            ),
            origin=origin,
            spacing=5.0,
            provenance={"notes": ["made by hand"]},
        )

    return make
