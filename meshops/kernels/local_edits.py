"""Building small edits: the polygon around two elements, and the fan of elements around a node."""

from __future__ import annotations

from math import nan

import numpy as np

from meshops.kernels.vectors import (
    Vector,
    add,
    area_vector,
    compiled,
    cross,
    length,
    scale,
    subtract,
    unit,
)
from meshops.mesh import Bools, Floats, Ints

MOST_AROUND = 12
"""Nodes with more elements are not collapsed or split."""

OFFSET = 0.25
"""Of the edge length: how far the two nodes that one is split into move from its place."""


@compiled
def pair_polygons(elements: Ints, pairs: Ints) -> tuple[Ints, Ints]:
    """Polygon around each pair of elements (S, 2) that share one edge.

    Returns
    -------
    polygons : (S, 6) int32
        Nodes counter-clockwise, -1 beyond the last. The first is an end of the shared edge; those
        of the larger element come first, up to the other end.
    sizes : (S,) int32
        Nodes of each polygon, 4 to 6.
    """
    polygons = np.full((len(pairs), 6), -1, np.int32)
    sizes = np.zeros(len(pairs), np.int32)
    for s in range(len(pairs)):
        one, two = pairs[s]
        if elements[one, 3] < 0:
            one, two = two, one
        count = 0
        size = 3 if elements[one, 3] < 0 else 4
        other = 3 if elements[two, 3] < 0 else 4
        for side in range(size):
            u, v = elements[one, side], elements[one, (side + 1) % size]
            for k in range(other):
                if elements[two, k] != v or elements[two, (k + 1) % other] != u or count > 0:
                    continue
                for step in range(size):  # from v around the one to u
                    polygons[s, step] = elements[one, (side + 1 + step) % size]
                for step in range(2, other):  # from u around the other, back to v
                    polygons[s, size - 2 + step] = elements[two, (k + step) % other]
                count = size + other - 2
        sizes[s] = count
    return polygons, sizes


@compiled
def fan(node: int, elements: Ints, start: Ints, around: Ints, rows: Ints, nodes: Ints) -> int:
    """Write the elements around a node in counter-clockwise order, and the edge before each.

    Edge i runs from the node to ``nodes[i]``, between elements ``rows[i - 1]`` and ``rows[i]``.
    Returns how many there are; 0 where they do not close around the node, or are too many.
    """
    count: int = start[node + 1] - start[node]
    if count > len(rows) or count < 2:
        return 0
    e = around[start[node]]
    for i in range(count):
        rows[i] = e
        size = 3 if elements[e, 3] < 0 else 4
        before = -1
        for k in range(size):
            if elements[e, k] == node:
                nodes[i] = elements[e, (k + 1) % size]
                before = elements[e, (k - 1 + size) % size]
        following = -1
        for j in range(start[node], start[node + 1]):
            other = around[j]
            other_size = 3 if elements[other, 3] < 0 else 4
            for k in range(other_size):
                if elements[other, k] == node and elements[other, (k + 1) % other_size] == before:
                    following = other
        if following < 0 or (following == rows[0]) != (i == count - 1):
            return 0
        e = following
    return count


@compiled
def collapse_diagonals(
    quads: Ints, points: Floats, elements: Ints, start: Ints, around: Ints, free: Bools
) -> tuple[Ints, Ints, Ints, Floats]:
    """Make the opposite nodes of each quad one, in two ways; padded candidates, two for each quad.

    A node that is free goes to the other, and both to the middle where both are free.
    """
    count = 2 * len(quads)
    removed = np.full((count, MOST_AROUND), -1, np.int32)
    added = np.full((count, MOST_AROUND, 4), -1, np.int32)
    moved = np.full((count, 1), -1, np.int32)
    moved_to = np.zeros((count, 1, 3))
    for s in range(len(quads)):
        for way in range(2):
            k = 2 * s + way
            goes, stays = elements[quads[s], way], elements[quads[s], way + 2]
            if not free[goes]:
                goes, stays = stays, goes
            if not free[goes] or start[goes + 1] - start[goes] > MOST_AROUND:
                continue
            places = 0
            for i in range(start[goes], start[goes + 1]):
                e = around[i]
                removed[k, i - start[goes]] = e
                if e != quads[s]:
                    for corner in range(4):
                        node = elements[e, corner]
                        added[k, places, corner] = stays if node == goes else node
                    places += 1
            if free[stays]:
                moved[k, 0] = stays
                moved_to[k, 0] = 0.5 * (points[goes] + points[stays])
    return removed, added, moved, moved_to


@compiled
def _place(points: Floats, node: int) -> Vector:
    return points[node, 0], points[node, 1], points[node, 2]


@compiled
def open_nodes(
    sites: Ints, variants: int, points: Floats, elements: Ints, start: Ints, around: Ints
) -> tuple[Ints, Ints, Floats, Ints, Floats]:
    """Split each node along two of its edges and put a quad between; padded candidates.

    Variant i opens at edge i of the node and at the one half of the elements further on.
    """
    count = variants * len(sites)
    half = MOST_AROUND // 2
    removed = np.full((count, half), -1, np.int32)
    added = np.full((count, half + 1, 4), -1, np.int32)
    new = np.full((count, 1, 3), nan)
    moved = np.full((count, 1), -1, np.int32)
    moved_to = np.zeros((count, 1, 3))
    rows = np.empty(MOST_AROUND, np.int32)
    ends = np.empty(MOST_AROUND, np.int32)
    for s in range(len(sites)):
        node = sites[s]
        around_it = fan(node, elements, start, around, rows, ends)
        if around_it < 4:
            continue
        side = around_it // 2
        ways = side if around_it % 2 == 0 else around_it
        normal = (0.0, 0.0, 0.0)
        for i in range(around_it):
            e = rows[i]
            normal = add(
                normal,
                area_vector(points, elements[e, 0], elements[e, 1], elements[e, 2], elements[e, 3]),
            )
        for way in range(min(ways, variants)):
            k = variants * s + way
            first, last = ends[way], ends[(way + side) % around_it]
            for i in range(side):
                e = rows[(way + i) % around_it]
                removed[k, i] = e
                for corner in range(4):
                    old = elements[e, corner]
                    added[k, i, corner] = len(points) if old == node else old
            added[k, side, 0], added[k, side, 1] = node, first
            added[k, side, 2], added[k, side, 3] = len(points), last
            # the side that is cut off lies to the right of the way from first to last
            along = subtract(_place(points, last), _place(points, first))
            step = scale(unit(cross(along, normal)), 0.5 * OFFSET * length(along))
            here = _place(points, node)
            new[k, 0, 0], new[k, 0, 1], new[k, 0, 2] = add(here, step)
            moved[k, 0] = node
            there = subtract(here, step)
            moved_to[k, 0, 0], moved_to[k, 0, 1], moved_to[k, 0, 2] = there
    return removed, added, new, moved, moved_to
