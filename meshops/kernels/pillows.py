"""Pillows and rings without a node: finer and coarser inside an outline that stays."""

from __future__ import annotations

import numpy as np

from meshops.kernels.chords import Elements, Places
from meshops.kernels.strips import put
from meshops.kernels.vectors import compiled
from meshops.mesh import Floats, Ints

MOST_SIDES = 10
"""Of the ring of a node that is taken out."""

FILLINGS = 12
"""Ways to fill a ring of `MOST_SIDES` sides at the most: an octagon has this many."""


@compiled
def _size(element: Ints) -> int:
    return 3 if element[3] < 0 else 4


@compiled
def _put_ring(
    members: Ints,
    k: int,
    chosen: Ints,
    elements: Ints,
    element_edges: Ints,
    edge_elements: Ints,
    nodes: int,
    inner: Ints,
    added: Ints,
    comes: int,
) -> tuple[int, int]:
    """Write a quad inside each border side of a set; the next row, and how many nodes are new.

    The new node inside a border node gets its number, from `nodes` on, in `inner`.
    """
    first, new = comes, 0
    for e in members:
        size = _size(elements[e])
        for side in range(size):
            edge = element_edges[e, side]
            other = edge_elements[edge, 0] + edge_elements[edge, 1] - e
            if edge_elements[edge, 0] >= 0 and chosen[other] == k:
                continue
            a, b = elements[e, side], elements[e, (side + 1) % size]
            comes = put(added, comes, a, b, -1, -1)
            for node in (a, b):
                if inner[node] < 0:
                    inner[node] = nodes + new
                    new += 1
    for i in range(first, comes):
        added[i, 2], added[i, 3] = inner[added[i, 1]], inner[added[i, 0]]
    return comes, new


@compiled
def _put_shrunk(
    members: Ints,
    points: Floats,
    elements: Ints,
    inner: Ints,
    added: Ints,
    comes: int,
    places: Floats,
) -> int:
    """Write the elements of a set on the new nodes, and the places of these; the next row.

    A new node is half-way from the old one to the middle of the elements of the set around it.
    """
    weight = np.zeros(len(places))
    places[:] = 0.0
    for e in members:
        size = _size(elements[e])
        added[comes] = elements[e]
        for corner in range(size):
            node = elements[e, corner]
            if inner[node] < 0:
                continue
            added[comes, corner] = inner[node]
            at = inner[node] - len(points)
            for other in elements[e, :size]:
                places[at] += points[other]
                weight[at] += 1.0
        comes += 1
    for e in members:
        for node in elements[e, : _size(elements[e])]:
            if inner[node] >= 0:
                at = inner[node] - len(points)
                places[at] = 0.5 * (points[node] + places[at] / weight[at])
                inner[node] = -1
    return comes


@compiled
def pillow(
    set_start: Ints,
    rows: Ints,
    points: Floats,
    elements: Ints,
    element_edges: Ints,
    edge_elements: Ints,
) -> tuple[Elements, Places]:
    """Shrink sets of elements and put a ring of quads around each (Mitchell and Tautges 1995).

    Parameters
    ----------
    set_start, rows : (K + 1,) int32, (R,) int32
        The elements of set k are ``rows[set_start[k]:set_start[k + 1]]``.
    points, elements, element_edges, edge_elements
        The mesh and its edges.

    Returns
    -------
    The elements that go and come, and the new points, as in ``Candidates``.
    """
    count = len(set_start) - 1
    added_start = np.zeros(count + 1, np.int32)
    point_start = np.zeros(count + 1, np.int32)
    added = np.empty((5 * len(rows), 4), np.int32)
    places = np.empty((4 * len(rows), 3))
    chosen = np.full(len(elements), -1, np.int32)
    inner = np.full(len(points), -1, np.int32)
    comes = 0
    for k in range(count):
        members = rows[set_start[k] : set_start[k + 1]]
        for e in members:
            chosen[e] = k
        comes, new = _put_ring(
            members, k, chosen, elements, element_edges, edge_elements, len(points), inner,
            added, comes,
        )  # fmt: skip
        first, last = point_start[k], point_start[k] + new
        comes = _put_shrunk(members, points, elements, inner, added, comes, places[first:last])
        added_start[k + 1], point_start[k + 1] = comes, last
    return (
        (set_start.copy(), rows.copy(), added_start, added[:comes].copy()),
        (point_start, places[: point_start[-1]].copy()),
    )


@compiled
def _ring_of(node: int, elements: Ints, around: Ints, ring: Ints) -> int:
    """Write the nodes of the ring around an inner node to `ring`; how many, 0 for too many."""
    count = 0
    ring[0] = -1
    element = around[0]
    for _ in range(len(around)):
        size = _size(elements[element])
        corner = 0
        while elements[element, corner] != node:
            corner += 1
        for step in range(1, size - 1):
            if count == len(ring):
                return 0
            ring[count] = elements[element, (corner + step) % size]
            count += 1
        last = elements[element, (corner - 1 + size) % size]
        for e in around:
            size = _size(elements[e])
            for k in range(size):
                if elements[e, k] == node and elements[e, (k + 1) % size] == last:
                    element = e
    return count


@compiled
def _fill(ring: Ints, sides: int, way: int, added: Ints, comes: int) -> int:
    """Write the elements that fill a polygon without inner nodes; where the next one goes.

    Ways up to the number of sides: all elements share the node of that number. The ways of an
    octagon beyond that: three quads in a row. Nothing for a way that is the same as another.
    """
    if sides == 8 and way >= 8:
        for corners in ((0, 1, 2, 3), (0, 3, 4, 7), (4, 5, 6, 7)):
            for k in range(4):
                added[comes, k] = ring[(way - 8 + corners[k]) % 8]
            comes += 1
        return comes
    ways = sides
    if sides == 6:
        ways = 3
    elif sides < 5:
        ways = 1
    if way >= ways:
        return comes
    at = 1
    while at < sides - 1:
        added[comes, 0] = ring[way]
        for k in range(3):
            added[comes, k + 1] = ring[(way + at + k) % sides] if at + k < sides else -1
        comes += 1
        at += 2
    return comes


@compiled
def take_out(chosen: Ints, ways: Ints, elements: Ints, start: Ints, around: Ints) -> Elements:
    """Take inner nodes out and fill the ring around each with fewer elements.

    Parameters
    ----------
    chosen, ways : (K,) int32
        The node of each candidate and the way to fill its ring, below ``FILLINGS``.
    elements, start, around
        The mesh and the elements of its nodes.
    """
    count = len(chosen)
    room = 0
    for node in chosen:
        room += start[node + 1] - start[node]
    removed_start = np.zeros(count + 1, np.int32)
    added_start = np.zeros(count + 1, np.int32)
    removed = np.empty(room, np.int32)
    added = np.empty((room, 4), np.int32)
    ring = np.empty(MOST_SIDES, np.int32)
    goes = comes = 0
    for k in range(count):
        fan = around[start[chosen[k]] : start[chosen[k] + 1]]
        sides = _ring_of(chosen[k], elements, fan, ring)
        if sides >= 3:
            comes = _fill(ring, sides, ways[k], added, comes)
        if comes > added_start[k]:
            removed[goes : goes + len(fan)] = fan
            goes += len(fan)
        removed_start[k + 1], added_start[k + 1] = goes, comes
    return removed_start, removed[:goes].copy(), added_start, added[:comes].copy()
