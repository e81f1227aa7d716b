"""Where shortest paths enter the organs of grown plants, which know where they are attached."""

from __future__ import annotations

import numpy as np
import pytest

import grow
from baker.segmentation.organ_entries import organ_entries


@pytest.mark.parametrize(("kind", "points"), [("tree", 6000), ("tomato", 8000), ("maize", 8000)])
def test_organs_are_entered_where_they_are_attached(kind: str, points: int) -> None:
    plant = grow.plant(kind)
    cloud, organs = plant.cloud(plant.days[1], points), plant.organs(plant.days[1])
    by_label = {organ.label: organ for organ in organs}
    base = ((cloud.points - by_label[0].base) ** 2).sum(axis=1).argmin()
    entries = organ_entries(cloud.points, cloud.labels, int(base))
    attachments, parents = entries.attachments()
    is_right, errors = [], []
    for label, attachment, parent in zip(entries.labels, attachments, parents, strict=True):
        organ = by_label[label]
        if label != 0:
            is_right.append(entries.labels[parent] == organ.parent)
            errors.append(np.linalg.norm(attachment - organ.base) / organ.length)
    assert np.mean(is_right) > 0.87
    assert np.median(errors) < 0.07
