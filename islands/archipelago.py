"""Archipelago: islands that evolve side by side and exchange their best individuals."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol

import numpy as np

from islands.integration_ga import Work
from islands.island import IslandPlan, IslandState, OwnFitness
from islands.migration import Migrants
from islands.stopping import Stopping
from islands.topology import Link

Status = Literal["finished", "time-limit", "interrupted"]


@dataclass(frozen=True)
class Schedule:
    """How long islands evolve, and when and where migrants travel.

    Attributes
    ----------
    plans : tuple of IslandPlan
        One for each island of a work.
    generations : int
        After the first one, which is drawn.
    links : tuple of (int, int)
        Source and target of migrants.
    every : int
        Generations between two migrations (an epoch).
    delay : int
        Epochs later than the next generation that migrants arrive.
    stopping : Stopping
        What ends a work sooner; a run of many works has its own evaluations and target.
    """

    plans: tuple[IslandPlan, ...]
    generations: int
    links: tuple[Link, ...] = ()
    every: int = 1
    delay: int = 0
    stopping: Stopping = field(default_factory=Stopping)

    @property
    def islands(self) -> int:
        """Of each work."""
        return len(self.plans)


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
    reasons : tuple of str
        Why the first work ended before its last generation, where a rule of stopping said so.
    """

    best: tuple[IslandState, ...]
    evaluations: int
    status: Status
    reasons: tuple[str, ...] = ()


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

    The islands of each work are linked among themselves. Migrants leave after every epoch and
    arrive before the next generation begins, or a fixed number of epochs later, by the number of
    the generation and never by who is ready first. A work in which nothing is left to gain stops,
    and so does one that a rule of `schedule.stopping` ends.
    Time limit and interruption end all of them with the best that was found until then.
    """
    status: Status = "finished"
    states = [
        [IslandState.first(work, island) for island in range(schedule.islands)]
        for work in range(len(works))
    ]
    try:
        executor.open(works)
        travelling: dict[int, list[_Group]] = {}
        for generation in range(schedule.generations + 1):
            busy = [
                row
                for row, work in zip(states, works, strict=True)
                if not (_done(row, work) or schedule.stopping.of_both(row))
            ]
            if not busy:
                break
            arriving = _arrivals(travelling.pop(generation, []))
            steps = [(s, arriving.get((s.work, s.island))) for row in busy for s in row]
            for state in executor.advance(steps):
                states[state.work][state.island] = state
            for island in range(schedule.islands):
                watch(island, [row[island] for row in states])
            if (generation + 1) % schedule.every == 0:
                arrival = generation + 1 + schedule.delay * schedule.every
                if arrival <= schedule.generations:
                    travelling[arrival] = _departures(busy, schedule, post)
    except TimeUpError:
        status = "time-limit"
    except KeyboardInterrupt:
        status = "interrupted"
    best = tuple(
        row[int(np.argmax(_fitness(row, work, schedule)))]
        for row, work in zip(states, works, strict=True)
    )
    reasons = tuple(schedule.stopping.of_both(states[0])) if states else ()
    return Result(best, sum(s.evaluations for row in states for s in row), status, reasons)


def _fitness(row: list[IslandState], work: Work, schedule: Schedule) -> list[float]:
    """Fitness of the best of each island, by the run's measure where islands have their own."""
    if all(plan.fitness == OwnFitness() for plan in schedule.plans):
        return [state.best_fitness for state in row]
    scoring, fitness = work.problem.setting.scoring, work.problem.fitness
    return [
        float(fitness.of(s.best_tally[None], scoring)[0]) if len(s.best_tally) else -np.inf
        for s in row
    ]


def _done(row: list[IslandState], work: Work) -> bool:
    return any(state.generation > 0 and work.is_solved(state.best_tally) for state in row)


@dataclass(frozen=True, eq=False)
class _Group:
    """Migrants on their way."""

    work: int
    target: int
    migrants: Migrants


def _departures(busy: list[list[IslandState]], schedule: Schedule, post: Post) -> list[_Group]:
    """Send migrants along all links, by source and then target; those that move are gone then."""
    groups = []
    targets: dict[int, list[int]] = {}
    for source, target in schedule.links:
        targets.setdefault(source, []).append(target)
    for row in busy:
        for source, goals in targets.items():
            state, migration = row[source], schedule.plans[source].migration
            leaving = state.leaving[: migration.number(len(state.genomes))]
            for i, target in enumerate(goals):
                chosen = leaving[i :: len(goals)] if migration.moves else leaving
                if len(chosen):
                    migrants = state.residents.take(chosen)
                    groups.append(_Group(state.work, target, migrants))
                    post(state, target, migrants)
            if migration.moves:
                row[source] = state.without(leaving)
    return groups


def _arrivals(groups: list[_Group]) -> dict[tuple[int, int], Migrants]:
    """Migrants by the work and the island where they arrive, in the order of their sources."""
    together: dict[tuple[int, int], list[Migrants]] = {}
    for group in groups:
        together.setdefault((group.work, group.target), []).append(group.migrants)
    return {place: Migrants.join(some) for place, some in together.items()}
