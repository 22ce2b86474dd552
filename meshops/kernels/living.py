"""A patch that changes element by element and can take each change back.

Arguments that always travel together are a tuple here:

live : points (N, 3), elements (M, 4), ring (N, MOST_AROUND), count (N,), log (L, 5), old (L, 3),
    sizes (4,)
    The patch in arrays with room to grow: a row of elements that begins with -1 is empty, and so is
    a node that no element uses. `ring` has the elements around each node, as many as `count` says.
    `log` keeps what a row of elements was before (row, four nodes) and `old` where nodes were; how
    many of either there are is in `sizes`, and after these where empty rows may be found.
"""

from __future__ import annotations

import numpy as np

from meshops.kernels.vectors import Vector, compiled
from meshops.mesh import Floats, Ints

MOST_AROUND = 10
"""Elements around a node at the most."""

LOG = 64
"""Changes between two settlements at the most."""

ELEMENT_CHANGES, NODE_CHANGES, ELEMENT_CURSOR, NODE_CURSOR = 0, 1, 2, 3

Live = tuple[Floats, Ints, Ints, Ints, Ints, Ints, Floats, Ints]


@compiled
def living(points: Floats, elements: Ints, room: int) -> tuple[bool, Live]:
    """Make a live patch; False where more elements meet at a node than there is room for.

    `room` is how many nodes and elements may come.
    """
    nodes, count = len(points), len(elements)
    places = np.zeros((nodes + room, 3))
    places[:nodes] = points
    rows = np.full((count + room, 4), -1, np.int32)
    ring = np.full((nodes + room, MOST_AROUND), -1, np.int32)
    around = np.zeros(nodes + room, np.int32)
    log = np.zeros((LOG, 5), np.int32)
    moved = np.zeros(LOG, np.int32)
    old = np.zeros((LOG, 3))
    sizes = np.zeros(4, np.int32)
    live = (places, rows, ring, around, log, moved, old, sizes)
    for e in range(count):
        for k in range(4):
            node = elements[e, k]
            if node >= 0 and around[node] == MOST_AROUND:
                return False, live
            if node >= 0:
                ring[node, around[node]] = e
                around[node] += 1
        rows[e] = elements[e]
    sizes[ELEMENT_CURSOR], sizes[NODE_CURSOR] = count, nodes
    return True, live


@compiled
def size_of_row(live: Live, e: int) -> int:
    """Corners of an element: 3 or 4; 0 of an empty row."""
    elements = live[1]
    if elements[e, 0] < 0:
        return 0
    return 3 if elements[e, 3] < 0 else 4


@compiled
def corner(live: Live, e: int, node: int) -> int:
    """Which corner of an element a node is; -1: none."""
    elements = live[1]
    for k in range(4):
        if elements[e, k] == node:
            return k
    return -1


@compiled
def ahead(live: Live, e: int, k: int) -> int:
    """Node that follows corner k of an element."""
    elements = live[1]
    following: int = elements[e, (k + 1) % size_of_row(live, e)]
    return following


@compiled
def behind(live: Live, e: int, k: int) -> int:
    """Node before corner k of an element."""
    size = size_of_row(live, e)
    elements = live[1]
    before: int = elements[e, (k + size - 1) % size]
    return before


@compiled
def element_with_side(live: Live, a: int, b: int) -> int:
    """Element in which node b follows node a; -1: none."""
    ring, around = live[2], live[3]
    for i in range(around[a]):
        e = ring[a, i]
        if ahead(live, e, corner(live, e, a)) == b:
            found: int = e
            return found
    return -1


@compiled
def _write(live: Live, e: int, a: int, b: int, c: int, d: int) -> bool:
    """Give row e other nodes; False where one of them has no room for another element."""
    elements, ring, around = live[1], live[2], live[3]
    for k in range(4):
        node = elements[e, k]
        if node < 0:
            continue
        last = around[node] - 1
        for i in range(last):
            if ring[node, i] == e:
                ring[node, i] = ring[node, last]
                break
        around[node] = last
    elements[e, 0], elements[e, 1], elements[e, 2], elements[e, 3] = a, b, c, d
    fits = True
    for k in range(4):
        node = elements[e, k]
        if node < 0:
            continue
        if around[node] == MOST_AROUND:
            fits = False
            elements[e, k] = -1
            continue
        ring[node, around[node]] = e
        around[node] += 1
    return fits


@compiled
def rewrite(live: Live, e: int, a: int, b: int, c: int, d: int) -> bool:
    """Give row e other nodes, so that it can be taken back; False where that is not possible.

    All nodes -1 remove the element; a row that was empty gets one.
    """
    elements, log, sizes = live[1], live[4], live[7]
    if sizes[ELEMENT_CHANGES] == LOG:
        return False
    entry = log[sizes[ELEMENT_CHANGES]]
    entry[0] = e
    entry[1:] = elements[e]
    sizes[ELEMENT_CHANGES] += 1
    done: bool = _write(live, e, a, b, c, d)
    return done


@compiled
def remove(live: Live, e: int) -> bool:
    """Empty a row."""
    done: bool = rewrite(live, e, -1, -1, -1, -1)
    return done


@compiled
def rename(live: Live, e: int, node: int, other: int) -> bool:
    """Put another node in the place of one."""
    elements = live[1]
    a, b, c, d = elements[e]
    done: bool = rewrite(
        live,
        e,
        other if a == node else a,
        other if b == node else b,
        other if c == node else c,
        other if d == node else d,
    )
    return done


@compiled
def put(live: Live, node: int, place: Vector) -> bool:
    """Move a node, so that it can be taken back; False where too many have moved."""
    points, moved, old, sizes = live[0], live[5], live[6], live[7]
    if sizes[NODE_CHANGES] == LOG:
        return False
    moved[sizes[NODE_CHANGES]] = node
    old[sizes[NODE_CHANGES]] = points[node]
    sizes[NODE_CHANGES] += 1
    points[node, 0], points[node, 1], points[node, 2] = place
    return True


@compiled
def empty_row(live: Live) -> int:
    """Row without an element; -1 where there is no more."""
    elements, sizes = live[1], live[7]
    for _ in range(len(elements)):
        sizes[ELEMENT_CURSOR] = (sizes[ELEMENT_CURSOR] + 1) % len(elements)
        if elements[sizes[ELEMENT_CURSOR], 0] < 0:
            found: int = sizes[ELEMENT_CURSOR]
            return found
    return -1


@compiled
def unused_node(live: Live, first: int) -> int:
    """Node from `first` on that no element uses; -1 where there is no more."""
    around, sizes = live[3], live[7]
    for _ in range(len(around)):
        sizes[NODE_CURSOR] = (sizes[NODE_CURSOR] + 1) % len(around)
        if sizes[NODE_CURSOR] >= first and around[sizes[NODE_CURSOR]] == 0:
            found: int = sizes[NODE_CURSOR]
            return found
    return -1


@compiled
def settle(live: Live) -> None:
    """Keep all changes."""
    sizes = live[7]
    sizes[ELEMENT_CHANGES] = sizes[NODE_CHANGES] = 0


@compiled
def take_back(live: Live) -> None:
    """Undo all changes since the last settlement."""
    points, log, moved, old, sizes = live[0], live[4], live[5], live[6], live[7]
    for i in range(sizes[ELEMENT_CHANGES] - 1, -1, -1):
        _write(live, log[i, 0], log[i, 1], log[i, 2], log[i, 3], log[i, 4])
    for i in range(sizes[NODE_CHANGES] - 1, -1, -1):
        points[moved[i]] = old[i]
    settle(live)


@compiled
def fan(live: Live, node: int, rows: Ints) -> tuple[int, bool]:
    """Write the elements around a node in order, each beginning where the one before ends.

    Returns how many there are, and whether they close around the node. Of an open fan the first
    is the one that nothing comes before. Counter-clockwise, as the corners of elements are.
    """
    ring, around = live[2], live[3]
    first = ring[node, 0]
    closed = True
    for _ in range(around[node]):
        # the element before shares the edge to the node that follows
        k = corner(live, first, node)
        before = element_with_side(live, ahead(live, first, k), node)
        if before < 0:
            closed = False
            break
        if before == ring[node, 0]:
            break
        first = before
    e, count = first, 0
    while e >= 0 and count < around[node]:
        rows[count] = e
        count += 1
        e = element_with_side(live, node, behind(live, e, corner(live, e, node)))
    return count, closed
