"""Walks of a tria through quads: tria transport."""

from __future__ import annotations

import numpy as np

from meshops.kernels.smoothing import own_corner
from meshops.kernels.strips import put
from meshops.kernels.vectors import compiled
from meshops.mesh import Floats, Ints

RIGHT, LEFT, BEST = 0, 1, 2
"""Where a step goes that crosses a quad straight: always to the corner ahead on the right, always
to that on the left, or where it gives the better elements."""


@compiled
def _goes_right(
    way: int, points: Floats, apex: int, a: int, b: int, x: int, y: int, p: int, q: int
) -> bool:
    """Whether the tria goes to corner x, on the right of the step, and not to y.

    The next edge crossed is pq, or -1: a way to the side leaves no choice.
    """
    if p == a or (p == x and q == a):
        return True
    if q == b:
        return False
    if way != BEST:
        return way == RIGHT
    right = min(own_corner(points, a, x, y, -1), own_corner(points, apex, a, y, b))
    left = min(own_corner(points, x, y, b, -1), own_corner(points, apex, a, x, b))
    return right >= left


@compiled
def transport(
    strip_start: Ints,
    cells: Ints,
    rungs: Ints,
    ways: Ints,
    points: Floats,
    elements: Ints,
) -> tuple[Ints, Ints]:
    """Make the elements after the tria at the beginning of each strip has walked to its end.

    A step changes tria and quad sides: the two make a pentagon, and its diagonal is moved. At a
    tria in the end the two become a quad.

    Returns
    -------
    added_start, added : (S + 1,) int32, (B, 4) int32
        They take the place of the cells of each strip (``kernels.strips``).
    """
    count = len(strip_start) - 1
    added_start = np.zeros(count + 1, np.int32)
    added = np.empty((len(cells), 4), np.int32)
    comes = 0
    for k in range(count):
        first, last = strip_start[k], strip_start[k + 1]
        a, b = rungs[first]
        apex = _third(elements[cells[first]], a, b)
        for i in range(first + 1, last):
            element = elements[cells[i]]
            if element[3] < 0:
                comes = put(added, comes, apex, a, _third(element, a, b), b)
                break
            x, y = _far_side(element, a)
            p, q = rungs[i]
            if _goes_right(ways[k], points, apex, a, b, x, y, p, q):
                comes = put(added, comes, apex, a, y, b)
                t0, t1, t2 = a, x, y
            else:
                comes = put(added, comes, apex, a, x, b)
                t0, t1, t2 = x, y, b
            if p < 0:
                comes = put(added, comes, t0, t1, t2, -1)
            else:
                apex, a, b = t0 + t1 + t2 - p - q, p, q
        added_start[k + 1] = comes
    return added_start, added[:comes].copy()


@compiled
def _third(tria: Ints, a: int, b: int) -> int:
    """Find the node of a tria that is neither of two."""
    return tria[0] + tria[1] + tria[2] - a - b  # type: ignore[no-any-return]


@compiled
def _far_side(quad: Ints, a: int) -> tuple[int, int]:
    """Find the two nodes that follow a in a quad."""
    for k in range(4):
        if quad[k] == a:
            return quad[(k + 1) % 4], quad[(k + 2) % 4]
    return -1, -1
