"""Export of point clouds as binary PLY files (Turk 1994), one file per day."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gclip import Clip
from gclip.evaluate import evaluate_layer, layers_at, locate
from gclip.text import printable
from player.export.film import Film, Progress
from player.output_names import is_numbered, numbered_path
from traits.dates import date_at

PLY_TYPES = {"<f4": "float", "<f8": "double", "|u1": "uchar"}


def write(clip: Clip, film: Film, path: Path, progress: Progress) -> None:
    """Write the cloud of the film's day, by default of the last scan; or a sequence from 0 on.

    A sequence of all days is spaced evenly: the pauses of films at both ends are left out.
    """
    if not is_numbered(path):
        days = list(film.at) or clip.times[-1:]
    elif film.at or film.every is not None:
        days = film.days(clip)
    else:
        ends = clip.times[0], clip.times[-1]
        days = np.linspace(*ends, max(film.frame_count(clip), 2)).tolist()
    progress(0, len(days))
    for number, day in enumerate(days):
        vertices = cloud_at(clip, day)
        if not is_numbered(path):
            vertices = vertices[vertices["alpha"] > 0]
        _save(clip, day, vertices, numbered_path(path, number))
        progress(number + 1, len(days))


def cloud_at(clip: Clip, day: float) -> NDArray[np.void]:
    """All movers of the day's interval as vertices of a PLY file.

    Number and order of the movers do not change within an interval, so that points correspond from
    file to file. Movers that have disappeared have alpha 0 and the position of a visible mover; the
    others are those of `Clip.at`. Positions are float, or double if the resolution of float is
    coarser than a hundredth of the point spacing.
    """
    index, _ = locate(clip, day)
    interval = clip.intervals[index]
    local = np.zeros((len(interval), 3), np.float64)
    colors = np.zeros((len(interval), 4), np.uint8)
    present = np.zeros(len(interval), bool)
    for layer in layers_at(clip, day):
        if layer.interval == index and not layer.litter:
            movers = slice(layer.group.first, layer.group.stop)
            local[movers], colors[movers], _ = evaluate_layer(clip, layer)
            present[movers] = True
    if present.any():
        local[~present] = local[np.argmax(present)]

    world = local + np.asarray(clip.origin)
    is_coarse = np.spacing(np.float32(np.abs(world).max(initial=0.0))) > 0.01 * clip.spacing
    columns = dict(zip("xyz", world.T.astype("<f8" if is_coarse else "<f4"), strict=True))
    columns |= dict(zip(("red", "green", "blue", "alpha"), colors.T, strict=True))
    columns["scalar_label"] = interval.tracks.astype("<f4")
    types = [(name, column.dtype) for name, column in columns.items()]
    return np.rec.fromarrays(list(columns.values()), types)


def _save(clip: Clip, day: float, vertices: NDArray[np.void], path: Path) -> None:
    names = vertices.dtype.names or ()
    header = [
        "ply",
        "format binary_little_endian 1.0",
        "comment made by plant-growth-clips",
        f"comment time {day!r} {clip.time_unit}",
        f"comment date {date_at(clip.scans, day)}",
        f"comment unit {clip.unit}",
        f"element vertex {len(vertices)}",
        *(f"property {PLY_TYPES[vertices.dtype[name].str]} {name}" for name in names),
        "end_header",
    ]
    # Line breaks in names must not add lines to the header.
    text = "".join(f"{printable(line)}\n" for line in header)
    path.write_bytes(text.encode("ascii", "replace") + vertices.tobytes())
