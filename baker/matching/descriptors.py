"""Describe the organs of a scan for matching: attachment point, size, direction, order."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from baker.segmentation.hierarchy import split_by_label
from baker.segmentation.organ_entries import organ_entries

SAMPLE_SIZE = 128  # number of points of an organ from which its descriptors are computed
AXIAL_WEIGHT = 0.35  # of the component of directions along the stem, in `about_stem`
ORDER_SOFTNESS = 0.025  # width of the step between "above" and "below", in organ sizes
MAX_ORGANS, POINT_STEP = 16, 2  # largest organs that score a rotation; step between their points
MIN_CARRIED = 0.4  # share of the other organs that grow from one organ, such as a stem


@dataclass(frozen=True)
class OrganDescriptors:
    """Descriptors of the n organs of a scan, in its unit of length."""

    samples: list[NDArray[np.float64]]  # n arrays of (s, 3) points, s <= `SAMPLE_SIZE`
    attachments: NDArray[np.float64]  # (n, 3) attachment points; of the root, the plant base
    sizes: NDArray[np.float64]  # (n,) root mean square distances from the attachment points
    directions: NDArray[np.float64]  # (n, 3) unit vectors from there to the centroids
    order: NDArray[np.float64]  # (n,) number of organs attached below; 0 without a stem
    height: NDArray[np.float64]  # (n,) relative distance from the plant base
    base: NDArray[np.float64]  # (3,) plant base

    def __len__(self) -> int:
        return len(self.samples)

    def moved(self, displacements: NDArray[np.float64]) -> "OrganDescriptors":
        """Move each organ by its (n, 3) displacement."""
        samples = [s + shift for s, shift in zip(self.samples, displacements, strict=True)]
        return replace(self, samples=samples, attachments=self.attachments + displacements)

    def transformed(self, motion: NDArray[np.float64]) -> "OrganDescriptors":
        """Move all organs by a (4, 4) rigid motion."""
        rotation, shift = motion[:3, :3].T, motion[:3, 3]
        return replace(
            self,
            samples=[sample @ rotation + shift for sample in self.samples],
            attachments=self.attachments @ rotation + shift,
            directions=self.directions @ rotation,
            base=self.base @ rotation + shift,
        )

    def about_stem(self) -> "OrganDescriptors":
        """Scale down the component of directions along the stem, which differs as leaves droop."""
        axis = (self.attachments - self.base).mean(axis=0)
        axis /= max(float(np.linalg.norm(axis)), np.finfo(float).tiny)
        lateral = self.directions - (1.0 - AXIAL_WEIGHT) * np.outer(self.directions @ axis, axis)
        length = np.linalg.norm(lateral, axis=1, keepdims=True)
        return replace(self, directions=lateral / np.maximum(length, np.finfo(float).tiny))

    def largest(self, count: int = MAX_ORGANS, step: int = POINT_STEP) -> "OrganDescriptors":
        """The `count` largest organs, the largest first, with every `step`-th of their points."""
        kept = np.argsort(-self.sizes, kind="stable")[:count]
        arrays = ("attachments", "sizes", "directions", "order", "height")
        return replace(
            self,
            samples=[self.samples[k][::step] for k in kept],
            **{name: getattr(self, name)[kept] for name in arrays},
        )


def describe_organs(
    cloud: NDArray[np.floating], labels: NDArray[np.integer], root_point: int
) -> OrganDescriptors:
    """Describe the organs of a scan, in ascending order of their labels.

    cloud, labels: (N, 3) points and (N,) organs. root_point: index of the point at the plant base.
    """
    from scipy.special import expit

    _, members = split_by_label(labels)
    steps = [-(-len(organ) // SAMPLE_SIZE) for organ in members]
    samples = [cloud[o[::k]].astype(np.float64) for o, k in zip(members, steps, strict=True)]
    base, entries = cloud[root_point].astype(np.float64), organ_entries(cloud, labels, root_point)
    attachments, parents = entries.attachments()
    is_attached = np.arange(len(members)) != entries.organ[0]
    offsets = [sample - point for sample, point in zip(samples, attachments, strict=True)]
    sizes = np.array([np.sqrt((offset**2).sum(axis=1).mean()) for offset in offsets])
    mean = np.array([offset.mean(axis=0) for offset in offsets])
    length = np.linalg.norm(mean, axis=1, keepdims=True)
    distance = np.linalg.norm(attachments - base, axis=1)
    softness = ORDER_SOFTNESS * float(np.sqrt((sizes**2).mean())) or np.inf
    below = expit((distance[:, None] - distance) / softness)
    np.fill_diagonal(below, 0.0)
    # Without a stem that carries many organs, as where leaflets are organs, there is no order.
    children = np.bincount(parents[is_attached], minlength=1)
    has_stem = children.max() >= MIN_CARRIED * children.sum()
    return OrganDescriptors(
        samples=samples,
        attachments=attachments,
        sizes=sizes,
        directions=np.divide(mean, length, out=np.zeros_like(mean), where=length > 0),
        order=below @ is_attached * has_stem,
        height=distance / max(distance.max(), np.finfo(float).tiny),
        base=base,
    )
