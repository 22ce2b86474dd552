"""Runs on the whole mesh, as in the paper: one procedure, or one operation GA alone."""

import pytest

from islands.executors.local import LocalExecutor
from islands.procedure import perform
from meshops.mesh import ShellMesh
from tests.decks import bad_plate
from tests.jobs import finish, job, whole_job
from tracking.events import Event, GenerationReport, MigrationReport, RunFinished, RunStarted


@pytest.fixture(scope="module")
def mesh() -> ShellMesh:
    return bad_plate()


def test_the_best_procedure_makes_the_reported_mesh(mesh: ShellMesh) -> None:
    events: list[Event] = []
    work = whole_job(mesh, islands=2, fitness="quality")
    done = finish(work, events)
    last = [e for e in events if isinstance(e, GenerationReport) and e.generation == 2]
    best = max(last, key=lambda e: e.best_so_far)
    assert (best.trias, best.failed) == (done.after.trias, done.after.failed)
    assert best.compound_qi == pytest.approx(done.after.compound_qi, rel=1e-9)
    assert best.procedure == done.text
    again = perform(mesh, done.procedure.rounds, work.problem.operations, work.problem.setting)
    assert again.digest == done.mesh.digest == done.procedure.result


def test_every_generation_of_every_island_is_reported(mesh: ShellMesh) -> None:
    events: list[Event] = []
    finish(whole_job(mesh, islands=3), events)
    assert isinstance(events[0], RunStarted)
    assert isinstance(events[-1], RunFinished)
    reports = [e for e in events if isinstance(e, GenerationReport)]
    assert sorted((e.island, e.generation) for e in reports) == [
        (i, g) for i in range(3) for g in range(3)
    ]
    for island in range(3):
        best = [e.best_so_far for e in reports if e.island == island]
        assert best == sorted(best)
    moves = [(e.generation, e.source, e.target) for e in events if isinstance(e, MigrationReport)]
    assert moves == [(g, i, (i + 1) % 3) for g in (0, 1) for i in range(3)]


def test_seeds_repeat_and_differ(mesh: ShellMesh) -> None:
    curves: list[list[float]] = []
    for seed in (1, 1, 2):
        events: list[Event] = []
        finish(whole_job(mesh, seed=seed), events)
        curves.append([e.mean for e in events if isinstance(e, GenerationReport)])
    assert curves[0] == curves[1] != curves[2]


def test_more_generations_continue_the_same_search(mesh: ShellMesh) -> None:
    figures = []
    for generations in (1, 2):
        events: list[Event] = []
        finish(whole_job(mesh, generations=generations), events)
        reports = [e for e in events if isinstance(e, GenerationReport)]
        figures.append([(e.island, e.generation, e.best, e.mean) for e in reports])
    assert figures[0] == [figure for figure in figures[1] if figure[1] < 2]


def test_the_time_limit_ends_a_run_with_the_best_so_far(mesh: ShellMesh) -> None:
    work = whole_job(mesh, time_limit=60.0)
    done = finish(work, executor=LocalExecutor(deadline=-1.0))
    assert done.status == "time-limit"
    assert done.mesh.digest == mesh.digest


@pytest.mark.parametrize("operation", ["remesh", "replace-node"])
def test_one_operation_ga_alone(mesh: ShellMesh, operation: str) -> None:
    events: list[Event] = []
    work = job(mesh, operation=operation, profile="paper", generations=3, population=8, islands=1)
    done = finish(work, events)
    reports = [e for e in events if isinstance(e, GenerationReport)]
    assert [e.generation for e in reports] == [0, 1, 2, 3]
    assert done.fitness == 100 - done.after.trias == reports[-1].best_so_far
    assert done.evaluations == 4 * 8
    assert reports[-1].failed == done.after.failed
    again = perform(mesh, done.procedure.rounds, work.problem.operations, work.problem.setting)
    assert again.digest == done.mesh.digest


@pytest.mark.parametrize("operation", ["remesh", "replace-node"])
def test_one_operation_alone_never_makes_a_mesh_worse(mesh: ShellMesh, operation: str) -> None:
    done = finish(job(mesh, operation=operation, generations=1, population=2, islands=1))
    assert (done.after.failed, done.after.trias) <= (done.before.failed, done.before.trias)
