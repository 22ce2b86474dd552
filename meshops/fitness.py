"""Fitness: one number for how good a mesh is, from its tally alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from meshops import _core
from meshops.criteria import Scoring
from meshops.mesh import Floats, Ids
from meshops.quality_sums import ELEMENTS, FAILED, SHAPE, SHAPE_FAILED, SIZE, TRIAS

FitnessKind = Literal["trias", "quads", "quality"]

INVALID = -np.inf
"""Fitness of an individual that makes no valid mesh: it is never selected and recorded as 0."""

PRICE = 0.3
"""What one operation of a procedure costs, over an element whose Q.I. is higher by 1."""

IRREGULARITY = 0.3
"""What an irregular node costs, over an element whose Q.I. is higher by 1: rows of quads flow
through a mesh as far as the next one (the paper's section 2.1)."""

_LIMITED = (SHAPE, TRIAS, SIZE)


@dataclass(frozen=True)
class Fitness:
    """One number for how good a mesh is; higher is better and 100 is a mesh without fault.

    ``trias`` is the paper's (section 3.2): 100 minus the number of trias. It falls below 0 on a
    mesh with more than 100 trias.

    ``quality`` orders meshes as an engineer does: shape before trias before all else, and by how
    severe faults are and not by how many. The severity s of the faults of shape is the sum of all
    penalties of shape beyond the fail level, and z that of the faults of size. Then come fewer
    trias, then less severe faults of size, a lower Q.I. of what passes and fewer irregular nodes,
    together, less a small price for each operation used, which section 5.3 of the paper wishes for:
    ``100 - s - 60 h - (trias + z / (31 n) + (q + price / n) / 2) / n``. Here n is one more than the
    elements that the run started from, q is the Q.I. of what passes plus `irregularity` times the
    irregular nodes an element, brought into [0, 1) by x / (1 + x), and the price is `price` for
    each operation. h is the harm: trias beyond those of the mesh that the search started from, but
    for one in the place of each element that was concave or folded, and severity of size beyond
    what it was.

    ``quads`` is the same with faults of shape and trias changing places; shape beyond what it was
    is harm then. A search that stands still takes this way round.

    Attributes
    ----------
    kind : "trias", "quality" or "quads"
    elements : int
        The number of elements of the mesh that the run started from.
    irregularity : float
        What an irregular node costs, over an element whose Q.I. is higher by 1.
    price : float
        What one operation of a procedure costs.
    limits : three floats
        Severity of shape, trias and severity of size of the mesh that the search started from;
        infinite: nothing is harm.
    """

    kind: FitnessKind
    elements: int
    irregularity: float = IRREGULARITY
    price: float = PRICE
    limits: tuple[float, float, float] = (np.inf, np.inf, np.inf)

    def of(self, tallies: Floats, scoring: Scoring, operations: Ids | int = 0) -> Floats:
        """(P,) fitness of (P, TALLY_SIZE) tallies; NaN tallies (no valid mesh) have INVALID.

        `operations` is how many each has used, (P,) or the same for all.
        """
        if self.kind == "trias":
            valid = np.isfinite(tallies[:, ELEMENTS])
            return np.where(valid, 100.0 - tallies[:, TRIAS], INVALID)
        order = _core.Fitness(
            self.limits, self.elements + 1, self.irregularity, self.kind == "quads"
        )
        return order.of(tallies, np.zeros(len(tallies)) + self.price * operations, scoring.core)

    def of_faults(self, tally: Floats) -> float:
        """Fitness of one tally (TALLY_SIZE,) by the numbers of its faults and trias alone."""
        order = (TRIAS, SHAPE_FAILED) if self.kind == "quads" else (SHAPE_FAILED, TRIAS)
        first, second = tally[list(order)]
        by_size = tally[FAILED] - tally[SHAPE_FAILED]
        share = self.elements + 1
        return float(100.0 - first - (second + by_size / share) / share)


def limits_of(tally: Floats) -> tuple[float, float, float]:
    """Return the limits of a search from a mesh with this tally (TALLY_SIZE,), for `Fitness`."""
    shape, trias, size = (float(tally[place]) for place in _LIMITED)
    return shape, trias, size
