"""Superelements that are joined by the places of their nodes."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from meshops.mesh import Bools, Floats

_ATTACHED = 1e-5
"""Nodes of two sections that are nearer, relative to the size of the mesh, are joined."""


def attached(points: Floats, others: Floats) -> Bools:
    """(N,) bool: which points have one of the others in their place, as where parts are joined."""
    if not (len(points) and len(others)):
        return np.zeros(len(points), bool)
    size = float(np.ptp(points, axis=0).max())
    distance = KDTree(others).query(points)[0]
    near: Bools = distance <= _ATTACHED * size
    return near
