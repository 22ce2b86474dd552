"""What an operation is."""

from __future__ import annotations

from typing import Protocol, runtime_checkable

import numpy as np

from meshops.edit import Edit
from meshops.mesh import Floats, Ids, Ints
from meshops.workpiece import Workpiece


class SearchSpace(Protocol):
    """The genomes of one operation on one mesh.

    Attributes
    ----------
    bounds : (G,) int64
        Gene g takes a value from 0 to ``bounds[g] - 1``.
    """

    bounds: Ids

    def draw(self, rng: np.random.Generator, count: int) -> Ids:
        """(count, G) int64 genomes of a first generation."""

    def evaluate(self, genomes: Ids) -> Floats:
        """(P, TALLY_SIZE) tally of the mesh that each genome (P, G) leads to.

        NaN where it does not lead to a valid mesh. Where the fitness only counts elements, they
        need not be measured.
        """

    def tally(self, genome: Ids) -> Floats:
        """(TALLY_SIZE,) the whole tally of the mesh that one genome (G,) leads to."""

    def parameters(self, genome: Ids) -> Ints:
        """(K, C) int32 parameters that a procedure keeps of a genome; no rows: nothing is done."""


@runtime_checkable
class Remembering(Protocol):
    """A search space that knows the edit of a genome that it has scored."""

    def edit_of(self, genome: Ids) -> Edit:
        """Edit that `Operation.apply` makes of the genome's parameters."""


class Operation(Protocol):
    """Something that can be done to a mesh: it returns an Edit and changes nothing."""

    @property
    def name(self) -> str:
        """As on the command line."""

    @property
    def code(self) -> int:
        """Gene of the integration GA."""

    def search_space(self, workpiece: Workpiece, rng: np.random.Generator) -> SearchSpace | None:
        """Find the genomes of this operation on the mesh; None where there is nothing to do."""

    def apply(self, workpiece: Workpiece, parameters: Ints) -> Edit:
        """Make the edit of some parameters, empty where it would not leave a valid mesh.

        Raises ValueError where the parameters name what the mesh does not have.
        """

    def format(self, parameters: Ints) -> str:
        """Write parameters as in the paper's Figure 10."""
