"""Sites: an operation that does a few small edits at once, each at one place of the mesh."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from meshops._core import Claims
from meshops.edit import Edit
from meshops.mesh import Bools, Floats, Ids, Ints
from meshops.operations.candidates import Candidates
from meshops.operations.judge import judge
from meshops.operations.places import nearest_first
from meshops.operations.relax import relax
from meshops.patch import join
from meshops.quality_sums import ELEMENTS
from meshops.workpiece import Workpiece

__all__ = [
    "SiteOperation",
    "SiteSpace",
    "apply_sites",
    "format_sites",
    "join_edits",
    "nearest_first",
    "relax",
]

EMPTY = 0.25
"""Share of the genes of a first generation that are nothing."""

REACH = 0.25
"""Mean rank of the genes that are drawn, as a share of all."""


@dataclass(frozen=True)
class SiteOperation(ABC):
    """An operation whose individuals are a few sites, each a small edit of its own.

    A subclass lists its candidates; guards, quality, search and parameters are common. Parameters
    are rows of the rank of a place, from 1, and the variant of the edit there. Places are ranked
    from the worst element on, so that what was found on one mesh can be tried on another.

    Attributes
    ----------
    picks : int
        How many sites an individual has at the most.
    pool : int
        How many places are looked at, so that the cost does not grow with the mesh.
    variants : int
        Candidates of each place, one after the other.
    nested : bool
        Whether a smaller pool has just the first places of a larger one. Then `apply` lists only as
        many as it needs.
    """

    picks: int = 4
    pool: int = 100
    variants: ClassVar[int] = 1
    nested: ClassVar[bool] = False

    @abstractmethod
    def candidates(self, workpiece: Workpiece) -> Candidates:
        """List the edits, `variants` for each place, the place nearest to the worst first."""

    def search_space(self, workpiece: Workpiece, rng: np.random.Generator) -> SiteSpace | None:
        """Genomes are sites; the random generator is not needed."""
        candidates = self.candidates(workpiece)
        space = SiteSpace(
            workpiece,
            candidates,
            judge(workpiece, candidates),
            picks=self.picks,
            variants=self.variants,
        )
        return space if len(space.sites) else None

    def apply(self, workpiece: Workpiece, parameters: Ints) -> Edit:
        """Do the sites of some parameters (K, 2), without those that the mesh does not have."""
        if not len(parameters):
            return Edit()
        places = int(parameters[:, 0].max(initial=0))
        listed = replace(self, pool=min(self.pool, places)) if self.nested else self
        candidates = listed.candidates(workpiece)
        return apply_sites(workpiece, candidates, parameters, variants=self.variants)

    def format(self, parameters: Ints) -> str:
        """Ranks, with the variant where there is more than one: ``3a 1b``."""
        return format_sites(parameters, variants=self.variants)


class SiteSpace:
    """Choices of a few sites on one mesh; a later site gives way to the earlier ones.

    Parameters
    ----------
    workpiece : Workpiece
    candidates : Candidates
        `variants` for each place, the place nearest to the worst first.
    tallies : (K, TALLY_SIZE) float64
        Of the mesh after each candidate alone, as `judge` finds them.
    picks : int
        Genes of a genome. A gene is a valid candidate, counted from 0, or from their number on
        nothing.
    variants : int
    """

    def __init__(
        self,
        workpiece: Workpiece,
        candidates: Candidates,
        tallies: Floats,
        *,
        picks: int = 4,
        variants: int = 1,
    ) -> None:
        self.workpiece = workpiece
        self.variants = variants
        self.sites: Ints = np.nonzero(np.isfinite(tallies[:, ELEMENTS]))[0].astype(np.int32)
        self._changes = tallies[self.sites] - workpiece.tally
        self._claims = _claims(workpiece, candidates.take(self.sites))
        count = len(self.sites)
        self.bounds: Ids = np.full(picks, count + max(1, int(EMPTY * count)), np.int64)

    def draw(self, rng: np.random.Generator, count: int) -> Ids:
        """Sites near the worst places, some genes empty; the first genome is the greedy one."""
        shape = (count, len(self.bounds))
        sites = max(1, len(self.sites))
        ranks = rng.exponential(REACH * sites, shape).astype(np.int64) % sites
        genomes: Ids = np.where(rng.random(shape) < EMPTY, len(self.sites), ranks)
        if count:
            genomes[0] = self._greedy()
        return genomes

    def evaluate(self, genomes: Ids) -> Floats:
        """Add up the changes of the sites that each genome takes."""
        return self.workpiece.tally + self._combined(genomes)[0]

    def tally(self, genome: Ids) -> Floats:
        """Add up the changes of one genome."""
        tally: Floats = self.evaluate(genome[None])[0]
        return tally

    def parameters(self, genome: Ids) -> Ints:
        """(K, 2): rank of the place from 1, and variant, of the sites really taken."""
        taken = self._combined(genome[None])[1][0]
        place, variant = np.divmod(self.sites[genome[taken]], self.variants)
        return np.column_stack([place + 1, variant]).astype(np.int32)

    def _combined(self, genomes: Ids) -> tuple[Floats, Bools]:
        return self._claims.combine(genomes, self._changes)

    def _greedy(self) -> Ids:
        """Take the sites that alone make the mesh fittest, as long as they make it fitter."""
        before = self.workpiece.fitness(self.workpiece.tally[None])[0]
        fitness = self.workpiece.fitness(self.workpiece.tally + self._changes)
        order = np.argsort(-fitness, kind="stable")
        gaining: Ids = order[fitness[order] > before].astype(np.int64)
        taken = gaining[self._combined(gaining[None])[1][0]][: len(self.bounds)]
        genome: Ids = np.full(len(self.bounds), len(self.sites), np.int64)
        genome[: len(taken)] = taken
        return genome


def apply_sites(
    workpiece: Workpiece, candidates: Candidates, parameters: Ints, *, variants: int = 1
) -> Edit:
    """Make one edit of the sites (K, 2) that parameters name, taken as `SiteSpace` takes them.

    Sites that the mesh does not have, that a guard forbids or that are in the way of earlier ones
    are left out.
    """
    place, variant = parameters[:, 0].astype(np.int64) - 1, parameters[:, 1]
    rows = place * variants + variant
    known = (place >= 0) & (variant >= 0) & (variant < variants) & (rows < len(candidates))
    named = candidates.take(rows[known].astype(np.int32))
    tallies = judge(workpiece, named)
    valid = np.nonzero(np.isfinite(tallies[:, ELEMENTS]))[0].astype(np.int32)
    named, changes = named.take(valid), tallies[valid] - workpiece.tally
    genome = np.arange(len(named), dtype=np.int64)[None]
    taken = _claims(workpiece, named).combine(genome, changes)[1][0]
    mesh = workpiece.mesh
    return join_edits(workpiece, [named.edit(int(k), mesh.region) for k in np.nonzero(taken)[0]])


def join_edits(workpiece: Workpiece, edits: list[Edit]) -> Edit:
    """One edit of several that touch different elements, moves of nodes included."""
    if len(edits) < 2:
        return edits[0] if edits else Edit()
    return replace(
        join(workpiece.mesh, edits),
        moved=np.concatenate([edit.moved for edit in edits]),
        moved_to=np.concatenate([edit.moved_to for edit in edits]),
    )


def format_sites(parameters: Ints, *, variants: int = 1) -> str:
    """Ranks, with the variant as a letter where there is more than one: ``3a 1b``."""
    letters = [chr(ord("a") + int(v)) if variants > 1 else "" for v in parameters[:, 1]]
    return " ".join(f"{rank}{v}" for rank, v in zip(parameters[:, 0], letters, strict=True))


def _claims(workpiece: Workpiece, candidates: Candidates) -> Claims:
    """List what each candidate needs for itself."""
    return Claims(candidates, workpiece.mesh.elements, workpiece.around)
