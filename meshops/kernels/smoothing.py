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


@compiled
def own_corner(points: Floats, a: int, b: int, c: int, d: int) -> float:
    """`corner_jacobian_min` of an element along its own mean normal."""
    n = unit(area_vector(points, a, b, c, d))
    jacobian: float = corner_jacobian_min(points, a, b, c, d, n[0], n[1], n[2])
    return jacobian


@compiled
def _worst_around(points: Floats, elements: Ints, around: Ints, first: int, last: int) -> float:
    worst = 1.0
    for i in range(first, last):
        e = around[i]
        corner = own_corner(points, elements[e, 0], elements[e, 1], elements[e, 2], elements[e, 3])
        worst = min(worst, corner)
    return worst


@compiled
def _place(points: Floats, node: int) -> Vector:
    return points[node, 0], points[node, 1], points[node, 2]


@compiled
def _put(points: Floats, node: int, place: Vector) -> None:
    points[node, 0], points[node, 1], points[node, 2] = place


@compiled
def _tangent_step(
    points: Floats, elements: Ints, around: Ints, first: int, last: int, node: int
) -> Vector:
    """From a node to the mean of its neighbours, within the tangent plane of its elements."""
    normal = (0.0, 0.0, 0.0)
    total = (0.0, 0.0, 0.0)
    count = 0
    for i in range(first, last):
        e = around[i]
        normal = add(
            normal,
            area_vector(points, elements[e, 0], elements[e, 1], elements[e, 2], elements[e, 3]),
        )
        size = 4 if elements[e, 3] >= 0 else 3
        for k in range(size):
            if elements[e, k] == node:
                total = add(total, _place(points, elements[e, (k + 1) % size]))
                total = add(total, _place(points, elements[e, (k - 1 + size) % size]))
                count += 2
    step = subtract(scale(total, 1.0 / count), _place(points, node))
    normal = unit(normal)
    return subtract(step, scale(normal, dot(step, normal)))


@compiled
def smooth(points: Floats, elements: Ints, first_free: int, sweeps: int) -> None:
    """Move nodes from row `first_free` on towards the mean of their neighbours, in place.

    A node moves in the tangent plane of its elements and only as far as the worst corner around it
    does not get worse (smart Laplacian smoothing: Freitag 1997).
    """
    start, around = elements_of_nodes(elements, len(points))
    for _ in range(sweeps):
        for node in range(first_free, len(points)):
            first, last = start[node], start[node + 1]
            if first == last:
                continue
            old = _place(points, node)
            step = _tangent_step(points, elements, around, first, last, node)
            before = _worst_around(points, elements, around, first, last)
            for _attempt in range(3):
                _put(points, node, add(old, step))
                if _worst_around(points, elements, around, first, last) >= before:
                    break
                _put(points, node, old)
                step = scale(step, 0.5)
