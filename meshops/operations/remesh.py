"""Remesh: mesh a disc or a strip around a bad place anew, by one of several methods."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops.edit import Edit
from meshops.kernels.patches import disc, nearby, strip
from meshops.kernels.quality import TALLY_SIZE
from meshops.methods import METHODS
from meshops.mesh import Bools, Floats, Ids, Ints
from meshops.patch import components, join
from meshops.remeshing import replace_patch
from meshops.workpiece import Workpiece

SIZES = (1.0, 0.9, 1.1, 0.8, 1.25)
"""Edge length of the new elements, over that of the run or of the patch."""

MOST_RINGS = 7

SHIFTS = 12
"""Elements near the bad one that a disc may be centred on."""



@dataclass(frozen=True)
class Remesh:
    """Cut a place out, mesh it anew, recombine to quads, smooth, project back, stitch in.

    A genome is one place: the rank of a bad element; which element near it is the centre; how many
    rings around that belong to the place; the rank of another bad element to which a strip of that
    width leads (0: none, a disc); the size step; the method.
    """

    name: str = "remesh"
    code: int = 22

    def search_space(self, workpiece: Workpiece, rng: np.random.Generator) -> RemeshSpace | None:
        """Genomes are places; the random generator is not needed."""
        if not workpiece.topology.editable.any():
            return None
        return RemeshSpace(workpiece)

    def apply(self, workpiece: Workpiece, parameters: Ints) -> Edit:
        """Remesh places (K, 6); a rank that the mesh does not have is left out."""
        edits = []
        for place in parameters:
            edits = [edit for edit, _ in remesh_place(workpiece, place) if not edit.is_empty]
        return join(workpiece.mesh, edits)

    def format(self, parameters: Ints) -> str:
        """Places as ``3+2 r4 100% front``: rank and shift, rings, size; ``3-5`` for a strip."""
        return " ".join(
            f"{rank}{f'-{other}' if other else ''}{f'+{shift}' if shift else ''} r{rings} "
            f"{100 * SIZES[size]:.0f}% {METHODS[method].name}"
            for rank, shift, rings, other, size, method in parameters
        )


class RemeshSpace:
    """Places on one mesh. A place that was remeshed once is remembered."""

    def __init__(self, workpiece: Workpiece) -> None:
        self.workpiece = workpiece
        self._changes: dict[bytes, Floats | None] = {}
        bad = len(workpiece.bad_elements)
        self.bounds: Ids = np.array(
            [bad, SHIFTS, MOST_RINGS, bad + 1, len(SIZES), len(METHODS)], np.int64
        )

    def draw(self, rng: np.random.Generator, count: int) -> Ids:
        """Places near the worst elements more often than others, half of them discs."""
        genomes = rng.integers(0, self.bounds, (count, len(self.bounds)))
        genomes[:, 0] = (self.bounds[0] * rng.random(count) ** 2).astype(np.int64)
        genomes[rng.random(count) < 0.5, 3] = 0
        genomes[rng.random(count) < 0.5, 4] = 0
        return genomes

    def parameters(self, genome: Ids) -> Ints:
        """(1, 6) int32: the place, its ranks from 1; no row where it cannot be remeshed."""
        place = (genome + np.array([1, 0, 1, 0, 0, 0])).astype(np.int32)[None]
        return place if self._change(genome) is not None else place[:0]

    def evaluate(self, genomes: Ids) -> Floats:
        """Remesh the place of each genome."""
        return np.stack([self.tally(genome) for genome in genomes])

    def tally(self, genome: Ids) -> Floats:
        """Tally after remeshing one place; NaN where no valid mesh comes out."""
        change = self._change(genome)
        return np.full(TALLY_SIZE, np.nan) if change is None else self.workpiece.tally + change

    def _change(self, genome: Ids) -> Floats | None:
        key = genome.tobytes()
        if key not in self._changes:
            place = (genome + np.array([1, 0, 1, 0, 0, 0])).astype(np.int32)
            done = [
                change for edit, change in remesh_place(self.workpiece, place) if not edit.is_empty
            ]
            self._changes[key] = np.sum(done, axis=0) if done else None
        return self._changes[key]


def remesh_place(workpiece: Workpiece, place: Ints) -> list[tuple[Edit, Floats]]:
    """Remesh all patches of one place (6,): their edits and changes of the tally."""
    *_, size, method = place
    if not (0 <= size < len(SIZES) and 0 <= method < len(METHODS)):
        raise ValueError(f"a place to remesh has no size {size} or method {method}")
    return [
        replace_patch(workpiece, rows, method=METHODS[method].remesh, scale=SIZES[size])
        for rows in components(workpiece.topology, select(workpiece, place))
    ]


def select(workpiece: Workpiece, place: Ints) -> Bools:
    """(M,) bool: the elements of a place (6,); none where it names a rank that is not there."""
    rank, shift, rings, other = place[:4]
    topology, bad = workpiece.topology, workpiece.bad_elements
    ways = (topology.element_edges, topology.edge_elements, topology.crossable, topology.editable)
    if not (1 <= rank <= len(bad) and 0 <= other <= len(bad)):
        return np.zeros(len(workpiece.mesh.elements), bool)
    centre = bad[rank - 1]
    if other == 0:
        chosen: Bools = disc(*ways, nearby(*ways, centre, shift), rings)
    else:
        chosen = strip(*ways, centre, bad[other - 1], rings)
    return chosen
