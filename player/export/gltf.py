"""The growing plant as one binary glTF 2.0 file: points, morph targets, one animation.

Each interval has nodes of its own, switched on and off by their scale (docs/exports.md). In it a
mover travels along a Bézier curve: the differences of its points from the first one are morph
targets, and the Bernstein polynomials are their weights, linear in time between keys.
"""

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
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
VERTICES = 34962  # and its ARRAY_BUFFER


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
        import pygltflib

        self._gltf = pygltflib
        self._clip = clip
        self._rate = film.length(clip) / (clip.times[-1] - clip.times[0])
        self._blob = bytearray()
        self._root = pygltflib.Node(
            name=film.title or film.name,
            matrix=_placed(clip).T.ravel().tolist(),
            children=[],
            extras={"origin": list(clip.origin), "up": clip.up, "unit": clip.unit},
        )
        self._animation = pygltflib.Animation(name="growth", samplers=[], channels=[])
        self._document = pygltflib.GLTF2(
            asset=pygltflib.Asset(version="2.0", generator="plant-growth-clips"),
            extensionsUsed=["KHR_materials_unlit"],
            materials=[pygltflib.Material(name="plant", extensions={"KHR_materials_unlit": {}})],
            scenes=[pygltflib.Scene(nodes=[0])],
            scene=0,
            nodes=[self._root],
            animations=[self._animation],
        )

    def save(self, path: Path) -> None:
        self._document.buffers = [self._gltf.Buffer(byteLength=len(self._blob))]
        self._document.set_binary_blob(bytes(self._blob))
        self._document.save_binary(str(path))

    def add(self, layer: Layer, until: float) -> None:
        """Add a part that is there up to a share of its interval."""
        gltf, document, clip = self._gltf, self._document, self._clip
        interval, group = clip.intervals[layer.interval], layer.group
        start, colors, tracks = evaluate_layer(clip, layer)
        paint = colors / 255.0
        paint[:, :3] = srgb_to_linear(paint[:, :3])
        attributes = gltf.Attributes(
            POSITION=self._array(start, VERTICES),
            COLOR_0=self._array(np.round(65535 * paint).astype(np.uint16), VERTICES),
        )
        attributes._LABEL = self._array(tracks.astype(np.float32), VERTICES)
        step = 1.0 if interval.box is None else interval.box.step
        origin, *others = (p[group.first : group.stop].astype(float) for p in interval.curve)
        moved = [self._array(step * (other - origin), VERTICES) for other in others]
        targets = [gltf.Attributes(POSITION=array) for array in moved]
        shape = {"attributes": attributes, "targets": targets, "material": 0, "mode": gltf.POINTS}
        # Without animation a viewer shows the last scan.
        end, stays = bernstein(interval.degree, 1.0)[1:].tolist(), until > 1.0
        dates = [date_at(clip.scans, time) for time in (interval.start, interval.end)]
        node = gltf.Node(mesh=len(document.meshes), scale=[float(stays)] * 3)
        node.name = f"{dates[0]} to {dates[1]}"
        self._root.children.append(len(document.nodes))
        document.meshes.append(gltf.Mesh(primitives=[gltf.Primitive(**shape)], weights=end))
        document.nodes.append(node)

        falls = group.motion is Motion.FALL
        shares = np.linspace(0.0, 1.0, CURVED_KEYS if falls or interval.degree > 1 else 2)
        eased = shares**2 if falls else shares
        weights = [bernstein(interval.degree, share)[1:] for share in eased.tolist()]
        begin = (interval.start - clip.times[0]) * self._rate
        length = (interval.end - interval.start) * self._rate
        self._animate("weights", gltf.ANIM_LINEAR, begin + length * shares, np.ravel(weights))
        changes = [(begin, 1.0)] if begin == 0.0 else [(0.0, 0.0), (begin, 1.0)]
        if not stays:
            changes.append((begin + length * until, 0.0))
        times, scales = np.array(changes).T
        self._animate("scale", gltf.ANIM_STEP, times, np.repeat(scales[:, None], 3, axis=1))

    def _animate(
        self, path: str, interpolation: str, seconds: NDArray[Any], values: NDArray[Any]
    ) -> None:
        """Animate a property of the newest node."""
        gltf, animation = self._gltf, self._animation
        target = gltf.AnimationChannelTarget(node=len(self._document.nodes) - 1, path=path)
        channel = gltf.AnimationChannel(sampler=len(animation.samplers), target=target)
        keys = {"input": self._array(seconds), "output": self._array(values)}
        animation.samplers.append(gltf.AnimationSampler(**keys, interpolation=interpolation))
        animation.channels.append(channel)

    def _array(self, values: NDArray[Any], target: int | None = None) -> int:
        """Append colours (uint16) or other numbers to the buffer; returns their index."""
        is_color = values.dtype == np.uint16
        values = np.ascontiguousarray(values if is_color else values.astype(np.float32))
        rows = values.reshape(len(values), -1)
        view = {"buffer": 0, "byteOffset": len(self._blob), "byteLength": values.nbytes}
        self._document.accessors.append(
            self._gltf.Accessor(
                bufferView=len(self._document.bufferViews),
                componentType=SHORT if is_color else FLOAT,
                normalized=is_color,
                type="SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}",
                count=len(values),
                min=rows.min(axis=0).tolist(),
                max=rows.max(axis=0).tolist(),
            )
        )
        self._document.bufferViews.append(self._gltf.BufferView(**view, target=target))
        self._blob += values.tobytes() + bytes(-values.nbytes % 4)
        return len(self._document.accessors) - 1


def _placed(clip: Clip) -> NDArray[np.float64]:
    """(4, 4) from local coordinates to glTF's: y up, metres where the unit is known."""
    first, second, up = axes(clip.up)
    matrix = np.eye(4)
    matrix[:3, :3] = METERS.get(clip.unit, 1.0) * np.array([first, up, -second])
    return matrix
