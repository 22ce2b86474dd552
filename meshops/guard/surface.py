"""Surface: whether what came lies on the surface of what went, and covers it."""

from __future__ import annotations

import numpy as np

from meshops._core import as_trias, bounding_spheres, find_edges, nearest, unit_normals
from meshops.guard.rules import Side, mean_edge
from meshops.mesh import NO_NODE, Bools, Floats, Ints

OFF = 0.01
"""Of the mean edge of a part: how far one surface may be from the other, beyond what facets leave
open."""

EVEN = 1e-9
"""What the cosine between normals of a plane part may lack of 1."""


def leaves_surface(before: Side, after: Side) -> Bools:
    """(P,) bool: parts of a change whose surface is another one, of those that are bent."""
    normals = unit_normals(before.points, before.elements)
    mean = np.stack([before.total(normals[:, axis]) for axis in range(3)], axis=1)
    mean /= np.maximum(np.linalg.norm(mean, axis=1), 1e-300)[:, None]
    bent = np.zeros(before.parts, bool)
    bent[before.part[np.einsum("ij,ij->i", normals, mean[before.part]) < 1.0 - EVEN]] = True
    leaves = np.zeros(before.parts, bool)
    for part in np.nonzero(bent)[0]:
        old, new = (side.elements[side.part == part] for side in (before, after))
        leaves[part] = _differs(before.points, old, after.points, new)
    return leaves


def _differs(points: Floats, old: Ints, points_now: Floats, new: Ints) -> bool:
    most = OFF * mean_edge(points, old) + _height_of_facets(points, old)
    nodes = points_now[np.unique(new[new != NO_NODE])]
    left = points[np.unique(old[old != NO_NODE])]
    is_node = new != NO_NODE
    centres = (points_now[new] * is_node[..., None]).sum(axis=1) / is_node.sum(axis=1)[:, None]
    return bool(
        _distance(nodes, points, old) > most
        or _distance(centres, points, old) > most
        or _distance(left, points_now, new) > most
    )


def _distance(queries: Floats, points: Floats, elements: Ints) -> float:
    """Farthest that a place is from the surface of elements."""
    trias = as_trias(points, elements)
    distance = nearest(queries, points, trias, bounding_spheres(points, trias))[1]
    return float(distance.max(initial=0.0))


def _height_of_facets(points: Floats, elements: Ints) -> float:
    """How far a smooth surface through the nodes may be from its facets, by the angles there.

    That is an eighth of an edge's length times its angle, and twice that where elements were split.
    """
    edge_elements = find_edges(elements, len(points))[2]
    pairs = edge_elements[edge_elements[:, 0] >= 0]
    if not len(pairs):
        return 0.0
    normals = unit_normals(points, elements)
    cosine = np.einsum("ij,ij->i", normals[pairs[:, 0]], normals[pairs[:, 1]])
    turn = float(np.arccos(np.clip(cosine, -1.0, 1.0)).max())
    return mean_edge(points, elements) * turn / 4.0
