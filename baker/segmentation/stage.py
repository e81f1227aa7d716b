"""The segmentation stage: labels where there are any and they are wanted, else organs or forks."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from baker.geometry.contacts import Gaps
from baker.geometry.parallel import MapLike, reporting
from baker.geometry.spacing import Surroundings
from baker.matching.labels import LabelUse, labels_of_organs, labels_of_pieces, use_of_labels
from baker.options import Options
from baker.recipe import Recipe
from baker.scans import Scan
from baker.segmentation.hierarchy import Hierarchy
from baker.segmentation.organs import segment_organs
from baker.segmentation.series import labelled_hierarchies, thin_hierarchies, whole_hierarchies


def segment_scans(
    scans: Sequence[Scan],
    clouds: Sequence[NDArray[np.float32]],
    bases: Sequence[int],
    measured: Sequence[Surroundings],
    recipe: Recipe,
    options: Options,
    tell: Callable[[str, int, int], None],
    map: MapLike = map,
) -> tuple[LabelUse, list[Hierarchy]]:
    """How labels are used, and each scan's hierarchy.

    clouds: aligned positions, (N, 3) each; bases: the point at each scan's stem base; measured:
            what each has around its points, with the labels as they were read.
    map: maps a function over scans.
    """
    map = reporting(map, partial(tell, "segmentation"), len(clouds))
    ignored = recipe.whole or options.segment != "auto"
    wanted = "ignore" if ignored else options.labels
    labels = use_of_labels(scans, clouds, bases, wanted, recipe.match_by_shape)
    if recipe.whole:
        return labels, whole_hierarchies(clouds)
    if labels.labels is None and _at_forks(recipe, options):
        k, threshold = options.graph_neighbors, options.bifurcation
        hierarchies = thin_hierarchies(clouds, bases, k, threshold, map)
        if not recipe.match_by_shape:
            return labels, hierarchies
        labels = labels_of_pieces(clouds, hierarchies, bases, labels.sentence)
    elif labels.labels is None:
        numbers = segment_organs(clouds, bases, map)
        labels = labels_of_organs(clouds, numbers, bases, labels.sentence)
    assert labels.labels is not None
    return labels, labelled_hierarchies(
        clouds,
        labels.labels,
        bases,
        consistent=labels.consistent,
        agreeing=recipe.match_by_shape,
        virtual_root=options.root == "virtual",
        spacings=[around.spacing for around in measured],
        touching=None if labels.renamed else _known([around.touching for around in measured]),
        map=map,
    )


def _known(touching: Sequence[Gaps | None]) -> list[Gaps] | None:
    """All of them, or None where one is missing."""
    known = [gaps for gaps in touching if gaps is not None]
    return known if len(known) == len(touching) else None


def _at_forks(recipe: Recipe, options: Options) -> bool:
    """Whether to cut thin structures at their forks: as asked, or as the paper does."""
    return options.segment == "thin" or (options.segment == "auto" and not recipe.match_by_shape)
