"""The archipelago: rings of islands, one a work; when migrants travel, and when a work stops."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from islands.archipelago import (
    Result,
    Schedule,
    TimeUpError,
    evolve_archipelago,
)
from islands.executors.local import LocalExecutor
from islands.genetics import Breeding
from islands.integration_ga import Work
from islands.island import IslandPlan, IslandState
from islands.migration import Migrants, Migration
from islands.topology import Topology
from tests.decks import bad_plate
from tests.jobs import problem_of

Move = tuple[int, int, int, int]
"""Work, generation, source, target."""


@dataclass(frozen=True)
class Goal:
    """Stands for a work that is solved once an island has scored so many generations."""

    solved_at: float = np.inf

    def is_solved(self, tally: np.ndarray) -> bool:
        return bool(tally[0] >= self.solved_at)


class ScriptedExecutor:
    """Steps islands without a mesh, in an order of its own, and remembers who arrived when."""

    def __init__(self, order: Sequence[int], error: type[BaseException] | None = None) -> None:
        self.order = order
        self.error = error
        self.arrived: list[tuple[int, int, int, float]] = []
        self.stepped: list[tuple[int, int]] = []

    def open(self, works: Sequence[Goal]) -> None:
        self.works = works

    def advance(
        self, steps: Sequence[tuple[IslandState, Migrants | None]]
    ) -> Iterator[IslandState]:
        for before, immigrants in sorted(steps, key=lambda s: self.order[s[0].island]):
            if self.error and before.generation == 2:
                raise self.error
            if immigrants is not None:
                self.arrived.append(
                    (before.work, before.generation, before.island, float(immigrants.fitness[0]))
                )
            self.stepped.append((before.work, before.generation))
            fitness = 100.0 * before.work + 10.0 * before.generation + before.island
            yield replace(
                before,
                generation=before.generation + 1,
                genomes=np.full((2, 3), before.island),
                fitness=np.full(2, fitness),
                tallies=np.zeros((2, 1)),
                leaving=np.arange(2),
                best_fitness=fitness,
                best_tally=np.array([before.generation + 1.0]),
                evaluations=before.evaluations + 7,
            )

    def close(self) -> None:
        pass


def schedule(
    islands: int,
    generations: int,
    every: int = 1,
    delay: int = 0,
    topology: Topology = Topology(),  # noqa: B008 - a value
    migration: Migration = Migration(),  # noqa: B008
) -> Schedule:
    plan = IslandPlan(Breeding(individuals=3), 3, migration)
    return Schedule((plan,) * islands, generations, topology.links(islands), every, delay)


def evolve(
    order: Sequence[int],
    works: Sequence[Goal] = (Goal(),),
    generations: int = 5,
    error: type[BaseException] | None = None,
    **settings: Any,
) -> tuple[ScriptedExecutor, list[Move], list[tuple[int, int]], Result]:
    executor = ScriptedExecutor(order, error)
    moves: list[Move] = []
    watched: list[tuple[int, int]] = []
    result = evolve_archipelago(
        works,  # type: ignore[arg-type]
        schedule(len(order), generations, every=2, **settings),
        executor,  # type: ignore[arg-type]
        lambda island, states: watched.append((island, len(states))),
        lambda state, target, _: moves.append(
            (state.work, state.generation - 1, state.island, target)
        ),
    )
    return executor, moves, watched, result


def test_migrants_arrive_by_generation_whoever_is_ready_first() -> None:
    one, moves, _, _ = evolve([0, 1, 2])
    other, _, _, _ = evolve([2, 0, 1])
    # after generations 1 and 3, from each island to the next
    assert sorted(one.arrived) == [
        (0, 2, 0, 12.0), (0, 2, 1, 10.0), (0, 2, 2, 11.0),
        (0, 4, 0, 32.0), (0, 4, 1, 30.0), (0, 4, 2, 31.0),
    ]  # fmt: skip
    assert sorted(one.arrived) == sorted(other.arrived)
    assert moves == [(0, g, i, (i + 1) % 3) for g in (1, 3) for i in range(3)]


def test_migrants_stay_within_their_work() -> None:
    executor, moves, watched, result = evolve([0, 1, 2], [Goal(), Goal()])
    assert {(work, int(fitness // 100)) for work, _, _, fitness in executor.arrived} == {
        (0, 0), (1, 1)
    }  # fmt: skip
    alone, _, _, _ = evolve([0, 1, 2])
    assert [a for a in executor.arrived if a[0] == 0] == alone.arrived
    assert len(moves) == 12
    assert watched == [(island, 2) for _ in range(6) for island in range(3)]
    assert [state.work for state in result.best] == [0, 1]
    assert [state.best_fitness for state in result.best] == [52.0, 152.0]
    assert result.evaluations == 2 * 3 * 6 * 7


def test_a_solved_work_stops_and_the_others_go_on() -> None:
    executor, moves, _, result = evolve([0, 1], [Goal(3), Goal(), Goal(1)])
    steps = [executor.stepped.count((work, g)) for work in range(3) for g in range(6)]
    assert steps == [2, 2, 2, 0, 0, 0, 2, 2, 2, 2, 2, 2, 2, 0, 0, 0, 0, 0]
    assert not [move for move in moves if move[0] == 2]
    assert result.status == "finished"


def test_all_works_solved_is_the_end() -> None:
    executor, _, watched, _ = evolve([0, 1], [Goal(1), Goal(1)])
    assert len(executor.stepped) == 4
    assert watched == [(0, 2), (1, 2)]


@pytest.mark.parametrize(
    ("error", "status"), [(TimeUpError, "time-limit"), (KeyboardInterrupt, "interrupted")]
)
def test_what_was_found_until_the_end_is_kept(error: type[BaseException], status: str) -> None:
    _, _, _, result = evolve([0, 1, 2], [Goal(), Goal()], error=error)
    assert result.status == status
    assert [state.generation for state in result.best] == [2, 2]
    assert result.best[0].best_fitness == 12.0


def test_a_work_comes_out_the_same_whatever_is_beside_it() -> None:
    meshes = [bad_plate(4, 3, seed) for seed in (0, 1, 2)]
    works = [Work(problem_of(mesh), mesh) for mesh in meshes]
    plan = schedule(2, 2)

    def best(some: list[Work]) -> list[tuple[float, bytes]]:
        executor = LocalExecutor(plan.plans)
        result = evolve_archipelago(some, plan, executor, lambda *_: None, lambda *_: None)
        return [(state.best_fitness, state.best_tally.tobytes()) for state in result.best]

    together = best(works)
    assert together == [best([work])[0] for work in works]
    assert together[::-1] == best(works[::-1])


@pytest.mark.parametrize("delay", [0, 1, 2])
def test_migrants_of_an_epoch_arrive_a_fixed_number_of_epochs_later(delay: int) -> None:
    executor, moves, _, _ = evolve([2, 0, 1], generations=9, delay=delay)
    for _, generation, island, fitness in executor.arrived:
        sent, source = divmod(fitness % 100, 10)
        assert island == (source + 1) % 3
        assert generation == sent + 1 + 2 * delay
        assert (0, sent, source, island) in moves
    assert {generation for _, generation, _, _ in executor.arrived} == set(
        range(2 + 2 * delay, 10, 2)
    )


def test_what_moves_is_gone_and_goes_to_one_neighbour_alone() -> None:
    star = Topology("star")
    executor, moves, _, _ = evolve([0, 1, 2], generations=2, topology=star,
                                   migration=Migration(count=2, moves=True))  # fmt: skip
    # the middle deals two individuals to two neighbours, each of which sends both of its own
    assert sorted((source, target) for _, _, source, target in moves) == [
        (0, 1), (0, 2), (1, 0), (2, 0)
    ]  # fmt: skip
    assert [island for _, _, island, _ in executor.arrived] == [0, 1, 2]
    state = replace(IslandState.first(0, 0), fitness=np.array([3.0, 4.0]))
    assert state.without(np.array([1])).fitness.tolist() == [3.0, -np.inf]
    assert state.fitness.tolist() == [3.0, 4.0]


def test_without_links_islands_stay_alone() -> None:
    executor, moves, _, _ = evolve([0, 1, 2], topology=Topology("unconnected"))
    assert not executor.arrived
    assert not moves
