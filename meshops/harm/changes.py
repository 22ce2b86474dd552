"""What an edit has changed: nodes, elements, ids, and the places where it did."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from meshops.harm.edges import corners_of, middles_of
from meshops.mesh import NEW, NO_NODE, Bools, Floats, Ids, ShellMesh


@dataclass(frozen=True, eq=False)
class Changes:
    """How the nodes and elements of two meshes belong together.

    Attributes
    ----------
    node_before : (N2,) int64
        The row before of each node that is still in its place; -1 for one that is new or moved.
    element_before : (M2,) int64
        The row before of each element on the same nodes, none of them moved; else -1.
    kept_nodes : (N1,) bool
        Nodes before that are still in their place and used.
    kept_elements : (M1,) bool
        Elements before that are still there.
    other_ids : (M2,) bool
        Elements on nodes as before, moved or not, that have another id.
    changed_nodes : int
        Nodes that moved, that came and that went; one that moved counts once.
    place_before, place_after : (M1,), (M2,) int64
        The connected place of change that an element belongs to; -1 where it is as it was.
    """

    node_before: Ids
    element_before: Ids
    kept_nodes: Bools
    kept_elements: Bools
    other_ids: Bools
    changed_nodes: int
    place_before: Ids
    place_after: Ids

    @classmethod
    def of(cls, before: ShellMesh, after: ShellMesh) -> Changes:
        """Compare two meshes, by ids where they tell something and by places."""
        same, moved = _same_nodes(before, after)
        element_before = _same_elements(before, after, same)
        kept = np.zeros(len(before.elements), bool)
        kept[element_before[element_before >= 0]] = True
        kept_nodes = np.zeros(len(before.points), bool)
        kept_nodes[same[same >= 0]] = True
        followed = np.where(same >= 0, same, moved)
        by_nodes = _same_elements(before, after, followed)
        other = (by_nodes >= 0) & (before.element_ids[by_nodes] != after.element_ids)
        place_before, place_after = _places(before, after, kept, element_before, same)
        gone = len(before.points) - len(np.unique(followed[followed >= 0]))
        changed = gone + int(np.count_nonzero(same < 0))
        return cls(
            same, element_before, kept_nodes, kept, other, changed, place_before, place_after
        )

    @property
    def changed_elements(self) -> int:
        """Elements of the new mesh that are not as they were, or else those that have gone."""
        came = int(np.count_nonzero(self.element_before < 0))
        return max(came, int(np.count_nonzero(~self.kept_elements)))


def duplicates(mesh: ShellMesh) -> Ids:
    """Rows of elements that have all the nodes of an earlier one, and no others."""
    keys = np.sort(corners_of(mesh), axis=1)
    # a tria has its last node twice; the smallest stands for it so that the order tells nothing
    tria = mesh.is_tria
    keys[tria] = np.sort(
        np.column_stack([np.full(tria.sum(), -1), mesh.elements[tria, :3]]), axis=1
    )
    _, first = np.unique(keys, axis=0, return_index=True)
    again = np.ones(len(keys), bool)
    again[first] = False
    return np.flatnonzero(again)


def with_regions_of(before: ShellMesh, after: ShellMesh, changes: Changes) -> ShellMesh:
    """Return the new mesh with the old one's numbers of regions.

    A deck that is read again may number them otherwise: each takes the number that most of its
    unchanged elements had, or without any that of the nearest elements.
    """
    if not len(before.elements) or not len(after.elements):
        return after
    was = changes.element_before.copy()
    numbers, which = np.unique(after.region, return_inverse=True)
    alone = np.bincount(which, was >= 0) == 0
    lost = np.flatnonzero(alone[which])
    if len(lost):
        was[lost] = cKDTree(middles_of(before)).query(middles_of(after)[lost])[1]
    known = was >= 0
    old, old_which = np.unique(before.region, return_inverse=True)
    votes = np.zeros((len(numbers), len(old)), np.int64)
    np.add.at(votes, (which[known], old_which[was[known]]), 1)
    return replace(after, region=old[votes.argmax(axis=1)][which].astype(np.int32))


def _same_nodes(before: ShellMesh, after: ShellMesh) -> tuple[Ids, Ids]:
    """(N2,) rows before of nodes in the same place, and of those that moved (by id); else -1."""
    by_id = _rows_of(before.node_ids, after.node_ids)
    at_place = (by_id >= 0) & (before.points[by_id] == after.points).all(axis=1)
    same = np.where(at_place, by_id, -1)
    left = np.flatnonzero((by_id < 0) & (after.node_ids == NEW))
    free = np.setdiff1d(np.arange(len(before.points)), same[same >= 0])
    if len(left) and len(free):  # a node may have lost its id and kept its place
        same[left] = _rows_at(before.points, free, after.points[left])
    return same, np.where(at_place, -1, by_id)


def _rows_of(known: Ids, wanted: Ids) -> Ids:
    """Row of each id among those that stand once; -1 for none and for ``NEW``."""
    ids, rows, counts = np.unique(known, return_index=True, return_counts=True)
    ids, rows = ids[counts == 1], rows[counts == 1]
    _, inverse, uses = np.unique(wanted, return_inverse=True, return_counts=True)
    if not len(ids):
        return np.full(len(wanted), -1, np.int64)
    place = np.minimum(np.searchsorted(ids, wanted), len(ids) - 1)
    found = (ids[place] == wanted) & (wanted != NEW) & (uses[inverse] == 1)
    return np.where(found, rows[place], -1).astype(np.int64)


def _rows_at(points: Floats, rows: Ids, wanted: Floats) -> Ids:
    """Of some rows of points that which lies exactly at each wanted place; -1 for none."""
    at = {tuple(place): row for place, row in zip(points[rows].tolist(), rows, strict=True)}
    return np.array([at.get(tuple(place), -1) for place in wanted.tolist()], np.int64)


def _same_elements(before: ShellMesh, after: ShellMesh, same: Ids) -> Ids:
    """(M2,) row before of each element on the same nodes in the same turn; -1 for none.

    Where two elements before share their nodes, that with the same id is meant.
    """
    mapped = np.where(after.elements == NO_NODE, NO_NODE, same[after.elements])
    known = ((mapped >= 0) | (after.elements == NO_NODE)).all(axis=1)
    keys = np.concatenate([_turned(before.elements.astype(np.int64)), _turned(mapped[known])])
    inverse = np.unique(keys, axis=0, return_inverse=True)[1].ravel()
    old, new = inverse[: len(before.elements)], inverse[len(before.elements) :]
    order = np.argsort(old, kind="stable")
    first = np.searchsorted(old[order], new)
    last = np.searchsorted(old[order], new, side="right")
    rows = np.flatnonzero(known)
    found = np.full(len(after.elements), -1, np.int64)
    one = first < last
    found[rows[one]] = order[first[one]]
    for place in np.flatnonzero(last - first > 1):
        candidates = order[first[place] : last[place]]
        alike = candidates[before.element_ids[candidates] == after.element_ids[rows[place]]]
        found[rows[place]] = alike[0] if len(alike) else candidates[0]
    return found


def _turned(elements: Ids) -> Ids:
    """Elements that begin with their smallest node, in their own turn."""
    turned = elements.copy()
    for size in (3, 4):
        rows = np.flatnonzero((elements[:, 3] == NO_NODE) == (size == 3))
        start = elements[rows, :size].argmin(axis=1)
        columns = (start[:, None] + np.arange(size)) % size
        turned[rows, :size] = elements[rows[:, None], columns]
    return turned


def _places(
    before: ShellMesh, after: ShellMesh, kept: Bools, element_before: Ids, same: Ids
) -> tuple[Ids, Ids]:
    """Group elements that went or came by the nodes they share, and number the groups."""
    gone, came = np.flatnonzero(~kept), np.flatnonzero(element_before < 0)
    nodes_after = np.where(same >= 0, same, len(before.points) + np.arange(len(same)))
    ends = np.concatenate(
        [corners_of(before)[gone], nodes_after[corners_of(after)[came]].reshape(-1, 4)]
    )
    rows = np.repeat(np.arange(len(ends)), 4)
    count = len(ends) + len(before.points) + len(same)
    graph = coo_matrix((np.ones(rows.size, bool), (rows, len(ends) + ends.ravel())), (count, count))
    labels = connected_components(graph, directed=False)[1][: len(ends)]
    _, labels = np.unique(labels, return_inverse=True)
    place_before, place_after = (np.full(len(e), -1, np.int64) for e in (kept, element_before))
    place_before[gone], place_after[came] = labels[: len(gone)], labels[len(gone) :]
    return place_before, place_after
