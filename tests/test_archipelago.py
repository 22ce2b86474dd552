"""The archipelago: who steps when, which migrants arrive, and when a work stops."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from islands.archipelago import (
    Archipelago,
    Milestone,
    Mode,
    Result,
    Schedule,
    TimeUpError,
    evolve_archipelagos,
)
from islands.executors.local import LocalExecutor
from islands.integration_ga import Work
from islands.migration import Migration
from islands.stopping import Stopping
from islands.topology import Topology
from tests.decks import bad_plate
from tests.jobs import problem_of
from tests.scripted import Goal, archipelago, sail, same, schedule, scripted_step


@st.composite
def schedules(draw: st.DrawFn) -> Schedule:
    islands = draw(st.integers(1, 6))
    kinds = ["unconnected", "ring", "two-way-ring", "star", "fully-connected"]
    pairs = st.tuples(st.integers(0, islands - 1), st.integers(0, islands - 1))
    edges = draw(st.lists(pairs.filter(lambda e: e[0] != e[1]), unique=True)) if islands > 1 else []
    topology = draw(
        st.sampled_from([Topology(k) for k in kinds] + [Topology("edges", edges=tuple(edges))] * 3)  # type: ignore[arg-type]
    )
    return schedule(
        islands,
        draw(st.integers(0, 9)),
        draw(st.integers(1, 3)),
        draw(st.integers(0, 3)),
        topology if edges or topology.kind != "edges" else Topology(),
        Migration(count=draw(st.integers(0, 3)), moves=draw(st.booleans())),
        draw(st.sampled_from(["synchronous", "overlapped"])),
    )


@given(schedules(), st.integers(0, 99), st.integers(0, 99), st.integers(1, 10))
def test_the_answer_depends_on_neither_mode_nor_order_nor_interruption(
    plan: Schedule, seed: int, other_seed: int, begun: int
) -> None:
    one = sail(archipelago(plan), np.random.default_rng(seed))
    other_mode: Mode = "overlapped" if plan.mode == "synchronous" else "synchronous"
    other = sail(archipelago(replace(plan, mode=other_mode)), np.random.default_rng(other_seed))
    assert [m.generation for m in one.milestones] == list(range(1, plan.generations + 2))
    assert all(map(same, one.milestones, other.milestones))
    assert one.arrived == other.arrived
    start = one.milestones[min(begun, plan.generations + 1) - 1]
    resumed = Archipelago(0, Goal(), plan, start)  # type: ignore[arg-type]
    rest = sail(resumed, np.random.default_rng(other_seed))
    assert len(rest.milestones) == plan.generations + 1 - start.generation
    assert all(map(same, one.milestones[start.generation :], rest.milestones))


@given(schedules(), st.integers(0, 99))
def test_migrants_of_an_epoch_arrive_at_their_fixed_epoch_exactly_those_as_copies(
    plan: Schedule, seed: int
) -> None:
    done = sail(archipelago(plan), np.random.default_rng(seed))
    scored = {(s.generation, s.island): s for m in done.milestones for s in m.islands}
    expected = []
    for generation in range(plan.every, plan.generations + 1, plan.every):
        arrival = generation + plan.delay * plan.every
        for target in range(plan.islands if arrival <= plan.generations else 0):
            groups: list[float] = []
            for source in sorted(s for s, t in plan.links if t == target):
                targets = sorted(t for s, t in plan.links if s == source)
                migration = plan.plans[source].migration
                leaving = scored[generation, source].fitness[: migration.number(3)]
                if migration.moves:
                    leaving = leaving[targets.index(target) :: len(targets)]
                groups += leaving.tolist()
            if groups:
                expected.append((arrival, target, tuple(groups)))
    assert done.arrived == sorted(expected)
    for milestone in done.milestones:
        for group in milestone.travelling:
            source = scored[group.arrival - plan.delay * plan.every, group.source]
            assert not np.shares_memory(group.migrants.genomes, source.genomes)
            assert not np.shares_memory(group.migrants.fitness, source.fitness)


@given(schedules(), st.integers(0, 99))
def test_what_moves_is_gone_and_nobody_else(plan: Schedule, seed: int) -> None:
    done = sail(archipelago(plan), np.random.default_rng(seed))
    for state, _ in done.asked:
        migration = plan.plans[state.island].migration
        has_left = (
            migration.moves
            and any(source == state.island for source, _ in plan.links)
            and plan.arrival(state.generation) is not None
            and state.generation > 0
        )
        gone = int(np.isneginf(state.fitness).sum())
        assert gone == (migration.number(3) if has_left else 0)


@given(schedules(), st.integers(0, 99))
def test_no_island_is_further_ahead_than_migrants_are_late(plan: Schedule, seed: int) -> None:
    going, rng = archipelago(plan), np.random.default_rng(seed)
    asked, passed = going.ready(), 0
    while asked:
        for state, _ in asked:
            assert state.generation <= passed + plan.lead
        passed += len(list(going.take(scripted_step(asked.pop(int(rng.integers(len(asked))))))))
        asked += going.ready()
    assert passed == plan.generations + 1


def test_an_overlapped_island_does_not_wait_and_a_synchronous_one_does() -> None:
    for mode, ahead in (("synchronous", 1), ("overlapped", 4)):
        going = archipelago(schedule(2, 9, 2, 1, mode=mode))  # type: ignore[arg-type]
        first, _ = going.ready()
        steps = 0
        while first:
            list(going.take(scripted_step(first)))
            steps += 1
            (first,) = going.ready() or [None]  # type: ignore[list-item]
        assert steps == ahead


@pytest.mark.parametrize("mode", ["synchronous", "overlapped"])
@pytest.mark.parametrize("solved_at", [1, 3])
def test_a_solved_work_stops_at_that_generation_however_far_an_island_is(
    mode: Mode, solved_at: int
) -> None:
    plan = schedule(3, 9, 1, 2, mode=mode)
    going = archipelago(plan, Goal(solved_at))
    # island 0 first, as far as it comes
    asked, milestones = going.ready(), []
    while asked:
        asked.sort(key=lambda a: a[0].island)
        milestones += going.take(scripted_step(asked.pop(0)))
        asked += going.ready()
    assert [m.generation for m in milestones] == list(range(1, solved_at + 1))
    assert [m.is_last for m in milestones] == [False] * (solved_at - 1) + [True]
    assert not going.ready()


def test_a_rule_of_stopping_ends_a_work_and_its_reason_is_kept() -> None:
    plan = schedule(2, 9, stopping=Stopping(target=30.0))
    done = sail(archipelago(plan), np.random.default_rng(0))
    assert done.milestones[-1].generation == 4
    (reason,) = done.milestones[-1].reasons
    assert reason.endswith("and 30 was asked for")


# --- several works ------------------------------------------------------------------------------


class ScriptedExecutor:
    """Takes the steps of all archipelagos in turn."""

    def __init__(self, error: type[BaseException] | None = None) -> None:
        self.error = error

    def evolve(self, archipelagos: Sequence[Archipelago]) -> Iterator[Milestone]:
        while asked := [(a, one) for a in archipelagos for one in a.ready()]:
            for going, one in asked:
                if self.error and one[0].generation == 2:
                    raise self.error
                yield from going.take(scripted_step(one))

    def close(self) -> None:
        pass


def evolve(works: Sequence[Goal], error: type[BaseException] | None = None) -> Result:
    plan = schedule(3, 5)
    going = [archipelago(plan, work, number) for number, work in enumerate(works)]
    return evolve_archipelagos(going, ScriptedExecutor(error), lambda _: None)


def test_works_are_evolved_side_by_side_and_summed_up() -> None:
    result = evolve([Goal(), Goal(), Goal(1)])
    assert result.status == "finished"
    assert [state.work for state in result.best] == [0, 1, 2]
    assert [state.generation for state in result.best] == [6, 6, 1]
    assert [state.island for state in result.best] == [2, 2, 2]
    assert result.evaluations == 3 * (6 + 6 + 1) * 7
    assert result.performed == 3 * (6 + 6 + 1) * 5


@pytest.mark.parametrize(
    ("error", "status"), [(TimeUpError, "time-limit"), (KeyboardInterrupt, "interrupted")]
)
def test_what_was_found_until_the_end_is_kept(error: type[BaseException], status: str) -> None:
    result = evolve([Goal(), Goal()], error)
    assert result.status == status
    assert [state.generation for state in result.best] == [2, 2]
    assert result.best[0].best_fitness >= 12.0


def test_what_has_not_begun_has_no_steps() -> None:
    class Late(ScriptedExecutor):
        def evolve(self, archipelagos: Sequence[Archipelago]) -> Iterator[Milestone]:
            raise TimeUpError
            yield

    going = [archipelago(schedule(2, 3))]
    result = evolve_archipelagos(going, Late(), lambda _: None)
    assert (result.status, result.evaluations) == ("time-limit", 0)
    assert result.best[0].best_steps == ()


def test_a_work_comes_out_the_same_whatever_is_beside_it() -> None:
    meshes = [bad_plate(4, 3, seed) for seed in (0, 1, 2)]
    works = [Work(problem_of(mesh), mesh) for mesh in meshes]
    plan = schedule(2, 2, every=1)

    def best(some: list[Work]) -> list[tuple[float, bytes]]:
        going = [Archipelago(number, work, plan) for number, work in enumerate(some)]
        result = evolve_archipelagos(going, LocalExecutor(), lambda _: None)
        return [(state.best_fitness, state.best_tally.tobytes()) for state in result.best]

    together: Any = best(works)
    assert together == [best([work])[0] for work in works]
    assert together[::-1] == best(works[::-1])
