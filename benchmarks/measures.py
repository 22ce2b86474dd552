"""Measures of shape that the literature compares meshers by.

Scaled Jacobian, stretch and taper are those of Verdict (Stimpson et al., The Verdict Geometric
Quality Library, 2007).
"""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from meshops.criteria import Scoring
from meshops.mesh import NO_NODE, Bools, Floats, Ints, ShellMesh
from meshops.quality import element_index
from meshops.topology import FEATURE_ANGLE, Topology, topology


@dataclass(frozen=True)
class Shape:
    """A mesh in five figures.

    Attributes
    ----------
    singular_nodes : int
    scaled_jacobian, stretch, taper : float
        Means over the elements; stretch and taper over the quads, NaN without any.
    index : float
        Mean element Q.I.
    """

    singular_nodes: int
    scaled_jacobian: float
    stretch: float
    taper: float
    index: float

    @classmethod
    def of(cls, mesh: ShellMesh, scoring: Scoring) -> Shape:
        """Measure a mesh."""
        quads = mesh.points[mesh.elements[~mesh.is_tria]]
        return cls(
            singular_nodes=singular_nodes(mesh),
            scaled_jacobian=float(scaled_jacobians(mesh).mean()),
            stretch=float(stretches(quads).mean()) if len(quads) else float("nan"),
            taper=float(tapers(quads).mean()) if len(quads) else float("nan"),
            index=float(element_index(mesh, scoring).mean()),
        )


def singular_nodes(mesh: ShellMesh) -> int:
    """Count the nodes inside the mesh at which not just four elements meet."""
    found = topology(mesh, feature_angle=180.0)
    inside = np.zeros(len(mesh.points), bool)
    inside[mesh.elements[mesh.elements != NO_NODE]] = True
    inside[found.edges[found.uses != 2]] = False
    valence = np.bincount(mesh.elements[mesh.elements != NO_NODE], minlength=len(mesh.points))
    return int(np.count_nonzero(inside & (valence != 4)))


def scaled_jacobians(mesh: ShellMesh) -> Floats:
    """(M,) smallest sine of an element's corners, 1 for a square and for a regular tria.

    Negative where a corner turns the wrong way round the element's normal; 0 where a side has no
    length.
    """
    worst = np.empty(len(mesh.elements))
    tria = mesh.is_tria
    worst[~tria] = _least_sines(mesh.points[mesh.elements[~tria]])
    worst[tria] = _least_sines(mesh.points[mesh.elements[tria, :3]]) * 2.0 / sqrt(3.0)
    return worst


def stretches(quads: Floats) -> Floats:
    """(Q,) shortest side over longest diagonal of quads (Q, 4, 3), 1 for a square."""
    sides = np.linalg.norm(np.roll(quads, -1, axis=1) - quads, axis=2)
    diagonals = np.linalg.norm(quads[:, 2:] - quads[:, :2], axis=2)
    stretch: Floats = sqrt(2.0) * sides.min(axis=1) / diagonals.max(axis=1)
    return stretch


def tapers(quads: Floats) -> Floats:
    """(Q,) difference of opposite sides over the shorter axis of quads (Q, 4, 3), 0 for a square.

    This is Verdict's taper; the criterion of the same name compares areas.
    """
    a, b, c, d = np.swapaxes(quads, 0, 1)
    axes = np.linalg.norm([(b - a) + (c - d), (c - b) + (d - a)], axis=2)
    taper: Floats = np.linalg.norm((a - b) + (c - d), axis=1) / axes.min(axis=0)
    return taper


def parity_bound(mesh: ShellMesh, *, feature_angle: float = FEATURE_ANGLE) -> int:
    """Fewest trias that the mesh can have with its borders as they are.

    4 Q + 3 T counts every edge inside a zone twice and every one on its border once, so a zone
    with an odd border keeps a tria. Trias that no operation may take out stay as well.
    """
    found = topology(mesh, feature_angle=feature_angle)
    zones = found.zones
    odd = np.bincount(zones[zones >= 0], weights=_border_sides(found)[zones >= 0]) % 2
    return int(odd.sum()) + int(np.count_nonzero(mesh.is_tria & ~found.editable))


def _border_sides(found: Topology) -> Ints:
    """(M,) how many sides of each element are on the border of its zone."""
    left, right = found.edge_elements.T
    zones: Ints = found.zones
    inner: Bools = found.crossable & (zones[left] == zones[right])
    is_side = found.element_edges >= 0
    sides: Ints = (is_side & ~inner[found.element_edges]).sum(axis=1)
    return sides


def _least_sines(corners: Floats) -> Floats:
    """(K,) smallest sine of the corners of (K, C, 3), signed by the element's normal."""
    ahead = np.roll(corners, -1, axis=1) - corners
    back = np.roll(corners, 1, axis=1) - corners
    turns = np.cross(ahead, back)
    normals = turns.sum(axis=1, keepdims=True)
    height = np.linalg.norm(normals, axis=2)
    area = np.divide(
        (turns * normals).sum(axis=2), height, out=np.zeros(turns.shape[:2]), where=height > 0.0
    )
    lengths = np.linalg.norm(ahead, axis=2) * np.linalg.norm(back, axis=2)
    sines = np.divide(area, lengths, out=np.zeros_like(area), where=lengths > 0.0)
    least: Floats = sines.min(axis=1)
    return least
