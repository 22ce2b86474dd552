"""Remesh: mesh a disc or a strip around a bad place anew, by one of several methods."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops.edit import Edit
from meshops.mesh import Bools, Floats, Ids, Ints
from meshops.methods import METHODS
from meshops.patch import components, join
from meshops.quality_sums import TALLY_SIZE
from meshops.remeshing import joint_change, replace_patch
from meshops.workpiece import Workpiece

LOCAL, WANTED = "of the place", "of the criteria"

SIZES = (
    (LOCAL, 1.0),
    (WANTED, 1.0),
    (LOCAL, 0.9),
    (LOCAL, 1.1),
    (WANTED, 0.85),
    (WANTED, 1.2),
    (LOCAL, 0.8),
    (LOCAL, 1.25),
)
"""Edge length of the new elements, over that of the place (or of the run, where the user gives one)
or over the length that the criteria take for ideal."""

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
        """Remesh the place (1, 6); none where the mesh does not have its ranks."""
        if not len(parameters):
            return Edit()
        if len(parameters) > 1:
            raise ValueError("Remesh takes one place at a time")
        return join(workpiece.mesh, [edit for edit, _ in remesh_place(workpiece, parameters[0])])

    def format(self, parameters: Ints) -> str:
        """Places as ``3+2 r4 100% front``: rank and shift, rings, size; ``3-5`` for a strip.

        ``100%!`` is a share of the length that the criteria take for ideal.
        """
        return " ".join(
            f"{rank}{f'-{other}' if other else ''}{f'+{shift}' if shift else ''} r{rings} "
            f"{100 * SIZES[size][1]:.0f}%{'!' if SIZES[size][0] is WANTED else ''} "
            f"{METHODS[method].name}"
            for rank, shift, rings, other, size, method in parameters
        )


class RemeshSpace:
    """Places on one mesh. A place that was remeshed once is remembered."""

    def __init__(self, workpiece: Workpiece) -> None:
        self.workpiece = workpiece
        self._done: dict[bytes, list[tuple[Edit, Floats]]] = {}
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
        place = _place(genome)[None]
        return place if self._remeshed(genome) else place[:0]

    def evaluate(self, genomes: Ids) -> Floats:
        """Remesh the place of each genome."""
        return np.stack([self.tally(genome) for genome in genomes])

    def tally(self, genome: Ids) -> Floats:
        """Tally after remeshing one place; NaN where no valid mesh comes out."""
        done = self._remeshed(genome)
        if not done:
            return np.full(TALLY_SIZE, np.nan)
        tally: Floats = self.workpiece.tally + joint_change(self.workpiece, done)
        return tally

    def edit_of(self, genome: Ids) -> Edit:
        """Remesh one place, once."""
        return join(self.workpiece.mesh, [edit for edit, _ in self._remeshed(genome)])

    def _remeshed(self, genome: Ids) -> list[tuple[Edit, Floats]]:
        key = genome.tobytes()
        if key not in self._done:
            self._done[key] = remesh_place(self.workpiece, _place(genome))
        return self._done[key]


def _place(genome: Ids) -> Ints:
    """(6,) int32 parameters of a genome (6,): the rank is counted from 1, rings too."""
    place: Ints = (genome + np.array([1, 0, 1, 0, 0, 0])).astype(np.int32)
    return place


def remesh_place(workpiece: Workpiece, place: Ints) -> list[tuple[Edit, Floats]]:
    """Remesh all patches of one place (6,): edits and changes of the tally where they succeed."""
    *_, size, method = place
    if not (0 <= size < len(SIZES) and 0 <= method < len(METHODS)):
        raise ValueError(f"a place to remesh has no size {size} or method {method}")
    base, scale = SIZES[size]
    done = [
        replace_patch(
            workpiece,
            rows,
            method=METHODS[method].remesh,
            size=workpiece.setting.scoring.size if base is WANTED else None,
            scale=scale,
        )
        for rows in components(workpiece.topology, select(workpiece, place))
    ]
    return [(edit, change) for edit, change in done if not edit.is_empty]


def select(workpiece: Workpiece, place: Ints) -> Bools:
    """(M,) bool: the elements of a place (6,); none where it names a rank that is not there."""
    rank, shift, rings, other = place[:4]
    bad, editable = workpiece.bad_elements, workpiece.topology.editable
    if not (1 <= rank <= len(bad) and 0 <= other <= len(bad)):
        return np.zeros(len(workpiece.mesh.elements), bool)
    centre, graph = bad[rank - 1], workpiece.topology.graph
    if other == 0:
        return graph.disc(editable, graph.nearby(editable, centre, shift), rings)
    return graph.strip(editable, centre, bad[other - 1], rings)
