"""The growing plant as one binary glTF 2.0 file: points, morph targets, one animation.

Each interval has nodes of its own, switched on and off by their scale (docs/exports.md). In it a
mover travels along a Bézier curve: the differences of its points from the first one are morph
targets, and the Bernstein polynomials are their weights, linear in time between keys.
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
from player.view.camera import axes
from player.view.dates import date_at

CURVED_KEYS = 17  # an interval, where weights are no straight lines in time
DISSOLVE = 8  # parts in which an organ that fades goes: glTF can't animate opacity
METERS = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001}
FLOAT, SHORT = 5126, 5123  # glTF's component types
POINTS, VERTICES = 0, 34962  # its mode of drawing, and its ARRAY_BUFFER


def write(clip: Clip, film: Film, path: Path, progress: Progress) -> None:
    """Write the plant; the animation takes as long as the film would.

    Positions are local to the clip; the root node turns the plant's up axis to glTF's (y) and
    scales to metres where the unit is known.
    """
    growth, parts = _Growth(clip, film), list(_parts(clip))
    progress(0, len(parts))
    for done, (layer, until) in enumerate(parts, start=1):
        growth.add(layer, until)
        progress(done, len(parts))
    growth.save(path)


def _parts(clip: Clip) -> Iterator[tuple[Layer, float]]:
    """Movers that move by the same weights and vanish together, with the places of an interval's
    start and the colours half way through it, for points have one each; and the share of the
    interval until which they are there, infinite for those that stay.
    """
    for index, interval in enumerate(clip.intervals):
        last = index == len(clip.intervals) - 1
        for group in interval.groups:
            layer = Layer(index, group, parameter=0.0, blend=0.5, alpha=1.0)
            if group.motion is Motion.FADE:
                # A prefix of a group is a fair sample of it, and so is each slice.
                cuts = np.linspace(group.first, group.stop, DISSOLVE + 1).astype(int).tolist()
                for i, (first, stop) in enumerate(pairwise(cuts)):
                    if stop > first:
                        some = replace(group, first=first, count=stop - first)
                        yield replace(layer, group=some), (i + 0.5) / DISSOLVE
            elif group.motion is not Motion.REMOVE and group.count:
                yield layer, np.inf if last and group.motion is Motion.MOVE else 1.0


class _Growth:
    """A document with one mesh, one node and two animation channels for each part of the plant."""

    def __init__(self, clip: Clip, film: Film) -> None:
        self._clip = clip
        self._rate = film.length(clip) / (clip.times[-1] - clip.times[0])
        self._blob = bytearray()
        root = {
            "name": film.title or film.name,
            "matrix": _placed(clip).T.ravel().tolist(),
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
        """Write the header, and the document and its buffer as a chunk each."""
        text = json.encode(self._document | {"buffers": [{"byteLength": len(self._blob)}]})
        text += b" " * (-len(text) % 4)
        with path.open("wb") as file:
            file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(self._blob)))
            for kind, content in ((b"JSON", text), (b"BIN\0", self._blob)):
                file.write(struct.pack("<I4s", len(content), kind))
                file.write(content)

    def add(self, layer: Layer, until: float) -> None:
        """Add a part that is there up to a share of its interval."""
        document, clip = self._document, self._clip
        interval, group = clip.intervals[layer.interval], layer.group
        start, colors, tracks = evaluate_layer(clip, layer)
        paint = colors / 255.0
        paint[:, :3] = srgb_to_linear(paint[:, :3])
        attributes = {
            "POSITION": self._array(start, target=VERTICES),
            "COLOR_0": self._array(np.round(65535 * paint).astype(np.uint16), target=VERTICES),
            "_LABEL": self._array(tracks.astype(np.float32), target=VERTICES),
        }
        step = 1.0 if interval.box is None else interval.box.step
        origin, *others = (p[group.first : group.stop].astype(float) for p in interval.curve)
        moved = [self._array(step * (other - origin), target=VERTICES) for other in others]
        targets = [{"POSITION": array} for array in moved]
        shape = {"attributes": attributes, "targets": targets, "material": 0, "mode": POINTS}
        # Without animation a viewer shows the last scan.
        end, stays = bernstein(interval.degree, 1.0)[1:].tolist(), until > 1.0
        dates = [date_at(clip.scans, time) for time in (interval.start, interval.end)]
        node = {"name": " to ".join(dates), "mesh": len(document["meshes"])}
        number = len(document["nodes"])
        document["nodes"][0]["children"].append(number)
        document["nodes"].append(node | {"scale": [float(stays)] * 3})
        document["meshes"].append({"primitives": [shape], "weights": end})

        falls = group.motion is Motion.FALL
        shares = np.linspace(0.0, 1.0, CURVED_KEYS if falls or interval.degree > 1 else 2)
        eased = (shares**2 if falls else shares).tolist()
        weights = np.concatenate([bernstein(interval.degree, share)[1:] for share in eased])
        begin = (interval.start - clip.times[0]) * self._rate
        length = (interval.end - interval.start) * self._rate
        changes = [(begin, 1.0)] if begin == 0.0 else [(0.0, 0.0), (begin, 1.0)]
        if not stays:
            changes.append((begin + length * until, 0.0))
        times, scales = np.array(changes).T
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
        """Append colours (uint16) or other numbers to the buffer; returns their index."""
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
        view |= {"buffer": 0, "byteOffset": len(self._blob), "byteLength": values.nbytes}
        self._document["bufferViews"].append(view)
        self._document["accessors"].append(accessor)
        self._blob += values.tobytes() + bytes(-values.nbytes % 4)
        return accessor["bufferView"]


def _placed(clip: Clip) -> NDArray[np.float64]:
    """(4, 4) from local coordinates to glTF's: y up, metres where the unit is known."""
    first, second, up = axes(clip.up)
    matrix = np.eye(4)
    matrix[:3, :3] = METERS.get(clip.unit, 1.0) * np.array([first, up, -second])
    return matrix
