"""The Reeb graph of a plant: components of the level sets of the geodesic distance from its base.

The plant is thinned to one point a voxel first. All lengths are in diameters of the stem, which is
measured here: so it does not matter in what unit, how densely or how evenly a plant was scanned.

Where leaves touch, the graph has loops; they are cut, each point staying with the component that it
was reached through, so that a tree is left. A small loop is no touch of two organs but a hole in
the scan, and is closed again.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import chain_ends, connected_knn_graph
from baker.geometry.neighbors import NEIGHBORS_FOR_REACH, nearest_neighbors, point_spacing
from baker.geometry.sampling import voxel_downsample, voxel_size_for
from baker.segmentation.hierarchy import split_by_label

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

COARSE_SIZE, FINE_SIZE = 4_000, 10_000  # points at most: to measure the stem, and to segment with
VOXEL_SIZE = 0.2  # in stem diameters
LEVEL_THICKNESS, MIN_LEVEL_THICKNESS = 0.35, 2.5  # in stem diameters, in point spacings at least
STEM_LENGTH = 6.0  # that the stem is measured over, in its diameters
MIN_POINTS_OF_SECTION = 6
MAX_ROUNDS = 15
MAX_HOLE = 2.0  # length of a loop that is but a hole, in stem diameters


@dataclass(frozen=True)
class PlantSample:
    """A plant's points, one a voxel, and their geodesic distances from the plant base."""

    points: NDArray[np.float64]  # (n, 3)
    nearest: NDArray[np.intp]  # (N,) the sample's point nearest to each point of the cloud
    graph: "csr_matrix"  # (n, n) the connected kNN graph
    distance: NDArray[np.float64]  # (n,) geodesic distance from the plant base
    predecessor: NDArray[np.intp]  # (n,) the point before on the path from there; -1 at the base
    spacing: float  # point spacing of the sample
    diameter: float  # of the stem; 0 where the cloud is too small to tell

    @property
    def thickness(self) -> float:
        """Of a level set of the distance."""
        return max(LEVEL_THICKNESS * self.diameter, MIN_LEVEL_THICKNESS * self.spacing)


@dataclass(frozen=True)
class ReebTree:
    """Components of level sets, m nodes numbered from the base on: parents before children."""

    node: NDArray[np.intp]  # (n,) the node of each point of the sample
    parent: list[int]  # of each node; -1 for the root, node 0
    children: list[list[int]]
    count: NDArray[np.float64]  # (m,) points of each node
    width: NDArray[np.float64]  # (m,) of each node's section
    reach: NDArray[np.float64]  # (m,) distance from a node's beginning to the farthest tip beyond

    def subtree_sums(self, values: NDArray[np.floating]) -> NDArray[np.float64]:
        """(m,) sums over each node and all nodes beyond it of (m,) values."""
        sums = np.array(values, np.float64)
        for node in range(len(self.parent) - 1, 0, -1):
            sums[self.parent[node]] += sums[node]
        return sums


def reeb_tree(sample: PlantSample) -> ReebTree:
    """Cut the sample into level sets of its distance from the base and hang them into a tree."""
    level = (sample.distance / sample.thickness).astype(np.intp)
    node, parent, depth = np.full(len(level), -1), list[int](), list[int]()
    # Where the path to each point entered that point's level set.
    before = sample.predecessor
    is_inside = (before >= 0) & (level[before] == level)
    entry = chain_ends(np.where(is_inside, before, np.arange(len(level))))
    for members in _parts(sample.graph, level):
        here = int(level[members[0]])
        through = before[entry[members]]
        source = np.where(through < 0, -1, node[through])
        for origin, own in _by_origin(members, source, parent, depth, here, sample):
            node[own] = len(parent)
            parent.append(origin)
            depth.append(here)
    return _measured(sample, node, parent)


def _parts(graph: "csr_matrix", level: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """The connected parts of all level sets, from the base on."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    edges = graph.tocoo()
    inside = level[edges.row] == level[edges.col]
    shape = edges.shape
    kept = coo_matrix((edges.data[inside], (edges.row[inside], edges.col[inside])), shape)
    _, part = connected_components(kept, directed=False)
    order = np.lexsort((part, level))
    return np.split(order, np.flatnonzero(np.diff(part[order])) + 1)


def _by_origin(
    members: NDArray[np.intp],
    source: NDArray[np.intp],
    parent: list[int],
    depth: list[int],
    level: int,
    sample: PlantSample,
) -> list[tuple[int, NDArray[np.intp]]]:
    """A part's points by the node that they were reached through, holes closed."""
    origins, counts = np.unique(source, return_counts=True)
    if len(origins) == 1:
        return [(int(origins[0]), members)]
    kept: dict[int, list[int]] = {}
    for origin in origins[np.argsort(-counts, kind="stable")].tolist():
        for other, joined in kept.items():
            loop = level - depth[_fork(parent, origin, other)]
            if loop * sample.thickness < MAX_HOLE * sample.diameter:
                joined.append(origin)
                break
        else:
            kept[origin] = [origin]
    return [(origin, members[np.isin(source, joined)]) for origin, joined in kept.items()]


def _fork(parent: list[int], one: int, other: int) -> int:
    """The last node that two nodes are both reached through; parents have smaller numbers."""
    while one != other:
        one, other = (parent[one], other) if one > other else (one, parent[other])
    return one


def _measured(sample: PlantSample, node: NDArray[np.intp], parent: list[int]) -> ReebTree:
    children: list[list[int]] = [[] for _ in parent]
    reach = np.full(len(parent), sample.thickness)
    for child in range(len(parent) - 1, 0, -1):
        children[parent[child]].insert(0, child)
        reach[parent[child]] = max(reach[parent[child]], reach[child] + sample.thickness)
    _, members = split_by_label(node)
    width = np.array([section_width(sample.points[m], sample.distance[m]) for m in members])
    count = np.array([len(m) for m in members], np.float64)
    return ReebTree(node, parent, children, count, width, reach)


def sample_plant(points: NDArray[np.floating], base: int, k: int) -> PlantSample:
    """Thin a cloud to voxels of a fifth of its stem's diameter, k neighbors a point."""
    cloud = np.asarray(points, np.float64)
    coarse = _sampled(cloud, voxel_size_for(cloud, COARSE_SIZE), base, k)
    if coarse.diameter == 0.0:
        return coarse
    size = max(VOXEL_SIZE * coarse.diameter, voxel_size_for(cloud, FINE_SIZE))
    return _sampled(cloud, size, base, k)


def _sampled(cloud: NDArray[np.float64], size: float, base: int, k: int) -> PlantSample:
    from scipy.sparse.csgraph import dijkstra
    from scipy.spatial import KDTree

    points = cloud[voxel_downsample(cloud, size)]
    points = points[nearest_neighbors(points, NEIGHBORS_FOR_REACH).inliers]
    tree = KDTree(points)
    graph, _, _ = connected_knn_graph(points, k)
    root = int(tree.query(cloud[base])[1])
    distance, before = dijkstra(graph, directed=False, indices=root, return_predecessors=True)
    predecessor = np.where(before < 0, -1, before).astype(np.intp)
    spacing = point_spacing(points)
    diameter = _stem_diameter(points, graph, distance, spacing)
    nearest = tree.query(cloud)[1]
    return PlantSample(points, nearest, graph, distance, predecessor, spacing, diameter)


def _stem_diameter(
    points: NDArray[np.float64], graph: "csr_matrix", distance: NDArray[np.float64], spacing: float
) -> float:
    """Median width of the sections up to six diameters above the base; 0 where there are none.

    A fixed point, found by iteration.
    """
    if spacing == 0.0:
        return 0.0
    diameter = 8.0 * spacing
    for _ in range(MAX_ROUNDS):
        thickness = max(LEVEL_THICKNESS * diameter, MIN_LEVEL_THICKNESS * spacing)
        level = np.floor((distance - 0.5 * diameter) / thickness).astype(np.intp)
        last = np.ceil((STEM_LENGTH - 0.5) * diameter / thickness) - 1
        stem = np.flatnonzero((level >= 0) & (level <= last))
        sections = [stem[part] for part in _parts(graph[stem][:, stem], level[stem])]
        sections = [own for own in sections if len(own) >= MIN_POINTS_OF_SECTION]
        if not sections:
            return 0.0
        widths = [section_width(points[own], distance[own]) for own in sections]
        weights, before = [*map(len, sections)], diameter
        diameter = float(np.quantile(widths, 0.5, weights=weights, method="inverted_cdf"))
        if abs(diameter - before) < 0.02 * before:
            break
    return diameter


def section_width(points: NDArray[np.float64], distance: NDArray[np.float64]) -> float:
    """Diameter of the circle that the points of a section would lie on, seen along the way up."""
    centred = points - points.mean(axis=0)
    along = centred.T @ (distance - distance.mean())
    length = np.linalg.norm(along)
    if length > 0.0:
        along /= length
        centred = centred - np.outer(centred @ along, along)
    return float(2.0 * np.sqrt((centred**2).sum(axis=1).mean()))
