"""Outlines: the polygon around a small group of adjacent elements."""

from __future__ import annotations

import numpy as np

from meshops.kernels.vectors import compiled
from meshops.mesh import Bools, Ints

MOST_SIDES = 12
"""Of all elements of a group together."""


@compiled
def outlines(elements: Ints, groups: Ints) -> tuple[Ints, Ints]:
    """Walk around each group of up to three elements.

    The first node is where the first element leaves a side that it shares with another, so that
    the order does not depend on how the nodes are numbered; the first node of an element alone.

    Parameters
    ----------
    elements : (M, 4) int32
    groups : (S, W) int32
        Element rows, W up to 3; -1 where a place is empty.

    Returns
    -------
    polygons : (S, MOST_SIDES) int32
        Node rows, counter-clockwise; -1 beyond the last.
    sizes : (S,) int32
        Corners of each polygon; 0 where what is around the group is not one simple polygon.
    """
    polygons = np.full((len(groups), MOST_SIDES), -1, np.int32)
    sizes = np.zeros(len(groups), np.int32)
    start = np.empty(MOST_SIDES, np.int32)
    end = np.empty(MOST_SIDES, np.int32)
    outer = np.empty(MOST_SIDES, np.bool_)
    for s in range(len(groups)):
        sides = first_sides = 0
        for element in groups[s]:
            if element < 0:
                continue
            size = 4 if elements[element, 3] >= 0 else 3
            for k in range(size):
                start[sides] = elements[element, k]
                end[sides] = elements[element, (k + 1) % size]
                outer[sides] = True
                sides += 1
            if first_sides == 0:
                first_sides = sides
        around = sides
        for i in range(sides):
            for j in range(sides):
                if start[i] == end[j] and end[i] == start[j]:
                    outer[i] = False
            around -= not outer[i]
        side = 0
        for i in range(first_sides):
            if outer[i] and not outer[i - 1 if i > 0 else first_sides - 1]:
                side = i
                break
        sizes[s] = _walk(start[:sides], end[:sides], outer[:sides], side, around, polygons[s])
    return polygons, sizes


@compiled
def _walk(start: Ints, end: Ints, outer: Bools, side: int, around: int, polygon: Ints) -> int:
    """Write the nodes along the outer sides, from one on; their number, 0 for no simple polygon."""
    first = side
    for k in range(around):
        if not outer[side]:
            return 0
        polygon[k] = start[side]
        following = -1
        for other in range(len(start)):
            if outer[other] and start[other] == end[side]:
                if following >= 0:
                    return 0
                following = other
        if following < 0 or (following == first) != (k == around - 1):
            return 0
        side = following
    return around
