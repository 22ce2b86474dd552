"""TransportTria: a tria walks through quads, to another tria or some steps away."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from meshops import _core
from meshops.operations.candidates import Candidates
from meshops.operations.ragged import alternatives, candidates_of
from meshops.operations.relax import relax
from meshops.operations.sites import SiteOperation
from meshops.operations.strips import Strips, worst_trias
from meshops.workpiece import Workpiece


@dataclass(frozen=True)
class TransportTria(SiteOperation):
    """Move a tria through the mesh; where it meets another one the two become a quad.

    A step changes the sides of the tria and the quad behind one of its edges: the two make a
    pentagon, and its diagonal is moved. The variants are where it goes in a quad that
    it crosses straight: always right, always left, each time where it gives the better elements.

    Attributes
    ----------
    trias : int
        How many trias are looked at, the worst first.
    reach : int
        Quads between two trias that are brought together, at the most.
    steps : int
        Steps of a tria that is only moved, at the most.
    partners : int
        How many of the nearest other trias a tria is brought to.
    """

    pool: int = 200
    name: str = "transport-tria"
    code: int = 6
    trias: int = 40
    reach: int = 12
    steps: int = 3
    partners: int = 6
    variants: ClassVar[int] = 3

    def candidates(self, workpiece: Workpiece) -> Candidates:
        """List walks: those that join two trias first, the shorter ones first."""
        mesh = workpiece.mesh
        found = Strips.walks(
            workpiece,
            worst_trias(workpiece, self.trias),
            reach=self.reach,
            steps=self.steps,
            partners=self.partners,
        ).ranked(workpiece, self.pool)
        rows, ways = alternatives(len(found), self.variants)
        strips = found.take(rows)
        after = _core.transport_trias(strips, ways, mesh.points, mesh.elements)
        return relax(workpiece, candidates_of((strips.start, strips.cells, *after)))
