"""The skirt: one tria outside each border edge, so that remeshing keeps the border."""

from __future__ import annotations

import numpy as np

from meshops.kernels.vectors import compiled
from meshops.mesh import Floats, Ints

_HEIGHT = 0.3
"""Of a skirt tria, as a share of its border edge."""


@compiled
def skirt_apexes(points: Floats, trias: Ints, border: Ints) -> Floats:
    """One point outside each border edge, in the plane of the tria inside it."""
    apexes = np.empty((len(border), 3))
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
    return apexes


@compiled
def drop_skirt(
    points: Floats, trias: Ints, apexes: Floats, border: Ints, border_nodes: int
) -> tuple[Ints, Ints]:
    """Find the new row of each node, or -1 where it goes, and the trias that stay, on old rows.

    The filter keeps the order of the nodes that survive it, so the apexes are met in order. No
    rows come back where the skirt is not whole.
    """
    failed = np.empty(0, np.int32)
    rows = np.full(len(points), -2, np.int32)
    edge_of = np.full(len(points), -1, np.int32)
    met = 0
    for p in range(len(points)):
        if met < len(apexes) and (
            points[p, 0] == apexes[met, 0]
            and points[p, 1] == apexes[met, 1]
            and points[p, 2] == apexes[met, 2]
        ):
            rows[p] = -1
            edge_of[p] = met
            met += 1
    inner = np.empty(trias.shape, np.int32)
    count = 0
    skirt = 0
    for t in range(len(trias)):
        j = -1
        for k in range(3):
            if edge_of[trias[t, k]] >= 0:
                j = edge_of[trias[t, k]]
                b, a = trias[t, (k + 1) % 3], trias[t, (k + 2) % 3]
        if j < 0:
            inner[count] = trias[t]
            count += 1
            continue
        skirt += 1
        for node, row in ((a, border[j, 0]), (b, border[j, 1])):
            if rows[node] != -2 and rows[node] != row:
                return failed, inner[:0]
            rows[node] = row
    if met < len(apexes) or skirt != len(border):
        return failed, inner[:0]
    following = border_nodes
    for p in range(len(points)):
        if rows[p] == -2:
            rows[p] = following
            following += 1
    return rows, inner[:count]
