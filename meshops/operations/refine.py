"""Refine: smaller elements in one place."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops import _core
from meshops.mesh import Ints
from meshops.operations.candidates import Candidates
from meshops.operations.ragged import candidates_of, picked, starts
from meshops.operations.relax import relax
from meshops.operations.sites import SiteOperation
from meshops.operations.strips import SWEEPS, nearness
from meshops.workpiece import Workpiece


@dataclass(frozen=True)
class Refine(SiteOperation):
    """Shrink an element, or all around a node, and put a ring of quads around it: a pillow.

    The outline stays, and no tria comes (Mitchell and Tautges 1995). A quad becomes five.
    """

    pool: int = 200
    name: str = "refine"
    code: int = 13

    def candidates(self, workpiece: Workpiece) -> Candidates:
        """List single elements and the elements around each free node, the worst first."""
        mesh, topology = workpiece.mesh, workpiece.topology
        start, rows = _single_elements_and_fans(workpiece)
        nearest = np.minimum.reduceat(nearness(workpiece)[rows], start[:-1])
        order = np.argsort(nearest, kind="stable")[: self.pool]
        chosen_start, places = picked(start, order.astype(np.int32))
        sets = chosen_start, rows[places]
        added_start, added, point_start, points = _core.pillow(
            sets, mesh.points, mesh.elements, topology.graph
        )
        return relax(
            workpiece,
            candidates_of((*sets, added_start, added), places=(point_start, points)),
            sweeps=SWEEPS,
        )


def _single_elements_and_fans(workpiece: Workpiece) -> tuple[Ints, Ints]:
    """List sets of elements, ragged: each editable element, then the fan of each free node."""
    topology = workpiece.topology
    single = np.nonzero(topology.editable)[0].astype(np.int32)
    start, around = workpiece.around
    valence = np.diff(start)
    of_free = np.repeat(topology.free_nodes, valence)
    lengths = np.concatenate([np.ones(len(single), np.int32), valence[topology.free_nodes]])
    return starts(lengths), np.concatenate([single, around[of_free]])
