"""Smoothing of free nodes."""

from __future__ import annotations

import numpy as np

from meshops.kernels.vectors import (
    Vector,
    add,
    area_vector,
    compiled,
    corner_jacobian_min,
    dot,
    inlined,
    scale,
    subtract,
    unit,
)
from meshops.mesh import Floats, Ints


@compiled
def elements_of_nodes(elements: Ints, nodes: int) -> tuple[Ints, Ints]:
    """Elements around each node: those of node n are ``around[start[n]:start[n + 1]]``."""
    start = np.zeros(nodes + 1, np.int32)
    for e in range(len(elements)):
        for k in range(4):
            if elements[e, k] >= 0:
                start[elements[e, k] + 1] += 1
    for n in range(nodes):
        start[n + 1] += start[n]
    fill = start[:-1].copy()
    around = np.empty(start[-1], np.int32)
    for e in range(len(elements)):
        for k in range(4):
            node = elements[e, k]
            if node >= 0:
                around[fill[node]] = e
                fill[node] += 1
    return start, around


@inlined
def own_corner(points: Floats, a: int, b: int, c: int, d: int) -> float:
    """`corner_jacobian_min` of an element along its own mean normal."""
    n = unit(area_vector(points, a, b, c, d))
    jacobian: float = corner_jacobian_min(points, a, b, c, d, n[0], n[1], n[2])
    return jacobian


@inlined
def _appraise(points: Floats, elements: Ints, e: int, out: Floats, row: int) -> float:
    """Write the area vector of element e and its worst corner along it to a row of `out` (., 4).

    Returns that corner. (A row passed as an array of its own would cost more than all the rest.)
    """
    a, b, c, d = elements[e, 0], elements[e, 1], elements[e, 2], elements[e, 3]
    area = area_vector(points, a, b, c, d)
    n = unit(area)
    corner: float = corner_jacobian_min(points, a, b, c, d, n[0], n[1], n[2])
    out[row, 0], out[row, 1], out[row, 2] = area
    out[row, 3] = corner
    return corner


@inlined
def _keeps(
    points: Floats, elements: Ints, around: Ints, first: int, last: int, least: float, out: Floats
) -> bool:
    """Whether no corner of the elements around a node is worse than `least`.

    Writes what the elements are like then to `out`, which is of use only where none is.
    """
    for i in range(first, last):
        if _appraise(points, elements, around[i], out, i - first) < least:
            return False
    return True


@inlined
def _place(points: Floats, node: int) -> Vector:
    return points[node, 0], points[node, 1], points[node, 2]


@inlined
def _put(points: Floats, node: int, place: Vector) -> None:
    points[node, 0], points[node, 1], points[node, 2] = place


@compiled
def _neighbours(elements: Ints, start: Ints, around: Ints, first_free: int) -> Ints:
    """List (A, 2) nodes after and before each node, from a row on, in each element around it."""
    neighbours = np.empty((len(around), 2), np.int32)
    for node in range(first_free, len(start) - 1):
        for i in range(start[node], start[node + 1]):
            e = around[i]
            size = 4 if elements[e, 3] >= 0 else 3
            for k in range(size):
                if elements[e, k] == node:
                    neighbours[i, 0] = elements[e, (k + 1) % size]
                    neighbours[i, 1] = elements[e, (k - 1 + size) % size]
    return neighbours


@inlined
def _tangent_step(
    points: Floats, like: Floats, neighbours: Ints, around: Ints, first: int, last: int, node: int
) -> Vector:
    """From a node to the mean of its neighbours, within the tangent plane of its elements."""
    normal = (0.0, 0.0, 0.0)
    total = (0.0, 0.0, 0.0)
    for i in range(first, last):
        e = around[i]
        normal = add(normal, (like[e, 0], like[e, 1], like[e, 2]))
        total = add(total, _place(points, neighbours[i, 0]))
        total = add(total, _place(points, neighbours[i, 1]))
    step = subtract(scale(total, 1.0 / (2 * (last - first))), _place(points, node))
    normal = unit(normal)
    return subtract(step, scale(normal, dot(step, normal)))


@compiled
def smooth(points: Floats, elements: Ints, first_free: int, sweeps: int) -> None:
    """Move nodes from row `first_free` on towards the mean of their neighbours, in place.

    A node moves in the tangent plane of its elements and only as far as the worst corner around it
    does not get worse (smart Laplacian smoothing: Freitag 1997).
    """
    start, around = elements_of_nodes(elements, len(points))
    neighbours = _neighbours(elements, start, around, first_free)
    like = np.empty((len(elements), 4))  # what the elements are like, as the nodes are
    for e in range(len(elements)):
        _appraise(points, elements, e, like, e)
    moved = np.empty((len(elements), 4))
    for _ in range(sweeps):
        for node in range(first_free, len(points)):
            first, last = start[node], start[node + 1]
            if first == last:
                continue
            old = _place(points, node)
            step = _tangent_step(points, like, neighbours, around, first, last, node)
            before = 1.0
            for i in range(first, last):
                before = min(before, like[around[i], 3])
            for _attempt in range(3):
                _put(points, node, add(old, step))
                if _keeps(points, elements, around, first, last, before, moved):
                    for i in range(first, last):
                        for k in range(4):
                            like[around[i], k] = moved[i - first, k]
                    break
                _put(points, node, old)
                step = scale(step, 0.5)
