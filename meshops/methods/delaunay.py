"""Delaunay refinement (Chew 1989, Ruppert 1995) with a border that stays, and Laplace smoothing."""

from __future__ import annotations

from meshops._core import fill_by_refinement
from meshops.mesh import Floats, Ints
from meshops.methods.flatten import FlatPatch
from meshops.remesher import RemeshError


def remesh_by_delaunay(
    points: Floats, trias: Ints, border: Ints, size: float
) -> tuple[Floats, Ints]:
    """Remesh a patch with nodes at circumcentres, its border kept node for node.

    Parameters, results and errors are those of ``remesh_isotropic``; the patch must not turn far
    from its mean plane.
    """
    patch = FlatPatch.of(points, trias, border)
    filled = fill_by_refinement(patch.flat, trias, border, size, patch.room(size))
    if filled is None:
        raise RemeshError("the patch could not be triangulated on its border")
    flat, anew = filled
    return patch.lift(flat), anew
