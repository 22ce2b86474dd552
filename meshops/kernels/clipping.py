"""Triangulating a polygon with holes by clipping ears (Meisters 1975, holes as in Eberly 1998)."""

from __future__ import annotations

import numpy as np

from meshops.kernels.triangulation import area_to, squared, turn
from meshops.kernels.vectors import compiled
from meshops.mesh import Bools, Floats, Ints


@compiled
def loop_areas(points: Floats, start: Ints) -> Floats:
    """(L,) signed areas of closed loops; loop i has the points ``start[i]:start[i + 1]``."""
    areas = np.zeros(len(start) - 1)
    for i in range(len(start) - 1):
        for j in range(start[i] + 2, start[i + 1]):
            areas[i] += 0.5 * turn(points, start[i], j - 1, j)
    return areas


@compiled
def _crosses(points: Floats, a: int, b: int, c: int, d: int) -> bool:
    """Whether segments ab and cd, which share no end, have a point in common."""
    ab_c, ab_d = turn(points, a, b, c), turn(points, a, b, d)
    cd_a, cd_b = turn(points, c, d, a), turn(points, c, d, b)
    return bool(
        max(ab_c, ab_d) >= 0.0 >= min(ab_c, ab_d) and max(cd_a, cd_b) >= 0.0 >= min(cd_a, cd_b)
    )


@compiled
def _sees(points: Floats, start: Ints, ring: Ints, size: int, done: Bools, a: int, b: int) -> bool:
    """Whether no edge of the ring or of a hole that is not yet part of it lies between a and b."""
    for i in range(size):
        c, d = ring[i], ring[(i + 1) % size]
        if c != a and c != b and d != a and d != b and _crosses(points, a, b, c, d):
            return False
    for loop in range(len(start) - 1):
        if done[loop]:
            continue
        for c in range(start[loop], start[loop + 1]):
            d = c + 1 if c + 1 < start[loop + 1] else start[loop]
            if c != a and c != b and d != a and d != b and _crosses(points, a, b, c, d):
                return False
    return True


@compiled
def _opens_to(points: Floats, before: int, node: int, after: int, target: int) -> bool:
    """Whether the direction to a target lies inside the angle of the ring at a node."""
    left = turn(points, before, node, target) > 0.0
    right = turn(points, node, after, target) > 0.0
    if turn(points, before, node, after) > 0.0:
        return left and right
    return left or right


@compiled
def _join_hole(points: Floats, start: Ints, ring: Ints, size: int, done: Bools, hole: int) -> int:
    """Join a hole to the ring by the shortest bridge from its rightmost point; the new size.

    0 where no point of the ring can be seen from there.
    """
    first, end = start[hole], start[hole + 1]
    tip = first
    for node in range(first, end):
        if points[node, 0] > points[tip, 0]:
            tip = node
    at, nearest = -1, np.inf
    for i in range(size):
        distance = squared(points, tip, ring[i])
        if (
            distance < nearest
            and _opens_to(
                points, ring[i - 1 if i else size - 1], ring[i], ring[(i + 1) % size], tip
            )
            and _sees(points, start, ring, size, done, tip, ring[i])
        ):
            at, nearest = i, distance
    if at < 0:
        return 0
    count = end - first
    for i in range(size - 1, at, -1):
        ring[i + count + 2] = ring[i]
    for i in range(count + 1):
        ring[at + 1 + i] = first + (tip - first + i) % count
    ring[at + count + 2] = ring[at]
    return int(size + count + 2)


@compiled
def _is_ear(points: Floats, ring: Ints, size: int, i: int) -> bool:
    """Whether the corner at place i can be clipped: it is convex and holds no other corner."""
    a, b, c = ring[i - 1 if i else size - 1], ring[i], ring[(i + 1) % size]
    if turn(points, a, b, c) <= 0.0:
        return False
    for j in range(size):
        p = ring[j]
        # a node may come twice: at a bridge, or where the border touches itself
        if min(squared(points, p, a), squared(points, p, b), squared(points, p, c)) == 0.0:
            continue
        x, y = points[p, 0], points[p, 1]
        if (
            area_to(points, a, b, x, y) >= 0.0
            and area_to(points, b, c, x, y) >= 0.0
            and area_to(points, c, a, x, y) >= 0.0
        ):
            return False
    return True


@compiled
def clip_ears(points: Floats, start: Ints) -> Ints:
    """Triangulate the area within closed loops.

    Parameters
    ----------
    points : (n, 2) float64
    start : (L + 1,) int32
        Loop i has the points ``start[i]:start[i + 1]``: one runs counter-clockwise around the area,
        all others clockwise around a hole in it.

    Returns
    -------
    (t, 3) int32; none where the loops do not bound an area.
    """
    none = np.zeros((0, 3), np.int32)
    areas = loop_areas(points, start)
    if np.count_nonzero(areas > 0.0) != 1 or (areas == 0.0).any():
        return none
    outer = int(np.argmax(areas))
    done = np.zeros(len(areas), np.bool_)
    done[outer] = True
    ring = np.empty(len(points) + 2 * len(areas), np.int32)
    size = start[outer + 1] - start[outer]
    for i in range(size):
        ring[i] = start[outer] + i
    reach = np.empty(len(areas))
    for loop in range(len(areas)):
        reach[loop] = points[start[loop] : start[loop + 1], 0].max()
    for loop in np.argsort(-reach):
        if not done[loop]:
            size = _join_hole(points, start, ring, size, done, loop)
            if size == 0:
                return none
            done[loop] = True
    trias = np.empty((size - 2, 3), np.int32)
    count = 0
    while size > 3:
        best, at = 0.0, -1
        for i in range(size):
            a, b, c = ring[i - 1 if i else size - 1], ring[i], ring[(i + 1) % size]
            base = squared(points, a, c) + squared(points, a, b) + squared(points, b, c)
            shape = turn(points, a, b, c) / base if base > 0.0 else 0.0
            if shape > best and _is_ear(points, ring, size, i):
                best, at = shape, i
        if at < 0:
            return none
        trias[count, 0] = ring[at - 1 if at else size - 1]
        trias[count, 1], trias[count, 2] = ring[at], ring[(at + 1) % size]
        count += 1
        for i in range(at, size - 1):
            ring[i] = ring[i + 1]
        size -= 1
    trias[count, 0], trias[count, 1], trias[count, 2] = ring[0], ring[1], ring[2]
    if turn(points, ring[0], ring[1], ring[2]) <= 0.0:
        return none
    return trias
