"""Descriptors of a scan's organs for matching: attachment point, size, direction, order."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from baker.segmentation.hierarchy import NO_PARENT, Hierarchy

SAMPLE_SIZE = 128  # points of an organ that its descriptors and distances are found from
ATTACHMENT_POINTS = 5  # of these, the nearest to the parent, whose mean is the attachment point
ORDER_SOFTNESS = 0.025  # distance along the stem that tells two organs apart, in organ sizes
ORDERED_ORGANS = 10  # organs of a plant up to which their order along the stem counts in full


@dataclass(frozen=True)
class OrganDescriptors:
    """What a scan's n organs look like; lengths in length units."""

    samples: list[NDArray[np.float64]]  # (s, 3) points of each organ, at most `SAMPLE_SIZE`
    attachments: NDArray[np.float64]  # (n, 3) points on the parents; of the root, the plant base
    sizes: NDArray[np.float64]  # (n,) root mean square distances from the attachment points
    directions: NDArray[np.float64]  # (n, 3) unit vectors from there to the centroids
    order: NDArray[np.float64]  # (n,) organs that leave the stem below; 0 where there is no stem
    height: NDArray[np.float64]  # (n,) distance from the plant base, of the last organ 1; likewise

    def __len__(self) -> int:
        return len(self.samples)

    def moved(self, displacements: NDArray[np.float64]) -> "OrganDescriptors":
        """Each organ moved by its own displacement, (n, 3)."""
        samples = [own + by for own, by in zip(self.samples, displacements, strict=True)]
        return replace(self, samples=samples, attachments=self.attachments + displacements)


def describe_organs(
    cloud: NDArray[np.floating], hierarchy: Hierarchy, root_point: int, stem: bool = False
) -> OrganDescriptors:
    """Describe the organs of a scan: the segments that have points, in their order.

    Parameters
    ----------
    cloud : (N, 3) float ndarray
    hierarchy : Hierarchy
    root_point : int
        Index of the point at the plant base.
    stem : bool
        The organ there is known to be the stem of all others, whatever the hierarchy says.

    Returns
    -------
    OrganDescriptors
    """
    members, root, parents = _organs(hierarchy, root_point)
    samples = [cloud[own[:: -(-len(own) // SAMPLE_SIZE)]].astype(np.float64) for own in members]
    base = cloud[root_point].astype(np.float64)
    attachments = np.array(
        [
            base if parent == NO_PARENT else _attachment(sample, samples[parent])
            for sample, parent in zip(samples, parents, strict=True)
        ]
    )
    offsets = [sample - point for sample, point in zip(samples, attachments, strict=True)]
    sizes = np.array([np.sqrt((offset**2).sum(axis=1).mean()) for offset in offsets])
    mean = np.array([offset.mean(axis=0) for offset in offsets])
    length = np.linalg.norm(mean, axis=1, keepdims=True)
    along = np.linalg.norm(attachments - base, axis=1)
    count = len(members)
    softness = ORDER_SOFTNESS * float(np.sqrt((sizes**2).mean()))
    is_stem = stem or _is_stem(root, parents)
    return OrganDescriptors(
        samples=samples,
        attachments=attachments,
        sizes=sizes,
        directions=np.divide(mean, length, out=np.zeros_like(mean), where=length > 0),
        order=_order_along_stem(along, root, softness) if is_stem else np.zeros(count),
        height=along / max(along.max(), np.finfo(float).tiny) if is_stem else np.zeros(count),
    )


def _organs(hierarchy: Hierarchy, root_point: int) -> tuple[list[NDArray[np.intp]], int, list[int]]:
    """The segments that have points, which of them holds the root point, and their parents.

    The root's parent is NO_PARENT. Segments under a virtual, empty root grow from the root too.
    """
    segments = [s for s, own in enumerate(hierarchy.segments) if len(own)]
    members = [hierarchy.segments[s] for s in segments]
    root = next(index for index, own in enumerate(members) if root_point in own)
    index = {segment: organ for organ, segment in enumerate(segments)}
    parents = [index.get(hierarchy.parents[segment], root) for segment in segments]
    parents[root] = NO_PARENT
    return members, root, parents


def _attachment(sample: NDArray[np.float64], parent: NDArray[np.float64]) -> NDArray[np.float64]:
    from scipy.spatial import KDTree

    distances = KDTree(parent).query(sample)[0]
    nearest = np.argsort(distances, kind="stable")[:ATTACHMENT_POINTS]
    return np.asarray(sample[nearest].mean(axis=0))


def _is_stem(root: int, parents: list[int]) -> bool:
    """Whether the order along the root means anything: not where leaves without a stem overlap."""
    children = np.bincount([p for p in parents if p != NO_PARENT], minlength=len(parents))
    most = np.delete(children, root).max(initial=0)
    no_other_parent = (children > 0).sum() <= 1
    return bool(no_other_parent or children[root] > most or most > 0.5 * (len(parents) - 1))


def _order_along_stem(
    along: NDArray[np.float64], root: int, softness: float
) -> NDArray[np.float64]:
    """How many organs other than the root begin nearer to the stem's base; a tie counts half.

    In a plant of hundreds of organs a few more below mean little: the count is scaled to
    `ORDERED_ORGANS`.
    """
    from scipy.special import expit

    below = expit((along[:, None] - along) / (softness or np.inf))
    np.fill_diagonal(below, 0.0)
    below[:, root] = 0.0
    return np.asarray(below.sum(axis=1) * min(1.0, ORDERED_ORGANS / len(along)))
