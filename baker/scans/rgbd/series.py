"""A folder of images as a series of scans: what `baker.scans.read_series` asks for."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError
from baker.scans.cloud import Cloud
from baker.scans.rgbd.camera import read_camera
from baker.scans.rgbd.depth_repair import LabelRepair, repair
from baker.scans.rgbd.images import (
    Frame,
    find_frames,
    read_color,
    read_depth,
    read_labels,
    read_mask,
    schedule_frames,
)
from baker.scans.rgbd.unproject import unproject
from baker.scans.times import Schedule


class ImageSeries:
    """The frames of one folder, found and checked by name; pixels are read frame by frame.

    Parameters
    ----------
    camera_file : Path
        In that folder.
    times_file : Path, optional
        As --times.

    Raises
    ------
    InputError
        Here and while reading: see the modules `camera` and `images`.
    """

    def __init__(self, camera_file: Path, times_file: Path | None = None) -> None:
        self.camera_file = camera_file
        self.camera = read_camera(camera_file)
        frames = find_frames(camera_file.parent, self.camera.images)
        self.schedule: Schedule = schedule_frames(frames, self.camera.per_day, times_file)
        self.frames = {frame.color: frame for frame in frames}
        self.has_labels = frames[0].label is not None

    def read(self, color: Path, use_labels: bool = True) -> Cloud:
        """Read the frame whose colour image is `color`; points are as `unproject` gives them.

        With label images only labelled pixels become points, after `repair`; without them every
        pixel that has a depth and is not masked. use_labels=False still cuts the plant out by its
        labels, but hands none on.
        """
        frame = self.frames[color]
        colors, depth = read_color(frame.color), self._depth(frame)
        _require_size(frame, frame.depth, depth, colors)
        painted = np.zeros(depth.shape, bool) if frame.mask is None else read_mask(frame.mask)
        _require_size(frame, frame.mask, painted, colors)
        labels = read_labels(frame.label) if frame.label else None
        notes: tuple[str, ...] = ()
        if labels is None:
            chosen = (depth > 0) & ~painted
        else:
            _require_size(frame, frame.label, labels, colors)
            repaired = repair(depth, labels, self.camera.background, painted, self.camera.repair)
            depth, chosen = repaired.depth, repaired.depth > 0
            notes = _notes(repaired.labels)
        if not chosen.any():
            raise InputError(
                f"'{frame.label or frame.depth}' shows no plant: no "
                f"{'labelled ' if frame.label else ''}pixel has a depth."
            )
        points = unproject(depth, chosen, self.camera, self._ground)
        named = labels[chosen] if labels is not None and use_labels else None
        return Cloud(points, named, colors[chosen], notes)

    def beside(self, color: Path) -> tuple[Path, ...]:
        """What a frame was read from besides its colour image."""
        return (self.camera_file, *self.frames[color].files[1:])

    @cached_property
    def _ground(self) -> float:
        """Distance to the ground: as given, else the median of what is no plant at first."""
        if self.camera.ground is not None:
            return self.camera.ground
        frame = self.frames[self.schedule.entries[0].path]
        depth = self._depth(frame)
        ground = depth > 0
        if frame.label is not None:
            labels = read_labels(frame.label)
            _require_size(frame, frame.label, labels, depth)
            ground &= labels == self.camera.background
        if not ground.any():
            raise InputError(
                f"'{frame.depth}' has no depth beside the plant, so the ground's distance is "
                f"unknown; set ground (mm from the camera) in '{self.camera_file}'."
            )
        return float(np.median(depth[ground]))

    def _depth(self, frame: Frame) -> NDArray[np.float64]:
        """The depth image, cut to the colour image where the camera's file says so."""
        depth = read_depth(frame.depth, self.camera)
        camera = self.camera
        expected = (camera.height or depth.shape[0], camera.width or depth.shape[1])
        for name, said, found in zip(("height", "width"), expected, depth.shape, strict=True):
            if said != found:
                raise InputError(
                    f"'{frame.depth}' has the {name} {found}, but '{self.camera_file}' says {said}."
                )
        if camera.crop is None:
            return depth
        height, width = read_color(frame.color).shape[:2]
        left, top = camera.crop
        return depth[top : top + height, left : left + width]


def _require_size(frame: Frame, path: Path | None, image: NDArray, color: NDArray) -> None:
    if image.shape[:2] != color.shape[:2]:
        sizes = [f"{i.shape[1]}x{i.shape[0]}" for i in (image, color)]
        raise InputError(
            f"'{path}' is {sizes[0]} pixels, but '{frame.color.name}' is {sizes[1]}; the images of "
            "a frame must show the same pixels (or set crop in the camera's file)."
        )


def _notes(labels: Sequence[LabelRepair]) -> tuple[str, ...]:
    """One sentence on the repair, one on what could not be repaired."""
    names = ("pixels", "missing", "painted", "jumps", "ring", "filled", "dropped")
    total = {name: sum(getattr(label, name) for label in labels) for name in names}
    unknown = total["filled"] + total["dropped"]
    if not unknown:
        return (f"depth is valid at all {total['pixels']} labelled pixels.",)
    reasons = {
        "not measured": total["missing"],
        "painted": total["painted"],
        "off their surface": total["jumps"],
        "on a border": total["ring"],
    }
    why = ", ".join(f"{count} {reason}" for reason, count in reasons.items() if count)
    each = ", ".join(f"{label.label}: {label.filled}" for label in labels if label.filled)
    notes = [
        f"depth unknown at {unknown} of {total['pixels']} labelled pixels ({why}); "
        f"{total['filled']} filled by diffusion (label: pixels {each or 'none'})."
    ]
    whole = [label for label in labels if label.dropped == label.pixels]
    if whole:
        listed = ", ".join(f"{label.label} ({label.pixels})" for label in whole)
        notes.append(f"left out, without any valid depth: label (pixels) {listed}.")
    parts = total["dropped"] - sum(label.dropped for label in whole)
    if parts:
        notes.append(f"left out {parts} pixels in parts of labels without any valid depth.")
    return tuple(notes)
