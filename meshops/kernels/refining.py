"""Delaunay refinement of a plane area, and bubbles that push each other to even distances."""

from __future__ import annotations

from math import sqrt

import numpy as np

from meshops.kernels.packing import border_field, cross_at
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
    turn,
)
from meshops.kernels.vectors import compiled
from meshops.mesh import Floats, Ints

REGULAR = 1.0 / sqrt(3.0)
"""Circumradius of a regular tria over its edge."""

PASSES = (4.0, 2.4, 1.7, 1.35)
"""Circumradius over that of the regular tria from which each pass refines: the largest first."""

FROM_BORDER = 0.6
"""Of the local size: the least distance of a node from a border edge and from other nodes."""

REACH = 1.5
"""Of the size: bubbles farther apart do not act on each other (Shimada and Gossard 1995)."""

STEP = 0.2
"""Of the force: how far a bubble moves in a sweep."""


@compiled
def _is_clear(mesh: Triangulation, node: int, size: float) -> bool:
    """Whether an inner node keeps its distance from all around it and from the border."""
    points = mesh.points
    least = FROM_BORDER * size
    t = mesh.tria_of[node]
    while True:
        k = corner_of(mesh, t, node)
        a, b = mesh.trias[t, (k + 1) % 3], mesh.trias[t, (k + 2) % 3]
        if squared(points, node, a) < least**2:
            return False
        if mesh.neighbours[t, (k + 1) % 3] < 0:
            area = area_to(points, a, b, points[node, 0], points[node, 1])
            if area < least * sqrt(squared(points, a, b)):
                return False
        t = mesh.neighbours[t, (k + 2) % 3]
        if t == mesh.tria_of[node]:
            return True


@compiled
def _circumcentre(points: Floats, a: int, b: int, c: int) -> tuple[float, float, float]:
    """Centre and radius of the circle through three nodes; radius 0 where they are in line."""
    bx, by = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
    cx, cy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
    double = 2.0 * (bx * cy - by * cx)
    if double <= 0.0:
        return points[a, 0], points[a, 1], 0.0
    b2, c2 = bx * bx + by * by, cx * cx + cy * cy
    x, y = (cy * b2 - by * c2) / double, (bx * c2 - cx * b2) / double
    return points[a, 0] + x, points[a, 1] + y, sqrt(x * x + y * y)


@compiled
def _refine(mesh: Triangulation, sizes: Floats, field: Floats, size: float) -> None:
    """Insert circumcentres until no tria is too large (Chew 1989, the border left alone)."""
    for limit in PASSES:
        t = 0
        while t < mesh.counts[1] and mesh.counts[0] < len(sizes):
            a, b, c = mesh.trias[t, 0], mesh.trias[t, 1], mesh.trias[t, 2]
            x, y, radius = _circumcentre(mesh.points, a, b, c)
            here = (sizes[a] + sizes[b] + sizes[c]) / 3.0
            t += 1
            if radius <= limit * REGULAR * here:
                continue
            inside = locate(mesh, t - 1, x, y)
            if inside < 0:
                continue
            before = mesh.counts[1]
            node = insert(mesh, inside, x, y)
            sizes[node] = cross_at(field, size, x, y)[1]
            if _is_clear(mesh, node, sizes[node]):
                t = max(0, min(t - 1, before))
            else:
                remove(mesh, node)
                mesh.counts[0] -= 1


@compiled
def _move(mesh: Triangulation, node: int, dx: float, dy: float) -> None:
    """Move an inner node by a step, or half of it and so on, as far as its trias stay upright."""
    points = mesh.points
    x, y = points[node, 0], points[node, 1]
    for _ in range(4):
        points[node, 0], points[node, 1] = x + dx, y + dy
        t = mesh.tria_of[node]
        while turn(points, mesh.trias[t, 0], mesh.trias[t, 1], mesh.trias[t, 2]) > 0.0:
            t = mesh.neighbours[t, (corner_of(mesh, t, node) + 2) % 3]
            if t == mesh.tria_of[node]:
                return
        dx, dy = 0.5 * dx, 0.5 * dy
    points[node, 0], points[node, 1] = x, y


@compiled
def _laplace(mesh: Triangulation, border_nodes: int) -> None:
    """Move every inner node to the mean of its neighbours."""
    for node in range(border_nodes, mesh.counts[0]):
        x = y = 0.0
        valence = 0
        t = mesh.tria_of[node]
        while True:
            k = corner_of(mesh, t, node)
            other = mesh.trias[t, (k + 1) % 3]
            x += mesh.points[other, 0]
            y += mesh.points[other, 1]
            valence += 1
            t = mesh.neighbours[t, (k + 2) % 3]
            if t == mesh.tria_of[node]:
                break
        _move(mesh, node, x / valence - mesh.points[node, 0], y / valence - mesh.points[node, 1])
    legalise(mesh)


@compiled
def _push(mesh: Triangulation, sizes: Floats, border_nodes: int) -> None:
    """Let neighbouring bubbles push and pull each other (Shimada and Gossard's cubic force)."""
    for node in range(border_nodes, mesh.counts[0]):
        x = y = 0.0
        t = mesh.tria_of[node]
        while True:
            k = corner_of(mesh, t, node)
            other = mesh.trias[t, (k + 1) % 3]
            dx = mesh.points[node, 0] - mesh.points[other, 0]
            dy = mesh.points[node, 1] - mesh.points[other, 1]
            distance = sqrt(dx * dx + dy * dy)
            w = 2.0 * distance / (sizes[node] + sizes[other])
            if 0.0 < w < REACH:
                force = 1.25 * w**3 - 2.375 * w**2 + 1.125
                x += force * dx / distance
                y += force * dy / distance
            t = mesh.neighbours[t, (k + 2) % 3]
            if t == mesh.tria_of[node]:
                break
        _move(mesh, node, STEP * sizes[node] * x, STEP * sizes[node] * y)
    legalise(mesh)


@compiled
def _crowding(mesh: Triangulation, sizes: Floats, node: int) -> float:
    """By how much the bubbles around a node overlap its own; 6 where they just touch."""
    t = mesh.tria_of[node]
    total = 0.0
    while True:
        k = corner_of(mesh, t, node)
        other = mesh.trias[t, (k + 1) % 3]
        distance = sqrt(squared(mesh.points, node, other))
        total += max(0.0, (sizes[node] + 0.5 * sizes[other] - distance) / (0.5 * sizes[node]))
        t = mesh.neighbours[t, (k + 2) % 3]
        if t == mesh.tria_of[node]:
            return float(total)


@compiled
def _thin_out(mesh: Triangulation, sizes: Floats, border_nodes: int, most: float) -> None:
    """Take out bubbles that overlap too much; the last one takes the row of each."""
    for node in range(mesh.counts[0] - 1, border_nodes - 1, -1):
        if _crowding(mesh, sizes, node) <= most or not remove(mesh, node):
            continue
        last = mesh.counts[0] - 1
        if node != last:
            first = mesh.tria_of[last]
            t = first
            while True:
                k = corner_of(mesh, t, last)
                mesh.trias[t, k] = node
                t = mesh.neighbours[t, (k + 2) % 3]
                if t == first:
                    break
            mesh.points[node] = mesh.points[last]
            sizes[node] = sizes[last]
            mesh.tria_of[node] = first
        mesh.tria_of[last] = -1
        mesh.counts[0] = last


@compiled
def fill_area(
    points: Floats,
    trias: Ints,
    border: Ints,
    border_nodes: int,
    size: float,
    room: int,
    rounds: int,
    sweeps: int,
) -> tuple[bool, Floats, Ints]:
    """Fill an area with trias of edge `size`.

    Parameters
    ----------
    points : (n, 2) float64
        Border nodes come first.
    trias : (t, 3) int32
    border : (b, 2) int32
    border_nodes : int
    size : float
    room : int
        Most nodes that may be placed.
    rounds : int
        How often bubbles are pushed, thinned out and added; 0: Laplace sweeps instead.
    sweeps : int
        Sweeps over all nodes, in each round.

    Returns
    -------
    Whether that went well, the points (n', 2), border nodes first, and the trias (t', 3).
    """
    whole, mesh = border_triangulation(points, trias, border_nodes, room)
    if not whole:
        return False, mesh.points, mesh.trias
    field = border_field(points, border)
    sizes = np.zeros(border_nodes + room)
    for j in range(len(border)):
        for end in range(2):
            sizes[border[j, end]] += 0.5 * field[j, 2]
    _refine(mesh, sizes, field, size)
    for _ in range(rounds):
        for _ in range(sweeps):
            _push(mesh, sizes, border_nodes)
        _thin_out(mesh, sizes, border_nodes, 8.5)
        legalise(mesh)
        _refine(mesh, sizes, field, size)
    if rounds:
        for _ in range(sweeps):
            _push(mesh, sizes, border_nodes)
    else:
        for _ in range(sweeps):
            _laplace(mesh, border_nodes)
    return True, mesh.points[: mesh.counts[0]].copy(), mesh.trias[: mesh.counts[1]].copy()
