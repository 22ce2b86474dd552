"""Whether elements are sound: neither inverted, concave nor degenerate, and none twice."""

from __future__ import annotations

import numpy as np

from meshops.kernels.smoothing import elements_of_nodes, own_corner
from meshops.kernels.vectors import area_vector, compiled, unit
from meshops.mesh import Bools, Floats, Ints

FACING = 0.5
"""Cosine of the angle up to which an element may be turned against the surface under it."""


@compiled
def sound_elements(points: Floats, elements: Ints, least: float) -> Bools:
    """(M,) bool: elements whose worst corner, along their own normal, is at least `least`."""
    sound = np.zeros(len(elements), np.bool_)
    for e in range(len(elements)):
        a, b, c, d = elements[e, 0], elements[e, 1], elements[e, 2], elements[e, 3]
        sound[e] = own_corner(points, a, b, c, d) >= least
    return sound


@compiled
def all_facing(points: Floats, elements: Ints, normals: Floats) -> bool:
    """Whether every element looks the way of its (M, 3) surface normal, up to 60 degrees."""
    for e in range(len(elements)):
        a, b, c, d = elements[e, 0], elements[e, 1], elements[e, 2], elements[e, 3]
        n = unit(area_vector(points, a, b, c, d))
        if n[0] * normals[e, 0] + n[1] * normals[e, 1] + n[2] * normals[e, 2] < FACING:
            return False
    return True


@compiled
def has_doubles(elements: Ints, nodes: int) -> bool:
    """Whether two elements have the same nodes, or one all nodes of another."""
    start, around = elements_of_nodes(elements, nodes)
    for e in range(len(elements)):
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


@compiled
def unit_normals(points: Floats, elements: Ints) -> Floats:
    """(M, 3) unit normals of elements (M, 4)."""
    normals = np.empty((len(elements), 3))
    for e in range(len(elements)):
        a, b, c, d = elements[e, 0], elements[e, 1], elements[e, 2], elements[e, 3]
        n = unit(area_vector(points, a, b, c, d))
        normals[e, 0], normals[e, 1], normals[e, 2] = n
    return normals
