"""Bubble packing: nodes push each other to even distances (Shimada and Gossard 1995)."""

from __future__ import annotations

from meshops.kernels.refining import fill_area
from meshops.mesh import Floats, Ints
from meshops.methods.flatten import FlatPatch
from meshops.remesher import RemeshError

ROUNDS = 3
SWEEPS = 5


def remesh_by_bubbles(
    points: Floats, trias: Ints, border: Ints, size: float
) -> tuple[Floats, Ints]:
    """Remesh a patch with nodes where packed bubbles come to rest, its border kept node for node.

    Parameters, results and errors are those of ``remesh_isotropic``; the patch must not turn far
    from its mean plane.
    """
    patch = FlatPatch.of(points, trias, border)
    whole, flat, anew = fill_area(
        patch.flat, trias, border, patch.border_nodes, size, patch.room(size), ROUNDS, SWEEPS
    )
    if not whole:
        raise RemeshError("the patch could not be triangulated on its border")
    return patch.lift(flat), anew
