"""Methods of meshing a patch anew: all take the same arguments and keep the border."""

from __future__ import annotations

from typing import NamedTuple, Protocol

from meshops.mesh import Floats, Ints
from meshops.methods.bubbles import remesh_by_bubbles
from meshops.methods.delaunay import remesh_by_delaunay
from meshops.methods.front import remesh_by_front
from meshops.remesher import remesh_isotropic

__all__ = ["METHODS", "Method"]


class Remesher(Protocol):
    """Meshes a patch of trias anew with trias, its border kept node for node."""

    def __call__(
        self, points: Floats, trias: Ints, border: Ints, size: float, /
    ) -> tuple[Floats, Ints]:
        """Take and return what ``remesh_isotropic`` does; RemeshError where that fails."""


class Method(NamedTuple):
    """A way to mesh a patch anew, and what a procedure calls it."""

    name: str
    remesh: Remesher


METHODS: tuple[Method, ...] = (
    Method("isotropic", remesh_isotropic),
    Method("front", remesh_by_front),
    Method("bubbles", remesh_by_bubbles),
    Method("delaunay", remesh_by_delaunay),
)
"""The index of a method is its gene."""
