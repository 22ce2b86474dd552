"""Collapse a diagonal: two opposite nodes of a quad become one and the quad vanishes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from meshops._core import collapse_diagonals
from meshops.operations.candidates import Candidates
from meshops.operations.places import nearest_first
from meshops.operations.relax import relax
from meshops.operations.sites import SiteOperation
from meshops.workpiece import Workpiece


@dataclass(frozen=True)
class CollapseDiagonal(SiteOperation):
    """Merge the ends of one diagonal of a quad, then relax the nodes around.

    They meet half-way where both are free, or else at the one that stays (diagonal collapse:
    Daniels et al. 2008).
    """

    variants: ClassVar[int] = 2
    nested: ClassVar[bool] = True
    name: str = "collapse-diagonal"
    code: int = 7

    def candidates(self, workpiece: Workpiece) -> Candidates:
        """Both diagonals of each quad."""
        mesh, topology = workpiece.mesh, workpiece.topology
        free = topology.free_nodes
        collapsible = ~mesh.is_tria & topology.editable & free[mesh.elements].any(axis=1)
        quads = np.nonzero(collapsible)[0].astype(np.int32)
        quads = quads[nearest_first(workpiece, quads[:, None])[: self.pool]]
        collapsed = collapse_diagonals(quads, mesh.points, mesh.elements, workpiece.around, free)
        return relax(workpiece, Candidates(*collapsed))
