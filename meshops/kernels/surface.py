"""Nearest points on a surface of trias."""

from __future__ import annotations

import numpy as np

from meshops.kernels.vectors import area_vector, compiled, length
from meshops.mesh import Floats, Ints


@compiled
def _closest_on_tria(p: Floats, a: Floats, b: Floats, c: Floats, out: Floats) -> float:
    """Closest point of tria abc to p (Ericson, Real-Time Collision Detection, 5.1.5).

    Writes the point to `out` and returns the squared distance.
    """
    abx, aby, abz = b[0] - a[0], b[1] - a[1], b[2] - a[2]
    acx, acy, acz = c[0] - a[0], c[1] - a[1], c[2] - a[2]
    apx, apy, apz = p[0] - a[0], p[1] - a[1], p[2] - a[2]
    d1 = abx * apx + aby * apy + abz * apz
    d2 = acx * apx + acy * apy + acz * apz
    v, w = 0.0, 0.0
    # d1 - d3 and d2 - d6 are squared lengths: 0 where a side has none
    if not (d1 <= 0.0 and d2 <= 0.0):
        bpx, bpy, bpz = p[0] - b[0], p[1] - b[1], p[2] - b[2]
        d3 = abx * bpx + aby * bpy + abz * bpz
        d4 = acx * bpx + acy * bpy + acz * bpz
        cpx, cpy, cpz = p[0] - c[0], p[1] - c[1], p[2] - c[2]
        d5 = abx * cpx + aby * cpy + abz * cpz
        d6 = acx * cpx + acy * cpy + acz * cpz
        va, vb, vc = d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2
        if d3 >= 0.0 and d4 <= d3:
            v = 1.0
        elif vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0 and d1 > d3:
            v = d1 / (d1 - d3)
        elif d6 >= 0.0 and d5 <= d6:
            w = 1.0
        elif vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0 and d2 > d6:
            w = d2 / (d2 - d6)
        elif va <= 0.0 and d4 >= d3 and d5 >= d6:
            w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
            v = 1.0 - w
        else:
            total = va + vb + vc
            v, w = vb / total, vc / total
    out[0] = a[0] + v * abx + w * acx
    out[1] = a[1] + v * aby + w * acy
    out[2] = a[2] + v * abz + w * acz
    squared: float = (p[0] - out[0]) ** 2 + (p[1] - out[1]) ** 2 + (p[2] - out[2]) ** 2
    return squared


@compiled
def bounding_spheres(points: Floats, trias: Ints) -> Floats:
    """(T, 4) float64: centre and radius of a sphere around each tria."""
    spheres = np.empty((len(trias), 4))
    for t in range(len(trias)):
        for k in range(3):
            spheres[t, k] = (
                points[trias[t, 0], k] + points[trias[t, 1], k] + points[trias[t, 2], k]
            ) / 3.0
        radius = 0.0
        for corner in range(3):
            squared = 0.0
            for k in range(3):
                squared += (points[trias[t, corner], k] - spheres[t, k]) ** 2
            radius = max(radius, squared)
        spheres[t, 3] = np.sqrt(radius)
    return spheres


@compiled
def nearest(
    queries: Floats, points: Floats, trias: Ints, spheres: Floats
) -> tuple[Floats, Floats, Ints]:
    """Nearest point of a surface to each query.

    Returns the points (Q, 3), the distances (Q,) and the trias (Q,) int32 that they lie on; of
    equally near trias the first.
    """
    found = np.empty((len(queries), 3))
    distance = np.empty(len(queries))
    tria = np.zeros(len(queries), np.int32)
    candidate = np.empty(3)
    guess = 0
    for q in range(len(queries)):
        p = queries[q]
        # the tria of the query before is a good first bound, as queries follow each other in space
        best = _closest_on_tria(
            p, points[trias[guess, 0]], points[trias[guess, 1]], points[trias[guess, 2]], candidate
        )
        found[q] = candidate
        tria[q] = guess
        reach = np.sqrt(best)
        for t in range(len(trias)):
            x, y, z = spheres[t, 0] - p[0], spheres[t, 1] - p[1], spheres[t, 2] - p[2]
            limit = reach + spheres[t, 3]
            if x * x + y * y + z * z > limit * limit:
                continue
            squared = _closest_on_tria(
                p, points[trias[t, 0]], points[trias[t, 1]], points[trias[t, 2]], candidate
            )
            if squared < best or (squared == best and t < tria[q]):
                best = squared
                reach = np.sqrt(best)
                found[q] = candidate
                tria[q] = t
        distance[q] = reach
        guess = tria[q]
    return found, distance, tria


@compiled
def areas_of(points: Floats, trias: Ints) -> tuple[Floats, float]:
    """Sum of the area vectors of trias (3,), and sum of their areas."""
    total = np.zeros(3)
    area = 0.0
    for t in range(len(trias)):
        v = area_vector(points, trias[t, 0], trias[t, 1], trias[t, 2], -1)
        for k in range(3):
            total[k] += v[k]
        area += length(v)
    return total, area


@compiled
def plane_of(points: Floats, trias: Ints, tolerance: float) -> tuple[Floats, float, Floats, bool]:
    """Sum of the area vectors of trias, sum of their areas, unit normal, and whether it is plane.

    Plane: all points are nearer to one plane than `tolerance` times their extent, and all trias
    look the same way.
    """
    total, area = areas_of(points, trias)
    size = np.sqrt((total * total).sum())
    if size <= 0.0:
        return total, area, total, False
    normal = total / size
    extent = 0.0
    for k in range(3):
        extent = max(extent, points[:, k].max() - points[:, k].min())
    for n in range(len(points)):
        offset = 0.0
        for k in range(3):
            offset += (points[n, k] - points[0, k]) * normal[k]
        if abs(offset) > tolerance * extent:
            return total, area, normal, False
    for t in range(len(trias)):
        v = area_vector(points, trias[t, 0], trias[t, 1], trias[t, 2], -1)
        if v[0] * normal[0] + v[1] * normal[1] + v[2] * normal[2] <= 0.0:
            return total, area, normal, False
    return total, area, normal, True
