"""A graphics context, tiny clips made by hand, and an open window."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import moderngl
import numpy as np
import pytest

from baker.interpolation.packing import Movers, pack_interval
from gclip import Clip, Motion, ScanMark, Track
from player.gl.context import headless
from tests.player.shown import SIZE, Shown, small_clip

ClipMaker = Callable[..., Clip]
STEM, LEAF = (140, 170, 70), (60, 130, 220)


@pytest.fixture(autouse=True)
def no_gl_errors(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """OpenGL goes on after an error. So each context is asked for one before it is given back."""
    errors: list[str] = []
    release = moderngl.Context.release

    def asked(context: moderngl.Context) -> None:
        if hasattr(context.mglo, "error"):  # not released yet
            errors.append(context.mglo.error)  # what a test may have put before it counts not
        release(context)

    monkeypatch.setattr(moderngl.Context, "release", asked)
    yield
    assert set(errors) <= {"GL_NO_ERROR"}


@pytest.fixture
def context() -> Iterator[moderngl.Context]:
    """A context of its own for each test, as each player has one; it costs a few milliseconds."""
    made = headless()
    yield made
    made.release()


@pytest.fixture
def compute_context(context: moderngl.Context) -> moderngl.Context:
    if context.version_code < 430:
        pytest.skip("compute shaders need OpenGL 4.3")
    return context


def sheet(side: int = 40) -> np.ndarray:
    """(side², 3) an upright sheet, 40 wide and 40 high, that faces the eye at yaw -90 degrees."""
    across, above = np.meshgrid(np.linspace(-20, 20, side), np.linspace(0, 40, side))
    return np.column_stack([across.ravel(), np.zeros(side**2), above.ravel()])


@pytest.fixture
def make_clip() -> ClipMaker:
    """Three scans: a sheet that widens, then its right half is lost while the left one moves on."""

    def make(
        degree: int = 1,
        precision: str = "auto",
        lost: Motion = Motion.FALL,
        colors: tuple[Sequence[int], Sequence[int]] | None = None,
        up: str = "z",
    ) -> Clip:
        random = np.random.default_rng(3)
        first = sheet()
        second = first * [1.3, 1.0, 1.2] + [0.0, 5.0, 0.0]
        stays = second[:, 0] < 0.0
        tracks = np.where(stays, 0, 1)
        last = second[stays] + [-4.0, 3.0, 6.0]
        fallen = second[~stays] * [1, 1, 0] if lost is Motion.FALL else second[~stays]

        def movers(start: np.ndarray, end: np.ndarray, ids: np.ndarray, motion: Motion) -> Movers:
            controls = [
                start + (end - start) * (i + 1) / degree + random.normal(0, 2, 3)
                for i in range(degree - 1)
            ]
            paint = (None, None)
            if colors is not None:
                paint = tuple(np.tile(np.array(c, np.uint8), (len(start), 1)) for c in colors)
            return Movers(motion, (start, *controls, end), ids, *paint)

        intervals = [
            [movers(first, second, tracks, Motion.MOVE)],
            [
                movers(second[stays], last, tracks[stays], Motion.MOVE),
                movers(second[~stays], fallen, tracks[~stays], lost),
            ],
        ]
        names = [("a.ply", 0.0, first), ("b.ply", 2.0, second), ("c.ply", 5.0, last)]
        return Clip(
            scans=tuple(ScanMark(n, t, f"day {t:g}", len(p)) for n, t, p in names),
            intervals=tuple(
                pack_interval(start, end, m, spacing=1.0, precision=precision)
                for (start, end), m in zip([(0.0, 2.0), (2.0, 5.0)], intervals, strict=True)
            ),
            track_table=(
                Track(0, "stem", STEM, kind="root"),
                Track(1, "leaf [bold]x[/bold]", LEAF, parent=0, lost=5.0),
            ),
            up=up,
            unit="mm",
            spacing=1.0,
            provenance={"notes": ["made by hand"], "options": {"up": "z", "root": None}},
        )

    return make


@pytest.fixture(scope="module")
def clip_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("clip") / "plant.gclip"
    small_clip().save(path)
    return path


@pytest.fixture(scope="module")
def opened(display: dict[str, str], clip_file: Path) -> Iterator[Shown]:
    shown = Shown(display, clip_file, SIZE)
    yield shown
    shown.end()


@pytest.fixture
def shown(opened: Shown) -> Shown:
    """The open window, paused at the first scan, seen from home, the mouse on the plant."""
    opened.point(320, 200)
    if opened.states[-1]["help"]:
        opened.key("h")
    if opened.states[-1]["playing"]:
        opened.key("space")
        opened.until(lambda state: not state["playing"])
    opened.key("Home", "f")
    opened.until(lambda state: state["day"] == 0.0 and state["at_home"])
    return opened
