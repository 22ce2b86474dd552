"""Moves of the nodes of a live patch, and the random numbers that they are drawn by.

See :mod:`meshops.kernels.living` for ``live`` and :mod:`meshops.kernels.lacking` for ``site``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from meshops.kernels.lacking import Site, is_plane
from meshops.kernels.living import Live, ahead, behind, corner, put
from meshops.kernels.node_scores import foot
from meshops.kernels.vectors import (
    Vector,
    add,
    compiled,
    cross,
    dot,
    length,
    scale,
    subtract,
    unit,
)
from meshops.mesh import Ints

Random = NDArray[np.uint64]
"""(1,) the state of a generator."""

SWEEPS = 2
"""Of relaxation after a change."""

OPPOSITE = 0.4
"""Weight of the far node of a quad in the place that a node relaxes to (Herrmann 1976)."""

PULLED = 0.3
"""Share of the moves that go to where the node relaxes."""

FARTHEST = 0.3
"""Of the mean edge at a node: the farthest that it is moved in a trial."""


@compiled
def draw(random: Random) -> float:
    """Next number from 0 to 1 of a xorshift generator (Marsaglia 2003); `random` (1,) uint64."""
    x = random[0]
    x ^= x << np.uint64(13)
    x ^= x >> np.uint64(7)
    x ^= x << np.uint64(17)
    random[0] = x
    return float(x >> np.uint64(11)) * (1.0 / 9007199254740992.0)


@compiled
def _relaxed(live: Live, node: int) -> tuple[Vector, float]:
    """Where a node relaxes to, between the mean of its neighbours and that of parallelograms.

    Also returns the mean edge at the node.
    """
    points, elements, ring, around = live[0], live[1], live[2], live[3]
    here = (points[node, 0], points[node, 1], points[node, 2])
    total, weight, edges = (0.0, 0.0, 0.0), 0.0, 0.0
    for i in range(around[node]):
        e = ring[node, i]
        k = corner(live, e, node)
        a, b = ahead(live, e, k), behind(live, e, k)
        p, q = (
            (points[a, 0], points[a, 1], points[a, 2]),
            (points[b, 0], points[b, 1], points[b, 2]),
        )
        edges += 0.5 * (length(subtract(p, here)) + length(subtract(q, here)))
        total = add(total, add(p, q))
        weight += 2.0
        if elements[e, 3] >= 0:
            o = elements[e, (k + 2) % 4]
            total = subtract(total, scale((points[o, 0], points[o, 1], points[o, 2]), OPPOSITE))
            weight -= OPPOSITE
    return scale(total, 1.0 / weight), edges / around[node]


@compiled
def _onto(site: Site, place: Vector) -> Vector:
    """Bring a place to the surface."""
    if is_plane(site):
        return place
    on_surface: Vector = foot(site[1], place)[0]
    return on_surface


@compiled
def relax_nodes(live: Live, site: Site, changed: Ints, count: int) -> bool:
    """Relax the free ones of some nodes."""
    for _ in range(SWEEPS):
        for i in range(count):
            node = changed[i]
            if node >= site[3] and live[3][node] > 0:
                place = _relaxed(live, node)[0]
                if not put(live, node, _onto(site, place)):
                    return False
    return True


@compiled
def move_node(live: Live, site: Site, node: int, random: Random) -> bool:
    """Move a node: a part of the way to where it relaxes, or anywhere near."""
    points, ring = live[0], live[2]
    if node < site[3]:
        return False
    here = (points[node, 0], points[node, 1], points[node, 2])
    relaxed, edge = _relaxed(live, node)
    if draw(random) < PULLED:
        pull = scale(subtract(relaxed, here), draw(random))
        return put(live, node, _onto(site, add(here, pull)))
    e = ring[node, 0]
    k = corner(live, e, node)
    a, b = ahead(live, e, k), behind(live, e, k)
    p = subtract((points[a, 0], points[a, 1], points[a, 2]), here)
    q = subtract((points[b, 0], points[b, 1], points[b, 2]), here)
    normal = unit(cross(p, q))
    along = unit(subtract(p, scale(normal, dot(p, normal))))
    across = cross(normal, along)
    reach = FARTHEST * edge * draw(random)
    x, y = reach * (2.0 * draw(random) - 1.0), reach * (2.0 * draw(random) - 1.0)
    return put(live, node, _onto(site, add(here, add(scale(along, x), scale(across, y)))))
