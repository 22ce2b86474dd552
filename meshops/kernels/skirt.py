"""The skirt: one tria outside each border edge, so that remeshing keeps the border."""

from __future__ import annotations

import numpy as np

from meshops.kernels.vectors import compiled
from meshops.mesh import Floats, Ints

_HEIGHT = 0.3
"""Of a skirt tria, as a share of its border edge."""

WHOLE, NOT_FINITE, BORDER_CHANGED, BORDER_MOVED = 0, 1, 2, 3
"""What `take_off` finds."""


@compiled
def skirt_apexes(points: Floats, trias: Ints, border: Ints) -> Floats:
    """One point outside each border edge, in the plane of the tria inside it."""
    apexes = np.empty((len(border), 3))
    _write_apexes(points, trias, border, apexes)
    return apexes


@compiled
def _write_apexes(points: Floats, trias: Ints, border: Ints, apexes: Floats) -> None:
    by_start = np.full(len(points), -1, np.int32)
    ordinal = np.full(len(border), -1, np.int32)
    for j in range(len(border)):  # border edges that start at the same node are chained
        ordinal[j] = by_start[border[j, 0]]
        by_start[border[j, 0]] = j
    for t in range(len(trias)):
        for k in range(3):
            a, b, c = trias[t, k], trias[t, (k + 1) % 3], trias[t, (k + 2) % 3]
            j = by_start[a]
            while j >= 0:
                if border[j, 1] == b:
                    edge = points[b] - points[a]
                    inward = points[c] - points[a]
                    along = np.dot(edge, edge)
                    if along > 0.0:
                        inward = inward - (np.dot(inward, edge) / along) * edge
                    height = np.sqrt(np.dot(inward, inward))
                    apexes[j] = points[a] + 0.5 * edge
                    if height > 0.0:
                        apexes[j] -= _HEIGHT * np.sqrt(along) / height * inward
                j = ordinal[j]


@compiled
def extents(points: Floats) -> tuple[float, float]:
    """Largest coordinate without its sign, and largest distance along an axis from the first point.

    Infinite where a coordinate is not finite.
    """
    largest = extent = 0.0
    for n in range(len(points)):
        for k in range(3):
            if not np.isfinite(points[n, k]):
                return np.inf, np.inf
            largest = max(largest, abs(points[n, k]))
            extent = max(extent, abs(points[n, k] - points[0, k]))
    return largest, extent


@compiled
def put_on(points: Floats, trias: Ints, border: Ints, nudge: float) -> tuple[Floats, Ints, Floats]:
    """Put a skirt on a patch.

    Parameters
    ----------
    points, trias, border
        The patch (n, 3), (t, 3), (b, 2).
    nudge : float
        How far nodes at the same place are set apart.

    Returns
    -------
    points : (n + b, 3) float64
        The apexes of the skirt come last.
    trias : (t + b, 3) int32
        Those of the skirt come last.
    inside : (t + b,) float64
        1 for the trias of the patch, 0 for those of the skirt.
    """
    n, t, b = len(points), len(trias), len(border)
    places = np.empty((n + b, 3))
    places[:n] = points
    _write_apexes(points, trias, border, places[n:])
    _set_apart(places, nudge)
    whole = np.empty((t + b, 3), np.int32)
    whole[:t] = trias
    inside = np.zeros(t + b)
    inside[:t] = 1.0
    for j in range(b):
        whole[t + j, 0], whole[t + j, 1], whole[t + j, 2] = border[j, 1], border[j, 0], n + j
    return places, whole, inside


@compiled
def _set_apart(places: Floats, step: float) -> None:
    """Move nodes that are where an earlier one is by a step for each, in place."""
    count = len(places)
    size = 4
    while size < 2 * count:
        size *= 2
    table = np.full(size, -1, np.int32)  # open addressing: the first node of each place
    earlier = np.zeros(count, np.int32)
    steps = np.zeros(count, np.int32)
    for n in range(count):
        x, y, z = places[n, 0], places[n, 1], places[n, 2]
        slot = hash((x, y, z)) & (size - 1)
        while True:
            first = table[slot]
            if first < 0:
                table[slot] = n
                break
            if places[first, 0] == x and places[first, 1] == y and places[first, 2] == z:
                earlier[first] += 1
                steps[n] = earlier[first]
                break
            slot = (slot + 1) & (size - 1)
    for n in range(count):
        if steps[n] > 0:
            places[n] += step * steps[n]


@compiled
def take_off(
    out_points: Floats,
    out_trias: Ints,
    inside: Floats,
    points: Floats,
    border: Ints,
    places: Floats,
    nudge: float,
) -> tuple[Floats, Ints, int]:
    """Take the skirt off a remeshed patch.

    The skirt comes back as it went in, tria for tria, and names the nodes of the border; all others
    are inside.

    Parameters
    ----------
    out_points, out_trias, inside
        The remeshed patch with its skirt.
    points, border : (n, 3) float64, (b, 2) int32
        The patch as it was.
    places : (n + b, 3) float64
        Where its nodes were put for remeshing.
    nudge : float
        How far a node of the border may have come back from its place.

    Returns
    -------
    points : (n', 3) float64
        Nodes of the border first, at the rows and places that they had.
    trias : (t', 3) int32
    fault : int
        ``WHOLE``, or why there is no patch.
    """
    faulty = np.empty((0, 3)), np.empty((0, 3), np.int32)
    for n in range(len(out_points)):
        for k in range(3):
            if not np.isfinite(out_points[n, k]):
                return faulty[0], faulty[1], NOT_FINITE
    on_border = 0
    for j in range(len(border)):
        on_border = max(on_border, border[j, 0] + 1, border[j, 1] + 1)
    unknown, apex = -2, -1
    rows = np.full(len(out_points), unknown, np.int32)
    skirt = np.empty(len(out_trias), np.int32)
    count = 0
    for t in range(len(out_trias)):
        if not inside[t] > 0.5:
            skirt[count] = t
            count += 1
    if count != len(border):
        return faulty[0], faulty[1], BORDER_CHANGED
    for j in range(count):
        rows[out_trias[skirt[j], 0]] = border[j, 1]
        rows[out_trias[skirt[j], 1]] = border[j, 0]
    for j in range(count):
        rows[out_trias[skirt[j], 2]] = apex
    for j in range(count):
        if (
            rows[out_trias[skirt[j], 0]] != border[j, 1]
            or rows[out_trias[skirt[j], 1]] != border[j, 0]
        ):
            return faulty[0], faulty[1], BORDER_CHANGED
    found, following = 0, on_border
    for n in range(len(rows)):
        if rows[n] >= 0:
            found += 1
        elif rows[n] == unknown:
            rows[n] = following
            following += 1
    if found != on_border:
        return faulty[0], faulty[1], BORDER_CHANGED
    new_points = np.empty((following, 3))
    for n in range(len(rows)):
        row = rows[n]
        if row >= on_border:
            for k in range(3):
                new_points[row, k] = out_points[n, k]
        elif row >= 0:
            for k in range(3):
                # projecting to the surface may have moved the border by the last digits
                if abs(out_points[n, k] - places[row, k]) > nudge:
                    return faulty[0], faulty[1], BORDER_MOVED
                new_points[row, k] = points[row, k]
    new_trias = np.empty((len(out_trias) - count, 3), np.int32)
    t = 0
    for i in range(len(out_trias)):
        if inside[i] > 0.5:
            for k in range(3):
                new_trias[t, k] = rows[out_trias[i, k]]
            t += 1
    return new_points, new_trias, WHOLE
