"""Isotropic remeshing of a tria patch by pymeshlab: the only file that imports it.

What was measured of pymeshlab shapes this file: open borders move unless the patch has a collar of
unselected trias; nodes at the same place become one; flags that a call leaves out keep the value of
an earlier call; selecting by an expression crashes on a mesh built from arrays; non-finite
coordinates crash the filter.
"""

from __future__ import annotations

from math import inf, isfinite, ulp
from typing import Any

import pymeshlab

from meshops._core import BorderCollar, extents
from meshops.mesh import Floats, Ints

SWEEPS = 2
"""Iterations of split, collapse, flip, smooth and project."""

_LARGEST = 1e6

_NUDGE = 1e-9
"""Of the edge length: how far nodes at the same place, as on a slit, are set apart."""


class RemeshError(Exception):
    """The patch could not be remeshed with its border kept."""


def remesh_isotropic(points: Floats, trias: Ints, border: Ints, size: float) -> tuple[Floats, Ints]:
    """Remesh a patch of trias to an edge length, its border kept node for node.

    Parameters
    ----------
    points : (n, 3) float64
        The nodes of the border come first.
    trias : (t, 3) int32
    border : (b, 2) int32
        Border edges in the direction of their tria.
    size : float
        Edge length, in the unit of the points.

    Returns
    -------
    points : (n', 3) float64
        Border nodes first, at the same rows and places as before.
    trias : (t', 3) int32

    Raises
    ------
    RemeshError
        Where coordinates are not usable or the border did not come back whole.
    """
    largest, extent = extents(points)
    if not (isfinite(largest) and 0.0 < size < inf):
        raise RemeshError("coordinates and size must be finite")
    if extent > _LARGEST * size:
        raise RemeshError(f"the patch is over {_LARGEST:.0e} times as large as the edge length")
    nudge = max(_NUDGE * size, 4.0 * ulp(largest))
    collar = BorderCollar(points, trias, border, nudge)

    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(collar.points, collar.trias, f_scalar_array=collar.inside))
    meshes.compute_selection_by_scalar_per_face(minq=0.5, maxq=2.0)
    meshes.meshing_isotropic_explicit_remeshing(**isotropic_options(size))
    remeshed = meshes.current_mesh()
    try:
        return collar.take_off(
            remeshed.vertex_matrix(), remeshed.face_matrix(), remeshed.face_scalar_array()
        )
    except ValueError as fault:
        raise RemeshError(str(fault)) from None


def isotropic_options(size: float) -> dict[str, Any]:
    """Return every option of pymeshlab's isotropic remeshing, none left to an earlier call."""
    return {
        "iterations": SWEEPS,
        "adaptive": False,
        "selectedonly": True,
        "targetlen": pymeshlab.PureValue(size),
        "featuredeg": 30.0,
        "checksurfdist": False,
        "maxsurfdist": pymeshlab.PureValue(size),
        "splitflag": True,
        "collapseflag": True,
        "swapflag": True,
        "smoothflag": True,
        "reprojectflag": True,
    }
