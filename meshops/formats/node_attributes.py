"""What the nodes of a deck have in common, and what new nodes between them therefore get.

A node has memberships: an output system, a support, a place in a set, a temperature. A node that is
born inside an element gets what all nodes of that element share. So the memberships that its nodes
share belong to the region of an element, as its property does: no operation mixes two regions, no
node is born but inside of one, and the edges between two keep their nodes. Nothing here knows a
format; a format says which memberships there are and writes them.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.spatial import KDTree

from meshops.mesh import NEW, NO_NODE, Bools, Floats, Ids, Ints, ShellMesh

_CANDIDATES = 16
"""Gone nodes among which a new one finds the nearest that is left."""


class Membership(NamedTuple):
    """Something that a deck says of a node and that other nodes can have too.

    Attributes
    ----------
    kind : hashable
        What is said, such as ``("SPC", 1, "3")`` or ``("NSET", "HELD")``. A node has one value of a
        kind at most.
    value : hashable
        Such as a temperature; ``None`` for membership in a set.
    can_grow : bool
        Whether it can be written for a new node without saying more than that.
    can_shrink : bool
        Whether a node that has it may move and vanish, and can be taken out of the deck with it.
    """

    kind: Hashable
    value: Hashable = None
    can_grow: bool = True
    can_shrink: bool = True


Memberships = frozenset[Membership]


@dataclass(frozen=True, eq=False)
class SharedMemberships:
    """Regions of elements whose nodes share the same memberships.

    Attributes
    ----------
    region : (M,) int32
        In the order of their first elements.
    before : (R,) int32
        The region of which each one is a part.
    shared : list of R frozensets of Membership
        What a new node of each region gets.
    locked_elements : (M,) bool
        Elements inside of which no node may be born: what their nodes share cannot be written for
        another node, or they have different values of one kind.
    locked_nodes : (N,) bool
        Nodes that have more than the elements around them share, or that may not vanish.
    """

    region: Ints
    before: Ints
    shared: list[Memberships]
    locked_elements: Bools
    locked_nodes: Bools


def share_memberships(
    elements: Ints, region: Ints, memberships: Sequence[Memberships]
) -> SharedMemberships:
    """Part regions where the memberships that all nodes of an element share are not the same.

    A tria with two sides on the border of its region, as in a corner, has no inside of its own: its
    nodes lie on a line, and so it is with its neighbour where it shares more than that one does.

    Parameters
    ----------
    elements : (M, 4) int32
        Node rows; a tria has ``NO_NODE`` last.
    region : (M,) int32
    memberships : sequence of N frozensets of Membership
        Of each node.
    """
    numbers: dict[Memberships, int] = {}
    profile = np.array([numbers.setdefault(mine, len(numbers)) for mine in memberships], np.int32)
    profiles = list(numbers)
    corners = np.where(elements == NO_NODE, elements[:, 2:3], elements)
    kinds, kind = np.unique(np.sort(profile[corners], axis=1), axis=0, return_inverse=True)
    kind = kind.reshape(-1)
    at_corners = [[profiles[i] for i in dict.fromkeys(row)] for row in kinds.tolist()]
    shared = [frozenset.intersection(*sets) for sets in at_corners]
    differs = np.array([_differ(sets) for sets in at_corners], bool)[kind]
    set_numbers: dict[Memberships, int] = {}
    number = np.array([set_numbers.setdefault(item, len(set_numbers)) for item in shared], np.int32)
    sets = list(set_numbers)
    mine = number[kind]
    for tria, neighbour in _ears(elements, region):
        if sets[mine[neighbour]] < sets[mine[tria]] and not differs[tria]:
            mine[tria] = mine[neighbour]
    refined, before, of_region = _number(region, mine)
    stuck = np.array([any(not m.can_grow for m in item) for item in sets], bool)
    own = np.array([set_numbers.get(item, -1) for item in profiles], np.int64)[profile]
    held = np.array([any(not m.can_shrink for m in item) for item in profiles], bool)[profile]
    other = elements != NO_NODE
    other &= own[elements] != mine[:, None]
    held[elements[other]] = True
    return SharedMemberships(
        region=refined,
        before=before,
        shared=[sets[i] for i in of_region],
        locked_elements=differs | stuck[mine],
        locked_nodes=held,
    )


def memberships_of_new_nodes(
    mesh: ShellMesh, shared: Sequence[Memberships]
) -> dict[int, Memberships]:
    """Find what each new node of an edited mesh gets, by its row.

    Parameters
    ----------
    mesh
        Descends by edits from one whose regions are those of ``SharedMemberships``.
    shared
        By region.
    """
    is_new = np.zeros(len(mesh.points) + 1, bool)
    is_new[:-1] = mesh.node_ids == NEW
    rows, sides = np.nonzero(is_new[mesh.elements])
    pairs = np.unique(
        np.stack([mesh.elements[rows, sides], mesh.region[rows]], axis=1), axis=0
    ).tolist()
    found: dict[int, Memberships] = {}
    for node, region in pairs:
        item = shared[region]
        found[node] = found[node] & item if node in found else item
    return found


def rows_by_membership(found: Mapping[int, Memberships]) -> dict[Membership, list[int]]:
    """Turn what each node gets round: the rows of the nodes that get each membership, ascending."""
    rows: dict[Membership, list[int]] = {}
    for row in sorted(found):
        for item in sorted(found[row], key=repr):
            rows.setdefault(item, []).append(row)
    return rows


def take_over_ids(
    before: ShellMesh,
    after: ShellMesh,
    own: Sequence[Memberships],
    shared: Sequence[Memberships],
    is_listed: Callable[[Membership], bool],
) -> ShellMesh:
    """Give new nodes the ids of gone nodes that had what they get, the nearest first.

    So cards that list nodes need not change: to them it is as if the node had moved.

    Parameters
    ----------
    before, own
        The mesh of the deck, and what each of its nodes has, (N,).
    after, shared
        The edited mesh, and what new nodes of each region get.
    is_listed
        Whether a membership is a place in a list: a node with none keeps away from old ids.
    """
    gone = np.flatnonzero(~np.isin(before.node_ids, after.node_ids))
    by_kind: dict[Memberships, list[int]] = {}
    for row in gone.tolist():
        if any(map(is_listed, own[row])):
            by_kind.setdefault(own[row], []).append(row)
    if not by_kind:
        return after
    waiting: dict[Memberships, list[int]] = {}
    for row, items in memberships_of_new_nodes(after, shared).items():
        if items in by_kind:
            waiting.setdefault(items, []).append(row)
    node_ids = after.node_ids.copy()
    for items, rows in waiting.items():
        old = by_kind[items]
        pairs = _nearest_pairs(after.points[rows], before.points[old])
        for new, taken in pairs:
            node_ids[rows[new]] = before.node_ids[old[taken]]
    node_ids.setflags(write=False)
    return replace(after, node_ids=node_ids)


def _nearest_pairs(points: Floats, others: Floats) -> list[tuple[int, int]]:
    """Pair as many points as there are others for, those that are nearest to each other first."""
    count = min(len(others), _CANDIDATES)
    distance, other = KDTree(others).query(points, k=count)
    order = np.argsort(distance, axis=None, kind="stable")
    row_of = np.repeat(np.arange(len(points)), count)
    found: dict[int, int] = {}
    taken: set[int] = set()
    for i in order.tolist():
        row, mine = int(row_of[i]), int(np.ravel(other)[i])
        if row not in found and mine not in taken:
            found[row] = mine
            taken.add(mine)
    left = [i for i in range(len(others)) if i not in taken]
    rows = [row for row in range(len(points)) if row not in found]
    return sorted({**found, **dict(zip(rows, left, strict=False))}.items())


def _differ(sets: Sequence[Memberships]) -> bool:
    """Whether all nodes have a value of one kind, but not all the same."""
    kinds = [{item.kind for item in mine} for mine in sets]
    return bool(set.intersection(*kinds) - {item.kind for item in frozenset.intersection(*sets)})


def _ears(elements: Ints, region: Ints) -> Iterator[tuple[int, int]]:
    """Trias that have one neighbour in their region, and that neighbour."""
    rows, sides = np.nonzero(elements != NO_NODE)
    size = np.where(elements[:, 3] == NO_NODE, 3, 4)[rows]
    ends = np.stack([elements[rows, sides], elements[rows, (sides + 1) % size]], axis=1)
    edges, edge, uses = np.unique(
        np.sort(ends, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    total = np.zeros(len(edges), np.int64)
    np.add.at(total, edge.reshape(-1), rows)
    # of two elements at an edge the other one is what is left of their sum
    other = np.where(uses == 2, total, -1)[edge.reshape(-1)] - rows
    inner = uses[edge.reshape(-1)] == 2
    inner[inner] = region[other[inner]] == region[rows[inner]]
    is_ear = (elements[:, 3] == NO_NODE) & (np.bincount(rows[inner], minlength=len(elements)) == 1)
    of_ear = inner & is_ear[rows]
    yield from zip(rows[of_ear].tolist(), other[of_ear].tolist(), strict=True)


def _number(region: Ints, number: Ints) -> tuple[Ints, Ints, list[int]]:
    """Regions by (region, number) in the order of their first elements; both of each region."""
    pairs = np.stack([region, number], axis=1)
    kinds, first, kind = np.unique(pairs, axis=0, return_index=True, return_inverse=True)
    order: Ids = np.argsort(first)
    refined = np.argsort(order).astype(np.int32)[kind.reshape(-1)]
    return refined, kinds[order, 0].astype(np.int32), kinds[order, 1].tolist()
