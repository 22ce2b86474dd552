"""Swap an edge: the edge between two elements is turned within the polygon around them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from meshops._core import swap_edges
from meshops.operations.candidates import Candidates
from meshops.operations.places import crossable_pairs, nearest_first
from meshops.operations.relax import relax
from meshops.operations.sites import SiteOperation
from meshops.workpiece import Workpiece


@dataclass(frozen=True)
class SwapEdge(SiteOperation):
    """Turn the edge between two elements, then relax the nodes around.

    Between two quads it turns to one of the two other long diagonals of their hexagon; between a
    quad and a tria the tria changes its place in their pentagon; between two trias it becomes the
    other diagonal.
    """

    variants: ClassVar[int] = 2
    nested: ClassVar[bool] = True
    name: str = "swap-edge"
    code: int = 3

    def candidates(self, workpiece: Workpiece) -> Candidates:
        """Two turns of each edge; the second of two trias is empty."""
        pairs = crossable_pairs(workpiece)
        pairs = pairs[nearest_first(workpiece, pairs)[: self.pool]]
        return relax(workpiece, Candidates(*swap_edges(workpiece.mesh.elements, pairs)))
