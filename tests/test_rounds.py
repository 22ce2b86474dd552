"""Rounds: what a run over all bad places keeps, how it ends, and that it can be done again."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
import pytest

from benchmarks.measures import singular_nodes
from islands.archipelago import Archipelago, Milestone, TimeUpError
from islands.executors.local import LocalExecutor
from islands.procedure import Place, Procedure, Round, Step, perform
from islands.rates import adapted_rates, credits_of, first_credit, named_rates
from islands.rounds import LEADING, moving_on
from islands.run import Finished, run
from meshops.examples import plate
from meshops.mesh import ShellMesh
from meshops.operations import ALL_OPERATIONS
from meshops.quality_sums import SHAPE_FAILED, TALLY_SIZE, TRIAS
from meshops.subdomain import Extent
from tests.decks import bad_plate
from tests.jobs import faults, finish, job, problem_of
from tests.measures import barriers
from tests.meshes import cylinder, joined, rib, shaped, sheet, with_, with_random_locks
from tests.wholeness import (
    assert_ids_are_kept,
    assert_nothing_locked_has_changed,
    assert_sound,
    assert_zones_are_whole,
)
from tracking.events import Event, GenerationReport, RoundReport

Events = list[Event]


@pytest.fixture(scope="module")
def mesh() -> ShellMesh:
    return bad_plate()


@pytest.fixture(scope="module")
def finished(mesh: ShellMesh) -> tuple[Finished, Events]:
    events: Events = []
    return finish(job(mesh, slide=False), events), events


def replayed(mesh: ShellMesh, done: Finished) -> ShellMesh:
    """The mesh that the run's procedure makes, after a journey through JSON."""
    text = done.procedure.to_json(ALL_OPERATIONS)
    procedure = Procedure.from_json(text, ALL_OPERATIONS, "procedure.json")
    assert procedure.to_json(ALL_OPERATIONS) == text
    assert procedure.text(ALL_OPERATIONS) == done.text
    setting = procedure.setting(mesh)
    return perform(mesh, procedure.rounds, ALL_OPERATIONS, setting)


def tall(mesh: ShellMesh) -> ShellMesh:
    """Elements of 5 by 5, as the jobs are for."""
    return with_(mesh, points=5.0 * mesh.points)


def with_a_fault_for_ever(mesh: ShellMesh) -> ShellMesh:
    """Two locked nodes of the border nearly touch: no operation can mend the quad there."""
    points = mesh.points.copy()
    points[1] = points[0] + (0.0, 0.2, 0.0)
    locked = np.zeros(len(points), bool)
    locked[:2] = True
    return with_(mesh, points=points, locked_nodes=locked)


# --- what comes out -----------------------------------------------------------------------------


def test_the_plate_of_the_paper_is_solved() -> None:
    mesh = plate()
    events: Events = []
    done = finish(job(mesh, seed=1), events)
    assert (done.after.failed, done.after.trias) in [(0, 0), (0, 1)]
    assert done.status == "finished"
    assert events[-1].reason == "nothing is left to gain"  # type: ignore[union-attr]
    assert barriers(done.mesh) == barriers(mesh)
    assert_sound(done.mesh)
    assert replayed(mesh, done).digest == done.mesh.digest


@pytest.mark.parametrize(
    "part",
    [
        tall(with_random_locks(sheet(9, 7, seed=1, jitter=0.3, trias=0.3), np.random.default_rng(0),
                               nodes=0.08, elements=0.08)),
        tall(cylinder(sheet(8, 6, seed=2, jitter=0.2, trias=0.3))),
        tall(joined(shaped(sheet(6, 3, seed=3, jitter=0.2, trias=0.4),
                           lambda x, y: (x, y - 3, 0 * x)),
                    sheet(6, 3, seed=4, jitter=0.2, trias=0.4), rib(3, 2, at=0.0, start=1.0))),
    ],
    ids=["locks", "cylinder", "rib"],
)  # fmt: skip
def test_a_part_gets_better_and_all_that_is_to_stay_stays(part: ShellMesh) -> None:
    done = finish(job(part, rounds=6, slide=False))
    assert faults(done.mesh) < faults(part)
    assert set(done.mesh.element_ids[~np.isin(done.mesh.element_ids, part.element_ids)]) <= {0}
    assert_nothing_locked_has_changed(part, done.mesh)
    assert_ids_are_kept(part, done.mesh)
    assert_zones_are_whole(part, done.mesh, area=0.05)
    assert barriers(done.mesh) == barriers(part)
    assert replayed(part, done).digest == done.mesh.digest


def test_the_best_of_all_rounds_is_kept(mesh: ShellMesh, finished: tuple[Finished, Events]) -> None:
    done, events = finished
    rounds = [e for e in events if isinstance(e, RoundReport)]
    figures = [(e.failed, e.trias) for e in rounds]
    assert faults(done.mesh) == (done.after.failed, done.after.trias) == min(figures)
    assert figures[len(done.procedure.rounds) - 1] == min(figures) < faults(mesh)
    # rounds after that only tidy
    assert len(done.procedure.rounds) >= 1 + figures.index(min(figures))


def test_a_mesh_without_fault_is_left_alone() -> None:
    mesh = tall(sheet(5, 4))
    events: Events = []
    done = finish(job(mesh), events)
    assert done.mesh.digest == mesh.digest
    assert done.procedure.rounds == ()
    assert events[-1].reason == "nothing is left to gain"  # type: ignore[union-attr]
    assert replayed(mesh, done).digest == mesh.digest


def test_patience_ends_where_nothing_more_can_be_gained() -> None:
    """And what was tried in vain after the last gain is no part of the procedure."""
    mesh = with_a_fault_for_ever(bad_plate())
    events: Events = []
    done = finish(
        job(mesh, patience=2, rings=[2, 4], largest=[20, 60], tidy=0, slide=False), events
    )
    assert "brought no gain" in events[-1].reason  # type: ignore[union-attr]
    assert (1, 0) <= faults(done.mesh) < faults(mesh)
    rounds = [e for e in events if isinstance(e, RoundReport)]
    assert {e.rings for e in rounds if e.turn >= len(LEADING)} == {2, 4}
    assert len(done.procedure.rounds) <= len(rounds) < 40
    assert faults(done.mesh) == min((e.failed, e.trias) for e in rounds)
    assert replayed(mesh, done).digest == done.mesh.digest
    assert_nothing_locked_has_changed(mesh, done.mesh)


def test_the_rounds_of_a_run_can_be_limited(mesh: ShellMesh) -> None:
    events: Events = []
    done = finish(job(mesh, rounds=1, tidy=0, slide=False), events)
    assert len(done.procedure.rounds) == 1
    assert finish(job(mesh, rounds=0)).mesh.digest == mesh.digest


# --- the same again -----------------------------------------------------------------------------


def test_a_procedure_comes_back_from_json_and_makes_the_same_mesh(
    mesh: ShellMesh, finished: tuple[Finished, Events]
) -> None:
    assert replayed(mesh, finished[0]).digest == finished[0].mesh.digest
    assert finished[0].procedure.result == finished[0].mesh.digest


def test_the_same_seed_makes_the_same_mesh_in_any_batches(
    mesh: ShellMesh, finished: tuple[Finished, Events], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("islands.rounds.BATCH", 2)
    again = finish(job(mesh, slide=False))
    assert again.mesh.digest == finished[0].mesh.digest
    assert again.text == finished[0].text


def test_another_seed_searches_otherwise(
    mesh: ShellMesh, finished: tuple[Finished, Events]
) -> None:
    assert finish(job(mesh, seed=2, slide=False)).mesh.digest != finished[0].mesh.digest


# --- how it ends --------------------------------------------------------------------------------


class EndingExecutor(LocalExecutor):
    """Ends within a round, as the clock or the user would."""

    def __init__(self, error: type[BaseException], rounds: int) -> None:
        super().__init__()
        self.error = error
        self.left = rounds

    def evolve(self, archipelagos: Sequence[Archipelago]) -> Iterator[Milestone]:
        self.left -= 1
        for number, archipelago in enumerate(archipelagos):
            if self.left <= 0 and number == len(archipelagos) // 2:
                raise self.error
            yield from super().evolve([archipelago])


@pytest.mark.parametrize("rounds", [1, 2])
@pytest.mark.parametrize(
    ("error", "status"), [(TimeUpError, "time-limit"), (KeyboardInterrupt, "interrupted")]
)
def test_an_end_before_the_end_keeps_what_was_done(
    mesh: ShellMesh, error: type[BaseException], status: str, rounds: int
) -> None:
    done = finish(job(mesh, slide=False), executor=EndingExecutor(error, rounds))
    assert done.status == status
    assert faults(done.mesh) < faults(mesh)
    assert replayed(mesh, done).digest == done.mesh.digest


@pytest.mark.parametrize("number", [0, 1])
def test_an_interrupt_between_two_generations_keeps_what_was_done(
    mesh: ShellMesh, finished: tuple[Finished, Events], number: int
) -> None:
    """Where rounds are short, Ctrl-C mostly comes while one is told, stitched or cut out."""
    rounds = [event for event in finished[1] if isinstance(event, RoundReport)]

    def record(event: Event) -> None:
        if isinstance(event, RoundReport) and event.turn == rounds[number].turn:
            raise KeyboardInterrupt

    work = job(mesh, slide=False)
    executor = LocalExecutor()
    try:
        done = run(work, executor, record, 0.0)
    except KeyboardInterrupt:
        pytest.fail("the interruption has taken the whole run with it")
    assert done.status == "interrupted"
    assert len(done.procedure.rounds) in (number, number + 1)
    assert faults(done.mesh) <= faults(mesh)
    assert replayed(mesh, done).digest == done.mesh.digest


def test_without_any_time_the_mesh_stays_as_it_is(mesh: ShellMesh) -> None:
    work = job(mesh, time_limit=60.0, slide=False)
    executor = LocalExecutor(deadline=-1.0)
    done = finish(work, executor=executor)
    assert done.status == "time-limit"
    assert done.mesh.digest == mesh.digest == replayed(mesh, done).digest


# --- what is told -------------------------------------------------------------------------------


def test_rounds_and_generations_are_told_in_order(finished: tuple[Finished, Events]) -> None:
    done, events = finished
    rounds = [e for e in events if isinstance(e, RoundReport)]
    kept = done.procedure.rounds
    assert [e.turn for e in rounds[: len(kept)]] == [r.turn for r in kept]
    assert [e.places for e in rounds[: len(kept)]] == [len(r.places) for r in kept]
    assert all(e.places >= e.changed >= e.solved for e in rounds)
    for island in range(2):
        reports = [e for e in events if isinstance(e, GenerationReport) and e.island == island]
        numbers = [e.generation for e in reports]
        assert numbers == sorted(set(numbers))
        best = [e.best_so_far for e in reports]
        assert best == pytest.approx(sorted(best))
    assert rounds[-1].evaluations == done.evaluations
    evaluations = [e.evaluations for e in rounds]
    assert evaluations == sorted(evaluations)


def test_the_rates_that_are_told_are_those_that_were_adapted(
    finished: tuple[Finished, Events],
) -> None:
    rates = [e.rates for e in finished[1] if isinstance(e, RoundReport)]
    names = {operation.name for operation in job(bad_plate(), slide=False).problem.operations} | {
        "nothing"
    }
    for each in rates:
        assert set(each) == names
        assert sum(each.values()) == pytest.approx(1.0, abs=1e-2)
    begun = job(bad_plate(), slide=False).problem
    first = named_rates(replace(begun, weights=adapted_rates(first_credit(begun))))
    assert first["remesh"] > first["swap-edge"] > 0
    assert rates[0]["remesh"] == rates[0]["anneal"] == 0 < rates[0]["swap-edge"]


def test_after_the_small_edits_rates_are_those_of_experience() -> None:
    events: Events = []
    finish(job(with_a_fault_for_ever(bad_plate()), rounds=5, slide=False), events)
    rates = [e.rates for e in events if isinstance(e, RoundReport) and e.turn >= len(LEADING)]
    assert rates[0]["remesh"] > rates[0]["swap-edge"] > 0
    assert rates[0]["anneal"] > 0


# --- rates --------------------------------------------------------------------------------------


@pytest.mark.parametrize("credit", [[0, 0, 0, 0], [5, 0, 0, 0], [1, 2, 3, 4], [0, 1e-9, 0, 0]])
def test_rates_are_shares_and_nothing_is_given_up(credit: list[float]) -> None:
    rates = adapted_rates(np.array(credit, float))
    assert rates.sum() == pytest.approx(1.0)
    assert rates.min() > 0.05
    assert (np.argsort(rates, kind="stable") == np.argsort(credit, kind="stable")).all()


def test_what_never_paid_off_is_drawn_less_than_before() -> None:
    assert adapted_rates(np.zeros(4)).tolist() == [0.25] * 4
    assert adapted_rates(np.array([0.0, 9.0, 0.0, 0.0]))[0] < 0.25


def test_credit_is_for_steps_that_did_something(mesh: ShellMesh) -> None:
    some, none = np.ones((1, 2), np.int32), np.zeros((0, 2), np.int32)
    places = (
        Place((0.0, 0.0, 0.0), (Step(0, some), Step(2, none), Step(1, none), Step(0, some))),
        Place((0.0, 0.0, 0.0), (Step(1, some),)),
        Place((0.0, 0.0, 0.0), ()),
    )
    credit = credits_of(Round(Extent(2, 9), 0, places), problem_of(mesh))
    assert credit.tolist() == [2, 1, 0]


# --- which fault comes first --------------------------------------------------------------------


@pytest.mark.parametrize(
    ("cycle", "failed", "trias", "kind"),
    [(0, 1, 9, "quality"), (0, 0, 9, "quads"), (1, 3, 2, "quads"), (2, 0, 3, "quality")],
)
def test_trias_come_first_where_nothing_fails_and_then_both_faults_in_turn(
    cycle: int, failed: int, trias: int, kind: str
) -> None:
    tally = np.zeros(TALLY_SIZE)
    tally[[SHAPE_FAILED, TRIAS]] = failed, trias
    problem = moving_on(problem_of(plate()), cycle, tally)
    assert problem.fitness.kind == kind
    assert problem.drifts == (cycle > 0)


def test_dense_faults_get_larger_subdomains_at_once() -> None:
    def first_rings(part: ShellMesh) -> int:
        events: Events = []
        finish(job(part, rounds=4, slide=False, tidy=0), events)
        rounds = [event for event in events if isinstance(event, RoundReport)]
        assert [event.rings for event in rounds[:1]] == [LEADING[0].rings]
        return next(event.rings for event in rounds if event.turn >= len(LEADING))

    rings = job(plate()).config.rings
    assert first_rings(tall(sheet(12, 12, seed=5, trias=0.5))) == rings[2]
    assert first_rings(with_a_fault_for_ever(plate())) == rings[0]


# --- a better flow ------------------------------------------------------------------------------


def test_rounds_for_a_better_flow_leave_fewer_irregular_nodes_and_no_fault() -> None:
    mesh = plate()
    plain, flowing = finish(job(mesh, tidy=0)), finish(job(mesh, flow=4, tidy=0))
    assert faults(flowing.mesh) <= faults(plain.mesh)
    assert singular_nodes(flowing.mesh) < singular_nodes(plain.mesh)
    assert [r.aim for r in flowing.procedure.rounds].count("flow") > 0
    assert barriers(flowing.mesh) == barriers(mesh)
    assert_sound(flowing.mesh)
    assert replayed(mesh, flowing).digest == flowing.mesh.digest


def test_tidying_leaves_fewer_irregular_nodes_than_a_repair_alone() -> None:
    mesh = plate()
    plain, tidied = finish(job(mesh, tidy=0)), finish(job(mesh))
    assert faults(tidied.mesh) <= faults(plain.mesh)
    assert singular_nodes(tidied.mesh) < singular_nodes(plain.mesh)
    assert [r.aim for r in tidied.procedure.rounds].count("tidy") > 0
    assert_sound(tidied.mesh)
    assert replayed(mesh, tidied).digest == tidied.mesh.digest


def test_without_rounds_for_flow_a_mesh_without_faults_stays_as_it_is() -> None:
    mesh = tall(sheet(6, 5, seed=1, jitter=0.1))
    assert faults(mesh) == (0, 0)
    assert finish(job(mesh)).mesh.digest == mesh.digest
