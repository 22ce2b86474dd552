"""Material directions of Nastran shells.

THETA turns the first edge of an element, from G1 to G2, into its material x-axis. What is to last
is the axis, so an element with another first edge needs another THETA.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from scipy.spatial import KDTree

from meshops.formats.difference import Difference
from meshops.mesh import NEW, Bools, Floats, Ids, Ints, ShellMesh, centres_of
from meshops.topology import element_normals, topology

AGREEMENT = 20.0
"""Degrees: two neighbours whose directions differ by more are of two regions."""

ANGLE_TOLERANCE = 1e-3
"""Degrees: a field of eight characters holds no finer angle; a smaller turn changes no card."""


@dataclass(frozen=True, eq=False)
class MaterialDirections:
    """The material x-axes that a deck gives to its shells.

    Attributes
    ----------
    directions : (K, 3) float64
        Unit vectors in the planes of the elements.
    centres : (K, 3) float64
    region, element_ids : (K,) int32, (K,) int64
    angles : (K,) float64
        As typed, in degrees.
    """

    directions: Floats
    centres: Floats
    region: Ints
    element_ids: Ids
    angles: Floats

    @classmethod
    def of(cls, mesh: ShellMesh, angles: Floats) -> Self:
        """Find the directions of the elements whose angle (M,) is not NaN."""
        rows = np.flatnonzero(np.isfinite(angles))
        return cls(
            directions=_directions(mesh, angles)[rows],
            centres=centres_of(mesh.points, mesh.elements[rows]),
            region=mesh.region[rows],
            element_ids=mesh.element_ids[rows],
            angles=angles[rows],
        )

    def changed_angles(self, mesh: ShellMesh, change: Difference) -> dict[int, float]:
        """Angles in degrees, by row of the edited mesh, of the elements that need another one.

        An element that is new, or whose nodes are others or elsewhere, takes the direction of the
        nearest original element of its region.
        """
        touched: Bools = np.asarray(np.isin(mesh.elements, change.moved).any(axis=1))
        touched[change.rewired] = True
        touched[change.new_elements] = True
        rows = np.flatnonzero(touched & np.isin(mesh.region, self.region))
        if not len(rows):
            return {}
        inherited = self.directions[self._nearest(mesh, rows)]
        along, across = (axis[rows] for axis in _axes(mesh))
        angles = _degrees(_dot(inherited, along), _dot(inherited, across))
        needed = self._is_turned(mesh.element_ids[rows], angles)
        return dict(zip(rows[needed].tolist(), angles[needed].tolist(), strict=True))

    def _nearest(self, mesh: ShellMesh, rows: Ids) -> Ids:
        """(R,) the original element nearest to each of some rows among those of its region."""
        centres = centres_of(mesh.points, mesh.elements[rows])
        found = np.zeros(len(rows), np.int64)
        for region in np.unique(mesh.region[rows]):
            mine = np.flatnonzero(self.region == region)
            wanted = mesh.region[rows] == region
            found[wanted] = mine[KDTree(self.centres[mine]).query(centres[wanted])[1]]
        return found

    def _is_turned(self, element_ids: Ids, angles: Floats) -> Bools:
        """(R,) bool: which elements are new, or have a typed angle other than these ``angles``."""
        typed = dict(zip(self.element_ids.tolist(), self.angles.tolist(), strict=True))
        before = np.array([typed.get(element, np.nan) for element in element_ids.tolist()])
        turn = np.abs((angles - before + 180.0) % 360.0 - 180.0)
        turned: Bools = (element_ids == NEW) | ~(turn <= ANGLE_TOLERANCE)
        return turned


def part_by_direction(mesh: ShellMesh, angles: Floats) -> tuple[ShellMesh, Ints]:
    """Part the regions of a mesh where the directions of neighbours do not agree.

    Parameters
    ----------
    angles : (M,) float64
        THETA of each element in degrees; NaN where it has none.

    Returns
    -------
    mesh : ShellMesh
        With regions in the order of their first elements.
    region_before : (R,) int32
        The region of which each new one is a part.
    """
    directed = np.isfinite(angles)
    if not directed.any():
        return mesh, np.arange(mesh.region.max() + 1, dtype=np.int32)
    # a lock is no reason for another region; a fold is, as it has no direction across it
    edges = topology(replace(mesh, locked_elements=np.zeros(len(directed), bool)))
    agree = edges.crossable.copy()
    left, right = edges.edge_elements[agree].T
    agree[agree] = _agree(mesh, _directions(mesh, angles), left, right)
    part = replace(edges, crossable=agree).graph.label_components(directed)
    names = np.where(directed, mesh.region.max() + 1 + part, mesh.region)
    _, first, number = np.unique(names, return_index=True, return_inverse=True)
    order = np.argsort(first)
    region = np.argsort(order).astype(np.int32)[number]
    region.setflags(write=False)
    return replace(mesh, region=region), mesh.region[first[order]]


def _agree(mesh: ShellMesh, directions: Floats, left: Ints, right: Ints) -> Bools:
    """(P,) bool: whether two neighbours' directions agree, seen along their mean normal."""
    normals = element_normals(mesh)
    normal = normals[left] + normals[right]
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    ours, theirs = (
        d - _dot(d, normal)[:, None] * normal for d in (directions[left], directions[right])
    )
    turn = _degrees(_dot(ours, theirs), _dot(np.cross(ours, theirs), normal))
    # an element without a direction has NaN, and agrees with nobody
    agree: Bools = np.abs(turn) <= AGREEMENT
    return agree


def _directions(mesh: ShellMesh, angles: Floats) -> Floats:
    """(M, 3) unit vectors: each first edge turned by its angle about its normal."""
    along, across = _axes(mesh)
    turn = np.radians(angles)[:, None]
    directions: Floats = np.cos(turn) * along + np.sin(turn) * across
    return directions


def _axes(mesh: ShellMesh) -> tuple[Floats, Floats]:
    """(M, 3), (M, 3) unit vectors in each element's mean plane: along its first edge and across."""
    normals = element_normals(mesh)
    edge = mesh.points[mesh.elements[:, 1]] - mesh.points[mesh.elements[:, 0]]
    along = edge - _dot(edge, normals)[:, None] * normals
    length = np.linalg.norm(along, axis=1, keepdims=True)
    along = np.divide(along, length, out=np.zeros_like(along), where=length > 0)
    return along, np.cross(normals, along)


def _dot(u: Floats, v: Floats) -> Floats:
    product: Floats = np.einsum("ij,ij->i", u, v)
    return product


def _degrees(cosine: Floats, sine: Floats) -> Floats:
    angles: Floats = np.degrees(np.arctan2(sine, cosine))
    return angles
