"""Archipelago: islands that evolve side by side and exchange their best individuals."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from islands.island import IslandState, Migrants, emigrants
from islands.procedure import steps_text
from islands.topology import ring
from meshops.criteria import Scoring
from meshops.kernels.quality import FAILED, TRIAS, compound_index
from meshops.operations import Operation
from tracking.events import Event, GenerationReport, MigrationReport


@dataclass(frozen=True)
class Migration:
    """When and how many individuals migrate.

    Attributes
    ----------
    every : int
        Generations between two migrations (an epoch).
    count : int
        Best individuals that each island sends to the next of the ring.
    """

    every: int = 2
    count: int = 1


class Executor(Protocol):
    """Where islands run. The rest of the program does not know which executor it has."""

    def advance(
        self, steps: Sequence[tuple[IslandState, Migrants | None]]
    ) -> Iterator[IslandState]:
        """Step each island by one generation; states come as they are ready, in any order.

        Raises TimeUpError where the run's time is up before all are.
        """

    def close(self) -> None:
        """Free what the executor holds."""


class TimeUpError(Exception):
    """The run's time limit was reached within a generation."""


@dataclass(frozen=True, eq=False)
class Result:
    """How an archipelago ended.

    Attributes
    ----------
    best : IslandState
        The island with the fittest procedure; the first of equals.
    evaluations : int
    status : "finished", "time-limit" or "interrupted"
    """

    best: IslandState
    evaluations: int
    status: Literal["finished", "time-limit", "interrupted"]


def evolve_archipelago(
    islands: int,
    generations: int,
    migration: Migration,
    executor: Executor,
    record: Callable[[Event], None],
    report: Callable[[IslandState], GenerationReport],
) -> Result:
    """Step all islands to the last generation and let migrants travel in between.

    Migrants leave after every `migration.every` generations and arrive before the next one begins,
    by the number of the generation and never by who is ready first. Time limit and interruption
    end the run with the best that was found until then.
    """
    states = [IslandState.first(island) for island in range(islands)]
    arriving: dict[int, Migrants] = {}
    status: Literal["finished", "time-limit", "interrupted"] = "finished"
    try:
        for generation in range(generations + 1):
            steps = [(state, arriving.get(state.island)) for state in states]
            for state in executor.advance(steps):
                states[state.island] = state
                record(report(state))
            if generation < generations and (generation + 1) % migration.every == 0:
                arriving = _migrate(states, migration, record)
            else:
                arriving = {}
    except TimeUpError:
        status = "time-limit"
    except KeyboardInterrupt:
        status = "interrupted"
    best = states[int(np.argmax([state.best_fitness for state in states]))]
    return Result(best, sum(state.evaluations for state in states), status)


def _migrate(
    states: list[IslandState], migration: Migration, record: Callable[[Event], None]
) -> dict[int, Migrants]:
    arriving = {}
    for source, target in ring(len(states)):
        leaving = emigrants(states[source], migration.count)
        arriving[target] = leaving
        for genome, fitness in zip(leaving.genomes, leaving.fitness, strict=True):
            record(
                MigrationReport(
                    generation=states[source].generation - 1,
                    source=source,
                    target=target,
                    fitness=float(fitness),
                    genome=tuple(int(gene) for gene in genome),
                )
            )
    return arriving


@dataclass(frozen=True)
class Reporter:
    """Makes reports of generations; the clock is read here and nowhere in the search."""

    scoring: Scoring
    operations: tuple[Operation, ...]
    started: float

    def __call__(self, state: IslandState) -> GenerationReport:
        """Report on an island; an individual that makes no valid mesh counts as 0."""
        fitness = np.where(np.isfinite(state.fitness), state.fitness, 0.0)
        tally = state.best_tally
        return GenerationReport(
            island=state.island,
            generation=state.generation - 1,
            best=float(fitness.max()),
            mean=float(fitness.mean()),
            worst=float(fitness.min()),
            best_so_far=state.best_fitness if np.isfinite(state.best_fitness) else 0.0,
            trias=int(tally[TRIAS]),
            failed=int(tally[FAILED]),
            compound_qi=float(compound_index(tally, *self.scoring.arrays)),
            evaluations=state.evaluations,
            seconds=time.monotonic() - self.started,
            procedure=steps_text(state.best_steps, self.operations),
        )
