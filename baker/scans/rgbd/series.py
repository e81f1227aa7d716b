"""Read a folder of colour and depth images as a series of scans."""

import re
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
from msgspec.structs import asdict
from numpy.typing import NDArray

from baker.errors import InputError
from baker.scans.rgbd.camera import Camera, Patterns, read_camera
from baker.scans.rgbd.depth_repair import REASONS, VALID, repair
from baker.scans.rgbd.images import read_depth, read_labels, read_mask, read_pixels
from baker.scans.scan import Scan, Series
from baker.scans.times.conventions import Moment
from baker.scans.times.schedule import natural_key, schedule_in_time, schedule_scans

_SLOT = re.compile(r"(?:\d{1,3}[_-])?(?P<day>\d{1,3})[_-](?P<slot>\d{1,2})")


class Frame(NamedTuple):
    """The images of one scan."""

    name: str  #: the text that the star in the patterns stands for
    color: Path
    depth: Path
    label: Path | None
    mask: Path | None


def find_frames(folder: Path, patterns: Patterns) -> tuple[Frame, ...]:
    """Find the frames of a folder, one for each colour image, in the natural order of their names.

    Raises InputError: fewer than two frames, one without depth, or labels for some frames only.
    """
    found: dict[str, dict[str, Path]] = {}
    for kind, pattern in asdict(patterns).items():
        before, _, after = Path(pattern).name.partition("*")
        files = (path for path in folder.glob(pattern) if path.is_file())
        found[kind] = {p.name.removeprefix(before).removesuffix(after): p for p in files}
    colors = found["color"]
    if len(colors) < 2:
        images = f"{len(colors) or 'no'} colour image{'s' * (len(colors) != 1)}"
        raise InputError(f"'{folder}' holds {images} '{patterns.color}'; growth needs two.")
    names = sorted(colors, key=natural_key)
    for kind in ("depth", "label")[: 1 + bool(found["label"])]:
        for name in (name for name in names if name not in found[kind]):
            missing = getattr(patterns, kind).replace("*", name)
            raise InputError(f"'{colors[name]}' has no {kind} image; '{missing}' is missing.")
    depths, labels, masks = found["depth"], found["label"], found["mask"]
    return tuple(Frame(n, colors[n], depths[n], labels.get(n), masks.get(n)) for n in names)


def schedule_frames(
    frames: Sequence[Frame], per_day: int, times_file: Path | None = None
) -> Series:
    """Time and order the frames: by a times file, by day and slot in their names, or like scans.

    A name of two numbers is a day and a slot of that day (000_05); a third number in front is the
    plant's (00_000_05). Slots are numbered from 0 to ``per_day - 1``.

    Raises InputError: a slot that is `per_day` or more, or two frames at one time.
    """
    paths = [frame.color for frame in frames]
    slots = [slot for frame in frames if (slot := _SLOT.fullmatch(frame.name))]
    if times_file is not None or len(slots) < len(frames):
        return schedule_scans(paths, times_file, from_folder=True)

    moments = []
    for frame, slot in zip(frames, slots, strict=True):
        day, number = int(slot["day"]), int(slot["slot"])
        if number >= per_day:
            raise InputError(
                f"'{frame.color}' is number {number} of its day, but a day has {per_day} images, "
                f"0 to {per_day - 1}; set per_day in the camera's file (24 where the number is "
                "the hour)."
            )
        time = day + number / per_day
        moments.append(Moment(time, f"day {time:.2f}"))
    rule = f"from day and number in the names, {per_day} images a day"
    return schedule_in_time(paths, [path.name for path in paths], moments, rule)


class ImageSeries:
    """The frames of one folder, found by name; their pixels are read one frame at a time.

    Creating it and reading raise InputError.
    """

    def __init__(self, camera_file: Path, times_file: Path | None = None) -> None:
        self.camera_file = camera_file
        self.camera = read_camera(camera_file)
        frames = find_frames(camera_file.parent, self.camera.images)
        self.series = schedule_frames(frames, self.camera.per_day, times_file)
        self.frames = {frame.color: frame for frame in frames}
        self.has_labels = frames[0].label is not None

    def read(self, color: Path, use_labels: bool = True) -> Scan:
        """Read the frame whose colour image is `color`, in the coordinates of `unproject`.

        With label images, labelled pixels become points, after `repair`; without them, all pixels
        that have a depth and are not masked. use_labels=False still leaves out pixels without a
        label, but returns no labels.
        """
        frame, camera = self.frames[color], self.camera
        colors, depth, labels, painted = self._images(frame)
        notes: tuple[str, ...] = ()
        if labels is None:
            depth[painted] = 0.0
        else:
            depth, reason = repair(depth, labels, camera.background, painted, camera.repair)
            notes = _notes(depth, reason, labels != camera.background)
        chosen = depth > 0
        if not chosen.any():
            path, pixel = (frame.label, "labelled pixel") if frame.label else (frame.depth, "pixel")
            raise InputError(f"'{path}' shows no plant: no {pixel} has a depth.")
        point_labels = labels[chosen] if labels is not None and use_labels else None
        points = unproject(depth, camera, self._ground)
        return Scan(points, point_labels, colors[chosen], notes, path=color)

    def files(self, color: Path) -> tuple[Path, ...]:
        """The files that a frame is read from, its colour image first."""
        _, _, *others = self.frames[color]
        return (color, self.camera_file, *filter(None, others))

    @cached_property
    def _ground(self) -> float:
        """Distance to the ground in mm: as given, else the median background of the first frame."""
        if self.camera.ground is not None:
            return self.camera.ground
        frame = self.frames[self.series.scans[0].path]
        _, depth, labels, _ = self._images(frame)
        ground = (depth > 0) & (labels is None or labels == self.camera.background)
        if not ground.any():
            raise InputError(
                f"'{frame.depth}' has no depth beside the plant, so the ground's distance is "
                f"unknown; set ground (mm from the camera) in '{self.camera_file}'."
            )
        return float(np.median(depth[ground]))

    def _images(self, frame: Frame) -> tuple[NDArray, NDArray, NDArray | None, NDArray]:
        """Read colours, depth (cropped as the camera file says), labels and mask, of one size."""
        camera, colors = self.camera, read_pixels(frame.color, "RGB", "RGB")
        depth = read_depth(frame.depth, camera.depth_unit)
        for k, side in enumerate(("height", "width")):
            if (expected := getattr(camera, side)) not in (None, depth.shape[k]):
                message = f"has the {side} {depth.shape[k]}, but '{self.camera_file}' says"
                raise InputError(f"'{frame.depth}' {message} {expected}.")
        height, width = colors.shape[:2]
        if camera.crop is not None:
            left, top = camera.crop
            depth = depth[top : top + height, left : left + width]
        labels = read_labels(frame.label) if frame.label else None
        painted = read_mask(frame.mask) if frame.mask else np.zeros(depth.shape, bool)
        for path, image in zip(frame[2:], (depth, labels, painted), strict=True):
            if image is not None and image.shape != (height, width):
                raise InputError(
                    f"'{path}' is {image.shape[1]}x{image.shape[0]} pixels, but "
                    f"'{frame.color.name}' is {width}x{height}; the images of a frame must show "
                    "the same pixels (or set crop in the camera's file)."
                )
        return colors, depth, labels, painted


def unproject(depth: NDArray[np.float64], camera: Camera, ground: float) -> NDArray[np.float64]:
    """Unproject a depth image (H, W) to (N, 3) points in mm, row by row, for pixels that aren't 0.

    x points to the right of the image, y to its top, z from the ground to the camera; the origin is
    where the camera's axis meets the ground, `ground` mm from the camera.
    """
    v, u = np.nonzero(depth)
    left, top = camera.crop or (0, 0)
    z = depth[v, u]
    x = (u + left - camera.cx) / camera.fx * z
    y = (v + top - camera.cy) / camera.fy * z
    return np.stack([x, -y, ground - z], axis=1)


def _notes(
    depth: NDArray[np.float64], reason: NDArray[np.uint8], plant: NDArray[np.bool_]
) -> tuple[str, ...]:
    """Notes on the pixels that were repaired and on those that could not be."""
    counts = np.bincount(reason[plant], minlength=len(REASONS))
    unknown, lost = plant.sum() - counts[VALID], (plant & (depth == 0)).sum()
    reasons = zip(counts[VALID + 1 :], REASONS[VALID + 1 :], strict=True)
    listed = ", ".join(f"{count} {why}" for count, why in reasons if count) or "none"
    notes = (
        f"depth unknown at {unknown} of {plant.sum()} labelled pixels ({listed}); "
        f"{unknown - lost} filled by diffusion.",
        f"left out {lost} pixels without any valid depth in reach.",
    )
    return notes if lost else notes[:1]
