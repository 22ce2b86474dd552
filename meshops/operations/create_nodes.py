"""CreateNodes: put a node into an element or on an edge (the paper's section 2.3)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from meshops import _core
from meshops.mesh import centres_of
from meshops.operations.candidates import Candidates
from meshops.operations.places import nearest_first
from meshops.operations.relax import relax
from meshops.operations.sites import SiteOperation
from meshops.operations.templates import fill, stars
from meshops.workpiece import Workpiece


@dataclass(frozen=True)
class CreateNodes(SiteOperation):
    """Put a node in the middle of an element or of an edge, and make the elements around it anew.

    The node is joined to three corners of the element or of the two at the edge, so the mesh stays
    whole: a variant is one choice of these corners. Two quads become three, a quad and a tria two
    quads and a tria, two trias or a quad one quad and two trias, a tria three trias.
    """

    variants: ClassVar[int] = max(len(stars(corners)) for corners in range(3, 7))
    name: str = "create-nodes"
    code: int = 18

    def candidates(self, workpiece: Workpiece) -> Candidates:
        """All ways to put a node into the elements and on the edges nearest to bad elements."""
        mesh, topology = workpiece.mesh, workpiece.topology
        edges = topology.crossable.copy()
        edges[edges] = topology.editable[topology.edge_elements[edges]].all(axis=1)
        two = topology.edge_elements[edges]
        one = np.nonzero(topology.editable)[0].astype(np.int32)
        groups = np.full((len(one) + len(two), 3), -1, np.int32)
        groups[: len(one), 0], groups[len(one) :, :2] = one, two
        points = np.concatenate(
            [
                centres_of(mesh.points, mesh.elements[one]),
                mesh.points[topology.edges[edges]].mean(axis=1),
            ]
        )
        nearest = nearest_first(workpiece, groups)[: self.pool]
        groups, points = groups[nearest], points[nearest]
        made = fill(*_core.cavity_polygons(mesh.elements, groups), stars, len(mesh.points))
        added = np.full((len(groups), self.variants, *made.shape[2:]), -1, np.int32)
        added[:, : made.shape[1]] = made
        return relax(
            workpiece,
            Candidates.padded(
                np.repeat(groups, self.variants, axis=0),
                added.reshape(-1, *added.shape[2:]),
                np.repeat(points, self.variants, axis=0)[:, None],
            ),
        )
