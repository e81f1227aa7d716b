"""Growth clips in napari: a plug-in that reads one as points over time."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import gclip

LayerData = tuple[np.ndarray, dict[str, Any], str]

STATES_BETWEEN = 3  # two scans, where these are nearest to each other
MAX_POINTS = 5_000_000  # that napari should show; then there are fewer states


def get_reader(path: str | list[str]) -> Callable[[str | list[str]], list[LayerData]] | None:
    """Napari's hook: the function that reads these files, None where one is no clip."""
    return read if all(Path(one).suffix.lower() == ".gclip" for one in paths(path)) else None


def read(path: str | list[str]) -> list[LayerData]:
    """A layer for each clip. Raises gclip.ClipError, with one sentence, for a damaged one."""
    return [points_over_time(gclip.open(one), Path(one).stem) for one in paths(path)]


def paths(path: str | list[str]) -> list[str]:
    """napari hands over one path, or several to be stacked."""
    return [path] if isinstance(path, str) else path


def points_over_time(clip: gclip.Clip, name: str) -> LayerData:
    """A clip as napari's points, with four axes: time, x, y, z.

    napari shows the points whose time is nearest to a whole step of its slider. So states are a
    step apart, and the one nearest to a scan's time is the scan itself; `day` holds the true time.

    Parameters
    ----------
    clip : gclip.Clip
    name : str
        Of the layer.

    Returns
    -------
    tuple
        (N, 4) float32 positions, about the clip's origin and in steps; the layer's properties,
        which bring them to days and to the input's frame; and "points".
    """
    step, days = states(clip)
    frames = clip.at(days)
    counts = [len(frame) for frame in frames]
    positions = np.concatenate([frame.local for frame in frames])
    tracks = np.concatenate([frame.tracks for frame in frames])
    size = 2.0 * clip.spacing or np.ptp(np.array(clip.bounds), axis=0).max() / 200.0
    properties = {
        "name": name,
        "axis_labels": ("time", "x", "y", "z"),
        "scale": (step, 1.0, 1.0, 1.0),
        "translate": (days[0], *clip.origin),
        "size": size,
        "border_width": 0.0,
        "face_color": np.concatenate([frame.colors for frame in frames]) / 255.0,
        "features": {
            "day": np.repeat(days, counts),
            "organ": np.array([track.name for track in clip.track_table])[tracks],
            "track": tracks,
        },
        "metadata": {"unit": clip.unit, "time_unit": clip.time_unit, "up": clip.up},
    }
    steps = np.repeat(np.arange(len(days), dtype=np.float32), counts)
    return np.column_stack([steps, positions]), properties, "points"


def states(clip: gclip.Clip) -> tuple[float, list[float]]:
    """The step of time, and the times of the states: a step apart, but for the scans' own times.

    Scans that are nearer to each other than a step, in a series too large for smaller ones, share
    a state, the later one's.
    """
    times = np.array(clip.times)
    length, shortest = times[-1] - times[0], np.diff(times).min()
    points = max(scan.points for scan in clip.scans) or 1
    steps = min(length / shortest * (STATES_BETWEEN + 1), MAX_POINTS / points)
    days = np.linspace(times[0], times[-1], max(1, math.ceil(steps)) + 1)
    step = days[1] - days[0]
    days[np.floor((times - times[0]) / step + 0.5).astype(int)] = times
    return float(step), days.tolist()
