"""The surface that a patch lies on."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from functools import cached_property
from math import dist

import numpy as np

from meshops._core import (
    FacetTree,
    areas_of,
    as_trias,
    bounding_spheres,
    nearest,
    plane_of,
    project,
    unit_normals,
)
from meshops.mesh import NO_NODE, Floats, Ints, centres_of
from meshops.patch import Patch

PLANE_TOLERANCE = 1e-9
"""Of the patch's extent: nodes nearer to a common plane count as on it."""

AREA_TOLERANCE = 1e-9
"""Of the patch's area: areas that differ by less are the same."""


@dataclass(frozen=True, eq=False)
class PatchSurface:
    """The surface that a patch had before it was remeshed.

    Attributes
    ----------
    points : (n, 3) float64
    trias : (t, 3) int32
        The patch with its quads split.
    area : float
    area_vector : (3,) float64
        Sum of the area vectors of the trias. It follows from the border alone.
    plane : (3,) float64 or None
        The unit normal of a patch that is plane.
    rails : (r, 2, 3) float64
        The edges along which border nodes may slide.
    """

    points: Floats
    trias: Ints
    area: float
    area_vector: Floats
    plane: Floats | None
    rails: Floats = field(default_factory=lambda: np.zeros((0, 2, 3)))

    @classmethod
    def of(cls, points: Floats, elements: Ints) -> PatchSurface:
        """Split the quads of a patch or a mesh and see whether it is plane."""
        trias = as_trias(points, elements)
        total, area, normal, is_plane = plane_of(points, trias, PLANE_TOLERANCE)
        return cls(points, trias, area, total, normal if is_plane else None)

    def mean_edge(self, patch: Patch) -> float:
        """Edge of a square of the mean area, counting a tria as half a quad."""
        trias = np.count_nonzero(patch.elements[:, 3] < 0)
        return float(np.sqrt(self.area / (len(patch.elements) - trias / 2)))

    def project(self, points: Floats, first: int) -> None:
        """Bring the nodes from row `first` on back to the surface, in place."""
        points[first:] = project(points[first:], self)

    def normals_at(self, points: Floats, elements: Ints, tolerance: float) -> Floats | None:
        """(M, 3) surface normals under each element; None where one is farther off."""
        if self.plane is not None:
            return np.repeat(self.plane[None], len(elements), axis=0)
        _, distance, tria = self._nearest(centres_of(points, elements))
        if distance.max() > tolerance:
            return None
        return unit_normals(self.points, _as_elements(self.trias[tria]))

    def is_covered(self, patch: Patch, points: Floats, elements: Ints, tolerance: float) -> bool:
        """Whether the new elements cover the surface: no hole, no lap, no old node left behind."""
        trias = as_trias(points, elements)
        total, area = areas_of(points, trias)
        missing = dist(total, self.area_vector)
        if missing > AREA_TOLERANCE * self.area:
            return False
        if self.plane is not None:
            return abs(area - self.area) <= AREA_TOLERANCE * self.area
        old = patch.points[patch.border_nodes :]
        if not len(old):
            return True
        distance = nearest(old, points, trias, bounding_spheres(points, trias))[1]
        return bool(distance.max() <= tolerance)

    @cached_property
    def spheres(self) -> Floats:
        """(t, 4) centres and radii of spheres around the trias."""
        return bounding_spheres(self.points, self.trias)

    @cached_property
    def tree(self) -> FacetTree:
        """The trias for many questions, where the surface is not plane."""
        return FacetTree(self.points, self.trias)

    def __getstate__(self) -> dict[str, object]:
        """Leave out what was made of the trias: it is made again where it is needed."""
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def near(self, points: Floats, margin: float) -> tuple[Ints, Floats]:
        """Trias (T, 3) that points up to `margin` away from some points can be nearest to.

        With their spheres (T, 4); all where none is near; none where the surface is plane.
        """
        if self.plane is not None:
            return self.trias[:0], np.zeros((0, 4))
        low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
        centres, radius = self.spheres[:, :3], self.spheres[:, 3:]
        near = ((centres + radius >= low) & (centres - radius <= high)).all(axis=1)
        near |= not near.any()
        return self.trias[near], self.spheres[near]

    def _nearest(self, queries: Floats) -> tuple[Floats, Floats, Ints]:
        return self.tree.nearest(queries)


def _as_elements(trias: Ints) -> Ints:
    return np.column_stack([trias, np.full(len(trias), NO_NODE, np.int32)])
