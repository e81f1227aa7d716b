"""The organs of one scan for matching: where each begins, which way and how far it goes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.segmentation.from_labels import hierarchy_from_labels
from baker.segmentation.hierarchy import NO_PARENT, split_by_label

CONTACTS, SAMPLE = 400, 128  # points of an organ that its attachment and its distances are found by
ATTACHED = 5  # of the latter, how many make its base
APART = 0.025  # from where on two bases are told apart, as a share of the organs' size
MANY = 10  # organs whose order along the stem counts in full


@dataclass(frozen=True)
class Shapes:
    """A scan's n organs.

    labels:     ascending, one an organ.
    samples:    (s, 3) float64 points of each, at most SAMPLE.
    bases:      (n, 3) where each leaves the organ that it grows from; of the root, the stem's base.
    sizes:      (n,) root mean square distance of an organ's points from its base.
    directions: (n, 3) unit vectors from the base to the organ's mean.
    below:      (n,) how many organs leave the stem before this one does, 0 where there is no stem.
    height:     (n,) distance of the base from the stem's, 1 that of the last organ; 0 without stem.
    """

    labels: list[int]
    samples: list[NDArray[np.float64]]
    bases: NDArray[np.float64]
    sizes: NDArray[np.float64]
    directions: NDArray[np.float64]
    below: NDArray[np.float64]
    height: NDArray[np.float64]


def shapes_of(
    cloud: NDArray[np.floating],
    labels: NDArray[np.integer],
    root_point: int,
    stem: bool = False,
) -> Shapes:
    """The organs of an (N, 3) cloud with (N,) labels, the stem's base at point `root_point`.

    stem: whether the organ there is known to be the stem, however the others seem to hang together.
    """
    names, members = split_by_label(labels)
    root = names.index(int(labels[root_point]))
    parents = _parents(cloud, members, root)
    samples = [cloud[_thinned(own, SAMPLE)].astype(np.float64) for own in members]
    foot = cloud[root_point].astype(np.float64)
    bases = np.array(
        [
            foot if parent == NO_PARENT else _base(sample, samples[parent])
            for sample, parent in zip(samples, parents, strict=True)
        ]
    )
    reach = [sample - base for sample, base in zip(samples, bases, strict=True)]
    sizes = np.array([np.sqrt((r**2).sum(axis=1).mean()) for r in reach])
    mean = np.array([r.mean(axis=0) for r in reach])
    length = np.linalg.norm(mean, axis=1, keepdims=True)
    along = np.linalg.norm(bases - foot, axis=1)
    stem = stem or _is_stem(root, parents)
    return Shapes(
        labels=names,
        samples=samples,
        bases=bases,
        sizes=sizes,
        directions=np.divide(mean, length, out=np.zeros_like(mean), where=length > 0),
        below=_number_below(along, root, APART * _overall(sizes)) if stem else np.zeros(len(names)),
        height=along / max(along.max(), np.finfo(float).tiny) if stem else np.zeros(len(names)),
    )


def _thinned(members: NDArray[np.intp], most: int) -> NDArray[np.intp]:
    return members[:: -(-len(members) // most)]


def _parents(cloud: NDArray[np.floating], members: list[NDArray[np.intp]], root: int) -> list[int]:
    """The organ that each grows from, found on some of the points; the root where unclear."""
    some = [_thinned(own, CONTACTS) for own in members]
    owner = np.repeat(np.arange(len(some)), [len(own) for own in some])
    parents = hierarchy_from_labels(cloud[np.concatenate(some)], owner, root).parents
    count = len(members)
    return [
        NO_PARENT if organ == root else parent if parent < count else root
        for organ, parent in enumerate(parents[:count])
    ]


def _base(sample: NDArray[np.float64], parent: NDArray[np.float64]) -> NDArray[np.float64]:
    from scipy.spatial import cKDTree

    gaps = cKDTree(parent).query(sample)[0]
    base: NDArray[np.float64] = sample[np.argsort(gaps, kind="stable")[:ATTACHED]].mean(axis=0)
    return base


def _is_stem(root: int, parents: list[int]) -> bool:
    """Whether the order along the root means anything: not where leaves without a stem overlap."""
    carried = np.bincount([p for p in parents if p != NO_PARENT], minlength=len(parents))
    others = np.delete(carried, root)
    most = others.max(initial=0)
    alone = (carried > 0).sum() <= 1
    return bool(alone or carried[root] > most or most > 0.5 * (len(parents) - 1))


def _number_below(along: NDArray[np.float64], root: int, apart: float) -> NDArray[np.float64]:
    """How many organs other than the root begin nearer to the stem's base; a tie counts half.

    Of many organs, as of MANY: where hundreds branch off, a few more below mean little.
    """
    from scipy.special import expit

    nearer = expit((along[:, None] - along) / apart) if apart else np.full([len(along)] * 2, 0.5)
    np.fill_diagonal(nearer, 0.0)
    nearer[:, root] = 0.0
    number: NDArray[np.float64] = nearer.sum(axis=1)
    return number * min(1.0, MANY / len(along))


def _overall(sizes: NDArray[np.float64]) -> float:
    return float(np.sqrt((sizes**2).mean()))
