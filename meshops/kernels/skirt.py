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
