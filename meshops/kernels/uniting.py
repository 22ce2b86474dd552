"""Uniting trias that pairing left alone: one moves through the quads until it meets another.

A tria and the quad next to it have five corners. These can be cut into a quad and a tria in other
ways, so that the tria comes out on any other side of the quad (tria transport).
"""

from __future__ import annotations

import numpy as np

from meshops.kernels.pairing import _quad_shape
from meshops.kernels.vectors import compiled
from meshops.mesh import Floats, Ints

SHAPES = (0.8, 0.6, 0.4, 0.2, 0.1)
"""Least shape of the quads that are made: long ways of good ones before short ways of poor ones."""

LONGEST = 24
"""Quads that a tria moves through at most."""

_MOST = 4096
"""Ways looked at before a tria stays alone."""


@compiled
def element_neighbours(elements: Ints, nodes: int) -> Ints:
    """(M, 4) int32: the element across side k, or -1; a tria has three sides."""
    start = np.zeros(nodes + 1, np.int32)
    for e in range(len(elements)):
        for k in range(4):
            if elements[e, k] >= 0:
                start[elements[e, k] + 1] += 1
    for n in range(nodes):
        start[n + 1] += start[n]
    fill = start[:-1].copy()
    sides = np.empty(start[-1], np.int32)
    for e in range(len(elements)):
        for k in range(4):
            node = elements[e, k]
            if node >= 0:
                sides[fill[node]] = 4 * e + k
                fill[node] += 1
    neighbours = np.full(elements.shape, -1, np.int32)
    for e in range(len(elements)):
        size = 3 if elements[e, 3] < 0 else 4
        for k in range(size):
            a, b = elements[e, k], elements[e, (k + 1) % size]
            for i in range(start[b], start[b + 1]):
                other, side = sides[i] // 4, sides[i] % 4
                ahead = (side + 1) % (3 if elements[other, 3] < 0 else 4)
                if elements[other, ahead] == a:
                    neighbours[e, k] = other
    return neighbours


@compiled
def _side(elements: Ints, e: int, a: int, b: int) -> int:
    """Find the side of element e that runs from node a to node b; -1 for none."""
    size = 3 if elements[e, 3] < 0 else 4
    for k in range(size):
        if elements[e, k] == a and elements[e, (k + 1) % size] == b:
            return k
    return -1


@compiled
def _on_way(quads: Ints, before: Ints, step: int, quad: int) -> bool:
    """Whether the way that leads to a step goes through a quad."""
    while step >= 0:
        if quads[step] == quad:
            return True
        step = before[step]
    return False


@compiled
def _find_way(
    points: Floats,
    elements: Ints,
    neighbours: Ints,
    first: int,
    trias: Ints,
    quads: Ints,
    before: Ints,
    made: Ints,
    least: float,
) -> tuple[int, int]:
    """Search by breadth for the shortest way from a tria to another one.

    Step s of a way leaves over the tria ``trias[s]``, cut from the element ``quads[s]``, and makes
    the quad ``made[s]`` there; ``before[s]`` is the step before it. Returns the last step and the
    tria that is met, or -1, -1; the quad of the two stands last in ``made``.
    """
    seen = np.zeros(8 * len(elements), np.bool_)
    depth = np.zeros(len(trias), np.int32)
    trias[0] = elements[first, :3]
    quads[0], before[0] = first, -1
    head, tail = 0, 1
    while head < tail:
        step = head
        head += 1
        for k in range(3):
            a, b, c = trias[step, k], trias[step, (k + 1) % 3], trias[step, (k + 2) % 3]
            out = _side(elements, quads[step], a, b)
            if out < 0:
                continue  # the diagonal along which the quad was cut
            other = neighbours[quads[step], out]
            if other < 0 or _on_way(quads, before, step, other):
                continue
            side = _side(elements, other, b, a)
            size = 3 if elements[other, 3] < 0 else 4
            for choice in range(size - 2):
                # the tria takes side ba of the other element and one more corner of it
                apex = elements[other, (side + 2 + choice) % size]
                state = 8 * other + 2 * side + choice
                if seen[state] or _quad_shape(points, a, apex, b, c) < least:
                    continue
                row = tail if size == 4 else len(made) - 1
                made[row, 0], made[row, 1], made[row, 2], made[row, 3] = a, apex, b, c
                if size == 3:
                    return step, other
                if depth[step] >= LONGEST or tail >= len(trias) - 1:
                    continue
                seen[state] = True
                trias[tail, 0] = b if choice == 0 else a
                trias[tail, 1] = elements[other, (side + 2) % 4]
                trias[tail, 2] = elements[other, (side + 3) % 4]
                quads[tail], before[tail], depth[tail] = other, step, depth[step] + 1
                tail += 1
    return -1, -1


@compiled
def unite_trias(points: Floats, elements: Ints) -> Ints:
    """Let trias that are left alone meet in pairs; (M', 4) int32 elements on the same nodes.

    The trias are taken in the order of their rows, each on its shortest way to another.
    """
    elements = elements.copy()
    trias = np.empty((_MOST, 3), np.int32)
    quads = np.empty(_MOST, np.int32)
    before = np.empty(_MOST, np.int32)
    made = np.empty((_MOST, 4), np.int32)
    for least in SHAPES:
        stuck = 0
        while True:
            alone = np.nonzero(elements[:, 3] < 0)[0]
            if len(alone) < 2 or stuck >= len(alone):
                break
            first = alone[stuck]
            neighbours = element_neighbours(elements, len(points))
            step, met = _find_way(
                points, elements, neighbours, first, trias, quads, before, made, least
            )
            if step < 0:
                stuck += 1
                continue
            if met < first:
                stuck -= 1
            elements[met] = made[-1]
            while before[step] >= 0:
                elements[quads[step]] = made[step]
                step = before[step]
            elements = np.concatenate((elements[:first], elements[first + 1 :]))
    return elements
