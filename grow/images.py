"""Write a series of colour, depth and label images of a rosette, like the Komatsuna dataset."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from baker.errors import InputError
from baker.interpolation.attributes import organ_colors
from grow import komatsuna
from grow.faults import Faults, add_depth_errors, displace_labels
from grow.model import Plant
from grow.output import MAX_NOISE, TRUTH, atomic_series
from grow.picture import View, take_picture

DEPTH_UNIT = 0.125  # mm of one count of depth
MAX_SIDE = 4096  # pixels along a side


@dataclass(frozen=True)
class ImagePlan:
    """Which images to write."""

    days: int = 10  # number of days
    per_day: int = 6  # number of images on each day
    size: tuple[int, int] = (480, 360)  # width and height in pixels
    seed: int = 0
    labels: bool = True  # whether to write label images
    faults: Faults = field(default_factory=Faults)


def rosette(seed: int) -> Plant:
    """Make the plant in the images, whose labels are those of the label images."""
    if seed < 0:
        raise InputError(f"the seed is {seed}; it must be 0 or more.")
    return Plant("komatsuna", seed, komatsuna.grow(np.random.default_rng([seed, *b"komatsuna"])))


def write_images(
    plan: ImagePlan,
    folder: Path,
    force: bool = False,
    report_written: Callable[[str, int], None] = lambda name, pixels: None,
) -> None:
    """Write camera.toml, rgb_00_DDD_SS.png, depth_… (16 bits) and label_… to `folder`.

    DDD is the day, SS the number of the image in that day. The true depth and labels are in
    `folder`/truth, with the same names.

    report_written: called with the name of each frame and its number of labelled pixels.
    Raises InputError if the plan is impossible, or the folder can't be written or has images.
    """
    plant = rosette(plan.seed)
    _check(plan, plant)
    with atomic_series(folder, _is_image, force) as draft:
        _write(plan, plant, draft, report_written)


def _write(
    plan: ImagePlan, plant: Plant, folder: Path, report_written: Callable[[str, int], None]
) -> None:
    """Write the images of a plan, and the true ones, to an empty folder."""
    view = View.over(plan.size)
    truth = folder / TRUTH
    truth.mkdir()
    (folder / "camera.toml").write_text(_camera(view, plan))
    for day in range(plan.days):
        for slot in range(plan.per_day):
            rng = np.random.default_rng([plan.seed, day, slot])
            picture = take_picture(plant, day + slot / plan.per_day, view, rng)
            measured = add_depth_errors(picture.depth, plan.faults, rng)
            label = displace_labels(picture.label, plan.faults, rng)
            name = f"00_{day:03}_{slot:02}.png"
            _save(picture.color, folder / f"rgb_{name}")
            _save(_counts(measured), folder / f"depth_{name}")
            _save(_counts(picture.depth), truth / f"depth_{name}")
            _save_labels(picture.label, truth / f"label_{name}")
            if plan.labels:
                _save_labels(label, folder / f"label_{name}")
            report_written(f"rgb_{name}", int((label > 0).sum()))


def _camera(view: View, plan: ImagePlan) -> str:
    """The content of camera.toml."""
    return f"""\
fx = {view.focal:.4f}
fy = {view.focal:.4f}
cx = {view.cx:.4f}
cy = {view.cy:.4f}
width = {view.width}
height = {view.height}
depth_unit = {DEPTH_UNIT}
per_day = {plan.per_day}
"""


def _counts(depth: NDArray[np.float64]) -> NDArray[np.uint16]:
    """Convert depth in mm to counts of the camera."""
    return np.clip(np.rint(depth / DEPTH_UNIT), 0, 65535).astype(np.uint16)


def _save(image: NDArray, path: Path) -> None:
    import imageio.v3 as iio

    path.write_bytes(
        iio.imwrite("<bytes>", image, extension=".png", plugin="pillow", compress_level=3)
    )


def _save_labels(label: NDArray[np.int64], path: Path) -> None:
    """Write labels as a PNG with a palette of colours, which imageio does not support."""
    from PIL import Image

    image = Image.fromarray(label.astype(np.uint8))
    colors = [(0, 0, 0), *organ_colors(int(label.max()) + 1)[1:]]
    image.putpalette([channel for color in colors for channel in color[:3]])
    image.save(path)


def _check(plan: ImagePlan, plant: Plant) -> None:
    """Raise InputError if a plan is impossible."""
    last_day = int(plant.days[1])
    if not 1 <= plan.days <= last_day:
        raise InputError(f"{plan.days} days of images: this plant grows for 1 to {last_day} days.")
    if not 1 <= plan.per_day <= 100:
        raise InputError(f"{plan.per_day} images a day: 1 to 100 are possible.")
    if plan.days * plan.per_day < 2:
        raise InputError("one image is no series; at least 2 are needed.")
    if not all(32 <= side <= MAX_SIDE for side in plan.size):
        raise InputError(
            f"images of {plan.size[0]}x{plan.size[1]} pixels: each side must have 32 to {MAX_SIDE}."
        )
    if not 0 <= plan.faults.noise <= MAX_NOISE:
        noise = plan.faults.noise
        raise InputError(f"the noise is {noise:g} mm; 0 to {MAX_NOISE:g} are possible.")
    if not 0 <= plan.faults.labels < 100:
        raise InputError(
            f"labels misplaced by {plan.faults.labels:g} pixels: 0 to 100 are possible."
        )


def _is_image(path: Path) -> bool:
    return path.suffix.lower() == ".png" or path.name == "camera.toml"
