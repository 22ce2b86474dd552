"""Correspondence: which nodes and elements of a mesh are still there after a change."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import cKDTree

from meshops._core import find_edges
from meshops.mesh import NEW, NO_NODE, Bools, Floats, Ids, Ints, ShellMesh

NEAR = 0.4
"""Of the mean edge at a node that went: how far off a new node may be that takes its place."""


@dataclass(frozen=True, eq=False)
class Change:
    """What has become of a mesh, in rows of its own nodes; rows from ``first_new`` on are new.

    Attributes
    ----------
    points : (N + K, 3) float64
        Where nodes are now.
    elements : (M, 4) int32
        The elements now.
    region : (M,) int32
    origin : (M,) int32
        The row of the element that each was before; -1 for a new one.
    first_new : int
        How many nodes there were before.
    """

    points: Floats
    elements: Ints
    region: Ints
    origin: Ints
    first_new: int

    def moved(self, before: ShellMesh) -> Bools:
        """(N + K,) bool: nodes that are not where they were, or were not there."""
        moved = np.ones(len(self.points), bool)
        moved[: self.first_new] = (self.points[: self.first_new] != before.points).any(axis=1)
        return moved


def correspondence(before: ShellMesh, after: ShellMesh) -> Change:
    """Tell a mesh that descends from another by the rows of that one.

    Nodes and elements are the same where they have the same id. A new node takes the place of one
    that went where each is the nearest to the other; an element on the nodes of one that went, in
    the same order around, is that one. Ids of `before` must be different.
    """
    rows = _rows_of(before.node_ids, after.node_ids)
    rows = _taking_place(before, after, rows)
    new = rows < 0
    first_new = len(before.points)
    rows[new] = first_new + np.arange(np.count_nonzero(new))
    points = np.concatenate([before.points, after.points[new]])
    points[rows] = after.points
    elements = np.where(after.elements == NO_NODE, np.int32(NO_NODE), rows[after.elements])
    origin = _origins(before, elements, _rows_of(before.element_ids, after.element_ids))
    return Change(points, elements.astype(np.int32), after.region, origin, first_new)


def count_changed(before: ShellMesh, after: ShellMesh) -> tuple[int, int]:
    """Count the elements and the nodes that are not any more as they were, or have come.

    Of what went and what came in its place the more counts.
    """
    change = correspondence(before, after)
    moved = change.moved(before)
    used = np.zeros(len(moved), bool)
    used[change.elements[change.elements != NO_NODE]] = True
    then = np.zeros(len(moved), bool)
    then[before.elements[before.elements != NO_NODE]] = True
    nodes = [int(np.count_nonzero(some)) for some in (then & (moved | ~used), used & moved)]
    stays = change.origin >= 0
    old = before.elements[change.origin[stays]]
    stays[stays] = same_around(old, change.elements[stays])
    stays &= ~(moved[change.elements] & (change.elements != NO_NODE)).any(axis=1)
    kept = int(np.count_nonzero(stays))
    return max(len(before.elements), len(after.elements)) - kept, max(nodes)


def in_order_of(change: Change, before: ShellMesh) -> Change:
    """Begin each element with the node that its origin begins with, where their nodes are alike."""
    known = np.nonzero(change.origin >= 0)[0]
    old = before.elements[change.origin[known]]
    alike = same_around(old, change.elements[known])
    elements = change.elements.copy()
    elements[known[alike]] = old[alike]
    return replace(change, elements=elements)


def same_around(one: Ints, other: Ints) -> Bools:
    """(K,) bool: which elements (K, 4) have the same nodes in the same order around."""
    same: Bools = (one == other).all(axis=1)
    rest = np.nonzero(~same & ((one[:, 3] < 0) == (other[:, 3] < 0)))[0]
    for corners in (3, 4):
        rows = rest[(one[rest, 3] >= 0) == (corners == 4)]
        for shift in range(1, corners):
            turned = np.roll(other[rows, :corners], shift, axis=1)
            same[rows] |= (one[rows, :corners] == turned).all(axis=1)
    return same


def _rows_of(known: Ids, ids: Ids) -> Ints:
    """(n,) int32: the row of each id among the known ones; -1 where it is new."""
    order = np.argsort(known, kind="stable")
    found = np.minimum(np.searchsorted(known[order], ids), max(len(known) - 1, 0))
    rows = order[found].astype(np.int32)
    rows[(known[rows] != ids) | (ids == NEW)] = -1
    return rows


def _taking_place(before: ShellMesh, after: ShellMesh, rows: Ints) -> Ints:
    """Give new nodes the rows of those that went from where they are, of the same region."""
    gone = np.ones(len(before.points), bool)
    gone[rows[rows >= 0]] = False
    left, new = np.nonzero(gone)[0], np.nonzero(rows < 0)[0]
    if not len(left) or not len(new):
        return rows
    rows, reach = rows.copy(), NEAR * mean_edges(before)
    region, region_now = _region_of_nodes(before)[left], _region_of_nodes(after)[new]
    for number in np.intersect1d(region, region_now):
        here, there = new[region_now == number], left[region == number]
        distance, nearest = cKDTree(before.points[there]).query(after.points[here])
        back = cKDTree(after.points[here]).query(before.points[there])[1]
        mutual = back[nearest] == np.arange(len(here))
        mutual &= distance <= reach[there[nearest]]
        rows[here[mutual]] = there[nearest[mutual]]
    return rows


def _region_of_nodes(mesh: ShellMesh) -> Ints:
    """(N,) int32: the region of an element at each node; -1 where there is none."""
    region = np.full(len(mesh.points), -1, np.int32)
    row, corner = np.nonzero(mesh.elements != NO_NODE)
    region[mesh.elements[row, corner]] = mesh.region[row]
    return region


def mean_edges(mesh: ShellMesh) -> Floats:
    """(N,) mean length of the edges at each node; 0 where there is none."""
    edges = find_edges(mesh.elements, len(mesh.points))[0]
    lengths = np.linalg.norm(mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]], axis=1)
    count = np.bincount(edges.ravel(), minlength=len(mesh.points))
    total = np.bincount(edges.ravel(), np.repeat(lengths, 2), len(mesh.points))
    means: Floats = total / np.maximum(count, 1)
    return means


def _origins(before: ShellMesh, elements: Ints, known: Ints) -> Ints:
    """(M,) int32: the element that each was: the one with the same nodes, or else the same id."""
    is_same = known >= 0
    is_same[is_same] = same_around(before.elements[known[is_same]], elements[is_same])
    origin = np.where(is_same, known, np.int32(-1)).astype(np.int32)
    free = np.ones(len(before.elements), bool)
    free[origin[is_same]] = False
    rest, left = np.nonzero(~is_same)[0], np.nonzero(free)[0]
    if not len(rest) or not len(left):
        return origin
    # rows are unsigned so that no node comes last, as it does in an element
    both = np.sort(np.concatenate([before.elements[left], elements[rest]]).view(np.uint32), axis=1)
    number = np.unique(both, axis=0, return_inverse=True)[1].ravel()
    first = np.full(len(both), -1, np.int32)
    first[number[: len(left)]] = left
    twin = first[number[len(left) :]]
    alike = twin >= 0
    alike[alike] = same_around(before.elements[twin[alike]], elements[rest[alike]])
    origin[rest[alike]] = twin[alike]
    free[twin[alike]] = False
    others = rest[~alike]
    others = others[known[others] >= 0]
    others = others[free[known[others]]]
    origin[others] = known[others]
    return origin
