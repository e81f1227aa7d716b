"""The growing plant as one binary glTF 2.0 file: points, morph targets, one animation.

Each interval has movers of its own, so each is a node of its own. It is there while its time lasts:
its scale steps from 0 to 1 and back to 0, which glTF 2.0 (section 3.5.3) names as the way to make a
node invisible. Within an interval a mover travels along a Bézier curve of degree d,

    B(u) = p_0 + Σ_j b_j(u) (p_j - p_0),   j = 1 ... d,

with the Bernstein polynomials b_j: so the differences p_j - p_0 are morph targets, and the b_j are
their weights over time, sampled at keys between which viewers interpolate linearly (exact for
straight paths).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gclip import Clip, Group, Interval, Motion
from gclip.evaluate import bernstein, blend_srgb, srgb_to_linear
from gclip.file import check_not_truncated
from player.export.film import Film, Progress
from player.view.camera import axes
from player.view.dates import date_at

CURVED_KEYS = 17  # an interval, where weights are no straight lines in time
DISSOLVE = 8  # parts in which an organ that fades goes: glTF can't animate opacity
METERS = {"m": 1.0, "dm": 0.1, "cm": 0.01, "mm": 0.001}
FLOAT, SHORT = 5126, 5123  # glTF's component types
VERTICES = 34962  # and its ARRAY_BUFFER


@dataclass(frozen=True)
class Part:
    """Movers that move by the same weights and vanish together."""

    interval: int
    movers: slice
    group: Group
    until: float  #: share of the interval until which they are there; infinite for those that stay


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
    )
    store, parts = _Store(document), list(_parts(clip))
    progress(0, len(parts))
    for done, movers in enumerate(parts, start=1):
        _add(document, store, clip, movers, film.length(clip))
        progress(done, len(parts))
    document.buffers = [gltf.Buffer(byteLength=store.size)]
    document.set_binary_blob(b"".join(store.pieces))
    document.save_binary(str(path))


def _parts(clip: Clip) -> Iterator[Part]:
    for index, interval in enumerate(clip.intervals):
        last = index == len(clip.intervals) - 1
        for group in interval.groups:
            if group.motion is Motion.FADE:
                # A prefix of a group is a fair sample of it, and so is each slice.
                cuts = np.linspace(group.first, group.stop, DISSOLVE + 1).astype(int).tolist()
                for i, (first, stop) in enumerate(pairwise(cuts)):
                    if stop > first:
                        yield Part(index, slice(first, stop), group, (i + 0.5) / DISSOLVE)
            elif group.motion is not Motion.REMOVE and group.count:
                until = np.inf if last and group.motion is Motion.MOVE else 1.0
                yield Part(index, slice(group.first, group.stop), group, until)


def _add(document: Any, store: _Store, clip: Clip, part: Part, seconds: float) -> None:
    """One node with its mesh and its two animation channels."""
    import pygltflib as gltf

    interval, box = clip.intervals[part.interval], clip.intervals[part.interval].box
    check_not_truncated(interval.tracks)
    low, step = (np.zeros(3), np.ones(3)) if box is None else (np.asarray(box.low), box.step)
    start, *others = (p[part.movers].astype(np.float64) for p in interval.curve)
    attributes = gltf.Attributes(
        POSITION=store.positions(low + step * start),
        COLOR_0=store.array(_linear_colors(clip, interval, part.movers), normalized=True),
    )
    attributes._LABEL = store.array(interval.tracks[part.movers].astype(np.float32))
    primitive = gltf.Primitive(
        attributes=attributes,
        targets=[
            gltf.Attributes(POSITION=store.positions(step * (other - start))) for other in others
        ],
        material=0,
        mode=gltf.POINTS,
    )
    shown = part.until > 1.0  # without animation a viewer shows the last scan
    end = bernstein(interval.degree, 1.0)[1:].tolist()
    dates = [date_at(clip.scans, time) for time in (interval.start, interval.end)]
    document.meshes.append(gltf.Mesh(primitives=[primitive], weights=end))
    document.nodes[0].children.append(len(document.nodes))
    document.nodes.append(
        gltf.Node(
            name=f"{dates[0]} to {dates[1]}",
            mesh=len(document.meshes) - 1,
            scale=[float(shown)] * 3,
        )
    )

    falls = part.group.motion is Motion.FALL
    shares = np.linspace(0.0, 1.0, CURVED_KEYS if falls or interval.degree > 1 else 2)
    eased = shares**2 if falls else shares
    first, last = clip.times[0], clip.times[-1]
    rate = seconds / (last - first)
    begin, length = (interval.start - first) * rate, (interval.end - interval.start) * rate
    store.channel(
        "weights",
        begin + length * shares,
        np.array([bernstein(interval.degree, share)[1:] for share in eased.tolist()]).ravel(),
        gltf.ANIM_LINEAR,
    )
    changes = [(begin, 1.0)] if begin == 0.0 else [(0.0, 0.0), (begin, 1.0)]
    if not shown:
        changes.append((begin + length * part.until, 0.0))
    times, scales = np.array(changes).T
    store.channel("scale", times, np.repeat(scales[:, None], 3, axis=1), gltf.ANIM_STEP)


def _linear_colors(clip: Clip, interval: Interval, movers: slice) -> NDArray[np.uint16]:
    """(n, 4) linear light and alpha in 16 bits, half way through the interval: points have one
    colour each.
    """
    if interval.start_colors is not None and interval.end_colors is not None:
        srgb = blend_srgb(interval.start_colors[movers], interval.end_colors[movers], 0.5)
    else:
        srgb = clip.palette[interval.tracks[movers]]
    linear = srgb / 255.0
    linear[:, :3] = srgb_to_linear(linear[:, :3])
    return np.round(65535.0 * linear).astype(np.uint16)


def _placed(clip: Clip) -> NDArray[np.float64]:
    """(4, 4) from local coordinates to glTF's: y up, metres where the unit is known."""
    first, second, up = axes(clip.up)
    matrix = np.eye(4)
    matrix[:3, :3] = METERS.get(clip.unit, 1.0) * np.array([first, up, -second])
    return matrix


@dataclass
class _Store:
    """The buffer in the making, and the accessors that say what lies where."""

    document: Any  # pygltflib's
    pieces: list[bytes] = field(default_factory=list)
    size: int = 0

    def positions(self, points: NDArray[np.float64]) -> int:
        """An accessor with the bounds that glTF wants of positions."""
        exact = points.astype(np.float32)
        return self.array(exact, min=exact.min(axis=0).tolist(), max=exact.max(axis=0).tolist())

    def array(self, values: NDArray[Any], vertices: bool = True, **about: Any) -> int:
        """Put an array of float32 or uint16 into the buffer; gives its accessor."""
        import pygltflib as gltf

        data = np.ascontiguousarray(values).tobytes()
        view = gltf.BufferView(buffer=0, byteOffset=self.size, byteLength=len(data))
        view.target = VERTICES if vertices else None
        self.document.bufferViews.append(view)
        kind = "SCALAR" if values.ndim == 1 else f"VEC{values.shape[1]}"
        self.document.accessors.append(
            gltf.Accessor(
                bufferView=len(self.document.bufferViews) - 1,
                componentType=FLOAT if values.dtype == np.float32 else SHORT,
                count=len(values),
                type=kind,
                **about,
            )
        )
        self.pieces.append(data + b"\0" * (-len(data) % 4))
        self.size += len(self.pieces[-1])
        return len(self.document.accessors) - 1

    def channel(
        self, path: str, seconds: NDArray[np.float64], values: NDArray[Any], how: str
    ) -> None:
        """Animate the newest node."""
        import pygltflib as gltf

        animation = self.document.animations[0]
        exact = seconds.astype(np.float32)
        bounds = {"min": [float(exact[0])], "max": [float(exact[-1])]}
        times = self.array(exact, vertices=False, **bounds)
        output = self.array(values.astype(np.float32), vertices=False)
        animation.samplers.append(
            gltf.AnimationSampler(input=times, output=output, interpolation=how)
        )
        node = gltf.AnimationChannelTarget(node=len(self.document.nodes) - 1, path=path)
        animation.channels.append(
            gltf.AnimationChannel(sampler=len(animation.samplers) - 1, target=node)
        )
