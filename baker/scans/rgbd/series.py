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
from baker.scans.rgbd.depth_repair import repair
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
    """Find the frames of a folder, one for each colour image, in natural order of their names."""
    files_of_kind: dict[str, dict[str, Path]] = {}
    for kind, pattern in asdict(patterns).items():
        before, _, after = Path(pattern).name.partition("*")
        files = filter(Path.is_file, folder.glob(pattern))
        files_of_kind[kind] = {p.name.removeprefix(before).removesuffix(after): p for p in files}
    colors, depths, labels, masks = files_of_kind.values()
    if len(colors) < 2:
        images = f"fewer than two colour images '{patterns.color}'"
        raise InputError(f"'{folder}' holds {images}; growth needs two.")
    names = sorted(colors, key=natural_key)
    for kind in ("depth", "label") if labels else ("depth",):
        if lacking := [name for name in names if name not in files_of_kind[kind]]:
            missing = getattr(patterns, kind).replace("*", lacking[0])
            raise InputError(f"'{colors[lacking[0]]}' has no {kind} image; '{missing}' is missing.")
    return tuple(Frame(n, colors[n], depths[n], labels.get(n), masks.get(n)) for n in names)


def schedule_frames(
    frames: Sequence[Frame], per_day: int, times_file: Path | None = None
) -> Series:
    """Time and order frames: by a times file, by the day and slot in their names, or as scans are.

    A name of two numbers is a day and a slot of that day (000_05); a third number in front is the
    plant's (00_000_05). Slots are numbered from 0 to ``per_day - 1``.
    """
    paths = [frame.color for frame in frames]
    slot_matches = [slot for frame in frames if (slot := _SLOT.fullmatch(frame.name))]
    slots = [(int(slot["day"]), int(slot["slot"])) for slot in slot_matches]
    if times_file is not None or len(slots) < len(frames):
        return schedule_scans(paths, times_file, from_folder=True)
    last, path = max((number, path) for (_, number), path in zip(slots, paths, strict=True))
    if last >= per_day:
        hint = "set per_day in the camera's file (24 where the number is the hour)"
        raise InputError(f"'{path}' is number {last} of its day, of {per_day} from 0 on; {hint}.")
    times = [day + number / per_day for day, number in slots]
    moments = [Moment(time, f"day {time:.2f}") for time in times]
    rule = f"from day and number in the names, {per_day} images a day"
    return schedule_in_time(paths, [path.name for path in paths], moments, rule)


class ImageSeries:
    """The frames of one folder, found by name; their pixels are read one frame at a time."""

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
        that have a depth and are not masked. With ``use_labels=False``, pixels without a label are
        left out as well, but the scan has no labels.
        """
        frame, camera = self.frames[color], self.camera
        colors, depth, labels = self._images(frame)
        notes = []
        if labels is not None:
            depth, unknown = repair(depth, labels, camera.background)
            plant = labels != camera.background
            lost = (plant & (depth == 0)).sum()
            notes.append(
                f"depth unknown at {unknown.sum()} of {plant.sum()} labelled pixels; "
                f"{unknown.sum() - lost} filled by convolution, {lost} left out: none valid nearby."
            )
        chosen = depth > 0
        if not chosen.any():
            path, pixel = (frame.label, "labelled pixel") if frame.label else (frame.depth, "pixel")
            raise InputError(f"'{path}' shows no plant: no {pixel} has a depth.")
        point_labels = labels[chosen] if labels is not None and use_labels else None
        points = unproject(depth, camera, self._ground)
        return Scan(points, point_labels, colors[chosen], tuple(notes), path=color)

    def files(self, color: Path) -> tuple[Path, ...]:
        """The files that a frame is read from, its colour image first."""
        _, _, *images = self.frames[color]
        return (color, self.camera_file, *filter(None, images))

    @cached_property
    def _ground(self) -> float:
        """Distance to the ground in mm: as given, else the median background of the first frame."""
        if self.camera.ground is not None:
            return self.camera.ground
        frame = self.frames[self.series.scans[0].path]
        _, depth, labels = self._images(frame)
        ground = (depth > 0) & (labels is None or labels == self.camera.background)
        if not ground.any():
            hint = f"set ground (mm from the camera) in '{self.camera_file}'"
            raise InputError(f"'{frame.depth}' has no depth beside the plant; {hint}.")
        return float(np.median(depth[ground]))

    def _images(self, frame: Frame) -> tuple[NDArray, NDArray, NDArray | None]:
        """Read colours, depth (cropped; 0 where masked) and labels, of one size."""
        camera, colors = self.camera, read_pixels(frame.color, "RGB", "RGB")
        depth = read_depth(frame.depth, camera.depth_unit)
        height, width = depth.shape
        if (camera.width or width, camera.height or height) != (width, height):
            expected = f"not of the width and height in '{self.camera_file}'"
            raise InputError(f"'{frame.depth}' is {width}x{height} pixels, {expected}.")
        height, width = colors.shape[:2]
        needed = f"'{frame.color.name}' is {width}x{height}; if it is a part of it, set crop"
        if camera.crop is not None:
            left, top = camera.crop
            depth = depth[top : top + height, left : left + width]
        labels = read_labels(frame.label) if frame.label else None
        masked = read_mask(frame.mask) if frame.mask else None
        for path, image in zip(frame[2:], (depth, labels, masked), strict=True):
            if image is not None and image.shape != (height, width):
                size = f"{image.shape[1]}x{image.shape[0]} pixels"
                raise InputError(f"'{path}' is {size}, but {needed}.")
        return colors, depth if masked is None else np.where(masked, 0.0, depth), labels


def unproject(depth: NDArray[np.float64], camera: Camera, ground: float) -> NDArray[np.float64]:
    """Unproject the pixels of a depth image (H, W) with a depth to (N, 3) points in mm, row by row.

    x points to the right of the image, y to its top, z from the ground to the camera; the origin is
    where the camera's axis meets the ground, `ground` mm from the camera.
    """
    v, u = np.nonzero(depth)
    left, top = camera.crop or (0, 0)
    z = depth[v, u]
    x = (u + left - camera.cx) / camera.fx * z
    y = (v + top - camera.cy) / camera.fy * z
    return np.stack([x, -y, ground - z], axis=1)
