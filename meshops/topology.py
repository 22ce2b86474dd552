"""Topology: edges of a mesh, and which of them no operation may cross."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meshops._core import ElementGraph, find_edges, unit_normals
from meshops.mesh import NO_NODE, Bools, Floats, Ints, ShellMesh

FAR = 1 << 30
"""Rings to an element that cannot be reached."""

REGULAR = 4
"""Elements that meet at a regular inner node."""

FEATURE_ANGLE = 30.0
"""Degrees between the normals of two elements from which their edge counts as a feature."""

CORNER_ANGLE = 30.0
"""Degrees that a border turns by at a node from which that node is a corner."""


@dataclass(frozen=True, eq=False)
class Topology:
    """The edges of a mesh and the barriers among them.

    Attributes
    ----------
    edges : (E, 2) int32
        Node rows of each edge, the smaller first.
    element_edges : (M, 4) int32
        The edge of each element side (side k runs from node k to node k + 1); -1 fourth for a tria.
    edge_elements : (E, 2) int32
        The two elements of an edge that has exactly two; elsewhere -1.
    uses : (E,) int32
        How many elements meet at an edge: 1 on the border, 3 and more at a T-junction.
    crossable : (E,) bool
        Edges that an operation may cross. All others are barriers: borders, T-junctions, edges
        between regions, feature edges, edges of locked elements, and edges where two elements
        disagree about which side is up.
    """

    edges: Ints
    element_edges: Ints
    edge_elements: Ints
    uses: Ints
    crossable: Bools
    mesh: ShellMesh

    @property
    def is_border(self) -> Bools:
        """(E,) bool: edges with one element."""
        border: Bools = self.uses == 1
        return border

    @property
    def is_t_junction(self) -> Bools:
        """(E,) bool: edges where three and more elements meet."""
        junction: Bools = self.uses > 2
        return junction

    @cached_property
    def graph(self) -> ElementGraph:
        """Elements joined across crossable edges."""
        return ElementGraph(self.element_edges, self.edge_elements, self.crossable)

    @cached_property
    def fans(self) -> tuple[Ints, Ints, int]:
        """Fans: elements around a node that crossable edges connect.

        Returns the fan of each element corner, (M, 4) int32; the node of each fan, (F,) int32; and
        the first inner fan: those before it touch a barrier, those from it on close around their
        node.
        """
        mesh = self.mesh
        rows = np.arange(len(mesh.elements), dtype=np.int32)
        corners, nodes, border = self.graph.cut(rows, mesh.elements)
        return corners, nodes, int(border.max()) + 1 if len(border) else 0

    @cached_property
    def inner_nodes(self) -> Bools:
        """(N,) bool: nodes inside a zone, that nothing but their one fan uses."""
        _, nodes, first_inner = self.fans
        inner = np.zeros(len(self.mesh.points), bool)
        inner[nodes[first_inner:]] = True
        inner &= self._fans_of_node == 1
        return inner

    @cached_property
    def free_nodes(self) -> Bools:
        """(N,) bool: inner nodes that are not locked."""
        free: Bools = self.inner_nodes & ~self.mesh.locked_nodes
        return free

    @cached_property
    def border_neighbours(self) -> Ints:
        """(N, 2) int32: the nodes before and after a node along a border; -1 where it is held.

        Held is what does not lie between just two border edges, or is on another barrier too, or is
        locked, or belongs to a locked element. A border runs as the elements at it do.
        """
        mesh = self.mesh
        is_side = self.element_edges >= 0
        is_side &= self.is_border[self.element_edges]
        rows, sides = np.nonzero(is_side)
        size = np.where(mesh.is_tria, 3, 4)[rows]
        start, end = mesh.elements[rows, sides], mesh.elements[rows, (sides + 1) % size]
        # both ends of a fan are barriers: one fan and two border edges, so no others
        count = len(mesh.points)
        between = np.bincount(start, minlength=count) + np.bincount(end, minlength=count) == 2
        between &= (self._fans_of_node == 1) & ~mesh.locked_nodes
        corners = mesh.elements[mesh.locked_elements]
        between[corners[corners >= 0]] = False
        neighbours = np.full((count, 2), -1, np.int32)
        neighbours[end, 0] = start
        neighbours[start, 1] = end
        neighbours[~between] = -1
        return neighbours

    @cached_property
    def sliding_nodes(self) -> Bools:
        """(N,) bool: nodes that may slide along the border that they lie on.

        They are not held, and the border does not turn at them as at a corner.
        """
        points, neighbours = self.mesh.points, self.border_neighbours
        nodes = np.nonzero(neighbours[:, 0] >= 0)[0]
        one = points[nodes] - points[neighbours[nodes, 0]]
        two = points[neighbours[nodes, 1]] - points[nodes]
        size = np.linalg.norm(one, axis=1) * np.linalg.norm(two, axis=1)
        straight = np.einsum("ij,ij->i", one, two) > np.cos(np.radians(CORNER_ANGLE)) * size
        sliding = np.zeros(len(points), bool)
        sliding[nodes[straight]] = True
        return sliding

    @cached_property
    def _fans_of_node(self) -> Ints:
        return np.bincount(self.fans[1], minlength=len(self.mesh.points)).astype(np.int32)

    @cached_property
    def valence(self) -> Ints:
        """(N,) int32: elements that meet at each node."""
        return valences(self.mesh.elements, len(self.mesh.points))

    @cached_property
    def anchors(self) -> Bools:
        """(M,) bool: elements that stay so that a node inside a zone stays in the mesh.

        Such a node is locked, or another part of the mesh hangs on it. The first quad around it,
        or else the first tria, is its anchor: a patch cut around that has the node on its border.
        """
        corners, nodes, first_inner = self.fans
        pinned = self.mesh.locked_nodes[nodes] | (self._fans_of_node[nodes] > 1)
        pinned[:first_inner] = False
        anchors = np.zeros(len(corners), bool)
        is_corner = corners >= 0
        touching = np.nonzero((pinned[corners] & is_corner).any(axis=1))[0]
        held: set[int] = set()
        for row in touching[np.argsort(self.mesh.is_tria[touching], kind="stable")]:
            around = {int(fan) for fan in corners[row][is_corner[row]] if pinned[fan]}
            if not around <= held:
                anchors[row] = True
                held |= around
        return anchors

    @cached_property
    def editable(self) -> Bools:
        """(M,) bool: elements that an operation may take out of the mesh."""
        return ~(self.mesh.locked_elements | self.anchors)

    @cached_property
    def zones(self) -> Ints:
        """(M,) int32: number of the connected area, bounded by barriers, of each editable element.

        Elements that no operation may take out have -1.
        """
        return self.graph.label_components(self.editable)


def topology(mesh: ShellMesh, *, feature_angle: float = FEATURE_ANGLE) -> Topology:
    """Find edges and barriers; `feature_angle` in degrees."""
    edges, element_edges, edge_elements, uses, opposed = find_edges(mesh.elements, len(mesh.points))
    crossable = opposed
    left, right = edge_elements[crossable].T
    normals = element_normals(mesh)
    smooth = np.einsum("ij,ij->i", normals[left], normals[right]) >= np.cos(
        np.radians(feature_angle)
    )
    unlocked = ~(mesh.locked_elements[left] | mesh.locked_elements[right])
    crossable[crossable] = smooth & unlocked & (mesh.region[left] == mesh.region[right])
    return Topology(
        edges=edges,
        element_edges=element_edges,
        edge_elements=edge_elements,
        uses=uses,
        crossable=crossable,
        mesh=mesh,
    )


def valences(elements: Ints, nodes: int) -> Ints:
    """(nodes,) int32: how many of some elements meet at each node."""
    corners = elements[elements != NO_NODE]
    return np.bincount(corners, minlength=nodes).astype(np.int32)


def element_normals(mesh: ShellMesh) -> Floats:
    """(M, 3) unit normals; a quad's is that of its two diagonals; zero for a flat line."""
    return unit_normals(mesh.points, mesh.elements)
