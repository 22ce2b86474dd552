"""Reference: the surface of the mesh that a run started from, on which nodes must stay."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from meshops._core import find_edges, split_quads, unit_normals
from meshops.mesh import NO_NODE, Floats, Ids, Ints, ShellMesh
from meshops.patch import Patch
from meshops.surface import PatchSurface
from meshops.topology import topology

FACING = 0.5
"""Cosine of the angle up to which a surface counts as facing the way of a patch."""

MARGIN = 1.0
"""Of the patch's radius: how far around a patch its reference reaches."""


@dataclass(frozen=True, eq=False)
class Reference:
    """A mesh as a surface of trias, to be asked for the part around a patch.

    Nodes that were brought back to it stay on it however many operations follow, while the surface
    of the current mesh would drift.

    Attributes
    ----------
    mesh : ShellMesh
    feature_angle : float
        Degrees from which an edge is a feature: beyond it the surface is another one.
    """

    mesh: ShellMesh
    feature_angle: float

    def around(self, patch: Patch) -> PatchSurface:
        """Return the surface under a patch, its own where it is plane, and the borders there."""
        own = PatchSurface.of(patch.points, patch.elements)
        centre = patch.points.mean(axis=0)
        radius = (1.0 + MARGIN) * float(np.linalg.norm(patch.points - centre, axis=1).max())
        rails = self._rails_around(centre, radius)
        if own.plane is not None:
            return replace(own, rails=rails)
        trias, tria_zones, _, tree, reach = self._trias
        near = np.sort(tree.query_ball_point(centre, radius + reach))
        rows = near.astype(np.int64)
        zone = self._zone_under(patch, own, rows)
        part = trias[rows[tria_zones[rows] == zone]]
        nodes, local = np.unique(part, return_inverse=True)
        points = np.ascontiguousarray(self.mesh.points[nodes])
        elements = np.full((len(part), 4), NO_NODE, np.int32)
        elements[:, :3] = local.reshape(-1, 3)
        return replace(PatchSurface.of(points, elements), rails=rails)

    def _rails_around(self, centre: Floats, radius: float) -> Floats:
        """(r, 2, 3): border edges of the mesh that reach into a sphere, and some more."""
        rails, tree, reach = self._borders
        near = np.sort(tree.query_ball_point(centre, radius + reach))
        return rails[near.astype(np.int64)]

    @cached_property
    def _borders(self) -> tuple[Floats, cKDTree, float]:
        """Border edges (R, 2, 3), a tree of their middles, half of the longest."""
        edges, _, _, uses, _ = find_edges(self.mesh.elements, len(self.mesh.points))
        rails = self.mesh.points[edges[uses == 1]]
        lengths = np.linalg.norm(rails[:, 1] - rails[:, 0], axis=1)
        return rails, cKDTree(rails.mean(axis=1)), float(lengths.max(initial=0.0)) / 2.0

    def _zone_under(self, patch: Patch, own: PatchSurface, rows: Ids) -> int:
        """Zone of the nearest tria that faces the way of the patch's first element."""
        _, tria_zones, normals, tree, _ = self._trias
        first = own.trias[:1]
        corners = np.column_stack([first, np.full(1, NO_NODE, np.int32)])
        normal = unit_normals(own.points, corners)[0]
        distance = np.linalg.norm(tree.data[rows] - own.points[first[0]].mean(axis=0), axis=1)
        turned = normals[rows] @ normal < FACING
        return int(tria_zones[rows[np.argmin(np.where(turned, np.inf, distance))]])

    @cached_property
    def _trias(self) -> tuple[Ints, Ints, Floats, cKDTree, float]:
        """Trias (T, 3), their zones and normals, a tree of their centres, the largest radius."""
        mesh = self.mesh
        zones = _surface_zones(mesh, self.feature_angle)
        is_quad = ~mesh.is_tria
        trias = split_quads(mesh.points, mesh.elements, np.ones(len(mesh.elements), bool))
        owner = np.repeat(np.arange(len(mesh.elements)), np.where(is_quad, 2, 1))
        normals = unit_normals(mesh.points, trias)
        corners = mesh.points[trias[:, :3]]
        centres = corners.mean(axis=1)
        reach = float(np.linalg.norm(corners - centres[:, None], axis=2).max())
        return np.ascontiguousarray(trias[:, :3]), zones[owner], normals, cKDTree(centres), reach


def _surface_zones(mesh: ShellMesh, feature_angle: float) -> Ints:
    """(M,) int32: connected areas within barriers, locked elements included."""
    free = ShellMesh.build(mesh.points, mesh.elements, region=mesh.region)
    found = topology(free, feature_angle=feature_angle)
    everything = np.ones(len(mesh.elements), bool)
    return found.graph.label_components(everything)
