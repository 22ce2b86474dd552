"""What is guaranteed where workers crash, hang, run out of memory or are killed, on Ray.

The answer is that of the run that nothing has disturbed; an individual that ends its process each
time has the worst fitness, everywhere the same.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import pytest

from benchmarks.killing import Killer
from islands.integration_ga import BYTES_AN_ELEMENT, REMEMBERED_BYTES, Task
from islands.run import Finished, Job
from meshops.mesh import ShellMesh
from tests.decks import bad_plate
from tests.faulty import Faulty, Harm
from tests.jobs import finish, job, whole_job
from tracking.events import Event, FaultReport

ray = pytest.importorskip("ray")

ALWAYS = 10**6

SHARE, WHOLE_SHARE = 10, 2
"""Harm is done on one mesh of so many; on every other one of a whole mesh, as there are few."""

Make = Callable[..., Job]


@pytest.fixture(scope="module", autouse=True)
def _ray_here() -> Iterator[None]:
    from islands.executors.ray import connect

    connect(None, 2)
    yield
    ray.shutdown()


@pytest.fixture(scope="module")
def mesh() -> ShellMesh:
    return bad_plate()


def with_faults(of: Job, harm: Harm, times: int, folder: Path) -> Job:
    """Every operation of a job does harm on some meshes, so many times."""
    folder.mkdir(exist_ok=True)
    share = WHOLE_SHARE if of.config.profile == "paper" else SHARE
    operations = tuple(
        Faulty(o, harm, share, times, str(folder), os.getpid()) for o in of.problem.operations
    )  # fmt: skip
    return replace(of, problem=replace(of.problem, operations=operations))


def faults_of(events: list[Event]) -> list[tuple[int, int, str]]:
    return [(e.generation, e.island, e.reason) for e in events if isinstance(e, FaultReport)]


@pytest.fixture(scope="module")
def sound(mesh: ShellMesh, tmp_path_factory: pytest.TempPathFactory) -> dict[Make, Finished]:
    """What the same operations lead to in one process, without any harm."""
    folder = tmp_path_factory.mktemp("none")
    return {
        make: finish(with_faults(make(mesh, islands=2), "none", 0, folder))
        for make in (job, whole_job)
    }


SLOW_JOB = pytest.param(job, marks=pytest.mark.slow)


@pytest.mark.parametrize(
    ("make", "harm"),
    [
        (job, "crash"),
        (whole_job, "crash"),
        pytest.param(job, "hang", marks=pytest.mark.slow),
        (whole_job, "hang"),
        pytest.param(job, "memory", marks=pytest.mark.slow),
        (whole_job, "memory"),
    ],
)
def test_what_a_second_try_mends_leaves_no_trace(
    mesh: ShellMesh, sound: dict[Make, Finished], tmp_path: Path, make: Make, harm: Harm
) -> None:
    """Some processes die, and the answer is the same."""
    limit = 5.0 if harm == "hang" else 600.0
    of = make(mesh, islands=2, backend="ray", evaluation_limit=limit)
    faulty = with_faults(of, harm, 1, tmp_path / "harm")
    events: list[Event] = []
    done = finish(faulty, events)
    assert list((tmp_path / "harm").iterdir())
    assert done.mesh.digest == sound[make].mesh.digest
    assert done.text == sound[make].text
    assert done.evaluations == sound[make].evaluations
    assert faults_of(events) == []


@pytest.mark.parametrize("make", [SLOW_JOB, whole_job])
def test_an_individual_that_always_crashes_has_the_worst_fitness_and_the_run_goes_on(
    mesh: ShellMesh, sound: dict[Make, Finished], tmp_path: Path, make: Make
) -> None:
    runs = []
    for workers in (1, 2):
        of = make(mesh, islands=2, backend="ray", workers=workers)
        faulty = with_faults(of, "crash", ALWAYS, tmp_path / str(workers))
        events: list[Event] = []
        runs.append((finish(faulty, events), faults_of(events)))
    (one, faults), (other, other_faults) = runs
    assert one.status == "finished"
    assert one.mesh.digest == other.mesh.digest
    assert one.text == other.text
    assert faults == other_faults != []
    assert all("has ended its process 4 times" in reason for _, _, reason in faults)


def test_a_ledger_forgets_no_task_that_runs_and_counts_each_submission_for_itself(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Islands that ask for the same task at the same time are no sign of a crash."""
    from islands.executors import ledger

    given: list[ledger.Ticket] = []

    class Remote:
        def remote(self, _: object, ticket: ledger.Ticket, *__: object) -> tuple[object, object]:
            given.append(ticket)
            return object(), object()

    here = SimpleNamespace(current_actor=None)
    monkeypatch.setattr(ledger, "_run_remotely", Remote())
    monkeypatch.setattr(ledger.ray, "get_runtime_context", lambda: here)
    book = ledger._Ledger(1.0)
    elements = int(REMEMBERED_BYTES / BYTES_AN_ELEMENT / 2)  # so large that two are remembered
    parcel = ledger.Parcel(0, b"problem", b"mesh", elements, {"is_whole": True})
    tasks = [Task(str(number), 0, 0) for number in range(10)]
    for _ in range(3):
        for task in tasks:
            book.ask(parcel, [(task, None)])
    assert len(given) == len(tasks)
    assert {book.begin(ticket) for ticket in given} == {1}
    for ticket in given:
        book.end(ticket)
    for task in tasks:
        book.ask(parcel, [(task, None)])
    assert len(given) == 2 * len(tasks) - 1  # nearly all had been forgotten by the next one
    assert book.begin(given[-1]) == 1
    assert [book.begin(given[-1]) for _ in range(4)] == [2, 3, 4, 5]
    book.forget(parcel, tasks[-1:])
    book.ask(parcel, [(tasks[-1], None)])
    assert book.begin(given[-1]) == 1


@pytest.mark.parametrize(
    ("make", "names", "seconds", "most"),
    [
        (job, ("ray::_Host", "ray::_run"), 3.0, 9),
        (whole_job, ("ray::_Host",), 3.0, 9),
        (whole_job, ("ray::_run",), 2.0, 9),
        (whole_job, ("ray::_Ledger",), 5.0, 2),
    ],
)
def test_processes_that_are_killed_at_any_moment_leave_no_trace(
    mesh: ShellMesh,
    sound: dict[Make, Finished],
    tmp_path: Path,
    make: Make,
    names: tuple[str, ...],
    seconds: float,
    most: int,
) -> None:
    of = with_faults(make(mesh, islands=2, backend="ray"), "none", 0, tmp_path)
    events: list[Event] = []
    with Killer(os.getpid(), seconds, names, most) as killer:
        done = finish(of, events)
    assert killer.killed
    assert done.mesh.digest == sound[make].mesh.digest
    assert done.text == sound[make].text
    assert faults_of(events) == []
