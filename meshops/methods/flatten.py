"""Flattening a patch of trias, and lifting points of the plane back to it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops._core import area_normals, lift
from meshops.mesh import Floats, Ints
from meshops.remesher import RemeshError

STEEPEST = 70.0
"""Degrees that a tria may be inclined against the mean plane of its patch."""

FLAT = 1e-9
"""Of the patch's area: trias below this may look anywhere."""

MOST_NODES = 5_000_000

SPARE = 4.0
"""How many times as many nodes may be placed as squares fit into the area."""


@dataclass(frozen=True, eq=False)
class FlatPatch:
    """A patch of trias and its projection to the mean plane.

    Attributes
    ----------
    points : (n, 3) float64
        The nodes of the border come first.
    trias : (t, 3) int32
    border : (b, 2) int32
        Border edges in the direction of their tria.
    axes : (3, 2) float64
        Two unit vectors of the plane.
    flat : (n, 2) float64
        The points in these axes, around the first one.
    """

    points: Floats
    trias: Ints
    border: Ints
    axes: Floats
    flat: Floats

    @classmethod
    def of(cls, points: Floats, trias: Ints, border: Ints) -> FlatPatch:
        """Project along the mean normal.

        Raises
        ------
        RemeshError
            Where a tria is too steep for that, or there is no border to begin at.
        """
        if not len(border):
            raise RemeshError("a patch without a border has nowhere to begin")
        vectors = area_normals(points, trias)
        total = vectors.sum(axis=0)
        size = np.linalg.norm(total)
        if not np.isfinite(size) or size <= 0.0:
            raise RemeshError("the patch has no mean plane")
        normal = total / size
        least = np.cos(np.radians(STEEPEST)) * np.linalg.norm(vectors, axis=1)
        if not (vectors @ normal >= least - FLAT * size).all():
            raise RemeshError(f"the patch turns by more than {STEEPEST:.0f} degrees")
        axis = [0.0, 0.0, 0.0]
        axis[np.argmin(np.abs(normal))] = 1.0
        first = np.cross(axis, normal)
        first /= np.linalg.norm(first)
        axes = np.array([first, np.cross(normal, first)]).T.copy()
        return cls(points, trias, border, axes, (points - points[0]) @ axes)

    @property
    def border_nodes(self) -> int:
        """How many of the nodes are on the border."""
        return int(self.border.max()) + 1

    def room(self, size: float) -> int:
        """Most nodes that a mesh of this size may need; RemeshError for a size of no use."""
        if not 0.0 < size < np.inf:
            raise RemeshError("the size must be a finite number above 0")
        a, b, c = self.flat[self.trias].transpose(1, 0, 2)
        area = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]).sum()
        nodes = SPARE * area / size**2
        if nodes > MOST_NODES:
            raise RemeshError(f"the patch needs more than {MOST_NODES} nodes")
        return int(nodes) + 2 * self.border_nodes + 8

    def flattened(self, places: Floats) -> Floats:
        """(n, 2) points in the plane of places (n, 3)."""
        flat: Floats = (places - self.points[0]) @ self.axes
        return flat

    def lift(self, flat: Floats) -> Floats:
        """(n', 3) places on the patch of points (n', 2) in its plane; border nodes as they are."""
        kept = self.border_nodes
        return np.concatenate([self.points[:kept], self.lift_inner(flat[kept:])])

    def lift_inner(self, flat: Floats) -> Floats:
        """(n', 3) places on the patch of points (n', 2) in its plane."""
        return lift(self.flat, self.trias, self.points, flat)
