"""What an edited mesh changes in the deck that it comes from."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from meshops.formats.ids import IdSet, with_new_ids
from meshops.mesh import NEW, NO_NODE, Ids, ShellMesh


@dataclass(frozen=True, eq=False)
class Difference:
    """The edited mesh in deck ids, and what is new, gone or changed in it.

    Attributes
    ----------
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


def numbered(mesh: ShellMesh, change: Difference) -> ShellMesh:
    """Give the edited mesh the ids that its nodes and elements have in the deck that is written."""
    return replace(mesh, node_ids=change.node_ids, element_ids=change.element_ids)


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
