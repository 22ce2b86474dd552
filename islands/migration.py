"""Migration: who leaves an island, who comes, and who gives way.

What is promised: migrants are copies, an island is never another number of individuals for them,
and what an island does depends on its state, on the migrants and on the generator that it is
given.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, Self

import numpy as np

from islands.genetics import roulette
from meshops.mesh import Floats, Ids

Leaving = Literal["best", "roulette", "tournament", "random"]
GivingWay = Literal["worst", "random", "most-similar", "parents"]


@dataclass(frozen=True)
class Migration:
    """How one island sends and receives.

    Attributes
    ----------
    count : int
        Individuals that leave at the end of an epoch, at the most all.
    share : float or None
        Of the island that leave, rounded up, in the place of `count`.
    leaving : str
        Who: the ``best``; by ``roulette`` or ``tournament`` on their fitness; at ``random``.
    giving_way : str
        Who is replaced: the ``worst``; at ``random``; for each immigrant the ``most-similar`` by
        the genes that are equal; the ``parents``, those that have left as copies.
    moves : bool
        Whether those that leave are gone: then they are not bred from any more, and each goes to
        one neighbour in turn instead of to all.
    refuses_duplicates : bool
        Whether an immigrant stays out whose genome lives here already.
    patience : int
        Generations without a better best after which immigrants are let in; 0: always.
    """

    count: int = 1
    share: float | None = None
    leaving: Leaving = "best"
    giving_way: GivingWay = "worst"
    moves: bool = False
    refuses_duplicates: bool = False
    patience: int = 0

    def number(self, individuals: int) -> int:
        """How many of so many individuals leave."""
        wanted = self.count if self.share is None else int(np.ceil(self.share * individuals))
        return min(wanted, individuals)


@dataclass(frozen=True, eq=False)
class Migrants:
    """Individuals that change islands, always copies, with what is known of them.

    Attributes
    ----------
    genomes : (K, G) int64
    fitness : (K,) float64
    tallies : (K, TALLY_SIZE) float64
    """

    genomes: Ids
    fitness: Floats
    tallies: Floats

    def take(self, rows: Ids) -> Self:
        """Copy some of them."""
        return type(self)(
            self.genomes[rows].copy(), self.fitness[rows].copy(), self.tallies[rows].copy()
        )

    @classmethod
    def join(cls, groups: Sequence[Migrants]) -> Migrants:
        """Put groups together, in their order."""
        return cls(
            np.concatenate([group.genomes for group in groups]),
            np.concatenate([group.fitness for group in groups]),
            np.concatenate([group.tallies for group in groups]),
        )


def queue(fitness: Floats, migration: Migration, rng: np.random.Generator) -> Ids:
    """(P,) rows of an island's individuals in the order in which they would leave."""
    count = len(fitness)
    if migration.leaving == "best":
        return np.argsort(-fitness, kind="stable").astype(np.int64)
    if migration.leaving == "random":
        return rng.permutation(count).astype(np.int64)
    left = np.arange(count)
    order = []
    while len(left):
        if migration.leaving == "roulette":
            i = int(roulette(fitness[left], 1, rng, scaling="window")[0])
        else:
            i = int(max(rng.choice(len(left), min(2, len(left)), replace=False),
                        key=lambda row: fitness[left[row]]))  # fmt: skip
        order.append(left[i])
        left = np.delete(left, i)
    return np.array(order, np.int64)


def settle(
    residents: Migrants,
    immigrants: Migrants,
    parents: Ids,
    migration: Migration,
    rng: np.random.Generator,
) -> Migrants:
    """Let immigrants in, each in the place of a resident.

    Parameters
    ----------
    residents, immigrants : Migrants
        Of more immigrants than residents the last ones stay out.
    parents : (K,) int64
        Rows of the residents that have just left as copies.
    """
    after = residents.take(np.arange(len(residents.genomes)))
    free = np.ones(len(after.genomes), bool)
    chance = rng.permutation(len(free)) if migration.giving_way == "random" else None
    worst_first = np.argsort(after.fitness, kind="stable")
    for i, genome in enumerate(immigrants.genomes):
        if not free.any():
            break
        same = (after.genomes == genome).sum(axis=1)
        if migration.refuses_duplicates and (same == len(genome)).any():
            continue
        if chance is not None:
            order = chance
        elif migration.giving_way == "most-similar":
            order = worst_first[np.argsort(-same[worst_first], kind="stable")]
        elif migration.giving_way == "parents":
            order = np.concatenate([parents, worst_first])
        else:
            order = worst_first
        row = order[free[order]][0]
        free[row] = False
        after.genomes[row] = genome
        after.fitness[row] = immigrants.fitness[i]
        after.tallies[row] = immigrants.tallies[i]
    return after
