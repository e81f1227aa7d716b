"""The growing plant as one binary glTF 2.0 file: points, morph targets, one animation.

Each interval has movers of its own, so each is a node of its own. It is there while its time lasts:
its scale steps from 0 to 1 and back to 0, which glTF 2.0 (section 3.5.3) names as the way to make a
node invisible. Within an interval a mover travels along a Bézier curve of degree d,

    B(u) = p_0 + Σ_j b_j(u) (p_j - p_0),   j = 1 ... d,

with the Bernstein polynomials b_j: so the differences p_j - p_0 are morph targets, and the b_j are
their weights over time, sampled at keys between which viewers interpolate linearly (exact for
straight paths).
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
    import pygltflib as gltf

    document = gltf.GLTF2(
        asset=gltf.Asset(version="2.0", generator="plant-growth-clips"),
        extensionsUsed=["KHR_materials_unlit"],
        materials=[gltf.Material(name="plant", extensions={"KHR_materials_unlit": {}})],
        scenes=[gltf.Scene(nodes=[0])],
        scene=0,
        nodes=[
            gltf.Node(
                name=film.title or film.name,
                matrix=_placed(clip).T.ravel().tolist(),
                children=[],
                extras={"origin": list(clip.origin), "up": clip.up, "unit": clip.unit},
            )
        ],
        animations=[gltf.Animation(name="growth", samplers=[], channels=[])],
        buffers=[gltf.Buffer(byteLength=0)],
    )
    blob, parts = bytearray(), list(_parts(clip))
    progress(0, len(parts))
    for done, (layer, until) in enumerate(parts, start=1):
        _add(document, blob, clip, layer, until, film.length(clip))
        progress(done, len(parts))
    document.buffers[0].byteLength = len(blob)
    document.set_binary_blob(bytes(blob))
    document.save_binary(str(path))


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


def _add(
    document: Any, blob: bytearray, clip: Clip, layer: Layer, until: float, seconds: float
) -> None:
    """One node with its mesh and its two animation channels."""
    import pygltflib as gltf

    interval, group = clip.intervals[layer.interval], layer.group
    start, colors, tracks = evaluate_layer(clip, layer)
    paint = colors / 255.0
    paint[:, :3] = srgb_to_linear(paint[:, :3])
    attributes = gltf.Attributes(
        POSITION=_array(document, blob, start, bounds=True),
        COLOR_0=_array(document, blob, np.round(65535 * paint).astype(np.uint16), normalized=True),
    )
    attributes._LABEL = _array(document, blob, tracks.astype(np.float32))
    step = 1.0 if interval.box is None else interval.box.step
    origin, *others = (p[group.first : group.stop].astype(float) for p in interval.curve)
    moved = [(step * (other - origin)).astype(np.float32) for other in others]
    primitive = gltf.Primitive(
        attributes=attributes,
        targets=[gltf.Attributes(POSITION=_array(document, blob, p, bounds=True)) for p in moved],
        material=0,
        mode=gltf.POINTS,
    )
    end = bernstein(interval.degree, 1.0)[1:].tolist()
    dates = [date_at(clip.scans, time) for time in (interval.start, interval.end)]
    document.nodes[0].children.append(len(document.nodes))
    stays = until > 1.0  # without animation a viewer shows the last scan
    node = gltf.Node(mesh=len(document.meshes), scale=[float(stays)] * 3)
    node.name = f"{dates[0]} to {dates[1]}"
    document.meshes.append(gltf.Mesh(primitives=[primitive], weights=end))
    document.nodes.append(node)

    falls = group.motion is Motion.FALL
    shares = np.linspace(0.0, 1.0, CURVED_KEYS if falls or interval.degree > 1 else 2)
    eased = shares**2 if falls else shares
    rate = seconds / (clip.times[-1] - clip.times[0])
    begin = (interval.start - clip.times[0]) * rate
    length = (interval.end - interval.start) * rate
    weights = [bernstein(interval.degree, share)[1:] for share in eased.tolist()]
    _animate(
        document, blob, "weights", gltf.ANIM_LINEAR, begin + length * shares, np.ravel(weights)
    )
    changes = [(begin, 1.0)] if begin == 0.0 else [(0.0, 0.0), (begin, 1.0)]
    if not stays:
        changes.append((begin + length * until, 0.0))
    times, scales = np.array(changes).T
    _animate(document, blob, "scale", gltf.ANIM_STEP, times, np.repeat(scales[:, None], 3, axis=1))


def _placed(clip: Clip) -> NDArray[np.float64]:
    """(4, 4) from local coordinates to glTF's: y up, metres where the unit is known."""
    first, second, up = axes(clip.up)
    matrix = np.eye(4)
    matrix[:3, :3] = METERS.get(clip.unit, 1.0) * np.array([first, up, -second])
    return matrix


def _array(
    document: Any,
    blob: bytearray,
    values: NDArray[Any],
    vertices: bool = True,
    bounds: bool = False,
    normalized: bool = False,
) -> int:
    """Append an array of float32 or uint16 to the buffer; returns the index of its accessor."""
    import pygltflib as gltf

    view = gltf.BufferView(buffer=0, byteOffset=len(blob), byteLength=values.nbytes)
    view.target = VERTICES if vertices else None
    accessor = gltf.Accessor(bufferView=len(document.bufferViews), count=len(values))
    accessor.componentType = FLOAT if values.dtype == np.float32 else SHORT
    accessor.type = "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}"
    accessor.normalized = normalized
    if bounds:
        rows = values.reshape(len(values), -1)
        accessor.min, accessor.max = rows.min(axis=0).tolist(), rows.max(axis=0).tolist()
    document.bufferViews.append(view)
    document.accessors.append(accessor)
    blob += np.ascontiguousarray(values).tobytes()
    blob += bytes(-len(blob) % 4)
    return len(document.accessors) - 1


def _animate(
    document: Any,
    blob: bytearray,
    path: str,
    interpolation: str,
    seconds: NDArray[np.float64],
    values: NDArray[np.float64],
) -> None:
    """Animate a property of the newest node."""
    import pygltflib as gltf

    animation = document.animations[0]
    target = gltf.AnimationChannelTarget(node=len(document.nodes) - 1, path=path)
    channel = gltf.AnimationChannel(sampler=len(animation.samplers), target=target)
    sampler = gltf.AnimationSampler(
        input=_array(document, blob, seconds.astype(np.float32), vertices=False, bounds=True),
        output=_array(document, blob, values.astype(np.float32), vertices=False),
        interpolation=interpolation,
    )
    animation.samplers.append(sampler)
    animation.channels.append(channel)
