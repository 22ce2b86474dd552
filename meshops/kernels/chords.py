"""Chords: rows of quads side by side, taken out of a mesh or put into it.

A chord follows opposite sides of quads. It closes on itself or, as a strip, leads from one tria to
another (Borden, Benzley and Shepherd 2002). A part of a chord that ends in a quad makes a tria
there: the tria has moved to that place (the paper's Figure 11). Strips are those of
``kernels.strips``; what comes out are arrays of ``Candidates``, empty for what cannot be done.
"""

from __future__ import annotations

import numpy as np

from meshops.kernels.merging import merged_element
from meshops.kernels.strips import put
from meshops.kernels.vectors import compiled
from meshops.mesh import Bools, Floats, Ints

Elements = tuple[Ints, Ints, Ints, Ints]
"""removed_start, removed, added_start, added"""

Places = tuple[Ints, Floats]
Moves = tuple[Ints, Ints, Floats]


@compiled
def _merge_rungs(
    rungs: Ints, first: int, last: int, free: Bools, target: Ints, marks: Ints, mark: int
) -> bool:
    """Point the node of each rung that vanishes to the one that stays, in `target`; whether it can.

    Nothing is done where a node is on two rungs, or both nodes of a rung have to stay.
    """
    for i in range(first, last):
        for end in range(2):
            node = rungs[i, end]
            if node >= 0:
                if marks[node] == mark or not (free[rungs[i, 0]] or free[rungs[i, 1]]):
                    return False
                marks[node] = mark
    for i in range(first, last):
        if rungs[i, 0] >= 0:
            goes, stays = rungs[i, 0], rungs[i, 1]
            if not free[goes]:
                goes, stays = stays, goes
            target[goes] = stays
    return True


@compiled
def _put_merged(
    fan: Ints,
    elements: Ints,
    target: Ints,
    gone: Ints,
    k: int,
    out: Ints,
    removed: Ints,
    goes: int,
    added: Ints,
    comes: int,
) -> tuple[int, int]:
    """Write elements around a node to `removed`, and to `added` as they are after merging."""
    for e in fan:
        if gone[e] != k:
            gone[e] = k
            removed[goes] = e
            goes += 1
            if merged_element(elements, e, target, out) >= 3:
                added[comes] = out
                comes += 1
    return goes, comes


@compiled
def collapse_strips(
    strip_start: Ints,
    rungs: Ints,
    points: Floats,
    elements: Ints,
    start: Ints,
    around: Ints,
    free: Bools,
) -> tuple[Elements, Moves]:
    """Merge the two nodes of every rung, half-way or at the one that cannot move.

    The quads between two rungs vanish, a tria at the end vanishes, and a quad at the end becomes a
    tria. `start` and `around` are the elements of nodes.
    """
    count = len(strip_start) - 1
    room = 0
    for node in rungs.ravel():
        if node >= 0:
            room += start[node + 1] - start[node]
    removed_start = np.zeros(count + 1, np.int32)
    added_start = np.zeros(count + 1, np.int32)
    moved_start = np.zeros(count + 1, np.int32)
    removed = np.empty(room, np.int32)
    added = np.empty((room, 4), np.int32)
    moved = np.empty(len(rungs), np.int32)
    moved_to = np.empty((len(rungs), 3))
    target = np.arange(len(points)).astype(np.int32)
    marks = np.full(len(points), -1, np.int32)
    gone = np.full(len(elements), -1, np.int32)
    out = np.empty(4, np.int32)
    goes = comes = moves = 0
    for k in range(count):
        first, last = strip_start[k], strip_start[k + 1]
        if _merge_rungs(rungs, first, last, free, target, marks, k):
            for i in range(first, last):
                for end in range(2):
                    node = rungs[i, end]
                    if node < 0 or target[node] == node:
                        continue
                    goes, comes = _put_merged(
                        around[start[node] : start[node + 1]], elements, target, gone, k, out,
                        removed, goes, added, comes,
                    )  # fmt: skip
                    if free[target[node]]:
                        moved[moves] = target[node]
                        moved_to[moves] = 0.5 * (points[node] + points[target[node]])
                        moves += 1
            for node in rungs[first:last].ravel():
                if node >= 0:
                    target[node] = node
        removed_start[k + 1], added_start[k + 1], moved_start[k + 1] = goes, comes, moves
    return (
        (removed_start, removed[:goes].copy(), added_start, added[:comes].copy()),
        (moved_start, moved[:moves].copy(), moved_to[:moves].copy()),
    )


@compiled
def _corner_after(element: Ints, node: int) -> int:
    """Which corner of an element follows a node."""
    size = 3 if element[3] < 0 else 4
    for k in range(size):
        if element[k] == node:
            return (k + 1) % size
    return 0


@compiled
def split_strips(
    strip_start: Ints,
    cells: Ints,
    rungs: Ints,
    ways: Ints,
    points: Floats,
    elements: Ints,
) -> tuple[Elements, Places]:
    """Put a node on the middle of every rung and split the strip lengthwise.

    The quads between two rungs become two, a tria at the end becomes a quad, and a quad at the end
    a quad and a tria, which is at the first node of the last rung, or at the second for a way of 1.
    There is only the way 0 for a strip that does not end in a quad.
    """
    count, nodes = len(strip_start) - 1, len(points)
    removed_start = np.zeros(count + 1, np.int32)
    removed = np.empty(len(cells), np.int32)
    added_start = np.zeros(count + 1, np.int32)
    point_start = np.zeros(count + 1, np.int32)
    added = np.empty((2 * len(cells), 4), np.int32)
    places = np.empty((len(cells), 3))
    goes = comes = new = 0
    for k in range(count):
        first, last = strip_start[k], strip_start[k + 1]
        is_closed = rungs[last - 1, 0] >= 0
        if ways[k] > 0 and (is_closed or elements[cells[last - 1], 3] < 0):
            last = first
        for i in range(first, last):
            removed[goes] = cells[i]
            goes += 1
            if rungs[i, 0] >= 0:
                places[new] = 0.5 * (points[rungs[i, 0]] + points[rungs[i, 1]])
                new += 1
            element = elements[cells[i]]
            if i == first and not is_closed:
                a, b = rungs[i]
                comes = put(added, comes, a, nodes, b, element[_corner_after(element, b)])
                continue
            # behind the rung with the nodes a and b this cell has x next to a, and y next to b
            before = i - 1 if i > first else last - 1
            a, b = rungs[before]
            m = nodes + before - first
            at = _corner_after(element, a)
            x = element[at]
            y = element[(at + 1) % 4]
            if element[3] < 0:
                comes = put(added, comes, b, m, a, x)
            elif rungs[i, 0] >= 0:
                ahead = nodes + i - first
                comes = put(added, comes, m, a, x, ahead)
                comes = put(added, comes, b, m, ahead, y)
            elif ways[k] == 0:
                comes = put(added, comes, m, a, x, -1)
                comes = put(added, comes, b, m, x, y)
            else:
                comes = put(added, comes, b, m, y, -1)
                comes = put(added, comes, m, a, x, y)
        removed_start[k + 1], added_start[k + 1], point_start[k + 1] = goes, comes, new
    return (
        (removed_start, removed[:goes].copy(), added_start, added[:comes].copy()),
        (point_start, places[:new].copy()),
    )
