"""InsertChord: split a row of quads lengthwise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from meshops import _core
from meshops.operations.candidates import Candidates
from meshops.operations.ragged import alternatives, candidates_of
from meshops.operations.relax import relax
from meshops.operations.sites import SiteOperation
from meshops.operations.strips import SWEEPS, Strips, worst_trias
from meshops.workpiece import Workpiece


@dataclass(frozen=True)
class InsertChord(SiteOperation):
    """Make two rows of quads of one that closes on itself or begins at a tria.

    The tria becomes a quad, and so does another one at the end. A quad at the end becomes a quad
    and a tria, at either side: the two variants.

    Attributes
    ----------
    trias : int
        How many trias are looked at, the worst first.
    reach : int
        Quads between two trias, at the most.
    steps : int
        Edges that a row crosses that ends in a quad, at the most.
    """

    name: str = "insert-chord"
    code: int = 11
    trias: int = 40
    reach: int = 24
    steps: int = 3
    variants: ClassVar[int] = 2

    def candidates(self, workpiece: Workpiece) -> Candidates:
        """List rows: those between two trias first, the shorter ones first."""
        mesh = workpiece.mesh
        trias = worst_trias(workpiece, self.trias)
        found = Strips.straight(workpiece, trias, reach=self.reach, steps=self.steps)
        found = (found + Strips.closed(workpiece)).ranked(workpiece, self.pool)
        rows, ways = alternatives(len(found), self.variants)
        strips = found.take(rows)
        elements, places = _core.insert_chords(strips, ways, mesh.points, mesh.elements)
        return relax(workpiece, candidates_of(elements, places=places), sweeps=SWEEPS)
