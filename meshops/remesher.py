"""Isotropic remeshing of a tria patch by pymeshlab: the only file that imports it.

What was measured of pymeshlab shapes this file: open borders move unless the patch has a skirt of
unselected trias; nodes at the same place become one; flags that a call leaves out keep the value of
an earlier call; selecting by an expression crashes on a mesh built from arrays; non-finite
coordinates crash the filter.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pymeshlab

from meshops.kernels.skirt import skirt_apexes
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
    border_nodes = int(border.max()) + 1 if len(border) else 0
    if not np.isfinite(points).all() or not 0.0 < size < np.inf:
        raise RemeshError("coordinates and size must be finite")
    origin = points[0]
    extent = float(np.abs(points - origin).max())
    if extent > _LARGEST * size:
        raise RemeshError(f"the patch is over {_LARGEST:.0e} times as large as the edge length")
    nudge = max(_NUDGE * size, 4.0 * float(np.spacing(np.abs(points).max())))
    places = _apart(np.concatenate([points, skirt_apexes(points, trias, border)]), nudge)
    skirt = np.empty((len(border), 3), np.int32)
    skirt[:, 0], skirt[:, 1] = border[:, 1], border[:, 0]
    skirt[:, 2] = np.arange(len(points), len(points) + len(border))
    selected = np.zeros(len(trias) + len(skirt))
    selected[: len(trias)] = 1.0

    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(places, np.concatenate([trias, skirt]), f_scalar_array=selected))
    meshes.compute_selection_by_scalar_per_face(minq=0.5, maxq=2.0)
    meshes.meshing_isotropic_explicit_remeshing(**isotropic_options(size))
    remeshed = meshes.current_mesh()
    out_points = remeshed.vertex_matrix()
    out_trias = remeshed.face_matrix().astype(np.int32)
    if not np.isfinite(out_points).all():
        raise RemeshError("remeshing left the finite numbers")
    inside = remeshed.face_scalar_array() > 0.5
    rows = _rows_by_skirt(out_trias[~inside], border, border_nodes, len(out_points))
    new_points = np.empty((len(out_points) - len(border), 3))
    new_points[rows[rows >= 0]] = out_points[rows >= 0]
    # projecting to the surface may have moved the border by the last digits
    moved = np.abs(new_points[:border_nodes] - places[:border_nodes])
    if (moved > nudge).any():
        raise RemeshError("remeshing moved the border")
    new_points[:border_nodes] = points[:border_nodes]
    return new_points, rows[out_trias[inside]]


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


def _rows_by_skirt(skirt: Ints, border: Ints, border_nodes: int, nodes: int) -> Ints:
    """Find the new row of each remeshed node, -1 for an apex of the skirt.

    The skirt comes back as it went in, tria for tria, and names the nodes of the border; all others
    are inside.
    """
    if len(skirt) != len(border):
        raise RemeshError("remeshing changed the border")
    inside = -2
    rows = np.full(nodes, inside, np.int32)
    rows[skirt[:, :2]] = border[:, ::-1]
    rows[skirt[:, 2]] = -1
    if (
        not np.array_equal(rows[skirt[:, :2]], border[:, ::-1])
        or np.count_nonzero(rows >= 0) != border_nodes
    ):
        raise RemeshError("remeshing changed the border")
    new = rows == inside
    rows[new] = np.arange(border_nodes, border_nodes + np.count_nonzero(new), dtype=np.int32)
    return rows


def _apart(places: Floats, step: float) -> Floats:
    """Move nodes that are where an earlier one is by a step: pymeshlab would make them one."""
    _, inverse, counts = np.unique(places, axis=0, return_inverse=True, return_counts=True)
    if len(counts) == len(places):
        return places
    order = np.argsort(inverse.ravel(), kind="stable")
    earlier = np.empty(len(places))
    earlier[order] = np.arange(len(places)) - np.repeat(np.cumsum(counts) - counts, counts)
    return places + step * earlier[:, None]
