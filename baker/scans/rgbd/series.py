"""A folder of images as a series of scans: what `baker.scans.read_series` asks for."""

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
from baker.scans.times.schedule import Schedule


class ImageSeries:
    """The frames of one folder, found and checked by name; pixels are read frame by frame.

    Raises InputError here and while reading: see the modules `camera` and `images`.
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
        frame, camera = self.frames[color], self.camera
        colors, depth, labels, painted = self._images(frame)
        notes: tuple[str, ...] = ()
        if labels is None:
            depth = np.where(painted, 0.0, depth)
        else:
            repaired = repair(depth, labels, camera.background, painted, camera.repair)
            depth, notes = repaired.depth, _notes(repaired, labels, camera.background)
        chosen = depth > 0
        if not chosen.any():
            raise InputError(
                f"'{frame.label or frame.depth}' shows no plant: no "
                f"{'labelled ' if frame.label else ''}pixel has a depth."
            )
        named = labels[chosen] if labels is not None and use_labels else None
        return Cloud(unproject(depth, camera, self._ground), named, colors[chosen], notes)

    def beside(self, color: Path) -> tuple[Path, ...]:
        """What a frame was read from besides its colour image."""
        frame = self.frames[color]
        return (self.camera_file, *filter(None, (frame.depth, frame.label, frame.mask)))

    @cached_property
    def _ground(self) -> float:
        """Distance to the ground: as given, else the median of what is no plant at first."""
        if self.camera.ground is not None:
            return self.camera.ground
        frame = self.frames[self.schedule.entries[0].path]
        _, depth, labels, _ = self._images(frame)
        ground = depth > 0
        if labels is not None:
            ground &= labels == self.camera.background
        if not ground.any():
            raise InputError(
                f"'{frame.depth}' has no depth beside the plant, so the ground's distance is "
                f"unknown; set ground (mm from the camera) in '{self.camera_file}'."
            )
        return float(np.median(depth[ground]))

    def _images(self, frame: Frame) -> tuple[NDArray, NDArray, NDArray | None, NDArray]:
        """Colours, depth, labels and mask, of one size; depth is cut as the camera's file says."""
        camera, colors = self.camera, read_color(frame.color)
        depth = read_depth(frame.depth, camera)
        sides = zip(("height", "width"), (camera.height, camera.width), depth.shape, strict=True)
        for name, said, found in sides:
            if said not in (None, found):
                raise InputError(
                    f"'{frame.depth}' has the {name} {found}, but '{self.camera_file}' says {said}."
                )
        height, width = colors.shape[:2]
        if camera.crop is not None:
            left, top = camera.crop
            depth = depth[top : top + height, left : left + width]
        labels = read_labels(frame.label) if frame.label else None
        painted = read_mask(frame.mask) if frame.mask else np.zeros(depth.shape, bool)
        images = ((frame.depth, depth), (frame.label, labels), (frame.mask, painted))
        for path, image in images:
            if image is not None and image.shape != (height, width):
                raise InputError(
                    f"'{path}' is {image.shape[1]}x{image.shape[0]} pixels, but "
                    f"'{frame.color.name}' is {width}x{height}; the images of a frame must show "
                    "the same pixels (or set crop in the camera's file)."
                )
        return colors, depth, labels, painted


def unproject(depth: NDArray[np.float64], camera: Camera, ground: float) -> NDArray[np.float64]:
    """(N, 3) points, in mm, that the pixels of a depth image show, row by row; none where it is 0.

    x points to the picture's right, y to its top, z from the ground to the camera; the origin lies
    on the ground, on the camera's axis, `ground` mm from the camera.
    """
    v, u = np.nonzero(depth)
    left, top = camera.crop or (0, 0)
    z = depth[v, u]
    x = (u + left - camera.cx) / camera.fx * z
    y = (v + top - camera.cy) / camera.fy * z
    return np.stack([x, -y, ground - z], axis=1)


def _notes(repaired: Repaired, labels: NDArray[np.int64], background: int) -> tuple[str, ...]:
    """A sentence on what was repaired, and one on what could not be."""
    plant, unknown, filled = labels != background, repaired.reason > VALID, repaired.depth > 0
    counts = np.bincount(repaired.reason[unknown], minlength=len(REASONS))
    why = ", ".join(f"{n} {what}" for n, what in zip(counts, REASONS, strict=True) if n)
    done, lost = labels[unknown & filled], labels[unknown & ~filled]
    notes = (
        f"depth unknown at {unknown.sum()} of {plant.sum()} labelled pixels ({why or 'none'}); "
        f"{len(done)} filled by diffusion ({_by_label(done)}).",
        f"left out {len(lost)} pixels without any valid depth in reach ({_by_label(lost)}).",
    )
    return notes if len(lost) else notes[:1]


def _by_label(labels: NDArray[np.int64]) -> str:
    counts = zip(*np.unique(labels, return_counts=True), strict=True)
    return "label: pixels " + (", ".join(f"{label}: {count}" for label, count in counts) or "none")
