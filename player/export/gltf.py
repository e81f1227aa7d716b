"""Export of the growing plant as a binary glTF 2.0 file with one animation.

Each interval has nodes of its own, which are shown and hidden by their scale (docs/exports.md).
Movers follow Bézier curves: the offsets of the control points from the first one are morph targets,
and the Bernstein polynomials are their weights, interpolated linearly between keys.
"""

import struct
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from msgspec import json
from numpy.typing import NDArray

from gclip import Clip, Motion
from gclip.evaluate import Layer, bernstein, evaluate_layer, srgb_to_linear
from player.export.film import Film, Progress
from traits.dates import date_at
from traits.upright import upright_axes

CURVED_KEYS = 17  # animation keys of an interval whose weights are not linear in time
FADE_PARTS = 8  # in which a fading organ disappears, because glTF cannot animate opacity
METERS = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001}
FLOAT, SHORT = 5126, 5123  # glTF's component types
POINTS, ARRAY_BUFFER = 0, 34962  # glTF's drawing mode, and target of buffer views


def write(clip: Clip, film: Film, path: Path, progress: Progress) -> None:
    """Write the plant, with an animation of the film's length.

    Positions are local to the clip. The root node rotates the up axis to glTF's y axis, and scales
    to metres if the clip's unit is known.
    """
    document, parts = _Document(clip, film), list(_parts(clip))
    progress(0, len(parts))
    for done, (layer, until) in enumerate(parts, start=1):
        document.add(layer, until)
        progress(done, len(parts))
    document.save(path)


def _parts(clip: Clip) -> Iterator[tuple[Layer, float]]:
    """Yield groups of movers that have the same weights and disappear at the same time.

    Each is a layer at the start of its interval, with colours of its middle because glTF's points
    have constant colours, and the share of the interval until which it is shown; infinite if it
    stays.
    """
    for index, interval in enumerate(clip.intervals):
        last = index == len(clip.intervals) - 1
        for group in interval.groups:
            layer = Layer(index, group, parameter=0.0, blend=0.5, alpha=1.0)
            if group.motion is Motion.FADE:
                # A prefix of a group is a representative sample of it, and so is each slice.
                bounds = np.linspace(group.first, group.stop, FADE_PARTS + 1).astype(int).tolist()
                for i, (first, stop) in enumerate(pairwise(bounds)):
                    if stop > first:
                        part = replace(group, first=first, count=stop - first)
                        yield replace(layer, group=part), (i + 0.5) / FADE_PARTS
            elif group.motion is not Motion.REMOVE and group.count:
                yield layer, np.inf if last and group.motion is Motion.MOVE else 1.0


class _Document:
    """A glTF document with a mesh, a node and two animation channels for each part."""

    def __init__(self, clip: Clip, film: Film) -> None:
        self._clip = clip
        self._seconds_per_day = film.length(clip) / (clip.times[-1] - clip.times[0])
        self._buffer = bytearray()
        root = {
            "name": film.title or film.name,
            "matrix": _root_matrix(clip).T.ravel().tolist(),
            "children": [],
            "extras": {"origin": list(clip.origin), "up": clip.up, "unit": clip.unit},
        }
        self._document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "plant-growth-clips"},
            "extensionsUsed": ["KHR_materials_unlit"],
            "materials": [{"name": "plant", "extensions": {"KHR_materials_unlit": {}}}],
            "scenes": [{"nodes": [0]}],
            "scene": 0,
            "nodes": [root],
            "animations": [{"name": "growth", "samplers": [], "channels": []}],
            **{"meshes": [], "accessors": [], "bufferViews": []},
        }

    def save(self, path: Path) -> None:
        """Write the header, and a chunk each for the document and its buffer."""
        text = json.encode(self._document | {"buffers": [{"byteLength": len(self._buffer)}]})
        text += b" " * (-len(text) % 4)
        with path.open("wb") as file:
            file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(self._buffer)))
            for kind, content in ((b"JSON", text), (b"BIN\0", self._buffer)):
                file.write(struct.pack("<I4s", len(content), kind))
                file.write(content)

    def add(self, layer: Layer, until: float) -> None:
        """Add a part that is shown until a share of its interval."""
        document, clip = self._document, self._clip
        interval, group = clip.intervals[layer.interval], layer.group
        start, colors, tracks = evaluate_layer(clip, layer)
        paint = colors / 255.0
        paint[:, :3] = srgb_to_linear(paint[:, :3])
        attributes = {
            "POSITION": self._array(start, target=ARRAY_BUFFER),
            "COLOR_0": self._array(np.round(65535 * paint).astype(np.uint16), target=ARRAY_BUFFER),
            "_LABEL": self._array(tracks.astype(np.float32), target=ARRAY_BUFFER),
        }
        step = 1.0 if interval.box is None else interval.box.step
        origin, *others = (p[group.first : group.stop].astype(float) for p in interval.curve)
        offsets = [self._array(step * (other - origin), target=ARRAY_BUFFER) for other in others]
        targets = [{"POSITION": array} for array in offsets]
        shape = {"attributes": attributes, "targets": targets, "material": 0, "mode": POINTS}
        # Viewers without animation show the last scan.
        end, stays = bernstein(interval.degree, 1.0)[1:].tolist(), until > 1.0
        dates = [date_at(clip.scans, time) for time in (interval.start, interval.end)]
        node = {"name": " to ".join(dates), "mesh": len(document["meshes"])}
        number = len(document["nodes"])
        document["nodes"][0]["children"].append(number)
        document["nodes"].append(node | {"scale": [float(stays)] * 3})
        document["meshes"].append({"primitives": [shape], "weights": end})

        falls = group.motion is Motion.FALL
        shares = np.linspace(0.0, 1.0, CURVED_KEYS if falls or interval.degree > 1 else 2)
        parameters = (shares**2 if falls else shares).tolist()
        weights = np.concatenate([bernstein(interval.degree, u)[1:] for u in parameters])
        begin = (interval.start - clip.times[0]) * self._seconds_per_day
        length = (interval.end - interval.start) * self._seconds_per_day
        keys = [(begin, 1.0)] if begin == 0.0 else [(0.0, 0.0), (begin, 1.0)]
        if not stays:
            keys.append((begin + length * until, 0.0))
        times, scales = np.array(keys).T
        (animation,) = document["animations"]
        for path, interpolation, seconds, values in (
            ("weights", "LINEAR", begin + length * shares, weights),
            ("scale", "STEP", times, np.repeat(scales[:, None], 3, axis=1)),
        ):
            sampler = {"input": self._array(seconds), "output": self._array(values)}
            target = {"node": number, "path": path}
            animation["channels"].append({"sampler": len(animation["samplers"]), "target": target})
            animation["samplers"].append(sampler | {"interpolation": interpolation})

    def _array(self, values: NDArray[Any], **view: int) -> int:
        """Append colours (uint16) or other numbers to the buffer; returns the accessor's index."""
        is_color = values.dtype == np.uint16
        values = np.ascontiguousarray(values, np.uint16 if is_color else np.float32)
        rows = values.reshape(len(values), -1)
        accessor = {
            "bufferView": len(self._document["bufferViews"]),
            "componentType": SHORT if is_color else FLOAT,
            "normalized": bool(is_color),
            "type": "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}",
            "count": len(values),
            "min": rows.min(axis=0).tolist(),
            "max": rows.max(axis=0).tolist(),
        }
        view |= {"buffer": 0, "byteOffset": len(self._buffer), "byteLength": values.nbytes}
        self._document["bufferViews"].append(view)
        self._document["accessors"].append(accessor)
        self._buffer += values.tobytes() + bytes(-values.nbytes % 4)
        return accessor["bufferView"]


def _root_matrix(clip: Clip) -> NDArray[np.float64]:
    """(4, 4) matrix from local coordinates to glTF's: y up, in metres if the unit is known."""
    first, second, up = upright_axes(clip.up)
    matrix = np.eye(4)
    matrix[:3, :3] = METERS.get(clip.unit, 1.0) * np.array([first, up, -second])
    return matrix
