"""Edges of a mesh, and the lines among them that a part is known by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from meshops.mesh import NO_NODE, Bools, Floats, Ids, ShellMesh

INSIDE, BORDER, JUNCTION, REGION, FEATURE = range(5)
"""Kinds of edges: with nothing special; of one element; of three and more; between two regions;
between elements that meet at an angle or disagree about which side is up."""

LINES = {BORDER: "free border", JUNCTION: "T-junction", REGION: "region edge", FEATURE: "crease"}
"""The kinds that are lines, and their names."""

FEATURE_ANGLE = 30.0
"""Degrees between two elements from which their edge is a crease."""

Kinds = NDArray[np.int8]


@dataclass(frozen=True, eq=False)
class Edges:
    """The edges of a mesh, each once.

    Attributes
    ----------
    nodes : (E, 2) int64
        Node rows, the smaller first.
    of_side : (M, 4) int64
        The edge of each side of an element, from corner k to k + 1; -1 fourth for a tria.
    uses : (E,) int64
        How many elements meet there.
    pair : (E, 2) int64
        The two elements of an edge that has just two; elsewhere -1.
    pair_sides : (E, 2) int64
        Which sides of these two it is.
    """

    nodes: Ids
    of_side: Ids
    uses: Ids
    pair: Ids
    pair_sides: Ids

    @classmethod
    def of(cls, mesh: ShellMesh) -> Edges:
        """Find the edges of a mesh."""
        rows, sides, ends = directed_sides(mesh)
        low, high = ends.min(axis=1), ends.max(axis=1)
        keys, inverse, uses = np.unique(
            low * len(mesh.points) + high, return_inverse=True, return_counts=True
        )
        of_side = np.full((len(mesh.elements), 4), -1, np.int64)
        of_side[rows, sides] = inverse
        order = np.argsort(inverse, kind="stable")
        first = np.searchsorted(inverse[order], np.flatnonzero(uses == 2))
        pair, pair_sides = np.full((2, len(keys), 2), -1, np.int64)
        for k in (0, 1):
            pair[uses == 2, k] = rows[order[first + k]]
            pair_sides[uses == 2, k] = sides[order[first + k]]
        nodes = np.column_stack(np.divmod(keys, max(len(mesh.points), 1)))
        return cls(nodes, of_side, uses, pair, pair_sides)

    def lengths(self, mesh: ShellMesh) -> Floats:
        """(E,) lengths."""
        start, end = mesh.points[self.nodes].transpose(1, 0, 2)
        found: Floats = np.linalg.norm(end - start, axis=1)
        return found


def directed_sides(mesh: ShellMesh) -> tuple[Ids, Ids, Ids]:
    """Sides of all elements as these run.

    Returns the (S,) element and (S,) number of each side, and its (S, 2) start and end.
    """
    count = np.where(mesh.is_tria, 3, 4)
    rows = np.repeat(np.arange(len(count)), count)
    sides = np.arange(len(rows)) - np.repeat(np.cumsum(count) - count, count)
    following = (sides + 1) % count[rows]
    ends = np.column_stack([mesh.elements[rows, sides], mesh.elements[rows, following]])
    return rows, sides, ends.astype(np.int64)


def corners_of(mesh: ShellMesh) -> Ids:
    """(M, 4) node rows; a tria's last node stands twice."""
    found: Ids = np.where(mesh.elements == NO_NODE, mesh.elements[:, 2:3], mesh.elements)
    return found.astype(np.int64)


def middles_of(mesh: ShellMesh) -> Floats:
    """(M, 3) means of the corners of elements."""
    corners = mesh.points[corners_of(mesh)]
    total = corners.sum(axis=1) - np.where(mesh.is_tria[:, None], corners[:, 3], 0.0)
    middles: Floats = total / np.where(mesh.is_tria, 3, 4)[:, None]
    return middles


def area_vectors(mesh: ShellMesh) -> Floats:
    """(M, 3) normals as long as the areas: half the cross product of the diagonals."""
    a, b, c, d = mesh.points[corners_of(mesh)].transpose(1, 0, 2)
    vectors: Floats = 0.5 * np.cross(c - a, d - b)
    return vectors


def dihedral_angles(mesh: ShellMesh, edges: Edges) -> Floats:
    """(E,) degrees that the surface turns by at an edge of two elements; elsewhere 0.

    Two elements that disagree about which side is up turn by at least a right angle.
    """
    normals = area_vectors(mesh)
    angles = np.zeros(len(edges.nodes))
    two = np.flatnonzero(edges.pair[:, 0] >= 0)
    one, other = normals[edges.pair[two]].transpose(1, 0, 2)
    sine = np.linalg.norm(np.cross(one, other), axis=1)
    angles[two] = np.degrees(np.arctan2(sine, np.einsum("ij,ij->i", one, other)))
    agree = _start(mesh, edges, two, 0) != _start(mesh, edges, two, 1)
    angles[two[~agree]] = np.maximum(angles[two[~agree]], 90.0)
    return angles


def kinds_of(mesh: ShellMesh, edges: Edges, feature_angle: float = FEATURE_ANGLE) -> Kinds:
    """(E,) kind of each edge; `feature_angle` in degrees."""
    kinds = np.full(len(edges.nodes), INSIDE, np.int8)
    kinds[dihedral_angles(mesh, edges) >= feature_angle] = FEATURE
    regions = mesh.region[edges.pair]
    kinds[(edges.uses == 2) & (regions[:, 0] != regions[:, 1])] = REGION
    kinds[edges.uses == 1] = BORDER
    kinds[edges.uses > 2] = JUNCTION
    return kinds


def used_nodes(mesh: ShellMesh) -> Bools:
    """(N,) bool: nodes that an element has."""
    used = np.zeros(len(mesh.points), bool)
    used[mesh.elements[mesh.elements != NO_NODE]] = True
    return used


def _start(mesh: ShellMesh, edges: Edges, rows: Ids, which: int) -> Ids:
    """Where an edge starts as one of its two elements runs."""
    found: Ids = mesh.elements[edges.pair[rows, which], edges.pair_sides[rows, which]]
    return found
