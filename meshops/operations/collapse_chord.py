"""CollapseChord: take a whole row of quads out of the mesh."""

from __future__ import annotations

from dataclasses import dataclass

from meshops import _core
from meshops.operations.candidates import Candidates
from meshops.operations.ragged import candidates_of
from meshops.operations.relax import relax
from meshops.operations.sites import SiteOperation
from meshops.operations.strips import SWEEPS, Strips, worst_trias
from meshops.workpiece import Workpiece


@dataclass(frozen=True)
class CollapseChord(SiteOperation):
    """Merge the sides of a row of quads that closes on itself or leads from tria to tria.

    Nodes on the two sides of the row meet half-way, or at the one that cannot move. Both trias
    vanish with their row.

    Attributes
    ----------
    trias : int
        How many trias are looked at, the worst first.
    reach : int
        Quads between two trias, at the most.
    """

    name: str = "collapse-chord"
    code: int = 10
    trias: int = 40
    reach: int = 60

    def candidates(self, workpiece: Workpiece) -> Candidates:
        """List rows: those between two trias first, the shorter ones first."""
        trias = worst_trias(workpiece, self.trias)
        between = Strips.straight(workpiece, trias, reach=self.reach, steps=0)
        strips = (between + Strips.closed(workpiece)).ranked(workpiece, self.pool)
        return collapsed(workpiece, strips)


def collapsed(workpiece: Workpiece, strips: Strips) -> Candidates:
    """Merge the nodes of all rungs of each strip and relax what is around it."""
    mesh = workpiece.mesh
    elements, moves = _core.collapse_chords(
        strips, mesh.points, mesh.elements, workpiece.around, workpiece.topology.free_nodes
    )
    return relax(workpiece, candidates_of(elements, moves=moves), sweeps=SWEEPS)
