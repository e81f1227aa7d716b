"""What people put right about the organs, applied to the labels of the scans' points.

A cut changes the organs of one scan, and so does what is said of two places in one scan: that comes
before organs are followed. A "same" or "different" of two scans is heeded by who follows organs, so
that their neighbors fall into place too; and it holds whatever the labels come from.
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
from baker.scans import Finding, Series
from gclip.corrections import Correction, Corrections, Place

Labels = NDArray[np.int64]

MAX_DISTANCE = 20.0  # of a place from the scan's nearest point, in point spacings
MAX_POINTS_CUT = 5000  # of an organ, between two of which the fewest edges are searched for
SEED_SHARE = 0.4  # of the way between these two, that belongs to the nearer one


@dataclass(frozen=True)
class PointCorrection:
    """A correction whose places are points of the scans to bake."""

    said: str  # "Correction 2 (same) of 'plant.corrections.toml'"
    kind: str
    places: tuple[tuple[int, int], ...]  # (scan, point), by scan
    name: str = ""

    @property
    def scans(self) -> tuple[int, int]:
        """The first and the last of its scans."""
        return self.places[0][0], self.places[-1][0]

    @property
    def spans_scans(self) -> bool:
        """Whether it says which organ of a scan is which of another one."""
        return self.scans[0] < self.scans[1]


def locate_corrections(
    corrections: Sequence[Correction],
    raw: Series,
    series: Series,
    aligned: AlignedSeries,
    scale: float,
) -> tuple[PointCorrection, ...]:
    """Find the points that corrections name, of the scans to bake.

    Parameters
    ----------
    corrections : sequence of Correction
    raw, series : Series
        All scans, and those to bake: what is said of the others is left aside.
    aligned : AlignedSeries
        Of the scans to bake.
    scale : float
        Factor of the scans' points on what their files say.

    Raises
    ------
    InputError
        Where a scan is not in the series, or a place is far from it.
    """
    numbers = {scan.name: k for k, scan in enumerate(series.scans)}
    known, located = [scan.name for scan in raw.scans], []

    def point(place: Place, said: str) -> tuple[int, int]:
        k = numbers[place.scan]
        scan, spacing = series.scans[k], aligned.neighbors[k].spacing
        distances = np.linalg.norm(
            scan.points + (scan.origin - scale * np.array(place.point)), axis=1
        )
        nearest = int(distances.argmin())
        if distances[nearest] > MAX_DISTANCE * spacing:
            where = ", ".join(f"{axis:g}" for axis in place.point)
            raise InputError(
                f"{said}: ({where}) is {distances[nearest] / scale:.3g} from the nearest point of "
                f"'{place.scan}'; a place on the plant is needed, in that file's own coordinates."
            )
        return k, nearest

    source = f" of '{corrections.file}'" if isinstance(corrections, Corrections) else ""
    for number, one in enumerate(corrections, start=1):
        said = f"Correction {number} ({one.kind}){source}"
        if unknown := [place.scan for place in one.places if place.scan not in known]:
            raise InputError(
                f"{said} names the scan '{unknown[0]}', which is not in the series; "
                f"these are: {', '.join(known)}."
            )
        if all(place.scan in numbers for place in one.places):
            places = tuple(sorted((point(p, said) for p in one.places), key=itemgetter(0)))
            located.append(PointCorrection(said, one.kind, places, one.name))
    return tuple(located)


def corrections_finding(corrections: Sequence[Correction]) -> Finding:
    """How much was put right by hand."""
    counts = Counter(one.kind for one in corrections)
    kinds = ", ".join(f"{count} {kind}" for kind, count in counts.items())
    return Finding("organs", f"put right by hand: {kinds}")


def with_corrected_organs(
    labels: Sequence[Labels], aligned: AlignedSeries, corrections: Sequence[PointCorrection]
) -> list[Labels]:
    """Cut organs off, join those of one scan that are the same, and part those that are not.

    Parameters
    ----------
    labels : sequence of (N,) int64 ndarray
        The organ of each point of each scan.
    aligned : AlignedSeries
    corrections : sequence of PointCorrection

    Returns
    -------
    list of (N,) int64 ndarray
        What is cut off has labels of its own.
    """
    corrected, unused = list(labels), 1 + max(int(own.max()) for own in labels)
    for one in sorted(corrections, key=lambda one: one.kind != "cut"):
        (k, point), (last, other) = one.places[0], one.places[-1]
        own = corrected[k]
        if one.kind == "cut":
            part = _beyond(aligned, k, own == own[point], point, one.said)
        elif one.kind == "different" and k == last and own[point] == own[other]:
            part = _on_the_other_side(aligned.clouds[k], own == own[point], (point, other))
        else:
            if one.kind == "same" and k == last:
                corrected[k] = np.where(own == own[other], own[point], own)
            continue
        corrected[k], unused = np.where(part, unused, own), unused + 1
    return corrected


def relinked(labels: Sequence[Labels], corrections: Sequence[PointCorrection]) -> list[Labels]:
    """Give organs of different scans the same label, or different ones, as corrections say.

    From the later of two scans on, the two organs change labels: each of them stays whole. Organs
    that are not the same get a label of their own there.

    Raises
    ------
    InputError
        Where corrections contradict each other.
    """
    corrected, unused = list(labels), 1 + max(int(own.max()) for own in labels)
    links = sorted((c for c in corrections if c.spans_scans), key=lambda c: c.places[1][0])
    for one in links:
        (k, point), (later, other) = one.places
        a, b = corrected[k][point], corrected[later][other]
        if (a == b) == (one.kind == "same"):
            continue
        b, unused = (b, unused) if one.kind == "same" else (unused, unused + 1)
        for scan in range(later, len(corrected)):
            own = corrected[scan]
            corrected[scan] = np.where(own == a, b, np.where(own == b, a, own))
    for one in (one for one in corrections if len(one.places) == 2):
        (k, point), (later, other) = one.places
        if (corrected[k][point] == corrected[later][other]) != (one.kind == "same"):
            raise InputError(f"{one.said} contradicts the others; take one of them out.")
    return corrected


def organ_names(
    labels: Sequence[Labels], corrections: Sequence[PointCorrection]
) -> dict[int, PointCorrection]:
    """Which correction names an organ, by label; the last word counts."""
    named = (one for one in corrections if one.kind == "name")
    return {int(labels[k][point]): one for one in named for k, point in one.places}


def confirmed_organs(
    labels: Sequence[Labels], corrections: Sequence[PointCorrection]
) -> frozenset[tuple[int, int]]:
    """The organs that are known to be the same through an interval: (interval, label)."""
    same = [one.places for one in corrections if one.kind == "same" and one.spans_scans]
    return frozenset(
        (interval, int(labels[k][point]))
        for (k, point), (later, _) in same
        for interval in range(k, later)
    )


def _beyond(
    aligned: AlignedSeries, scan: int, organ: NDArray[np.bool_], point: int, said: str
) -> NDArray[np.bool_]:
    """(N,) what is connected to a point in its organ, and as far from the plant base or farther."""
    from scipy.sparse.csgraph import connected_components

    cloud, base = aligned.clouds[scan], aligned.bases[scan]
    graph, _, _ = connected_knn_graph(cloud, NEIGHBORS, aligned.neighbors[scan])
    distance = geodesic_distances(graph, np.array([base]))
    beyond = np.flatnonzero(organ & (distance >= distance[point]))
    _, component = connected_components(graph[beyond][:, beyond], directed=False)
    part = np.zeros(len(cloud), bool)
    part[beyond[component == component[np.searchsorted(beyond, point)]]] = True
    if part.sum() == organ.sum():
        raise InputError(f"{said}: all of the organ is as far from the plant's base, or farther.")
    return part


def _on_the_other_side(
    cloud: NDArray[np.floating], organ: NDArray[np.bool_], places: tuple[int, int]
) -> NDArray[np.bool_]:
    """(N,) what is on the second place's side of where the organ between the places is thinnest.

    A minimum cut of its kNN graph: what is within a share of the way from one place to the other
    belongs to the nearer one, and between them the fewest edges are cut.
    """
    from scipy.sparse import block_array, csr_array
    from scipy.sparse.csgraph import breadth_first_order, maximum_flow
    from scipy.spatial import KDTree

    points = np.flatnonzero(organ)
    some = np.random.default_rng(0).permutation(np.setdiff1d(points, places))
    sample = cloud[[*places, *some[:MAX_POINTS_CUT]]]
    graph, _, _ = connected_knn_graph(sample, NEIGHBORS)
    distance = np.stack([geodesic_distances(graph, np.array([place])) for place in (0, 1)], axis=1)
    count, is_certain = len(sample), distance <= SEED_SHARE * distance[1, 0]
    links, ends = csr_array(graph + graph.T > 0), csr_array(is_certain * count)
    network = block_array([[links, ends], [ends.T, None]], format="csr", dtype=np.int32)
    left = network - maximum_flow(network, count, count + 1).flow
    left.eliminate_zeros()
    other = np.ones(count + 2, bool)
    other[breadth_first_order(left, count, return_predecessors=False)] = False
    part = np.zeros(len(cloud), bool)
    part[points] = other[KDTree(sample).query(cloud[points])[1]]
    return part
