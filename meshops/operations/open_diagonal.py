"""Open a diagonal: a node becomes two, with a new quad between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from meshops._core import open_diagonals
from meshops.operations.candidates import Candidates
from meshops.operations.places import nearest_first, padded_around
from meshops.operations.relax import relax
from meshops.operations.sites import SiteOperation
from meshops.workpiece import Workpiece


@dataclass(frozen=True)
class OpenDiagonal(SiteOperation):
    """Split a node along two opposite edges, then relax the nodes around.

    The inverse of `CollapseDiagonal` (vertex rotation and face opening: Canann et al. 1998). It
    takes elements away from a node that has too many: a node of v elements becomes two with about
    v / 2 + 1.
    """

    variants: ClassVar[int] = 6
    nested: ClassVar[bool] = True
    name: str = "open-diagonal"
    code: int = 8

    def candidates(self, workpiece: Workpiece) -> Candidates:
        """Each node that is free and has four or more elements, opened at each of its edges."""
        mesh = workpiece.mesh
        start, around = workpiece.around
        valence = np.diff(start)
        nodes = np.nonzero(workpiece.topology.free_nodes & (valence >= 4))[0].astype(np.int32)
        order = nearest_first(workpiece, padded_around(nodes, start, around))
        nodes = nodes[order[: self.pool]]
        opened = open_diagonals(nodes, self.variants, mesh.points, mesh.elements, workpiece.around)
        return relax(workpiece, Candidates(*opened))
