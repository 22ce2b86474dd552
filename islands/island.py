"""Island: a population of procedures, as a value that steps from generation to generation."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from islands.genetics import Breeding, next_generation
from islands.integration_ga import Evaluator, Problem
from islands.migration import Migrants, Migration, queue, settle
from islands.procedure import Step
from meshops.fitness import Fitness, FitnessKind
from meshops.mesh import Floats, Ids
from meshops.operations import NOTHING
from meshops.quality_sums import TALLY_SIZE

MIGRATING = 1
"""Last part of the key of the random numbers that migration takes: breeding has its own."""


@dataclass(frozen=True, eq=False)
class IslandState:
    """All that an island is between two generations.

    Attributes
    ----------
    work : int
        The number of the work that it is busy with.
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
        NaN before there is one.
    best_steps : tuple of Step
        The fittest procedure that the island has seen.
    evaluations : int
        Individuals of the operation GAs that its procedures asked for: the same everywhere.
    performed : int
        Those of them that were scored: fewer where others had asked for the same before.
    stagnant : int
        Generations since the fittest procedure was found.
    leaving : (P,) int64
        Rows of the individuals in the order in which they would leave.
    faults : tuple of str
        Why individuals of this generation could not be scored.
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
    performed: int
    stagnant: int
    leaving: Ids
    faults: tuple[str, ...] = ()

    @classmethod
    def first(cls, work: int, island: int) -> Self:
        """Make an island before its first generation."""
        return cls(
            work=work,
            island=island,
            generation=0,
            genomes=np.zeros((0, 0), np.int64),
            fitness=np.zeros(0),
            tallies=np.zeros((0, TALLY_SIZE)),
            best_fitness=-np.inf,
            best_tally=np.full(TALLY_SIZE, np.nan),
            best_steps=(),
            evaluations=0,
            performed=0,
            stagnant=0,
            leaving=np.zeros(0, np.int64),
        )

    @property
    def residents(self) -> Migrants:
        """Its individuals."""
        return Migrants(self.genomes, self.fitness, self.tallies)

    def without(self, rows: Ids) -> IslandState:
        """Return the island after individuals have gone for good: none is bred from any more."""
        fitness = self.fitness.copy()
        fitness[rows] = -np.inf
        return replace(self, fitness=fitness)


@dataclass(frozen=True)
class OwnFitness:
    """What an island weighs otherwise than the run; None: as the run does.

    Its operation GAs aim at the run's fitness all the same, and so the islands share their work.
    """

    kind: FitnessKind | None = None
    irregularity: float | None = None
    price: float | None = None

    def instead_of(self, fitness: Fitness) -> Fitness:
        """Return the island's fitness."""
        return replace(fitness, **{k: v for k, v in vars(self).items() if v is not None})


@dataclass(frozen=True)
class IslandPlan:
    """How an island lives; each may live in another way.

    Attributes
    ----------
    breeding : Breeding
    genes : int
        Of an individual.
    migration : Migration
    operations : tuple of str
        Those that it draws, by name; empty: all of the run.
    fitness : OwnFitness
    """

    breeding: Breeding
    genes: int
    migration: Migration
    operations: tuple[str, ...] = ()
    fitness: OwnFitness = field(default_factory=OwnFitness)

    def problem(self, problem: Problem) -> Problem:
        """Return the run's problem as this island draws for it."""
        if not self.operations:
            return problem
        own = {o.code for o in problem.operations if o.name in self.operations} | {NOTHING}
        weights = np.ones(len(problem.codes)) if problem.weights is None else problem.weights
        weights = np.where([code in own for code in problem.codes], weights, 0.0)
        return replace(problem, weights=weights / weights.sum())


def step(
    state: IslandState, immigrants: Migrants | None, evaluator: Evaluator, plan: IslandPlan
) -> IslandState:
    """Take in immigrants, breed and score one generation.

    Random numbers come from (run seed, round, mesh, island, generation) alone.
    """
    problem, breeding = plan.problem(evaluator.problem), plan.breeding
    judge = plan.fitness.instead_of(problem.fitness)
    key = [
        problem.seed, problem.turn, int(evaluator.root.mesh, 16), state.island, state.generation
    ]  # fmt: skip
    rng, migrating = np.random.default_rng(key), np.random.default_rng([*key, MIGRATING])
    genomes = problem.draw(rng, breeding.individuals, plan.genes)
    if state.generation > 0:
        if immigrants is not None and judge != problem.fitness:
            immigrants = _judged_anew(immigrants, judge, problem)
        residents = _with(immigrants, state, plan.migration, migrating)
        genomes = next_generation(residents.genomes, residents.fitness, genomes, breeding, rng)
    evaluations, performed = evaluator.evaluations, evaluator.performed
    scored = evaluator.evaluate(genomes, judge)
    fitness = scored.fitness
    after = replace(
        state,
        generation=state.generation + 1,
        genomes=genomes,
        fitness=fitness,
        tallies=scored.tallies,
        evaluations=state.evaluations + evaluator.evaluations - evaluations,
        performed=state.performed + evaluator.performed - performed,
        stagnant=state.stagnant + 1,
        leaving=queue(fitness, plan.migration, migrating),
        faults=scored.faults,
    )
    top = int(np.argmax(fitness))
    if fitness[top] <= state.best_fitness:
        return after
    return replace(
        after,
        best_fitness=float(fitness[top]),
        best_tally=scored.tallies[top],
        best_steps=scored.steps[top],
        stagnant=0,
    )


def _judged_anew(immigrants: Migrants, judge: Fitness, problem: Problem) -> Migrants:
    """Score immigrants as the island does; what the use of an operation costs is left out."""
    return replace(immigrants, fitness=judge.of(immigrants.tallies, problem.setting.scoring))


def _with(
    immigrants: Migrants | None,
    state: IslandState,
    migration: Migration,
    rng: np.random.Generator,
) -> Migrants:
    """Return the individuals of an island once those who are let in have settled."""
    if immigrants is None or state.stagnant < migration.patience:
        return state.residents
    parents = state.leaving[: migration.number(len(state.genomes))]
    return settle(state.residents, immigrants, parents, migration, rng)
