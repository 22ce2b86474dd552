"""Smoothing of free nodes, and the check that elements are sound."""

from __future__ import annotations

import numpy as np
from numba import njit

from meshops.mesh import Bools, Floats, Ints


@njit(cache=True)
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


@njit(cache=True)
def area_vector(points: Floats, element: Ints, out: Floats) -> None:
    """Write the vector area of an element, whose direction is the mean normal, to `out`."""
    a, b, c = points[element[0]], points[element[1]], points[element[2]]
    d = points[element[3]] if element[3] >= 0 else c
    ux, uy, uz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    vx, vy, vz = d[0] - b[0], d[1] - b[1], d[2] - b[2]
    out[0] = 0.5 * (uy * vz - uz * vy)
    out[1] = 0.5 * (uz * vx - ux * vz)
    out[2] = 0.5 * (ux * vy - uy * vx)


@njit(cache=True)
def worst_corner(points: Floats, element: Ints, nx: float, ny: float, nz: float) -> float:
    """Worst corner of an element seen along the unit normal n, in [-1, 1].

    The sine of the corner's angle times the ratio of its shorter to its longer side: 1 for a
    square, 0.87 for a regular tria, 0 and less for what is flat, concave or inverted.
    """
    size = 4 if element[3] >= 0 else 3
    worst = 1.0
    for k in range(size):
        o = points[element[k]]
        f = points[element[(k + 1) % size]]
        g = points[element[(k - 1 + size) % size]]
        ux, uy, uz = f[0] - o[0], f[1] - o[1], f[2] - o[2]
        vx, vy, vz = g[0] - o[0], g[1] - o[1], g[2] - o[2]
        cross = (uy * vz - uz * vy) * nx + (uz * vx - ux * vz) * ny + (ux * vy - uy * vx) * nz
        longer = max(ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz)
        if longer <= 0.0:
            return -1.0
        worst = min(worst, cross / longer)
    return worst


@njit(cache=True)
def _worst_around(points: Floats, elements: Ints, around: Ints, scratch: Floats) -> float:
    worst = 1.0
    for i in range(len(around)):
        element = elements[around[i]]
        area_vector(points, element, scratch)
        size = np.sqrt(scratch[0] ** 2 + scratch[1] ** 2 + scratch[2] ** 2)
        if size <= 0.0:
            return -1.0
        worst = min(
            worst,
            worst_corner(points, element, scratch[0] / size, scratch[1] / size, scratch[2] / size),
        )
    return worst


@njit(cache=True)
def smooth(points: Floats, elements: Ints, first_free: int, sweeps: int) -> None:
    """Move nodes from row `first_free` on towards the mean of their neighbours, in place.

    A node moves in the tangent plane of its elements and only as far as the worst corner around it
    does not get worse (smart Laplacian smoothing: Freitag 1997).
    """
    start, around = elements_of_nodes(elements, len(points))
    scratch = np.empty(3)
    old = np.empty(3)
    step = np.empty(3)
    normal = np.empty(3)
    for _ in range(sweeps):
        for node in range(first_free, len(points)):
            mine = around[start[node] : start[node + 1]]
            if len(mine) == 0:
                continue
            normal[:] = 0.0
            step[:] = 0.0
            total = 0
            for i in range(len(mine)):
                element = elements[mine[i]]
                area_vector(points, element, scratch)
                normal += scratch
                size = 4 if element[3] >= 0 else 3
                for k in range(size):
                    if element[k] == node:
                        step += points[element[(k + 1) % size]]
                        step += points[element[(k - 1 + size) % size]]
                        total += 2
            old[:] = points[node]
            step /= total
            step -= old
            size2 = normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2
            if size2 > 0.0:
                out = (step[0] * normal[0] + step[1] * normal[1] + step[2] * normal[2]) / size2
                step -= out * normal
            before = _worst_around(points, elements, mine, scratch)
            for _attempt in range(3):
                points[node] = old + step
                if _worst_around(points, elements, mine, scratch) >= before:
                    break
                points[node] = old
                step *= 0.5


@njit(cache=True)
def all_sound(points: Floats, elements: Ints, normals: Floats, least: float) -> bool:
    """Whether no element is inverted, concave or degenerate, each seen along its (M, 3) normal.

    `least` is the smallest admitted `worst_corner`.
    """
    scratch = np.empty(3)
    for e in range(len(elements)):
        area_vector(points, elements[e], scratch)
        size = np.sqrt(scratch[0] ** 2 + scratch[1] ** 2 + scratch[2] ** 2)
        if size <= 0.0:
            return False
        scratch /= size
        # turned by more than 60 degrees out of the surface is as wrong as inverted
        if (
            scratch[0] * normals[e, 0] + scratch[1] * normals[e, 1] + scratch[2] * normals[e, 2]
            < 0.5
        ):
            return False
        if worst_corner(points, elements[e], scratch[0], scratch[1], scratch[2]) < least:
            return False
    return True


@njit(cache=True)
def has_doubles(elements: Ints, nodes: int, checked: Bools) -> bool:
    """Whether one of the checked elements has the same node set as another element."""
    start, around = elements_of_nodes(elements, nodes)
    for e in range(len(elements)):
        if not checked[e]:
            continue
        first = elements[e, 0]
        for i in range(start[first], start[first + 1]):
            other = around[i]
            if other == e:
                continue
            shared = 0
            for j in range(4):
                for k in range(4):
                    if elements[e, j] >= 0 and elements[e, j] == elements[other, k]:
                        shared += 1
            size = 3 if elements[e, 3] < 0 else 4
            other_size = 3 if elements[other, 3] < 0 else 4
            if shared == min(size, other_size):
                return True
    return False


@njit(cache=True)
def sound_elements(points: Floats, elements: Ints, least: float) -> Bools:
    """(M,) bool: elements whose worst corner, along their own normal, is at least `least`."""
    scratch = np.empty(3)
    sound = np.zeros(len(elements), np.bool_)
    for e in range(len(elements)):
        area_vector(points, elements[e], scratch)
        size = np.sqrt(scratch[0] ** 2 + scratch[1] ** 2 + scratch[2] ** 2)
        if size > 0.0:
            scratch /= size
            sound[e] = (
                worst_corner(points, elements[e], scratch[0], scratch[1], scratch[2]) >= least
            )
    return sound


@njit(cache=True)
def mean_normals(points: Floats, trias: Ints) -> Floats:
    """(T, 3) unit normals of trias (T, 3)."""
    normals = np.empty((len(trias), 3))
    element = np.full(4, -1, np.int32)
    for t in range(len(trias)):
        element[:3] = trias[t]
        area_vector(points, element, normals[t])
        size = np.sqrt(normals[t, 0] ** 2 + normals[t, 1] ** 2 + normals[t, 2] ** 2)
        if size > 0.0:
            normals[t] /= size
    return normals
