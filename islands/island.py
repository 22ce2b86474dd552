"""Island: a population of procedures, as a value that steps from generation to generation."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from islands.genetics import Breeding, next_generation
from islands.integration_ga import Evaluator
from islands.procedure import Step
from meshops.mesh import Floats, Ids


@dataclass(frozen=True, eq=False)
class IslandState:
    """All that an island is between two generations.

    Attributes
    ----------
    work : int
        Which of the works of an archipelago it is busy with.
    island : int
    generation : int
        How many generations it has scored; 0 before the first.
    genomes : (P, G) int64
    fitness : (P,) float64
        Of the genomes; no values before the first generation.
    tallies : (P, TALLY_SIZE) float64
        Of the meshes that the genomes lead to.
    best_fitness : float
    best_tally : (TALLY_SIZE,) float64
    best_steps : tuple of Step
        The fittest procedure that the island has seen.
    evaluations : int
        Individuals of operation GAs that were scored for it.
    """

    work: int
    island: int
    generation: int
    genomes: Ids
    fitness: Floats
    tallies: Floats
    best_fitness: float
    best_tally: Floats
    best_steps: tuple[Step, ...]
    evaluations: int

    @classmethod
    def first(cls, work: int, island: int) -> Self:
        """Make an island before its first generation."""
        none = np.zeros(0)
        no_genomes = np.zeros((0, 0), np.int64)
        return cls(work, island, 0, no_genomes, none, np.zeros((0, 0)), -np.inf, none, (), 0)


@dataclass(frozen=True, eq=False)
class Migrants:
    """Individuals that change islands, always copies, with the fitness that they were given.

    Attributes
    ----------
    genomes : (K, G) int64
    fitness : (K,) float64
    """

    genomes: Ids
    fitness: Floats


def step(
    state: IslandState,
    immigrants: Migrants | None,
    evaluator: Evaluator,
    breeding: Breeding,
    genes: int,
) -> IslandState:
    """Take in immigrants, breed and score one generation.

    Random numbers come from (run seed, round, mesh, island, generation) alone.
    """
    problem = evaluator.problem
    rng = np.random.default_rng(
        [problem.seed, problem.turn, int(evaluator.root.mesh, 16), state.island, state.generation]
    )
    genomes = problem.draw(rng, breeding.individuals, genes)
    if state.generation > 0:
        residents = settle(state, immigrants)
        genomes = next_generation(residents.genomes, residents.fitness, genomes, breeding, rng)
    before = evaluator.evaluations
    fitness, tallies, steps = evaluator.evaluate(genomes)
    after = replace(
        state,
        generation=state.generation + 1,
        genomes=genomes,
        fitness=fitness,
        tallies=tallies,
        evaluations=state.evaluations + evaluator.evaluations - before,
    )
    top = int(np.argmax(fitness))
    if fitness[top] <= state.best_fitness:
        return after
    return replace(
        after, best_fitness=float(fitness[top]), best_tally=tallies[top], best_steps=steps[top]
    )


def settle(state: IslandState, immigrants: Migrants | None) -> Migrants:
    """Put immigrants in the place of the worst residents; later residents go first among equals."""
    genomes, fitness = state.genomes.copy(), state.fitness.copy()
    if immigrants is not None and len(immigrants.genomes):
        leaving = np.argsort(fitness, kind="stable")[: len(immigrants.genomes)]
        genomes[leaving] = immigrants.genomes[: len(leaving)]
        fitness[leaving] = immigrants.fitness[: len(leaving)]
    return Migrants(genomes, fitness)


def emigrants(state: IslandState, count: int) -> Migrants:
    """Copy the best individuals of an island."""
    best = np.argsort(-state.fitness, kind="stable")[:count]
    return Migrants(state.genomes[best].copy(), state.fitness[best].copy())
