"""Join trias: two trias that share an edge become a quad."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from meshops._core import join_trias
from meshops.operations.candidates import Candidates
from meshops.operations.places import crossable_pairs, nearest_first
from meshops.operations.relax import relax
from meshops.operations.sites import SiteOperation
from meshops.workpiece import Workpiece


@dataclass(frozen=True)
class JoinTrias(SiteOperation):
    """Take away the edge between two trias, then relax the nodes around."""

    nested: ClassVar[bool] = True
    name: str = "join-trias"
    code: int = 4

    def candidates(self, workpiece: Workpiece) -> Candidates:
        """One quad of each pair of trias."""
        pairs = crossable_pairs(workpiece)
        pairs = pairs[workpiece.mesh.is_tria[pairs].all(axis=1)]
        pairs = pairs[nearest_first(workpiece, pairs)[: self.pool]]
        return relax(workpiece, Candidates(*join_trias(workpiece.mesh.elements, pairs)))
