"""Coarsen: fewer elements around one node."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from meshops import _core
from meshops.operations.candidates import Candidates
from meshops.operations.ragged import alternatives, candidates_of
from meshops.operations.relax import relax
from meshops.operations.sites import SiteOperation
from meshops.operations.strips import SWEEPS, nearness
from meshops.workpiece import Workpiece


@dataclass(frozen=True)
class Coarsen(SiteOperation):
    """Take a free node out and fill the ring around it with fewer elements.

    Four quads become three, three quads two, and of trias quads are made; one tria at the most is
    left, where the ring has an odd number of sides. The variants are the ways to fill it. (The
    ring of quads that Refine makes is a closed row: CollapseChord takes it out.)
    """

    pool: int = 120
    name: str = "coarsen"
    code: int = 14
    variants: ClassVar[int] = _core.FILLINGS

    def candidates(self, workpiece: Workpiece) -> Candidates:
        """List free nodes, those of the worst elements first."""
        mesh = workpiece.mesh
        start, around = workpiece.around
        nodes = np.nonzero(workpiece.topology.free_nodes)[0].astype(np.int32)
        used = start[:-1][np.diff(start) > 0]
        nearest = np.full(len(mesh.points), len(mesh.elements), np.int32)
        nearest[np.diff(start) > 0] = np.minimum.reduceat(nearness(workpiece)[around], used)
        nodes = nodes[np.argsort(nearest[nodes], kind="stable")[: self.pool]]
        rows, ways = alternatives(len(nodes), self.variants)
        elements = _core.remove_nodes(nodes[rows], ways, mesh.elements, workpiece.around)
        return relax(workpiece, candidates_of(elements), sweeps=SWEEPS)
