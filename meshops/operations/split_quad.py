"""Split a quad: it becomes two trias."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from meshops.operations.candidates import Candidates
from meshops.operations.places import nearest_first
from meshops.operations.relax import relax
from meshops.operations.sites import SiteOperation
from meshops.workpiece import Workpiece


@dataclass(frozen=True)
class SplitQuad(SiteOperation):
    """Cut a quad along one of its diagonals, then relax the nodes around."""

    variants: ClassVar[int] = 2
    nested: ClassVar[bool] = True
    name: str = "split-quad"
    code: int = 5

    def candidates(self, workpiece: Workpiece) -> Candidates:
        """Both diagonals of each quad."""
        mesh = workpiece.mesh
        quads = np.nonzero(~mesh.is_tria & workpiece.topology.editable)[0].astype(np.int32)
        quads = quads[nearest_first(workpiece, quads[:, None])[: self.pool]]
        a, b, c, d = mesh.elements[quads].T
        none = np.full(len(quads), -1, np.int32)
        ways = [[(a, b, c, none), (c, d, a, none)], [(b, c, d, none), (d, a, b, none)]]
        added = np.moveaxis(np.array(ways, np.int32), -1, 0)
        return relax(
            workpiece,
            Candidates.padded(np.repeat(quads, 2)[:, None], added.reshape(-1, 2, 4)),
        )
