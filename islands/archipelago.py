"""Archipelago: islands that evolve side by side and exchange their best individuals."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from islands.integration_ga import Work
from islands.island import IslandState, Migrants, emigrants
from islands.topology import ring

Status = Literal["finished", "time-limit", "interrupted"]


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


@dataclass(frozen=True)
class Schedule:
    """How long islands evolve, and how.

    Attributes
    ----------
    islands : int
        Of each work.
    generations : int
        After the first one, which is drawn.
    migration : Migration
    """

    islands: int
    generations: int
    migration: Migration


class Executor(Protocol):
    """Where islands run. The rest of the program does not know which executor it has."""

    def open(self, works: Sequence[Work]) -> None:
        """Take the works that the next islands are busy with, in the place of earlier ones."""

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
    best : tuple of IslandState
        Of each work the island with the fittest procedure; the first of equals.
    evaluations : int
    status : "finished", "time-limit" or "interrupted"
    """

    best: tuple[IslandState, ...]
    evaluations: int
    status: Status


Watch = Callable[[int, Sequence[IslandState]], None]
"""Is told an island's number and its states, one a work, after each generation."""

Post = Callable[[IslandState, int, Migrants], None]
"""Is told of emigrants: the island that they leave, that they go to, and who they are."""


def evolve_archipelago(
    works: Sequence[Work],
    schedule: Schedule,
    executor: Executor,
    watch: Watch,
    post: Post,
) -> Result:
    """Step all islands of all works to the last generation, migrants travelling in between.

    The islands of a work are a ring of their own. Migrants leave after every `migration.every`
    generations and arrive before the next one begins, by the number of the generation and never by
    who is ready first. A work in which nothing is left to gain stops. Time limit and interruption
    end all of them with the best that was found until then.
    """
    status: Status = "finished"
    states = [
        [IslandState.first(work, island) for island in range(schedule.islands)]
        for work in range(len(works))
    ]
    try:
        executor.open(works)
        arriving: dict[tuple[int, int], Migrants] = {}
        for generation in range(schedule.generations + 1):
            busy = [row for row, work in zip(states, works, strict=True) if not _done(row, work)]
            if not busy:
                break
            steps = [(s, arriving.get((s.work, s.island))) for row in busy for s in row]
            for state in executor.advance(steps):
                states[state.work][state.island] = state
            for island in range(schedule.islands):
                watch(island, [row[island] for row in states])
            arriving = {}
            if generation < schedule.generations and (
                (generation + 1) % schedule.migration.every == 0
            ):
                arriving = _migrate(busy, schedule.migration, post)
    except TimeUpError:
        status = "time-limit"
    except KeyboardInterrupt:
        status = "interrupted"
    best = tuple(row[int(np.argmax([s.best_fitness for s in row]))] for row in states)
    return Result(best, sum(s.evaluations for row in states for s in row), status)


def _done(row: list[IslandState], work: Work) -> bool:
    return any(state.generation > 0 and work.is_solved(state.best_tally) for state in row)


def _migrate(
    busy: list[list[IslandState]], migration: Migration, post: Post
) -> dict[tuple[int, int], Migrants]:
    arriving = {}
    for row in busy:
        for source, target in ring(len(row)):
            leaving = emigrants(row[source], migration.count)
            arriving[row[source].work, target] = leaving
            post(row[source], target, leaving)
    return arriving
