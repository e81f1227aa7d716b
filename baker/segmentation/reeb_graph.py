"""The Reeb graph of a plant: components of the level sets of the geodesic distance from its base.

The plant is down-sampled to one point in each voxel. Lengths are relative to the diameter of the
stem, which is measured first, so that unit and density of the scan don't matter.

Where leaves touch, the graph has loops. They are cut to get a tree: each point stays in the
component through which the shortest path from the base reaches it. A small loop is a hole in the
scan instead, and is filled.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from baker.geometry.graph import Graph, chain_ends, connected_knn_graph, edge_components
from baker.geometry.neighbors import nearest_neighbors
from baker.geometry.sampling import voxel_downsample, voxel_size_for

Floats = NDArray[np.floating]

# docs/method.md, "Organs without labels".
COARSE_SIZE, FINE_SIZE = 4_000, 10_000  # most points to measure the stem, and to segment the plant
VOXEL_SIZE, NEIGHBORS = 0.2, 12  # in stem diameters; in the mutual kNN graph
# Number of neighbours in the graph of paths and level sets, times the evenness of the points: the
# ratio of their spacing to the radius of their neighbourhoods, 0.5 if even and 0.3 at random.
EVEN_NEIGHBORS = 4.0
LEVEL_THICKNESS = 2.5  # of a level set, in point spacings
STEM_LENGTH = 6.0  # of the part of the stem that is measured, in its diameters
MIN_POINTS, MIN_POINTS_OF_SECTION = 30, 6  # to measure the stem: of the sample, of a section
FIRST_DIAMETER, MIN_DIAMETER = 8.0, 2.75  # of the fixed-point iteration, in point spacings
SHIFTS = 0.0, 0.25, 0.5, 0.75  # of the sets of sections that it measures, in their thicknesses
MAX_ITERATIONS, MAX_CHANGE = 15, 0.02  # of that iteration; relative change at which it ends
MAX_HOLE = 1.0  # length of a loop that is a hole in the scan, in stem diameters


@dataclass(frozen=True)
class PlantSample:
    """A sample of a plant's points, and their geodesic distances from the plant base."""

    points: NDArray[np.float64]  # (n, 3)
    nearest: NDArray[np.intp]  # (N,) index of the sample's point nearest to each point of the scan
    graph: Graph  # (n, n) the connected mutual kNN graph
    sparse_graph: Graph  # (n, n) the same of fewer neighbours; of paths and level sets
    distance: NDArray[np.float64]  # (n,) geodesic distance from the plant base
    predecessor: NDArray[np.intp]  # (n,) previous point on the shortest path; -1 at the base
    spacing: float  # median even spacing of the sample's points
    diameter: float  # of the stem; 0 if there are too few points

    @property
    def thickness(self) -> float:
        """The thickness of a level set of the distance."""
        return LEVEL_THICKNESS * self.spacing

    @property
    def level(self) -> NDArray[np.intp]:
        """(n,) level set of each point, from 0 on."""
        return (self.distance / self.thickness).astype(np.intp)


@dataclass(frozen=True)
class ReebTree:
    """A tree of m nodes, the components of level sets; parents have smaller numbers."""

    node: NDArray[np.intp]  # (n,) the node of each point of the sample
    parent: list[int]  # of each node; -1 for the root, node 0
    children: list[list[int]]
    width: Floats  # (m,) width of each node's section
    tip_distance: NDArray[np.float64]  # (m,) from the start of each node to its farthest tip

    def subtree_sums(self, values: NDArray[np.number | np.bool_]) -> NDArray[np.float64]:
        """(m,) sums of (m,) values over the subtree of each node."""
        sums = np.array(values, np.float64)
        for node in range(len(self.parent) - 1, 0, -1):
            sums[self.parent[node]] += sums[node]
        return sums


def reeb_tree(sample: PlantSample) -> ReebTree:
    """Compute the Reeb graph of the geodesic distance from the base, with its loops cut."""
    level, parent, depth = sample.level, list[int](), list[int]()
    node = np.full(len(level), -1)
    # On the shortest path to each point, the point where it enters the level set of that point.
    previous = sample.predecessor
    is_inside = (previous >= 0) & (level[previous] == level)
    entry = chain_ends(np.where(is_inside, previous, np.arange(len(level))))
    for members in _level_components(sample.sparse_graph, level):
        node_level, before_entry = int(level[members[0]]), previous[entry[members]]
        source = np.where(before_entry < 0, -1, node[before_entry])
        # Split the component by the nodes that it is reached from, unless they enclose a hole.
        origins, origin_of, counts = np.unique(source, return_inverse=True, return_counts=True)
        numbers, found = np.empty(len(origins), np.intp), dict[int, int]()  # of nodes, by origin
        for k in np.argsort(-counts, kind="stable").tolist():
            origin = int(origins[k])
            for main in found:
                loop = node_level - depth[_common_ancestor(parent, origin, main)]
                if loop * sample.thickness < MAX_HOLE * sample.diameter:
                    break
            else:
                main = origin
                found[main] = len(parent)
                parent.append(origin)
                depth.append(node_level)
            numbers[k] = found[main]
        node[members] = numbers[origin_of]
    children: list[list[int]] = [[] for _ in parent]
    tip_distance = np.full(len(parent), sample.thickness)
    for child in range(len(parent) - 1, 0, -1):
        node_below, through_child = parent[child], tip_distance[child] + sample.thickness
        children[node_below].insert(0, child)
        tip_distance[node_below] = max(tip_distance[node_below], through_child)
    width = section_widths(sample.points, sample.distance, node)
    return ReebTree(node, parent, children, width, tip_distance)


def _level_components(graph: Graph, level: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """The points of each connected component of all level sets, sorted by level."""
    ends = np.stack(graph.nonzero())
    component = edge_components(ends[:, level[ends[0]] == level[ends[1]]], len(level))
    order = np.lexsort((component, level))
    return np.split(order, np.flatnonzero(np.diff(component[order])) + 1)


def _common_ancestor(parent: list[int], i: int, j: int) -> int:
    """The lowest common ancestor of two nodes; parents have smaller numbers."""
    while i != j:
        i, j = (parent[i], j) if i > j else (i, parent[j])
    return i


def sample_plant(points: NDArray[np.floating], base: int) -> PlantSample:
    """Down-sample (N, 3) points to voxels of a fifth of the stem diameter, with a kNN graph.

    base: index of the point at the plant base.
    """
    cloud = np.asarray(points, np.float64)
    coarse = _sample_voxels(cloud, voxel_size_for(cloud, COARSE_SIZE), base)
    if coarse.diameter == 0.0:
        return coarse
    size = max(VOXEL_SIZE * coarse.diameter, voxel_size_for(cloud, FINE_SIZE))
    return _sample_voxels(cloud, size, base)


def _sample_voxels(cloud: NDArray[np.float64], size: float, base: int) -> PlantSample:
    """The sample of one point in each voxel with edges of length `size`, without outliers."""
    from scipy.sparse.csgraph import dijkstra
    from scipy.spatial import cKDTree

    points = cloud[voxel_downsample(cloud, size)]
    neighbors = nearest_neighbors(points, NEIGHBORS)
    if not neighbors.inliers.all():
        points = points[neighbors.inliers]
        neighbors = nearest_neighbors(points, NEIGHBORS)
    graph = connected_knn_graph(points, NEIGHBORS, neighbors, mutual=True)
    evenness = neighbors.spacing / max(float(np.median(neighbors.radii)), np.finfo(float).tiny)
    k = round(EVEN_NEIGHBORS / max(evenness, EVEN_NEIGHBORS / NEIGHBORS))
    sparse = connected_knn_graph(points, k, neighbors, mutual=True)
    nearest, spacings = cKDTree(points).query(cloud)[1], neighbors.even_spacings
    diameter = _stem_diameter(points, graph, dijkstra(graph, False, nearest[base]), spacings)
    distance, before = dijkstra(sparse, False, nearest[base], return_predecessors=True)
    predecessor, spacing = np.maximum(before, -1).astype(np.intp), float(np.median(spacings))
    return PlantSample(points, nearest, graph, sparse, distance, predecessor, spacing, diameter)


def _stem_diameter(points: Floats, graph: Graph, distance: Floats, spacings: Floats) -> float:
    """Median width of the sections up to six diameters above the base, by fixed-point iteration.

    It is 0 if there are too few points. spacings: (n,) point spacing around each point.
    """
    diameter = FIRST_DIAMETER * float(np.median(spacings))
    if diameter == 0.0 or len(points) < MIN_POINTS:
        return 0.0
    for _ in range(MAX_ITERATIONS):
        spacing = float(np.median(spacings[distance <= STEM_LENGTH * diameter]))
        thickness = LEVEL_THICKNESS * spacing
        last = np.ceil((STEM_LENGTH - 0.5) * diameter / thickness) - 1
        sections = list[NDArray[np.intp]]()
        for shift in SHIFTS:
            level = np.floor((distance - 0.5 * diameter) / thickness - shift).astype(np.intp)
            stem = np.flatnonzero((level >= 0) & (level <= last))
            components = _level_components(graph[stem][:, stem], level[stem])
            sections += [stem[c] for c in components if len(c) >= MIN_POINTS_OF_SECTION]
        if not sections:
            return 0.0
        weights, chosen, previous = [*map(len, sections)], np.concatenate(sections), diameter
        number = np.repeat(np.arange(len(sections)), weights)
        widths = section_widths(points[chosen], distance[chosen], number)
        diameter = float(np.quantile(widths, 0.5, weights=weights, method="inverted_cdf"))
        diameter = max(diameter, MIN_DIAMETER * spacing)
        if abs(diameter - previous) < MAX_CHANGE * previous:
            break
    return diameter


def section_widths(points: Floats, distance: Floats, section: NDArray[np.intp]) -> Floats:
    """(m,) root mean square diameters of sections, perpendicular to the gradient of the distance.

    points, distance, section: (n, 3), (n,) and (n,) number of the section of each point, from 0.
    """
    count = np.bincount(section)[:, None]

    def sums(values: Floats) -> Floats:
        return np.stack([np.bincount(section, column) for column in values.T], axis=1)

    centered = points - (sums(points) / count)[section]
    slope = distance[:, None] - (sums(distance[:, None]) / count)[section]
    gradient = sums(centered * slope)
    gradient /= np.maximum(np.linalg.norm(gradient, axis=1, keepdims=True), np.finfo(float).tiny)
    along = (centered * gradient[section]).sum(axis=1, keepdims=True)
    variance = sums((centered**2).sum(axis=1, keepdims=True) - along**2) / count
    return 2.0 * np.sqrt(np.maximum(variance[:, 0], 0.0))
