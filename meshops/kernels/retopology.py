"""Small changes of the topology of a live patch, each drawn by a few random numbers.

Each returns whether it was done; what was begun and not done is to be taken back. None of them
looks at places of nodes, except to say where a new one begins. Nodes below `fixed` are those of the
border: they neither move nor vanish.
"""

from __future__ import annotations

import numpy as np

from meshops.kernels.living import (
    ELEMENT_CHANGES,
    MOST_AROUND,
    Live,
    ahead,
    behind,
    corner,
    element_with_side,
    empty_row,
    fan,
    put,
    remove,
    rename,
    rewrite,
    size_of_row,
    unused_node,
)
from meshops.kernels.vectors import add, compiled, scale, subtract
from meshops.mesh import Ints

MOST_VALENCE = 8
"""Elements that may meet at a node."""

OPENING = 0.3
"""Of the way to the nodes around it: where the second node begins that one is split into."""


@compiled
def swap_side(live: Live, e: int, side: int, choice: int) -> bool:
    """Divide the outline of two neighbours another way: by a turned edge, or as one quad.

    Two quads have two other ways, a quad and a tria four, two trias two: a turned edge or a quad.
    """
    elements = live[1]
    size = size_of_row(live, e)
    a, b = elements[e, side], ahead(live, e, side)
    other = element_with_side(live, b, a)
    if other < 0:
        return False
    outline = np.empty(6, np.int32)
    count = 0
    for i in range(1, size):  # from b all around to a
        outline[count] = elements[e, (side + i) % size]
        count += 1
    k = corner(live, other, a)
    for i in range(size_of_row(live, other) - 1):
        outline[count] = elements[other, (k + i) % size_of_row(live, other)]
        count += 1
    if count == 6:
        # outline: b c d a f g; the edge in the middle runs from the first to the fourth
        turn = 1 + choice % 2
        p = np.roll(outline, -turn)
        return rewrite(live, e, p[0], p[1], p[2], p[3]) and rewrite(
            live, other, p[3], p[4], p[5], p[0]
        )
    if count == 5:
        p = np.roll(outline[:5], -(choice % 5))
        return rewrite(live, e, p[0], p[1], p[2], -1) and rewrite(
            live, other, p[2], p[3], p[4], p[0]
        )
    p = outline
    if choice % 2:
        return remove(live, other) and rewrite(live, e, p[0], p[1], p[2], p[3])
    return rewrite(live, e, p[1], p[2], p[3], -1) and rewrite(live, other, p[3], p[0], p[1], -1)


@compiled
def split_row(live: Live, e: int, choice: int) -> bool:
    """Divide a quad into two trias."""
    elements = live[1]
    other = empty_row(live)
    if size_of_row(live, e) < 4 or other < 0:
        return False
    k = choice % 2
    a, b, c, d = elements[e, k], elements[e, k + 1], elements[e, k + 2], elements[e, (k + 3) % 4]
    return rewrite(live, e, a, b, c, -1) and rewrite(live, other, a, c, d, -1)


@compiled
def merge_nodes(live: Live, gone: int, stays: int, fixed: int) -> bool:
    """Put node `stays` in the place of node `gone`; half-way between the two if it may move.

    The elements of both must have been dealt with.
    """
    points, _, ring, around, _, _, _, _ = live
    if stays >= fixed:
        half = scale(
            add(
                (points[gone, 0], points[gone, 1], points[gone, 2]),
                (points[stays, 0], points[stays, 1], points[stays, 2]),
            ),
            0.5,
        )
        if not put(live, stays, half):
            return False
    while around[gone] > 0:
        e = ring[gone, 0]
        if corner(live, e, stays) >= 0 or not rename(live, e, gone, stays):
            return False
    return True


@compiled
def collapse_diagonal_of(live: Live, e: int, k: int, fixed: int) -> bool:
    """Merge corner k of a quad with the opposite one; the quad vanishes."""
    elements = live[1]
    if size_of_row(live, e) < 4:
        return False
    gone, stays = elements[e, k % 4], elements[e, (k + 2) % 4]
    if gone < fixed:
        gone, stays = stays, gone
    return gone >= fixed and remove(live, e) and merge_nodes(live, gone, stays, fixed)


@compiled
def collapse_side(live: Live, e: int, side: int, fixed: int) -> bool:
    """Merge the ends of a side: quads beside it become trias, trias vanish."""
    elements = live[1]
    gone, stays = elements[e, side], ahead(live, e, side)
    other = element_with_side(live, stays, gone)
    if gone < fixed:
        gone, stays = stays, gone
    if gone < fixed or other < 0:
        return False
    for row in (e, other):
        if size_of_row(live, row) == 3:
            if not remove(live, row):
                return False
            continue
        k = corner(live, row, gone)
        a, b, c = elements[row, (k + 1) % 4], elements[row, (k + 2) % 4], elements[row, (k + 3) % 4]
        if not rewrite(live, row, a, b, c, -1):
            return False
    return merge_nodes(live, gone, stays, fixed)


@compiled
def _rename_part(live: Live, rows: Ints, first: int, last: int, node: int, other: int) -> bool:
    """Put another node into the elements of a fan from `first` to before `last`."""
    done = True
    for i in range(first, last):
        done = done and rename(live, rows[i % len(rows)], node, other)
    return done


@compiled
def _place_apart(live: Live, rows: Ints, first: int, last: int, node: int, other: int) -> bool:
    """Put a new node a part of the way to the middle of some elements around the old one."""
    points, elements = live[0], live[1]
    place = (points[node, 0], points[node, 1], points[node, 2])
    total, count = (0.0, 0.0, 0.0), 0
    for i in range(first, last):
        e = rows[i % len(rows)]
        for k in range(size_of_row(live, e)):
            p = elements[e, k]
            total = add(total, (points[p, 0], points[p, 1], points[p, 2]))
            count += 1
    step = subtract(scale(total, 1.0 / count), place)
    return put(live, other, add(place, scale(step, OPENING)))


@compiled
def open_node(live: Live, node: int, i: int, j: int, fixed: int) -> bool:
    """Split a node along two of its edges, drawn by i and j: a quad opens between them."""
    rows = np.empty(MOST_AROUND, np.int32)
    count, closed = fan(live, node, rows)
    fresh, row = unused_node(live, fixed), empty_row(live)
    if fresh < 0 or row < 0 or closed != (node >= fixed):
        return False
    if closed:
        if count < 4:
            return False
        first, part = i % count, 2 + j % (count - 3)
    else:
        # the first and the last edge are of the border
        if count < 3:
            return False
        first = 1 + i % (count - 2)
        part = 1 + j % (count - 1 - first)
    last = first + part
    begin = rows[first]
    end = rows[(last - 1) % count]
    a = ahead(live, begin, corner(live, begin, node))
    b = behind(live, end, corner(live, end, node))
    return (
        _place_apart(live, rows[:count], first, last, node, fresh)
        and _rename_part(live, rows[:count], first, last, node, fresh)
        and rewrite(live, row, node, a, fresh, b)
    )


@compiled
def open_trias(live: Live, node: int, i: int, j: int, fixed: int) -> bool:
    """Split a node so that an edge comes through two of its trias, which become quads."""
    elements = live[1]
    rows = np.empty(MOST_AROUND, np.int32)
    trias = np.empty(MOST_AROUND, np.int32)
    count, closed = fan(live, node, rows)
    fresh = unused_node(live, fixed)
    if fresh < 0 or closed != (node >= fixed):
        return False
    found = 0
    for k in range(count):
        if size_of_row(live, rows[k]) == 3:
            trias[found] = k
            found += 1
    if found < 2:
        return False
    one = i % found
    two = (one + 1 + j % (found - 1)) % found
    first, last = trias[one], trias[two]
    if not closed and first > last:
        first, last = last, first
    if last < first:
        last += count
    # the elements between the two trias get the new node; each tria gets both
    begin, end = rows[first], rows[last % count]
    k = corner(live, begin, node)
    p, q = elements[begin, (k + 1) % 3], elements[begin, (k + 2) % 3]
    m = corner(live, end, node)
    r, s = elements[end, (m + 1) % 3], elements[end, (m + 2) % 3]
    return (
        last - first > 1
        and _place_apart(live, rows[:count], first, last + 1, node, fresh)
        and _rename_part(live, rows[:count], first + 1, last, node, fresh)
        and rewrite(live, begin, node, p, q, fresh)
        and rewrite(live, end, fresh, r, s, node)
    )


@compiled
def is_whole(live: Live, outside: Ints, fixed: int) -> bool:
    """Whether the elements that changed leave a surface: each side once, each node well used.

    `outside` (N,) is how many elements outside of the patch meet at each node, -1 where any may.
    """
    _, elements, ring, around, log, _, _, sizes = live
    for i in range(sizes[ELEMENT_CHANGES]):
        for j in range(1, 5):  # a node that has lost elements
            node = log[i, j]
            if node < 0:
                continue
            if node < fixed and around[node] == 0:
                return False
            if node >= fixed and 0 < around[node] < 3:
                return False
        e = log[i, 0]
        size = size_of_row(live, e)
        for k in range(size):
            a, b = elements[e, k], ahead(live, e, k)
            if a == b or (size == 4 and k < 2 and a == elements[e, k + 2]):
                return False
            valence = around[a] + max(outside[a], 0)
            if valence > MOST_VALENCE or (a >= fixed and valence < 3):
                return False
            same = opposed = 0
            for m in range(around[a]):
                other = ring[a, m]
                c = corner(live, other, a)
                same += ahead(live, other, c) == b
                opposed += behind(live, other, c) == b
            if same != 1 or opposed > 1:
                return False
    return True
