"""Fitness: one number for how good a mesh is, from its tally alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from meshops.criteria import Scoring
from meshops.kernels.quality import ELEMENTS, FAILED, TRIAS, order_meshes
from meshops.mesh import Floats, Ids

FitnessKind = Literal["trias", "quads", "quality"]

INVALID = -np.inf
"""Fitness of an individual that makes no valid mesh: it is never selected and recorded as 0."""

PRICE = 0.001
"""What one operation of a procedure costs, on the scale of q in `Fitness`."""

IRREGULARITY = 0.3
"""What an irregular node costs, over an element whose Q.I. is higher by 1: rows of quads flow
through a mesh as far as the next one (the paper's section 2.1)."""


@dataclass(frozen=True)
class Fitness:
    """One number for how good a mesh is; higher is better and 100 is a mesh without fault.

    ``trias`` is the paper's (section 3.2): 100 minus the number of trias. It falls below 0 on a
    mesh with more than 100 trias.

    ``quality`` orders meshes as an engineer does: fewer failed elements first, then fewer trias,
    then a lower compound Q.I. and fewer irregular nodes, less a small price for each operation
    used, which section 5.3 of the paper wishes for:
    ``100 - failed - (trias + (q + price) / 2) / (n + 1)``. Here n is the number of elements that
    the run started from, q is the compound Q.I. plus `irregularity` times the irregular nodes an
    element, brought into [0, 1) by x / (1 + x), and the price is `price` for each operation, at
    most 1.

    ``quads`` is the same with failed elements and trias changing places: fewer trias first. A
    search that stands still takes this way round, since a failed element is the easier to mend.

    Attributes
    ----------
    kind : "trias", "quality" or "quads"
    elements : int
        The number of elements of the mesh that the run started from.
    irregularity : float
        What an irregular node costs, over an element whose Q.I. is higher by 1.
    price : float
        What one operation of a procedure costs.
    """

    kind: FitnessKind
    elements: int
    irregularity: float = IRREGULARITY
    price: float = PRICE

    def of(self, tallies: Floats, scoring: Scoring, operations: Ids | int = 0) -> Floats:
        """(P,) fitness of (P, TALLY_SIZE) tallies; NaN tallies (no valid mesh) have INVALID.

        `operations` is how many each has used, (P,) or the same for all.
        """
        if self.kind == "trias":
            valid = np.isfinite(tallies[:, ELEMENTS])
            return np.where(valid, 100.0 - tallies[:, TRIAS], INVALID)
        first, second = (TRIAS, FAILED) if self.kind == "quads" else (FAILED, TRIAS)
        prices = np.zeros(len(tallies)) + np.minimum(self.price * operations, 1.0)
        fitness: Floats = order_meshes(
            tallies,
            first,
            second,
            self.elements + 1,
            self.irregularity,
            prices,
            INVALID,
            *scoring.arrays,
        )
        return fitness

    def of_faults(self, tally: Floats) -> float:
        """Fitness of one tally (TALLY_SIZE,) by failed elements and trias alone."""
        order = (TRIAS, FAILED) if self.kind == "quads" else (FAILED, TRIAS)
        first, second = tally[list(order)]
        return float(100.0 - first - second / (self.elements + 1))
