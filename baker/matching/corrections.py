"""Apply the corrections of users to the organs of a series.

Corrections of kind "cut", and those with two places in one scan, change the organs of that scan
before organs are tracked. Corrections of kind "same" or "different" with places in two scans are
constraints of the tracking, which may also correct neighbouring organs, and are enforced on the
labels afterwards.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from operator import itemgetter

import numpy as np
from numpy.typing import NDArray

from baker.alignment.keyframes import AlignedSeries
from baker.errors import InputError
from baker.geometry.graph import connected_knn_graph, geodesic_distances
from baker.geometry.neighbors import NEIGHBORS
from baker.scans.scan import Finding, Series
from corrections import Correction, Corrections, Place

Labels = NDArray[np.int64]
Mask = NDArray[np.bool_]

MAX_DISTANCE = 20.0  # point spacings from a place to the nearest point of the scan
MAX_POINTS_CUT = 5000  # number of points of an organ in the graph whose minimum cut is computed
SEED_SHARE = 0.4  # of the geodesic distance of two places: points within it belong to the place


@dataclass(frozen=True)
class PointCorrection:
    """A correction whose places are points of the scans to bake."""

    title: str  # for messages: "Correction 2 (same) of 'plant.corrections.toml'"
    kind: str
    places: tuple[tuple[int, int], ...]  # (scan, point), sorted by scan
    name: str = ""

    @property
    def scans(self) -> tuple[int, int]:
        """The first and the last of its scans."""
        return self.places[0][0], self.places[-1][0]

    @property
    def spans_scans(self) -> bool:
        """Whether its places are in two different scans."""
        return self.scans[0] < self.scans[1]


def locate_corrections(
    corrections: Sequence[Correction],
    raw: Series,
    series: Series,
    aligned: AlignedSeries,
    scale: float,
) -> tuple[PointCorrection, ...]:
    """Find the points of the scans that corrections refer to.

    raw, series, aligned: all scans, the scans to bake, and these in one frame; corrections in
    others are ignored. scale: the factor by which the coordinates in the files were multiplied.
    Raises InputError if a scan is not in the series, or a place is far from its points.
    """
    numbers = {scan.name: k for k, scan in enumerate(series.scans)}
    scan_names, located = [scan.name for scan in raw.scans], []

    def locate(place: Place, title: str) -> tuple[int, int]:
        """The numbers of a place's scan and of the point nearest to the place."""
        k = numbers[place.scan]
        scan = series.scans[k]
        offsets = scan.points + (scan.origin - scale * np.array(place.point))
        distances = np.linalg.norm(offsets, axis=1)
        nearest = int(distances.argmin())
        if distances[nearest] > MAX_DISTANCE * aligned.neighbors[k].spacing:
            position = ", ".join(f"{axis:g}" for axis in place.point)
            raise InputError(
                f"{title}: ({position}) is {distances[nearest] / scale:.3g} from the nearest point "
                f"of '{place.scan}'; a place on the plant is needed, in that file's own "
                "coordinates."
            )
        return k, nearest

    source = f" of '{corrections.file}'" if isinstance(corrections, Corrections) else ""
    for number, correction in enumerate(corrections, start=1):
        title = f"Correction {number} ({correction.kind}){source}"
        if unknown := [place.scan for place in correction.places if place.scan not in scan_names]:
            raise InputError(
                f"{title} names the scan '{unknown[0]}', which is not in the series; "
                f"these are: {', '.join(scan_names)}."
            )
        if all(place.scan in numbers for place in correction.places):
            places = tuple(sorted((locate(p, title) for p in correction.places), key=itemgetter(0)))
            located.append(PointCorrection(title, correction.kind, places, correction.name))
    return tuple(located)


def corrections_finding(corrections: Sequence[Correction]) -> Finding:
    """Make a finding that counts the corrections of each kind."""
    counts = Counter(correction.kind for correction in corrections)
    kinds = ", ".join(f"{count} {kind}" for kind, count in counts.items())
    return Finding("organs", f"put right by hand: {kinds}")


def with_corrected_organs(
    labels: Sequence[Labels], aligned: AlignedSeries, corrections: Sequence[PointCorrection]
) -> list[Labels]:
    """Apply the corrections with places in one scan: cut organs off, join and separate them.

    labels: for each scan the (N,) organs of its points. Parts that are cut off have new labels.
    """
    corrected = list(labels)
    for correction in sorted(corrections, key=lambda item: item.kind != "cut"):
        (k, point), (_, second_point) = correction.places[0], correction.places[-1]
        organs = corrected[k]
        organ = organs == organs[point]
        if correction.kind == "cut":
            part = _distal_part(aligned, k, organ, point, correction.title)
            corrected[k] = np.where(part, _unused_label(corrected), organs)
        elif correction.spans_scans or correction.kind == "name":
            continue
        elif correction.kind == "same":
            corrected[k] = np.where(organs == organs[second_point], organs[point], organs)
        elif organ[second_point]:
            part = _minimum_cut(aligned.clouds[k], organ, (point, second_point))
            corrected[k] = np.where(part, _unused_label(corrected), organs)
    return corrected


def _unused_label(labels: Sequence[Labels]) -> int:
    """The smallest label that is greater than all labels of the scans."""
    return 1 + max(int(organs.max()) for organs in labels)


def with_corrected_links(
    labels: Sequence[Labels], corrections: Sequence[PointCorrection]
) -> list[Labels]:
    """Apply the corrections with places in two scans to labels that are consistent.

    From the later scan on, an organ that is the same as an earlier one swaps labels with the organ
    that has the earlier one's label, and an organ that is a different one gets a new label. Raises
    InputError if corrections contradict each other.

    labels: for each scan the (N,) organs of its points.
    """
    corrected = list(labels)
    links = sorted((c for c in corrections if c.spans_scans), key=lambda c: c.places[1][0])
    for correction in links:
        (k, point), (later, later_point) = correction.places
        a, b = corrected[k][point], corrected[later][later_point]
        if (a == b) == (correction.kind == "same"):
            continue
        b = b if correction.kind == "same" else _unused_label(corrected)
        for scan in range(later, len(corrected)):
            organs = corrected[scan]
            corrected[scan] = np.where(organs == a, b, np.where(organs == b, a, organs))
    for correction in (c for c in corrections if len(c.places) == 2):
        (k, point), (later, later_point) = correction.places
        if (corrected[k][point] == corrected[later][later_point]) != (correction.kind == "same"):
            raise InputError(f"{correction.title} contradicts the others; take one of them out.")
    return corrected


def organ_names(
    labels: Sequence[Labels], corrections: Sequence[PointCorrection]
) -> dict[int, PointCorrection]:
    """The last correction that names an organ, by the organ's label.

    labels: (N,) int organs of each scan, with consistent labels.
    """
    named = (correction for correction in corrections if correction.kind == "name")
    return {int(labels[k][point]): item for item in named for k, point in item.places}


def confirmed_organs(
    labels: Sequence[Labels], corrections: Sequence[PointCorrection]
) -> frozenset[tuple[int, int]]:
    """The (interval, label) of organs that corrections confirm to be the same in both its scans.

    labels: (N,) int organs of each scan, with consistent labels.
    """
    same = [item.places for item in corrections if item.kind == "same" and item.spans_scans]
    return frozenset(
        (interval, int(labels[k][point]))
        for (k, point), (later, _) in same
        for interval in range(k, later)
    )


def _distal_part(aligned: AlignedSeries, scan: int, organ: Mask, point: int, title: str) -> Mask:
    """(N,) the part of an organ that a cut at a point separates from the plant base.

    Its points are at least as far from the plant base as that point, and connected to it.
    """
    from scipy.sparse.csgraph import connected_components

    cloud, base = aligned.clouds[scan], aligned.bases[scan]
    graph = connected_knn_graph(cloud, NEIGHBORS, aligned.neighbors[scan])
    distance = geodesic_distances(graph, np.array([base]))
    distal = np.flatnonzero(organ & (distance >= distance[point]))
    _, component = connected_components(graph[distal][:, distal], directed=False)
    part = np.zeros(len(cloud), bool)
    part[distal[component == component[np.searchsorted(distal, point)]]] = True
    if part.sum() == organ.sum():
        raise InputError(f"{title}: all of the organ is as far from the plant's base, or farther.")
    return part


def _minimum_cut(cloud: NDArray[np.floating], organ: Mask, places: tuple[int, int]) -> Mask:
    """(N,) the part of an organ on the side of the second place, by a minimum cut of its kNN graph.

    Points within `SEED_SHARE` of the distance between the places are linked to the nearer place.
    """
    from scipy.sparse import block_array, csr_array
    from scipy.sparse.csgraph import breadth_first_order, maximum_flow
    from scipy.spatial import cKDTree

    points = np.flatnonzero(organ)
    candidates = np.random.default_rng(0).permutation(np.setdiff1d(points, places))
    sample = cloud[[*places, *candidates[:MAX_POINTS_CUT]]]
    graph = connected_knn_graph(sample, NEIGHBORS)
    distance = np.stack([geodesic_distances(graph, np.array([place])) for place in (0, 1)], axis=1)
    count, is_certain = len(sample), distance <= SEED_SHARE * distance[1, 0]
    links, ends = csr_array(graph + graph.T > 0), csr_array(is_certain * count)
    network = block_array([[links, ends], [ends.T, None]], format="csr", dtype=np.int32)
    residual = network - maximum_flow(network, count, count + 1).flow
    residual.eliminate_zeros()
    is_second = np.ones(count + 2, bool)
    is_second[breadth_first_order(residual, count, return_predecessors=False)] = False
    part = np.zeros(len(cloud), bool)
    part[points] = is_second[cKDTree(sample).query(cloud[points])[1]]
    return part
