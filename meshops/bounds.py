"""Bounds: how bad by shape a changed element may be on a mesh that is better than its limits."""

from __future__ import annotations

from math import degrees, inf, sqrt

import numpy as np

from meshops.criteria import (
    FALLING,
    MAX_ANGLE_QUAD,
    MAX_ANGLE_TRIA,
    MIN_ANGLE_QUAD,
    MIN_ANGLE_TRIA,
    NAMES,
)
from meshops.mesh import ShellMesh
from meshops.quality import angle_extremes

BEST_SINE = sqrt(3.0) / 2.0
"""Of a tria's angles; the scaled Jacobian of a tria is over that."""


def bounds_of(mesh: ShellMesh) -> tuple[float, ...]:
    """Find the angles that keep a mesh's worst ones, for `Scoring.bounds`.

    No element gets a smaller or larger angle than there is, nor a smaller scaled Jacobian.
    The scaled Jacobian of a plane element is the least sine of its angles, over that of the best
    element of its kind; 0 of one that is concave, which leaves angles unbounded.
    """
    bounds = [-inf if name in FALLING else inf for name in NAMES]
    least, most = angle_extremes(mesh)
    sines = np.minimum(np.sin(np.radians(least)), np.sin(np.radians(most)))
    scaled = max(float((sines / np.where(mesh.is_tria, BEST_SINE, 1.0)).min()), 0.0)
    for best, narrow, wide in (
        (1.0, MIN_ANGLE_QUAD, MAX_ANGLE_QUAD),
        (BEST_SINE, MIN_ANGLE_TRIA, MAX_ANGLE_TRIA),
    ):
        narrowest = degrees(float(np.arcsin(min(best * scaled, 1.0))))
        bounds[narrow] = max(narrowest, float(least.min()))
        bounds[wide] = min(180.0 - narrowest, float(most.max())) if scaled else inf
    return tuple(bounds)
