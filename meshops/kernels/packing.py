"""Packing of squares: nodes placed in rows that grow from the border inwards.

After Packing of Parallelograms (Remacle, Henrotte, Carrier Baudouin and others, A frontal Delaunay
quad mesh generator using the L-infinity norm, 2013), with the field taken from the border edges.
"""

from __future__ import annotations

from math import atan2, cos, pi, sin, sqrt

import numpy as np

from meshops.kernels.triangulation import (
    Triangulation,
    area_to,
    border_triangulation,
    corner_of,
    insert,
    legalise,
    locate,
    remove,
    squared,
)
from meshops.kernels.vectors import compiled
from meshops.mesh import Floats, Ints

APART = 0.6
"""Of the local size: places nearer than this to a node that is there stay free."""

FROM_BORDER = 0.5
"""Of the local size: the least distance of a node from a border edge."""

REACH = 2.0
"""Of the size: the distance from the border where half of its own spacing is forgotten."""


@compiled
def border_field(points: Floats, border: Ints) -> Floats:
    """(b, 5) float64 of each border edge: its middle, its length, and cos and sin of 4 angles."""
    field = np.empty((len(border), 5))
    for j in range(len(border)):
        a, b = border[j, 0], border[j, 1]
        x, y = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
        angle = 4.0 * atan2(y, x)
        field[j, 0] = points[a, 0] + 0.5 * x
        field[j, 1] = points[a, 1] + 0.5 * y
        field[j, 2] = sqrt(x * x + y * y)
        field[j, 3], field[j, 4] = cos(angle), sin(angle)
    return field


@compiled
def cross_at(field: Floats, size: float, x: float, y: float) -> tuple[float, float]:
    """Angle of the cross at a place, and the size of squares there.

    Each border edge counts by its length over the cubed distance; the size that is asked for counts
    like an endless border at a distance of `REACH` sizes.
    """
    far = 2.0 / (REACH * size) ** 2
    cosine = sine = 0.0
    total, spacing = far, far * size
    for j in range(len(field)):
        d2 = (field[j, 0] - x) ** 2 + (field[j, 1] - y) ** 2
        d2 += 1e-6 * size * size
        weight = field[j, 2] / (d2 * sqrt(d2))
        cosine += weight * field[j, 3]
        sine += weight * field[j, 4]
        total += weight
        spacing += weight * field[j, 2]
    return 0.25 * atan2(sine, cosine), spacing / total


@compiled
def _is_free(mesh: Triangulation, node: int, angle: float, size: float) -> bool:
    """Whether an inner node is far enough from all around it and from the border.

    Distances are measured in the axes of the cross, by the larger coordinate: so the middle of a
    square is near to its corners.
    """
    points = mesh.points
    least = APART * size
    cosine, sine = cos(angle), sin(angle)
    t = mesh.tria_of[node]
    while True:
        k = corner_of(mesh, t, node)
        a, b = mesh.trias[t, (k + 1) % 3], mesh.trias[t, (k + 2) % 3]
        x, y = points[a, 0] - points[node, 0], points[a, 1] - points[node, 1]
        if max(abs(cosine * x + sine * y), abs(cosine * y - sine * x)) < least:
            return False
        if mesh.neighbours[t, (k + 1) % 3] < 0:
            area = area_to(points, a, b, points[node, 0], points[node, 1])
            if area < FROM_BORDER * size * sqrt(squared(points, a, b)):
                return False
        t = mesh.neighbours[t, (k + 2) % 3]
        if t == mesh.tria_of[node]:
            return True


@compiled
def _loops(border: Ints, border_nodes: int) -> tuple[Ints, Ints, Ints]:
    """Border nodes in the order of their loops; the next and the previous one of each."""
    ahead = np.full(border_nodes, -1, np.int32)
    behind = np.full(border_nodes, -1, np.int32)
    for j in range(len(border)):
        ahead[border[j, 0]] = border[j, 1]
        behind[border[j, 1]] = border[j, 0]
    order = np.empty(border_nodes, np.int32)
    seen = np.zeros(border_nodes, np.bool_)
    count = 0
    for first in range(border_nodes):
        node = first
        while node >= 0 and not seen[node]:
            seen[node] = True
            order[count] = node
            count += 1
            node = ahead[node]
    return order[:count], ahead, behind


@compiled
def _propose(
    mesh: Triangulation,
    crosses: Floats,
    field: Floats,
    size: float,
    parent: int,
    angle: float,
    step: float,
) -> None:
    """Place a node one step away from its parent, where that is inside and nothing is too near."""
    if mesh.counts[0] >= len(crosses):
        return
    x = mesh.points[parent, 0] + step * cos(angle)
    y = mesh.points[parent, 1] + step * sin(angle)
    t = locate(mesh, mesh.tria_of[parent], x, y)
    if t < 0:
        return
    for k in range(3):
        corner = mesh.trias[t, k]
        dx, dy = mesh.points[corner, 0] - x, mesh.points[corner, 1] - y
        if dx * dx + dy * dy < (0.5 * APART * step) ** 2:
            return  # most proposals end here, before they cost anything
    cross = cross_at(field, size, x, y)
    node = insert(mesh, t, x, y)
    crosses[node, 0], crosses[node, 1] = cross
    if not _is_free(mesh, node, cross[0], cross[1]):
        remove(mesh, node)
        mesh.counts[0] -= 1


@compiled
def _propose_from_border(
    mesh: Triangulation,
    crosses: Floats,
    field: Floats,
    size: float,
    behind: int,
    node: int,
    ahead: int,
) -> None:
    """Divide the angle at a border node evenly into nearly right ones, and go along each ray."""
    points = mesh.points
    x, y = points[node, 0], points[node, 1]
    first = atan2(points[ahead, 1] - y, points[ahead, 0] - x)
    opening = (atan2(points[behind, 1] - y, points[behind, 0] - x) - first) % (2.0 * pi)
    if opening < 1e-6:  # the end of a slit
        opening = 2.0 * pi
    parts = int(opening / (0.5 * pi) + 0.5)
    for i in range(1, parts):
        angle = first + opening * i / parts
        near = 0.5 * size
        step = cross_at(field, size, x + near * cos(angle), y + near * sin(angle))[1]
        _propose(mesh, crosses, field, size, node, angle, step)


@compiled
def pack_squares(
    points: Floats, trias: Ints, border: Ints, border_nodes: int, size: float, room: int
) -> tuple[bool, Floats, Ints]:
    """Place nodes for quads of edge `size` and triangulate.

    Returns whether that went well, the points (n, 2), border nodes first, and the trias (t, 3).
    """
    whole, mesh = border_triangulation(points, trias, border_nodes, room)
    if not whole:
        return False, mesh.points, mesh.trias
    field = border_field(points, border)
    crosses = np.empty((border_nodes + room, 2))
    order, ahead, behind = _loops(border, border_nodes)
    for node in order:
        _propose_from_border(mesh, crosses, field, size, behind[node], node, ahead[node])
    parent = border_nodes
    while parent < mesh.counts[0]:
        for quarter in range(4):
            angle = crosses[parent, 0] + 0.5 * pi * quarter
            _propose(mesh, crosses, field, size, parent, angle, crosses[parent, 1])
        parent += 1
    legalise(mesh)
    return True, mesh.points[: mesh.counts[0]].copy(), mesh.trias[: mesh.counts[1]].copy()
