"""A folder of images as a series of scans: what `baker.scans.read_series` asks for."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError
from baker.scans.cloud import Cloud
from baker.scans.rgbd.camera import Camera, read_camera
from baker.scans.rgbd.depth_repair import REASONS, VALID, Repaired, repair
from baker.scans.rgbd.images import (
    Frame,
    find_frames,
    read_color,
    read_depth,
    read_labels,
    read_mask,
    schedule_frames,
)
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
            depth = np.where(painted, 0.0, depth)
        else:
            _require_size(frame, frame.label, labels, colors)
            repaired = repair(depth, labels, self.camera.background, painted, self.camera.repair)
            depth, notes = repaired.depth, _notes(repaired, labels, self.camera.background)
        chosen = depth > 0
        if not chosen.any():
            raise InputError(
                f"'{frame.label or frame.depth}' shows no plant: no "
                f"{'labelled ' if frame.label else ''}pixel has a depth."
            )
        points = unproject(depth, self.camera, self._ground)
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


def unproject(depth: NDArray[np.float64], camera: Camera, ground: float) -> NDArray[np.float64]:
    """The points that the pixels of a depth image show, in mm, row by row.

    x points to the picture's right, y to its top, z from the ground to the camera; the origin lies
    on the ground, on the camera's axis. (Of the usual camera axes, right, down and forward, the
    last two are turned over: a half turn about x.)

    Parameters
    ----------
    depth : (H, W) float64
        mm along the camera's axis; pixels of 0 give no point.
    camera : Camera
    ground : float
        Distance from the camera to the ground, mm.

    Returns
    -------
    (N, 3) float64
    """
    v, u = np.nonzero(depth)
    left, top = camera.crop or (0, 0)
    z = depth[v, u]
    x = (u + left - camera.cx) / camera.fx * z
    y = (v + top - camera.cy) / camera.fy * z
    return np.stack([x, -y, ground - z], axis=1)


def _notes(repaired: Repaired, labels: NDArray[np.int64], background: int) -> tuple[str, ...]:
    """A sentence on what was repaired, and one on what could not be."""
    plant, unknown = labels != background, repaired.reason > VALID
    if not unknown.any():
        return (f"depth is valid at all {plant.sum()} labelled pixels.",)
    counts = np.bincount(repaired.reason[unknown], minlength=len(REASONS)).tolist()
    why = ", ".join(f"{count} {what}" for count, what in zip(counts, REASONS, strict=True) if count)
    is_filled = repaired.depth > 0
    filled, lost = labels[unknown & is_filled], labels[unknown & ~is_filled]
    note = (
        f"depth unknown at {unknown.sum()} of {plant.sum()} labelled pixels ({why}); {len(filled)} "
        f"filled by diffusion (label: pixels {_by_label(filled)})."
    )
    if not len(lost):
        return (note,)
    each = f"label: pixels {_by_label(lost)}"
    return (note, f"left out {len(lost)} pixels without any valid depth in reach ({each}).")


def _by_label(labels: NDArray[np.int64]) -> str:
    counts = zip(*np.unique(labels, return_counts=True), strict=True)
    return ", ".join(f"{label}: {count}" for label, count in counts) or "none"
