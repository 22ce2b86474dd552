"""What an edited mesh changes in the deck that it comes from."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from meshops.formats.ids import IdSet, with_new_ids
from meshops.mesh import NEW, NO_NODE, Ids, ShellMesh


@dataclass(frozen=True, eq=False)
class Difference:
    """The edited mesh in deck ids, and what is new, gone or changed in it.

    Attributes
    ----------
    mesh : ShellMesh
        The edited mesh; an element on the nodes of one that is gone has its id.
    node_ids, element_ids : (N,) int64, (M,) int64
        Of the edited mesh, every NEW replaced by an id of its own.
    corners : (M, 4) int64
        Node ids of the elements; 0 stands last in a tria.
    moved, new_nodes : (K,) int64
        Rows of nodes of the edited mesh.
    rewired, new_elements : (K,) int64
        Rows of elements of the edited mesh.
    gone_nodes, gone_elements : (K,) int64
        Ids that the deck has and the edited mesh has not.
    """

    mesh: ShellMesh
    node_ids: Ids
    element_ids: Ids
    corners: Ids
    moved: Ids
    new_nodes: Ids
    rewired: Ids
    new_elements: Ids
    gone_nodes: Ids
    gone_elements: Ids


def compare(
    before: ShellMesh, after: ShellMesh, *, taken_nodes: IdSet, taken_elements: IdSet, limit: int
) -> Difference:
    """Compare the mesh of a deck with a mesh that edits have made of it.

    Raises
    ------
    ValueError
        Where ``after`` has an id twice or an id that ``before`` has not: it is of another deck.
    InputError
        Where no ids up to ``limit`` are left for what is new.
    """
    after = keep_ids_on_same_nodes(before, after)
    node_ids = with_new_ids(after.node_ids, taken_nodes, limit)
    element_ids = with_new_ids(after.element_ids, taken_elements, limit)
    corners = deck_corners(after, node_ids)
    kept_nodes = np.flatnonzero(after.node_ids != NEW)
    kept_elements = np.flatnonzero(after.element_ids != NEW)
    old_nodes = _rows(before.node_ids, after.node_ids[kept_nodes])
    old_elements = _rows(before.element_ids, after.element_ids[kept_elements])
    moved = (before.points[old_nodes] != after.points[kept_nodes]).any(axis=1)
    old_corners = deck_corners(before, before.node_ids)
    rewired = (old_corners[old_elements] != corners[kept_elements]).any(axis=1)
    vanishing = before.node_ids[~before.locked_nodes]
    return Difference(
        mesh=after,
        node_ids=node_ids,
        element_ids=element_ids,
        corners=corners,
        moved=kept_nodes[moved],
        new_nodes=np.flatnonzero(after.node_ids == NEW),
        rewired=kept_elements[rewired],
        new_elements=np.flatnonzero(after.element_ids == NEW),
        gone_nodes=np.setdiff1d(vanishing, after.node_ids),
        gone_elements=np.setdiff1d(before.element_ids, after.element_ids),
    )


def keep_ids_on_same_nodes(before: ShellMesh, after: ShellMesh) -> ShellMesh:
    """Give a new element on the nodes of a gone one its id, and its first node.

    That is where both are of one region and the nodes follow each other in the same order.
    """
    new = np.flatnonzero(after.element_ids == NEW)
    gone = np.flatnonzero(~np.isin(before.element_ids, after.element_ids))
    if not (len(new) and len(gone)):
        return after
    # what has a new node is on none of the deck's
    has_new = (after.node_ids[after.elements[new]] == NEW) & (after.elements[new] != NO_NODE)
    new = new[~has_new.any(axis=1)]
    old_corners = deck_corners(before, before.node_ids)
    ids = {_around(old_corners[row].tolist()): row for row in gone.tolist()}
    elements, element_ids = after.elements.copy(), after.element_ids.copy()
    corners = deck_corners(after, after.node_ids)
    for row in new.tolist():
        old = ids.get(_around(corners[row].tolist()), -1)
        if old < 0 or before.region[old] != after.region[row]:
            continue
        element_ids[row] = before.element_ids[old]
        start = corners[row].tolist().index(before.node_ids[before.elements[old, 0]])
        size = 3 if elements[row, 3] == NO_NODE else 4
        elements[row, :size] = np.roll(elements[row, :size], -start)
    elements.setflags(write=False)
    element_ids.setflags(write=False)
    return replace(after, elements=elements, element_ids=element_ids)


def _around(nodes: Sequence[int]) -> tuple[int, ...]:
    """Make lists of ids of one cycle equal, wherever they begin; 0 stands last in a tria."""
    cycle = [node for node in nodes if node]
    start = cycle.index(min(cycle))
    return (*cycle[start:], *cycle[:start])


def deck_corners(mesh: ShellMesh, node_ids: Ids) -> Ids:
    """(M, 4) int64 node ids of the elements; 0 stands last in a tria."""
    corners: Ids = np.where(mesh.elements == NO_NODE, 0, node_ids[mesh.elements])
    return corners


def _rows(ids: Ids, wanted: Ids) -> Ids:
    order = np.argsort(ids)
    places = np.searchsorted(ids, wanted, sorter=order)
    rows = order[np.minimum(places, len(ids) - 1)]
    if len(np.unique(wanted)) != len(wanted) or (ids[rows] != wanted).any():
        raise ValueError("the mesh does not descend from this deck")
    return rows
