"""A triangulation of a plane area whose border stays: nodes are taken out and put in, edges flip.

No border edge is ever recovered, since none is ever lost: one begins with an older triangulation of
the area. It may even lap over itself, or have slits.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from meshops.kernels.pairing import tria_neighbours
from meshops.kernels.vectors import compiled
from meshops.mesh import Floats, Ids, Ints

_ROUND = 1e-12
"""Of squared areas: in-circle tests below this are taken for zero."""


class Triangulation(NamedTuple):
    """Arrays with room to grow, changed in place.

    Attributes
    ----------
    points : (N, 2) float64
    trias : (T, 3) int32
        Counter-clockwise.
    neighbours : (T, 3) int32
        The tria across side k, from node k to node k + 1; -1 on the border.
    tria_of : (N,) int32
        A tria at each node; -1 for a node that is not there.
    counts : (2,) int64
        How many rows of nodes and of trias are in use.
    """

    points: Floats
    trias: Ints
    neighbours: Ints
    tria_of: Ints
    counts: Ids


@compiled
def begin(points: Floats, trias: Ints, room: int) -> Triangulation:
    """Take over a triangulation, with room for some more nodes."""
    nodes, count = len(points), len(trias)
    places = np.empty((nodes + room, 2))
    places[:nodes] = points
    corners = np.full((count + 2 * room, 3), -1, np.int32)
    corners[:count] = trias
    neighbours = np.full((count + 2 * room, 3), -1, np.int32)
    neighbours[:count] = tria_neighbours(trias, nodes)
    tria_of = np.full(nodes + room, -1, np.int32)
    for t in range(count):
        for k in range(3):
            tria_of[trias[t, k]] = t
    return Triangulation(places, corners, neighbours, tria_of, np.array([nodes, count], np.int64))


@compiled
def area_to(points: Floats, a: int, b: int, x: float, y: float) -> float:
    """Twice the signed area of the tria of nodes a and b and a place."""
    area: float = (points[b, 0] - points[a, 0]) * (y - points[a, 1]) - (
        points[b, 1] - points[a, 1]
    ) * (x - points[a, 0])
    return area


@compiled
def turn(points: Floats, a: int, b: int, c: int) -> float:
    """Twice the signed area of abc."""
    area: float = area_to(points, a, b, points[c, 0], points[c, 1])
    return area


@compiled
def squared(points: Floats, a: int, b: int) -> float:
    """Squared distance of two nodes."""
    distance: float = (points[b, 0] - points[a, 0]) ** 2 + (points[b, 1] - points[a, 1]) ** 2
    return distance


@compiled
def corner_of(mesh: Triangulation, t: int, node: int) -> int:
    """Which corner of tria t the node is; -1 for none."""
    for k in range(3):
        if mesh.trias[t, k] == node:
            return k
    return -1


@compiled
def across(mesh: Triangulation, t: int, k: int) -> tuple[int, int]:
    """Tria across side k of tria t, and its corner that is not on the side; -1, -1 for none.

    Two trias may share two sides, so the corner is found by the nodes of the side.
    """
    other = mesh.neighbours[t, k]
    if other >= 0:
        a, b = mesh.trias[t, k], mesh.trias[t, (k + 1) % 3]
        for side in range(3):
            if mesh.trias[other, side] == b and mesh.trias[other, (side + 1) % 3] == a:
                return other, (side + 2) % 3
    return -1, -1


@compiled
def _relink(mesh: Triangulation, t: int, old: int, new: int) -> None:
    """Let tria t, if any, look at `new` across the side where it looked at `old`."""
    if t >= 0:
        for k in range(3):
            if mesh.neighbours[t, k] == old:
                mesh.neighbours[t, k] = new
                return


@compiled
def _set(mesh: Triangulation, t: int, a: int, b: int, c: int, ab: int, bc: int, ca: int) -> None:
    """Write the corners of tria t and its neighbours."""
    mesh.trias[t, 0], mesh.trias[t, 1], mesh.trias[t, 2] = a, b, c
    mesh.neighbours[t, 0], mesh.neighbours[t, 1], mesh.neighbours[t, 2] = ab, bc, ca
    mesh.tria_of[a], mesh.tria_of[b], mesh.tria_of[c] = t, t, t


@compiled
def flip(mesh: Triangulation, t: int, k: int) -> None:
    """Turn the edge at side k of tria t, which joins it to another, to the other diagonal."""
    o, apex = across(mesh, t, k)
    a, b, c = mesh.trias[t, k], mesh.trias[t, (k + 1) % 3], mesh.trias[t, (k + 2) % 3]
    d = mesh.trias[o, apex]
    bc, ca = mesh.neighbours[t, (k + 1) % 3], mesh.neighbours[t, (k + 2) % 3]
    db, ad = mesh.neighbours[o, apex], mesh.neighbours[o, (apex + 2) % 3]
    _set(mesh, t, a, d, c, ad, o, ca)
    _set(mesh, o, d, b, c, db, bc, t)
    _relink(mesh, ad, o, t)
    _relink(mesh, bc, t, o)


@compiled
def _wants_flip(points: Floats, a: int, b: int, c: int, d: int) -> bool:
    """Whether d, beyond side ab of tria abc, lies in its circle, so that edge cd is better."""
    if turn(points, a, d, c) <= 0.0 or turn(points, d, b, c) <= 0.0:
        return False
    ax, ay = points[a, 0] - points[d, 0], points[a, 1] - points[d, 1]
    bx, by = points[b, 0] - points[d, 0], points[b, 1] - points[d, 1]
    cx, cy = points[c, 0] - points[d, 0], points[c, 1] - points[d, 1]
    a2, b2, c2 = ax * ax + ay * ay, bx * bx + by * by, cx * cx + cy * cy
    inside = a2 * (bx * cy - by * cx) + b2 * (cx * ay - cy * ax) + c2 * (ax * by - ay * bx)
    return bool(inside > _ROUND * max(a2, b2, c2) ** 2)


@compiled
def legalise(mesh: Triangulation) -> None:
    """Flip edges until the triangulation is the constrained Delaunay one (Lawson 1977)."""
    for _ in range(mesh.counts[1] + 8):
        changed = False
        for t in range(mesh.counts[1]):
            for k in range(3):
                o, apex = across(mesh, t, k)
                if o < 0:
                    continue
                a, b, c = mesh.trias[t, k], mesh.trias[t, (k + 1) % 3], mesh.trias[t, (k + 2) % 3]
                if _wants_flip(mesh.points, a, b, c, mesh.trias[o, apex]):
                    flip(mesh, t, k)
                    changed = True
        if not changed:
            return


@compiled
def _legalise_around(mesh: Triangulation, node: int) -> None:
    """Make the edges opposite an inner node Delaunay, and those that flips bring to face it."""
    t = first = mesh.tria_of[node]
    while True:
        k = (corner_of(mesh, t, node) + 1) % 3
        o, apex = across(mesh, t, k)
        a, b = mesh.trias[t, k], mesh.trias[t, (k + 1) % 3]
        if o >= 0 and _wants_flip(mesh.points, a, b, node, mesh.trias[o, apex]):
            flip(mesh, t, k)
            # both trias of the flipped edge are at the node: go on with the earlier one
            first = t
        else:
            t = mesh.neighbours[t, (k + 1) % 3]
            if t == first:
                return


@compiled
def locate(mesh: Triangulation, start: int, x: float, y: float) -> int:
    """Tria that a place lies in, or -1: walk there from tria `start`, else look at all."""
    t = start
    for _ in range(mesh.counts[1]):
        out, worst = -1, 0.0
        for k in range(3):
            area = area_to(mesh.points, mesh.trias[t, k], mesh.trias[t, (k + 1) % 3], x, y)
            if -area > worst:
                out, worst = k, -area
        if out < 0:
            return t
        t = mesh.neighbours[t, out]
        if t < 0:
            break
    for t in range(mesh.counts[1]):
        a, b, c = mesh.trias[t, 0], mesh.trias[t, 1], mesh.trias[t, 2]
        if (
            area_to(mesh.points, a, b, x, y) >= 0.0
            and area_to(mesh.points, b, c, x, y) >= 0.0
            and area_to(mesh.points, c, a, x, y) >= 0.0
        ):
            return t
    return -1


@compiled
def insert(mesh: Triangulation, t: int, x: float, y: float) -> int:
    """Put a node at a place in tria t, and flip to Delaunay; the row of the node."""
    node = mesh.counts[0]
    mesh.points[node, 0], mesh.points[node, 1] = x, y
    a, b, c = mesh.trias[t, 0], mesh.trias[t, 1], mesh.trias[t, 2]
    ab, bc, ca = mesh.neighbours[t, 0], mesh.neighbours[t, 1], mesh.neighbours[t, 2]
    u, v = mesh.counts[1], mesh.counts[1] + 1
    mesh.counts[0] += 1
    mesh.counts[1] += 2
    _set(mesh, t, a, b, node, ab, u, v)
    _set(mesh, u, b, c, node, bc, v, t)
    _set(mesh, v, c, a, node, ca, t, u)
    _relink(mesh, bc, t, u)
    _relink(mesh, ca, t, v)
    _legalise_around(mesh, node)
    return int(node)


@compiled
def remove(mesh: Triangulation, node: int) -> bool:
    """Take an inner node out: flip its edges away until three are left. False where none will."""
    while True:
        best, best_t, best_k = 0.0, -1, -1
        t = mesh.tria_of[node]
        valence = 0
        while True:
            k = corner_of(mesh, t, node)
            o, apex = across(mesh, t, k)
            b, c, d = mesh.trias[t, (k + 1) % 3], mesh.trias[t, (k + 2) % 3], mesh.trias[o, apex]
            # the edge from the node to b goes: tria dbc stays behind, and must not hold the node
            ear = turn(mesh.points, d, b, c)
            if ear > 0.0 and turn(mesh.points, node, d, c) >= 0.0:
                shape = ear / (squared(mesh.points, b, c) + squared(mesh.points, b, d))
                if shape > best:
                    best, best_t, best_k = shape, t, k
            valence += 1
            t = mesh.neighbours[t, (k + 2) % 3]
            if t == mesh.tria_of[node]:
                break
        if valence == 3:
            _join_three(mesh, node)
            return True
        if best_t < 0 or valence < 3:
            return False
        flip(mesh, best_t, best_k)


@compiled
def _join_three(mesh: Triangulation, node: int) -> None:
    """Make one tria of the three around a node, which is gone then."""
    t = mesh.tria_of[node]
    k = corner_of(mesh, t, node)
    u, v = mesh.neighbours[t, k], mesh.neighbours[t, (k + 2) % 3]
    i, j = corner_of(mesh, u, node), corner_of(mesh, v, node)
    a, b, c = mesh.trias[t, (k + 1) % 3], mesh.trias[t, (k + 2) % 3], mesh.trias[u, (i + 1) % 3]
    ab, bc, ca = (
        mesh.neighbours[t, (k + 1) % 3],
        mesh.neighbours[v, (j + 1) % 3],
        mesh.neighbours[u, (i + 1) % 3],
    )
    _set(mesh, t, a, b, c, ab, bc, ca)
    _relink(mesh, bc, v, t)
    _relink(mesh, ca, u, t)
    mesh.tria_of[node] = -1
    _drop(mesh, max(u, v))
    _drop(mesh, min(u, v))


@compiled
def _drop(mesh: Triangulation, t: int) -> None:
    """Let the last tria take the row of tria t, which nothing looks at any more."""
    last = mesh.counts[1] - 1
    mesh.counts[1] = last
    if t == last:
        return
    a, b, c = mesh.trias[last, 0], mesh.trias[last, 1], mesh.trias[last, 2]
    ab, bc, ca = mesh.neighbours[last, 0], mesh.neighbours[last, 1], mesh.neighbours[last, 2]
    _set(mesh, t, a, b, c, ab, bc, ca)
    for other in (ab, bc, ca):
        _relink(mesh, other, last, t)


@compiled
def border_triangulation(
    points: Floats, trias: Ints, border_nodes: int, room: int
) -> tuple[bool, Triangulation]:
    """Constrained Delaunay triangulation of an area on its border nodes alone, which come first.

    Returns whether all other nodes could be taken out, and the triangulation.
    """
    mesh = begin(points, trias, room)
    legalise(mesh)
    for node in range(len(points) - 1, border_nodes - 1, -1):
        if mesh.tria_of[node] >= 0 and not remove(mesh, node):
            return False, mesh
    mesh.counts[0] = border_nodes
    legalise(mesh)
    return True, mesh
