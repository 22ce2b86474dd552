"""Rings of elements around a hole: border loops, and how far away they are."""

from __future__ import annotations

import numpy as np

from meshops.kernels.vectors import compiled, dot, length, scale, subtract
from meshops.mesh import Floats, Ints


@compiled
def trace_loops(border: Ints) -> tuple[Ints, Ints]:
    """Order the border edges (b, 2) of a patch, each from node to node, into closed loops.

    Returns
    -------
    order : (b,) int32
        Rows of the edges, loop after loop, each loop along its edges from its first row on.
    start : (L + 1,) int32
        Loop k has the places from ``start[k]`` to ``start[k + 1]`` of `order`.
    """
    count = len(border)
    leaving = np.full(border.max() + 1 if count else 0, -1, np.int32)
    for i in range(count):
        leaving[border[i, 0]] = i
    order = np.empty(count, np.int32)
    start = np.zeros(count + 1, np.int32)
    seen = np.zeros(count, np.bool_)
    loops = placed = 0
    for first in range(count):
        edge = first
        while not seen[edge]:
            seen[edge] = True
            order[placed] = edge
            placed += 1
            edge = leaving[border[edge, 1]]
        if placed > start[loops]:
            loops += 1
            start[loops] = placed
    return order, start[: loops + 1].copy()


@compiled
def nearest_edges(points: Floats, starts: Floats, ends: Floats) -> tuple[Floats, Ints, Floats]:
    """Find the nearest of some edges, each from `starts` (h, 3) to `ends`, to each point (N, 3).

    Returns
    -------
    distance : (N,) float64
    edge : (N,) int32
        Row of the edge.
    along : (N,) float64
        Place of the nearest point on the edge, from 0 at its start to 1 at its end.
    """
    distance = np.full(len(points), np.inf)
    edge = np.zeros(len(points), np.int32)
    along = np.zeros(len(points))
    for i in range(len(points)):
        p = points[i, 0], points[i, 1], points[i, 2]
        for j in range(len(starts)):
            a = starts[j, 0], starts[j, 1], starts[j, 2]
            ab = subtract((ends[j, 0], ends[j, 1], ends[j, 2]), a)
            ap = subtract(p, a)
            square = dot(ab, ab)
            t = min(max(dot(ap, ab) / square, 0.0), 1.0) if square > 0.0 else 0.0
            apart = length(subtract(ap, scale(ab, t)))
            if apart < distance[i]:
                distance[i], edge[i], along[i] = apart, j, t
    return distance, edge, along
