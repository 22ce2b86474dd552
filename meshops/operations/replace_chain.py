"""ReplaceChain: ReplaceNode along a row of quads, from a tria on."""

from __future__ import annotations

from dataclasses import dataclass

from meshops.operations.candidates import Candidates
from meshops.operations.collapse_chord import collapsed
from meshops.operations.sites import SiteOperation
from meshops.operations.strips import Strips, worst_trias
from meshops.workpiece import Workpiece


@dataclass(frozen=True)
class ReplaceChain(SiteOperation):
    """Merge the nodes of one edge of a tria and of the edges behind it (the paper's Figure 11).

    Each edge is opposite to the last one in its quad, so that the quads between them vanish, and
    with them the tria. Another tria at the end vanishes too; a quad at the end becomes a tria.

    Attributes
    ----------
    trias : int
        How many trias are looked at, the worst first.
    reach : int
        Quads between two trias, at the most.
    steps : int
        Edges of a chain that ends in a quad, at the most.
    """

    name: str = "replace-chain"
    code: int = 15
    trias: int = 40
    reach: int = 24
    steps: int = 6

    def candidates(self, workpiece: Workpiece) -> Candidates:
        """List chains: those that join two trias first, the shorter ones first."""
        strips = Strips.straight(
            workpiece,
            worst_trias(workpiece, self.trias),
            reach=self.reach,
            steps=self.steps,
        )
        return collapsed(workpiece, strips.ranked(workpiece, self.pool))
