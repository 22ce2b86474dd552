"""Lifting points of a flattened patch back to its surface."""

from __future__ import annotations

import numpy as np

from meshops.kernels.triangulation import area_to, begin, locate, turn
from meshops.kernels.vectors import compiled, cross, edge
from meshops.mesh import Floats, Ints


@compiled
def normals_of(points: Floats, trias: Ints) -> Floats:
    """(T, 3) normals of trias, as long as twice their area."""
    normals = np.empty((len(trias), 3))
    for t in range(len(trias)):
        a, b, c = trias[t, 0], trias[t, 1], trias[t, 2]
        normals[t, 0], normals[t, 1], normals[t, 2] = cross(edge(points, a, b), edge(points, a, c))
    return normals


@compiled
def lift(flat: Floats, trias: Ints, points: Floats, queries: Floats) -> Floats:
    """(q, 3) places on a surface of points in the plane of its flattened trias.

    Parameters
    ----------
    flat, points : (n, 2) and (n, 3) float64
        The nodes in the plane and in space.
    trias : (t, 3) int32
    queries : (q, 2) float64
        Where one lies in no tria, the nearest node lends its place.
    """
    mesh = begin(flat, trias, 0)
    lifted = np.empty((len(queries), 3))
    t = 0
    for q in range(len(queries)):
        x, y = queries[q, 0], queries[q, 1]
        found = locate(mesh, t, x, y)
        if found < 0:
            nearest, best = 0, np.inf
            for n in range(len(flat)):
                d2 = (flat[n, 0] - x) ** 2 + (flat[n, 1] - y) ** 2
                if d2 < best:
                    nearest, best = n, d2
            lifted[q] = points[nearest]
            continue
        t = found
        whole = turn(flat, trias[t, 0], trias[t, 1], trias[t, 2])
        lifted[q] = 0.0
        for k in range(3):
            b, c = trias[t, (k + 1) % 3], trias[t, (k + 2) % 3]
            share = area_to(flat, b, c, x, y) / whole
            for axis in range(3):
                lifted[q, axis] += share * points[trias[t, k], axis]
    return lifted
