"""Everything that the player does with a clip between opening it and handing it to the GPU."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from unittest.mock import Mock

import numpy as np

from gclip import Clip
from gclip.evaluate import frame_at, layers_at

ASPECT = 16 / 9


def days_of(clip: Clip) -> list[float]:
    """The ends, the scans, moments around them, and what lies outside."""
    first, last = clip.times[0], clip.times[-1]
    middles = [(a + b) / 2 for a, b in zip(clip.times[:3], clip.times[1:4], strict=False)]
    return [*clip.times[:3], *middles, last, last + 1.0, first - 1e18]


def evaluated(clip: Clip) -> None:
    """Positions are numbers, ids are known, at every time."""
    for day in days_of(clip):
        frame = frame_at(clip, day)
        for part in (frame, frame.litter):
            if part is not None and len(part):
                assert np.isfinite(part.positions).all()
                assert int(part.tracks.max()) < len(clip.track_table)
                assert len(part.positions) == len(part.colors) == len(part.tracks)
    low, high = clip.bounds
    assert (low <= high).all()


def told(clip: Clip, path: Path) -> None:
    """`--info`."""
    from player.info import info_lines

    assert len(list(info_lines(clip, path))) > 10


def loaded(clip: Clip) -> None:
    """What the window needs before its first picture."""

    from player.rendering.point_buffers import PointBuffers, bytes_per_point, full_ranges
    from player.rendering.splat_radius import ClosingDistances
    from player.ui.timeline import Line, fitting_labels
    from player.view.camera import Camera
    from player.view.camera_animation import CameraPath
    from player.view.colors import Colors
    from player.view.playback import Timeline
    from player.view.style import Style
    from player.window.viewports import home_camera
    from traits.dates import date_at, elapsed, short_dates

    dates = [scan.date for scan in clip.scans]
    home = Camera.home(clip, ASPECT)
    for camera in (home, Camera.home(clip, 0.5, turning=True), home_camera(clip, (1280.0, 720.0))):
        assert np.isfinite(camera.matrix(ASPECT)).all()
        assert np.isfinite(camera.zoom(1e9).orbit(1.0, 1.0).pan(0.1, 0.1).matrix(ASPECT)).all()
    closing, buffers = ClosingDistances(clip), PointBuffers(Mock(info={}), clip, 0)
    for day in days_of(clip):
        assert np.isfinite(closing.at(day))
        assert date_at(clip.scans, day) is not None
        elapsed(clip.scans, day, clip.time_unit)
        for drawn in full_ranges(layers_at(clip, day)):
            list(buffers.chunks(drawn))
        CameraPath().with_key(day, home)
    for name in ("scan", "track", "age", "speed", "height"):
        colors, style = Colors(clip), Style(color_by=name)
        assert np.isfinite(colors.palette(days_of(clip)[1], style)).all()
        if scale := colors.value_range(style):
            assert np.isfinite([scale.low, scale.high]).all()
            assert all(np.isfinite(value).all() for value in scale.uniforms.values())
    assert all(bytes_per_point(interval) > 0 for interval in clip.intervals)
    timeline = Timeline.of(clip.times).played().tick(0.1)
    assert np.isfinite(timeline.day)
    line = Line(50.0, 1100.0, 650.0, tuple(clip.times))
    for texts in (dates, short_dates(dates)):
        fitting_labels(line, texts, (8.0, 1270.0), len)


def exported(clip: Clip, suffix: str) -> None:
    """Exports that need no GPU: whole, or refused in one sentence."""
    from player.export import Film, export

    with tempfile.TemporaryDirectory() as folder:
        export(clip, Film(seconds=0.1, fps=10), Path(folder, f"plant{suffix}"))


EXPORTS = (".html", ".ply", ".glb", ".usda", ".csv")
USES: dict[str, Callable[[Clip, Path], None]] = {
    "evaluated": lambda clip, path: evaluated(clip),
    "told": told,
    "loaded": lambda clip, path: loaded(clip),
    **{suffix: lambda clip, path, s=suffix: exported(clip, s) for suffix in EXPORTS},  # type: ignore[misc]
}


def drawn(clip: Clip, path: Path) -> None:
    """A small picture, without an error that OpenGL would report."""
    from player.rendering.headless import Offscreen

    with Offscreen(clip, (48, 36), supersample=1) as offscreen:
        for day in (clip.times[0], clip.times[-1]):
            offscreen.picture(day)
        assert offscreen.context.error == "GL_NO_ERROR"


def overlaid(clip: Clip, path: Path) -> None:
    """What lies over the plant in the window: names and dates as a clip has them."""
    from player.gl.context import headless
    from tests.player.desk import Desk, scene_of

    context = headless()
    name = clip.track_table[0].name
    for day, notice in ((clip.times[0], name), (clip.times[-1], "")):
        scene = scene_of(clip, day, color_by="track", picked=0).with_notice(notice)
        for shown in (scene, replace(scene, panel=True)):
            desk = Desk(context, clip, shown, name=path.name)
            desk.point((450.0, 570.0))
            desk.release()
    context.release()
