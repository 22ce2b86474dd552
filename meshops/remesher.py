"""Isotropic remeshing of a tria patch by pymeshlab: the only file that imports it.

What was measured of pymeshlab shapes this file: open borders move unless the patch has a skirt of
unselected trias; flags that a call leaves out keep the value of an earlier call; selecting by an
expression crashes on a mesh built from arrays; non-finite coordinates crash the filter.
"""

from __future__ import annotations

import numpy as np
import pymeshlab

from meshops.kernels.skirt import drop_skirt, skirt_apexes
from meshops.mesh import Floats, Ints

SWEEPS = 2
"""Iterations of split, collapse, flip, smooth and project."""

_LARGEST = 1e6


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
    border_nodes = int(border.max()) + 1
    if not np.isfinite(points).all() or not 0.0 < size < np.inf:
        raise RemeshError("coordinates and size must be finite")
    origin = points[0]
    extent = float(np.abs(points - origin).max())
    if extent > _LARGEST * size:
        raise RemeshError(f"the patch is over {_LARGEST:.0e} times as large as the edge length")
    apexes = skirt_apexes(points, trias, border)
    skirt = np.empty((len(border), 3), np.int32)
    skirt[:, 0], skirt[:, 1] = border[:, 1], border[:, 0]
    skirt[:, 2] = np.arange(len(points), len(points) + len(border))
    selected = np.zeros(len(trias) + len(skirt))
    selected[: len(trias)] = 1.0

    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(
        pymeshlab.Mesh(
            np.concatenate([points, apexes]),
            np.concatenate([trias, skirt]),
            f_scalar_array=selected,
        )
    )
    meshes.compute_selection_by_scalar_per_face(minq=0.5, maxq=2.0)
    meshes.meshing_isotropic_explicit_remeshing(
        iterations=SWEEPS,
        adaptive=False,
        selectedonly=True,
        targetlen=pymeshlab.PureValue(size),
        featuredeg=30.0,
        checksurfdist=False,
        maxsurfdist=pymeshlab.PureValue(size),
        splitflag=True,
        collapseflag=True,
        swapflag=True,
        smoothflag=True,
        reprojectflag=True,
    )
    remeshed = meshes.current_mesh()
    out_points = remeshed.vertex_matrix()
    out_trias = remeshed.face_matrix().astype(np.int32)
    if not np.isfinite(out_points).all():
        raise RemeshError("remeshing left the finite numbers")
    rows, inner = drop_skirt(out_points, out_trias, apexes, border, border_nodes)
    if len(rows) == 0:
        raise RemeshError("remeshing changed the border")
    order = np.argsort(rows, kind="stable")[np.count_nonzero(rows < 0) :]
    new_points = out_points[order]
    if not np.array_equal(new_points[:border_nodes], points[:border_nodes]):
        raise RemeshError("remeshing moved the border")
    return new_points, rows[inner]
