"""Advancing front: rows of squares along the border (Remacle, Henrotte and others 2013)."""

from __future__ import annotations

from meshops._core import pack_parallelograms
from meshops.mesh import Floats, Ints
from meshops.methods.flatten import FlatPatch
from meshops.remesher import RemeshError

QUAD_OF_TRIA = (3.0 / 4.0) ** 0.25
"""Edge of a square of twice a regular tria's area, over the tria's edge."""


def remesh_by_front(points: Floats, trias: Ints, border: Ints, size: float) -> tuple[Floats, Ints]:
    """Remesh a patch with nodes in rows along its border, its border kept node for node.

    Parameters, results and errors are those of ``remesh_isotropic``: `size` is the edge of regular
    trias, and the squares here are of the same area as two of them. The patch must not turn far
    from its mean plane.
    """
    patch = FlatPatch.of(points, trias, border)
    edge = QUAD_OF_TRIA * size
    packed = pack_parallelograms(patch.flat, trias, border, edge, patch.room(edge))
    if packed is None:
        raise RemeshError("the patch could not be triangulated on its border")
    flat, anew = packed
    return patch.lift(flat), anew
