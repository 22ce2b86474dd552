"""Surface: whether what came lies on the surface of what went, and covers it."""

from __future__ import annotations

import numpy as np

from meshops._core import FacetTree, as_trias, unit_normals
from meshops.guard.correspondence import Change
from meshops.guard.rules import Side
from meshops.mesh import NO_NODE, Bools, Floats, Ids, Ints, centres_of, following
from meshops.workpiece import Workpiece

OFF = 0.01
"""Of the local edge: how far one surface may be from the other, beyond what facets leave open."""

EVEN = 1e-9
"""What the cosine between normals of a plane part may lack of 1."""


def leaves_surface(before: Side, after: Side, turns: Floats, suspect: Bools) -> Bools:
    """(P,) bool: parts of a change whose surface is another one, of those that are bent.

    `turns` (P,) are the largest angles between facets in and at each part, see `turns_of`;
    `suspect` (P,) are the parts to look at although they are plane.
    """
    normals = unit_normals(before.points, before.elements)
    mean = np.stack([before.total(normals[:, axis]) for axis in range(3)], axis=1)
    mean /= np.maximum(np.linalg.norm(mean, axis=1), 1e-300)[:, None]
    bent = suspect.copy()
    bent[before.part[np.einsum("ij,ij->i", normals, mean[before.part]) < 1.0 - EVEN]] = True
    leaves = np.zeros(before.parts, bool)
    for part in np.nonzero(bent)[0]:
        old, new = (side.elements[side.part == part] for side in (before, after))
        # the sagitta of an arc that turns at each edge as the facets do, a quarter of the turn
        # over its chord in each of both meshes
        most = OFF + float(np.tan(turns[part] / 4.0))
        leaves[part] = _differs(before.points, old, after.points, new, most)
    return leaves


def shifts_border(before: Workpiece, change: Change, part_was: Ids, parts: int) -> Bools:
    """(P,) bool: parts of a change with a node of the border that moves or goes."""
    topology = before.topology
    at_border = np.zeros(len(before.mesh.points), bool)
    at_border[topology.edges[topology.is_border]] = True
    stays = np.zeros(len(change.points), bool)
    stays[change.elements[change.elements != NO_NODE]] = True
    stays &= ~change.moved(before.mesh)
    shifted = at_border & ~stays[: change.first_new]
    elements = before.mesh.elements
    touched = (shifted[elements] & (elements != NO_NODE)).any(axis=1) & (part_was >= 0)
    shifts = np.zeros(parts, bool)
    shifts[part_was[touched]] = True
    return shifts


def turns_of(before: Workpiece, part_was: Ids, parts: int) -> Floats:
    """(P,) largest angle, in radians, at an edge of an element of each part, features left out."""
    topology = before.topology
    pairs = topology.edge_elements[topology.crossable]
    pairs = pairs[(part_was[pairs] >= 0).any(axis=1)]
    turns = np.zeros(parts)
    normals = unit_normals(before.mesh.points, before.mesh.elements[pairs.ravel()])
    cosine = np.einsum("ij,ij->i", normals[0::2], normals[1::2])
    angle = np.arccos(np.clip(cosine, -1.0, 1.0))
    for side in (0, 1):
        part = part_was[pairs[:, side]]
        np.maximum.at(turns, part[part >= 0], angle[part >= 0])
    return turns


def _differs(points: Floats, old: Ints, points_now: Floats, new: Ints, most: float) -> bool:
    local = _local_edges(points, old)
    at_node = np.full(len(points), np.inf)
    is_node = old != NO_NODE
    np.minimum.at(at_node, old[is_node], np.broadcast_to(local[:, None], old.shape)[is_node])
    left, nodes = np.unique(old[is_node]), np.unique(new[new != NO_NODE])
    came = np.concatenate([points_now[nodes], centres_of(points_now, new)])
    went = np.concatenate([points[left], centres_of(points, old)])
    distance, owner = _nearest(came, points, old)
    back, _ = _nearest(went, points_now, new)
    return bool(
        (distance / local[owner]).max(initial=0.0) > most
        or (back / np.concatenate([at_node[left], local])).max(initial=0.0) > most
    )


def _nearest(places: Floats, points: Floats, elements: Ints) -> tuple[Floats, Ids]:
    """Distance of places (K, 3) from the surface of elements, and the element that is nearest."""
    _, distance, tria = FacetTree(points, as_trias(points, elements)).nearest(places)
    owner = np.repeat(np.arange(len(elements)), np.where(elements[:, 3] == NO_NODE, 1, 2))
    return distance, owner[tria]


def _local_edges(points: Floats, elements: Ints) -> Floats:
    """(K,) shortest side of each element, or half of their mean: a needle's says little."""
    lengths = np.linalg.norm(points[following(elements)] - points[elements], axis=2)
    lengths[elements == NO_NODE] = np.nan
    local: Floats = np.maximum(np.nanmin(lengths, axis=1), 0.5 * np.nanmean(lengths, axis=1))
    return np.maximum(local, np.finfo(float).tiny)
