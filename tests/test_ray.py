"""Islands on Ray: the same answer as in one process, with any number of CPUs and in both modes."""

from collections.abc import Iterator

import pytest

from islands.archipelago import Archipelago, Executor, Mode, TimeUpError
from islands.executors.local import LocalExecutor
from islands.integration_ga import Work
from islands.run import start_executor
from meshops.mesh import ShellMesh
from tests.decks import bad_plate
from tests.jobs import finish, job, whole_job

ray = pytest.importorskip("ray")


@pytest.fixture(scope="module")
def mesh() -> ShellMesh:
    return bad_plate()


@pytest.fixture(scope="module", params=[1, 4])
def cpus(request: pytest.FixtureRequest) -> Iterator[int]:
    """A Ray with so many CPUs, whatever the machine has."""
    from islands.executors.ray import connect

    connect(None, request.param)
    yield request.param
    ray.shutdown()


@pytest.mark.parametrize(
    "settings",
    [
        {"islands": 1},
        {"islands": 2},
        {"islands": 5, "mode": "overlapped", "migration_delay": 1},
        {"islands": 3, "mode": "overlapped", "topology": "fully-connected"},
    ],
)
def test_one_procedure_for_the_whole_mesh(
    cpus: int, mesh: ShellMesh, settings: dict[str, object]
) -> None:
    here = finish(whole_job(mesh, **settings))
    there = finish(whole_job(mesh, backend="ray", **settings))
    assert there.mesh.digest == here.mesh.digest
    assert there.text == here.text
    assert there.fitness == here.fitness
    assert there.evaluations == here.evaluations
    # islands share what they ask for, as they do in one process
    assert there.performed == here.performed < here.evaluations


@pytest.mark.parametrize("mode", ["synchronous", "overlapped"])
@pytest.mark.parametrize("islands", [2, 3])
def test_rounds_over_all_bad_places(cpus: int, mesh: ShellMesh, islands: int, mode: Mode) -> None:
    here = finish(job(mesh, islands=islands))
    there = finish(job(mesh, islands=islands, mode=mode, backend="ray"))
    assert there.mesh.digest == here.mesh.digest
    assert there.text == here.text
    assert there.procedure.result == here.procedure.result
    assert there.evaluations == here.evaluations


def test_the_time_limit_holds_on_ray(cpus: int, mesh: ShellMesh) -> None:
    work = job(mesh, backend="ray", slide=False)
    executor = start_executor(work, -1.0)
    archipelagos = [
        Archipelago(number, Work(work.problem, mesh), work.config.schedule)
        for number in range(2 * cpus - 1)
    ]
    with pytest.raises(TimeUpError):
        list(executor.evolve(archipelagos))
    done = finish(work, executor=executor)
    assert done.status == "time-limit"
    assert done.mesh.digest == mesh.digest


def test_pieces_are_finished_where_they_were_found(cpus: int, mesh: ShellMesh) -> None:
    work = job(mesh, islands=3)
    schedule = work.config.schedule

    def pieces(executor: Executor, count: int) -> list[str]:
        archipelagos = [Archipelago(n, Work(work.problem, mesh), schedule) for n in range(count)]
        last = [milestone for milestone in executor.evolve(archipelagos) if milestone.is_last]
        assert len(last) == count
        return [m.piece.mesh.digest for m in last if m.piece is not None]

    here = pieces(LocalExecutor(), 1)
    there = start_executor(job(mesh, backend="ray"), float("inf"))
    try:
        for count in (1, cpus + 1):  # islands shared out, and whole archipelagos
            assert pieces(there, count) == here * count
    finally:
        there.close()
