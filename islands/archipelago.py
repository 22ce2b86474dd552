"""Archipelago: islands that evolve side by side and exchange their best individuals.

What is promised: what becomes of an archipelago follows from its work and its schedule alone, in
whatever order and wherever its islands take their steps. Migrants leave at the end of an epoch as
copies, arrive a fixed number of epochs later, exactly those, and in the order of their sources.
What is not promised: how far islands that need not wait are ahead of each other at any moment.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol

import numpy as np

from islands.finishing import Piece
from islands.integration_ga import Work
from islands.island import IslandPlan, IslandState, OwnFitness
from islands.migration import Migrants
from islands.stopping import Stopping
from islands.topology import Link
from meshops.mesh import Ids

Status = Literal["finished", "time-limit", "interrupted"]

Mode = Literal["synchronous", "overlapped"]


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
    mode : "synchronous" or "overlapped"
        Whether all islands begin a generation together, or each as soon as the migrants are known
        that arrive before it. The answer is the same.
    """

    plans: tuple[IslandPlan, ...]
    generations: int
    links: tuple[Link, ...] = ()
    every: int = 1
    delay: int = 0
    stopping: Stopping = field(default_factory=Stopping)
    mode: Mode = "synchronous"

    @property
    def islands(self) -> int:
        """Of each work."""
        return len(self.plans)

    @property
    def lead(self) -> int:
        """Generations that an island may be ahead of the slowest."""
        return 0 if self.mode == "synchronous" else self.every * (self.delay + 1)

    def arrival(self, generation: int) -> int | None:
        """Tell before which generation those arrive that leave after so many; None: nobody does."""
        if generation % self.every:
            return None
        arrival = generation + self.delay * self.every
        return arrival if arrival <= self.generations else None

    def departure(self, generation: int) -> int | None:
        """Tell after how many generations those left that arrive before this one; None: nobody."""
        left = generation - self.delay * self.every
        return left if left > 0 and left % self.every == 0 else None


@dataclass(frozen=True, eq=False)
class Group:
    """Migrants on their way from one island to another.

    Attributes
    ----------
    source, target : int
    arrival : int
        The generation before which they arrive.
    migrants : Migrants
    """

    source: int
    target: int
    arrival: int
    migrants: Migrants

    @property
    def key(self) -> tuple[int, int, int]:
        """When and where they arrive, and from where."""
        return self.arrival, self.target, self.source


@dataclass(frozen=True, eq=False)
class Milestone:
    """An archipelago when all of its islands have scored as many generations: it can go on from it.

    Attributes
    ----------
    work : int
        The number of its work.
    islands : tuple of IslandState
        Before those leave that move.
    left : tuple of Group
        Who has just left.
    travelling : tuple of Group
        All who are on their way, these among them.
    is_last : bool
    reasons : tuple of str
        Why it is the last one before the last generation, where a rule of stopping said so.
    piece : Piece or None
        What becomes of the mesh, polished, where it is the last one of a part of a mesh and its
        executor has found that out.
    """

    work: int
    islands: tuple[IslandState, ...]
    left: tuple[Group, ...]
    travelling: tuple[Group, ...]
    is_last: bool
    reasons: tuple[str, ...]
    piece: Piece | None = None

    @property
    def generation(self) -> int:
        """How many generations are scored."""
        return self.islands[0].generation


Asked = tuple[IslandState, Migrants | None]
"""A step that an island is to take, and who arrives before it."""


class Archipelago:
    """The islands of one work on their way.

    It says which steps can be taken, and is told what came of them; it takes none itself.

    Parameters
    ----------
    number : int
        Of the work.
    work : Work
    schedule : Schedule
    begun : Milestone or None
        What it goes on from.
    """

    def __init__(
        self, number: int, work: Work, schedule: Schedule, begun: Milestone | None = None
    ) -> None:
        self.number = number
        self.work = work
        self.schedule = schedule
        self.begun = begun
        self.is_over = begun is not None and begun.is_last
        self._targets: dict[int, list[int]] = {}
        self._sources: dict[int, list[int]] = {}
        for source, target in sorted(schedule.links):
            self._targets.setdefault(source, []).append(target)
            self._sources.setdefault(target, []).append(source)
        self._asked: set[int] = set()
        self._scored: dict[int, dict[int, IslandState]] = {}
        self._travelling: dict[tuple[int, int, int], Group] = {}
        if begun is None:
            self._passed = 0
            self._states = [IslandState.first(number, i) for i in range(schedule.islands)]
            return
        self._passed = begun.generation
        self._states = [self._without_movers(state) for state in begun.islands]
        for group in begun.travelling:
            self._travelling[group.key] = group

    def ready(self) -> list[Asked]:
        """Return the steps that can be taken now and were not given out before."""
        if self.is_over:
            return []
        steps: list[Asked] = []
        for state in self._states:
            if state.island not in self._asked and self._can_step(state):
                self._asked.add(state.island)
                steps.append((state, self._arrivals(state)))
        return steps

    def take(self, state: IslandState) -> Iterator[Milestone]:
        """Take an island after its step; milestones that are reached by it come in order."""
        self._asked.discard(state.island)
        self._scored.setdefault(state.generation, {})[state.island] = state
        for group in self._departures(state):
            self._travelling[group.key] = group
        self._states[state.island] = self._without_movers(state)
        while not self.is_over and len(self._scored.get(self._passed + 1, ())) == len(self._states):
            self._passed += 1
            yield self._milestone(self._scored.pop(self._passed))

    def fittest(self, milestone: Milestone) -> IslandState:
        """Return the island that has seen the fittest procedure, the first of equals.

        By the run's measure, where islands have their own.
        """
        islands = milestone.islands
        if all(plan.fitness == OwnFitness() for plan in self.schedule.plans):
            return islands[int(np.argmax([state.best_fitness for state in islands]))]
        tallies, problem = np.stack([state.best_tally for state in islands]), self.work.problem
        return islands[int(np.argmax(problem.fitness.of(tallies, problem.setting.scoring)))]

    def _can_step(self, state: IslandState) -> bool:
        generation = state.generation
        if generation > self.schedule.generations:
            return False
        if generation - self._passed > self.schedule.lead:
            return False
        left = self.schedule.departure(generation)
        sources = self._sources.get(state.island, ())
        return left is None or all(self._states[s].generation >= left for s in sources)

    def _arrivals(self, state: IslandState) -> Migrants | None:
        """Who arrives, in the order of the sources."""
        sources = self._sources.get(state.island, ())
        keys = [(state.generation, state.island, source) for source in sources]
        groups = [self._travelling[key].migrants for key in keys if key in self._travelling]
        return Migrants.join(groups) if groups else None

    def _departures(self, state: IslandState) -> Iterator[Group]:
        """Send migrants along all links of an island."""
        arrival = self.schedule.arrival(state.generation)
        if arrival is None:
            return
        moves, leaving = self._leaving(state)
        targets = self._targets.get(state.island, ())
        for i, target in enumerate(targets):
            chosen = leaving[i :: len(targets)] if moves else leaving
            if len(chosen):
                yield Group(state.island, target, arrival, state.residents.take(chosen))

    def _leaving(self, state: IslandState) -> tuple[bool, Ids]:
        migration = self.schedule.plans[state.island].migration
        return migration.moves, state.leaving[: migration.number(len(state.genomes))]

    def _without_movers(self, state: IslandState) -> IslandState:
        """Return an island as it goes on: those that move are gone then."""
        moves, leaving = self._leaving(state)
        has_left = self.schedule.arrival(state.generation) is not None
        is_source = state.island in self._targets
        return state.without(leaving) if moves and has_left and is_source else state

    def _milestone(self, scored: dict[int, IslandState]) -> Milestone:
        islands = tuple(scored[island] for island in range(len(self._states)))
        passed, schedule = self._passed, self.schedule
        # an island that is ahead has sent some already that this milestone knows nothing of
        travelling = [
            group
            for key, group in sorted(self._travelling.items())
            if group.arrival - schedule.delay * schedule.every <= passed <= group.arrival
        ]
        left = [g for g in travelling if schedule.arrival(passed) == g.arrival]
        self._travelling = {k: g for k, g in self._travelling.items() if g.arrival >= passed}
        reasons = tuple(schedule.stopping.of_both(islands))
        is_solved = any(self.work.is_solved(state.best_tally) for state in islands)
        self.is_over = bool(is_solved or reasons or passed > schedule.generations)
        left.sort(key=lambda group: (group.source, group.target))
        return Milestone(
            self.number, islands, tuple(left), tuple(travelling), self.is_over, reasons
        )


def evolve_in_turn(
    archipelago: Archipelago, step: Callable[[IslandState, Migrants | None], IslandState]
) -> Iterator[Milestone]:
    """Take all steps of an archipelago here, one after the other."""
    while asked := archipelago.ready():
        for state, immigrants in asked:
            if not archipelago.is_over:
                yield from archipelago.take(step(state, immigrants))


class Executor(Protocol):
    """Where islands run. The rest of the program does not know which executor it has."""

    def evolve(self, archipelagos: Sequence[Archipelago]) -> Iterator[Milestone]:
        """Take all steps of all archipelagos, which are numbered by their place in the list.

        Milestones of one archipelago come in order, the last one with its piece unless the work is
        a whole mesh. Raises TimeUpError where the run's time is up; last milestones that were
        reached by then come before, if need be without their pieces.
        """

    def close(self) -> None:
        """Free what the executor holds."""


class TimeUpError(Exception):
    """The run's time limit was reached within a generation."""


@dataclass(frozen=True, eq=False)
class Result:
    """How archipelagos ended.

    Attributes
    ----------
    best : tuple of IslandState
        Of each work the island with the fittest procedure; the first of equals.
    evaluations, performed : int
        Individuals of operation GAs that procedures asked for, and that were scored for that.
    status : "finished", "time-limit" or "interrupted"
    reasons : tuple of str
        Why the first work ended before its last generation, where a rule of stopping said so.
    pieces : tuple of (Piece or None)
        What becomes of the mesh of each work, polished, where that is known.
    """

    best: tuple[IslandState, ...]
    evaluations: int
    performed: int
    status: Status
    reasons: tuple[str, ...] = ()
    pieces: tuple[Piece | None, ...] = ()


def evolve_archipelagos(
    archipelagos: Sequence[Archipelago],
    executor: Executor,
    watch: Callable[[Milestone], None],
) -> Result:
    """Evolve archipelagos to their ends; `watch` is told of each milestone.

    Time limit and interruption end all of them with the best that was found until then.
    """
    status: Status = "finished"
    reached = {a.number: a.begun for a in archipelagos if a.begun is not None}
    try:
        for milestone in executor.evolve(archipelagos):
            reached[milestone.work] = milestone
            watch(milestone)
    except TimeUpError:
        status = "time-limit"
    except KeyboardInterrupt:
        status = "interrupted"
    best = [
        archipelago.fittest(reached[number]) if number in reached else IslandState.first(number, 0)
        for number, archipelago in enumerate(archipelagos)
    ]
    states = [state for milestone in reached.values() for state in milestone.islands]
    return Result(
        tuple(best),
        sum(state.evaluations for state in states),
        sum(state.performed for state in states),
        status,
        reached[0].reasons if 0 in reached else (),
        tuple(reached[n].piece if n in reached else None for n in range(len(archipelagos))),
    )
