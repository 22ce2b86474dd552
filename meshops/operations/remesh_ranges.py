"""Remesh of element number ranges, as in the paper's section 3.1."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops._core import select_ranges
from meshops.edit import Edit
from meshops.mesh import Floats, Ids, Ints
from meshops.patch import components, join
from meshops.remeshing import joint_change, replace_patch
from meshops.workpiece import Workpiece


@dataclass(frozen=True)
class RemeshRanges:
    """Remesh all that a union of element number ranges selects.

    Attributes
    ----------
    ranges : int
        How many ranges a genome selects; it has twice as many genes, the ends of the ranges.
    """

    ranges: int = 5
    name: str = "remesh-ranges"
    code: int = 0

    def search_space(
        self, workpiece: Workpiece, rng: np.random.Generator
    ) -> RemeshRangesSpace | None:
        """Genomes are ranges; the random generator is not needed."""
        if not workpiece.topology.editable.any():
            return None
        return RemeshRangesSpace(self, workpiece)

    def apply(self, workpiece: Workpiece, parameters: Ints) -> Edit:
        """Remesh the union of ranges (K, 2) of element numbers from 1."""
        count = len(workpiece.mesh.elements)
        if len(parameters) and (parameters.min() < 1 or parameters.max() > count):
            raise ValueError(f"element numbers must be from 1 to {count}")
        edits = [replace_patch(workpiece, rows)[0] for rows in select(workpiece, parameters)]
        return join(workpiece.mesh, [edit for edit in edits if not edit.is_empty])

    def format(self, parameters: Ints) -> str:
        """Ranges as in Figure 10: ``33-301 317-243``."""
        return " ".join(f"{low}-{high}" for low, high in parameters)


class RemeshRangesSpace:
    """Ranges of element numbers on one mesh. A patch that was remeshed once is remembered."""

    def __init__(self, operation: RemeshRanges, workpiece: Workpiece) -> None:
        self.workpiece = workpiece
        self._done: dict[bytes, tuple[Edit, Floats]] = {}
        count = len(workpiece.mesh.elements)
        self.bounds: Ids = np.full(2 * operation.ranges, count, np.int64)

    def draw(self, rng: np.random.Generator, count: int) -> Ids:
        """Numbers drawn evenly (section 4.1)."""
        return rng.integers(0, self.bounds, (count, len(self.bounds)))

    def parameters(self, genome: Ids) -> Ints:
        """(K, 2) ranges, numbered from 1."""
        ranges: Ints = genome.reshape(-1, 2).astype(np.int32) + np.int32(1)
        return ranges

    def evaluate(self, genomes: Ids) -> Floats:
        """Remesh the patches of each genome."""
        return np.stack([self.tally(genome) for genome in genomes])

    def tally(self, genome: Ids) -> Floats:
        """Add up what the patches of one genome change."""
        workpiece = self.workpiece
        done = [self._replaced(rows) for rows in select(workpiece, self.parameters(genome))]
        return workpiece.tally + joint_change(workpiece, done) if done else workpiece.tally

    def _replaced(self, rows: Ints) -> tuple[Edit, Floats]:
        key = rows.tobytes()
        if key not in self._done:
            self._done[key] = replace_patch(self.workpiece, rows)
        return self._done[key]


def select(workpiece: Workpiece, ranges: Ints) -> list[Ints]:
    """Split the union of ranges (K, 2) of numbers from 1 into patches: lists of element rows."""
    topology = workpiece.topology
    return components(topology, select_ranges(ranges, len(topology.mesh.elements)))
