"""Colours of the points, as a scanner with a camera would measure them."""

import numpy as np
from numpy.typing import NDArray

from grow.pose import Array, Body, Pose, at_node, sigmoid, unit
from grow.surface import Material, normals

SUN = np.array([0.35, -0.30, 0.89])  # direction of the sun


def shade(
    body: Body, pose: Pose, material: Material, rng: np.random.Generator
) -> NDArray[np.uint8]:
    """(N, 3) sRGB colours by the age of the tissue, shaded by soft sunlight."""
    part = material.part
    young, mature, old, rib = (_palette(body, name) for name in ("young", "mature", "old", "rib"))
    grown = at_node(pose.growth, part, material.along)[:, None]
    tissue = young[part] + (mature - young)[part] * grown

    lifespan = body.column("lifespan")[part]
    decay = sigmoid((pose.age[part] - lifespan) / 8 + 0.6 * material.along - 0.3)[:, None]
    tissue = tissue + (old[part] - tissue) * decay
    edge = np.exp(-((material.across / 0.09) ** 2)) * (1 - material.along) ** 0.5
    tissue = tissue + (rib[part] - tissue) * 0.8 * edge[:, None] * (1 - decay)
    veins = 0.03 * np.cos(2 * np.pi * 6 * material.across)

    facing = unit(normals(body, pose, material)) @ SUN
    # Leaves are translucent, stems are not.
    light = np.where(body.tube[part], 0.5 + 0.5 * facing, np.abs(facing) ** 0.8)
    brightness = 0.68 + 0.42 * light + veins + rng.normal(0, 0.025, len(part))
    return np.clip(255 * tissue * brightness[:, None], 0, 255).astype(np.uint8)


def _palette(body: Body, name: str) -> Array:
    """(P, 3) one of the colours of every part; by default, a midrib has that of young tissue."""
    return np.array(
        [getattr(part, name) or (part.young if name == "rib" else ()) for part in body.parts]
    )
