"""Islands whose steps follow a script: archipelagos without a mesh."""

from dataclasses import dataclass, replace

import numpy as np

from islands.archipelago import Archipelago, Asked, Milestone, Mode, Schedule
from islands.genetics import Breeding
from islands.island import IslandPlan, IslandState
from islands.migration import Migration
from islands.stopping import Stopping
from islands.topology import Topology
from meshops.quality_sums import TALLY_SIZE


@dataclass(frozen=True)
class Goal:
    """Stands for a work that is solved once an island has scored so many generations."""

    solved_at: float = np.inf
    is_whole: bool = False

    def is_solved(self, tally: np.ndarray) -> bool:
        return bool(tally[0] >= self.solved_at)


def scripted_step(asked: Asked) -> IslandState:
    """Step an island without a mesh: who it is and what has arrived decides all that follows."""
    before, immigrants = asked
    heard = 0.0
    if immigrants is not None:
        heard = float(immigrants.fitness @ np.arange(1.0, len(immigrants.fitness) + 1))
    fitness = 100.0 * before.work + 10.0 * before.generation + before.island + heard * 1e-3
    tally = np.zeros(TALLY_SIZE)
    tally[0] = before.generation + 1.0
    return replace(
        before,
        generation=before.generation + 1,
        genomes=np.full((3, 3), before.island) + np.arange(3)[:, None],
        fitness=fitness - np.arange(3.0),
        tallies=np.zeros((3, TALLY_SIZE)),
        leaving=np.arange(3),
        best_fitness=fitness,
        best_tally=tally,
        evaluations=before.evaluations + 7,
        performed=before.performed + 5,
    )


def schedule(
    islands: int,
    generations: int,
    every: int = 2,
    delay: int = 0,
    topology: Topology = Topology(),  # noqa: B008 - a value
    migration: Migration = Migration(),  # noqa: B008
    mode: Mode = "synchronous",
    stopping: Stopping = Stopping(),  # noqa: B008
) -> Schedule:
    plan = IslandPlan(Breeding(individuals=3), 3, migration)
    links = topology.links(islands)
    return Schedule((plan,) * islands, generations, links, every, delay, stopping, mode)


def archipelago(plan: Schedule, work: Goal = Goal(), number: int = 0) -> Archipelago:
    return Archipelago(number, work, plan)  # type: ignore[arg-type]


@dataclass
class Voyage:
    """An archipelago that has gone its way, in an order that chance or a list has chosen."""

    milestones: list[Milestone]
    asked: list[Asked]

    @property
    def arrived(self) -> list[tuple[int, int, tuple[float, ...]]]:
        """Generation, island, and fitness of who arrived."""
        return sorted(
            (state.generation, state.island, tuple(migrants.fitness.tolist()))
            for state, migrants in self.asked
            if migrants is not None
        )

    @property
    def moves(self) -> list[tuple[int, int, int]]:
        """After how many generations, from where to where."""
        return [(m.generation, g.source, g.target) for m in self.milestones for g in m.left]


def sail(going: Archipelago, rng: np.random.Generator, most: int = 10**6) -> Voyage:
    """Take the steps in any order, with as many at the same time as there can be."""
    done, asked = Voyage([], []), going.ready()
    while asked and len(done.milestones) < most:
        chosen = asked.pop(int(rng.integers(len(asked))))
        done.asked.append(chosen)
        done.milestones += going.take(scripted_step(chosen))
        asked += going.ready()
    return done


def same(one: Milestone, other: Milestone) -> bool:
    """Whether two milestones hold the same, and what goes on from them will be the same."""

    def content(milestone: Milestone) -> list[object]:
        return [
            milestone.generation,
            milestone.is_last,
            milestone.reasons,
            [state.fitness.tolist() for state in milestone.islands],
            [(group.key, group.migrants.fitness.tolist()) for group in milestone.travelling],
            [group.key for group in milestone.left],
        ]

    return content(one) == content(other)
