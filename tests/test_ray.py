"""Islands on Ray: the same answer as in one process, and actors that die."""

import pytest

from islands.archipelago import TimeUpError
from islands.integration_ga import Work
from islands.island import IslandState
from islands.run import start_executor
from meshops.mesh import ShellMesh
from tests.decks import bad_plate
from tests.jobs import finish, job, whole_job


@pytest.fixture(scope="module")
def mesh() -> ShellMesh:
    return bad_plate()


@pytest.fixture(scope="module")
def ray_here():  # type: ignore[no-untyped-def]
    ray = pytest.importorskip("ray")
    from islands.executors.ray import connect

    connect(None)
    yield ray
    ray.shutdown()


@pytest.mark.parametrize("islands", [1, 2, 4])
def test_one_procedure_for_the_whole_mesh(ray_here, mesh: ShellMesh, islands: int) -> None:  # type: ignore[no-untyped-def]
    here = finish(whole_job(mesh, islands=islands))
    there = finish(whole_job(mesh, islands=islands, backend="ray"))
    assert there.mesh.digest == here.mesh.digest
    assert there.text == here.text
    assert there.fitness == here.fitness


@pytest.mark.parametrize("islands", [2, 3])
def test_rounds_over_all_bad_places(ray_here, mesh: ShellMesh, islands: int) -> None:  # type: ignore[no-untyped-def]
    here = finish(job(mesh, islands=islands))
    there = finish(job(mesh, islands=islands, backend="ray"))
    assert there.mesh.digest == here.mesh.digest
    assert there.text == here.text
    assert there.procedure.result == here.procedure.result


@pytest.mark.parametrize("works", [1, 5])
def test_an_actor_that_dies_is_asked_again(ray_here, mesh: ShellMesh, works: int) -> None:  # type: ignore[no-untyped-def]
    meshes = [mesh, *(bad_plate(4, 3, seed) for seed in range(works - 1))]
    islands = [(work, island) for work in range(works) for island in range(2)]

    def second_generation(backend: str, *, killing: bool) -> dict[tuple[int, int], IslandState]:
        of = whole_job(mesh, islands=2, backend=backend)
        executor = start_executor(of, float("inf"))
        executor.open([Work(of.problem, each) for each in meshes])
        states = {key: IslandState.first(*key) for key in islands}
        try:
            for generation in range(2):
                steps = [(states[key], None) for key in islands]
                for after in executor.advance(steps):
                    states[after.work, after.island] = after
                if killing and generation == 0:
                    ray_here.kill(next(iter(executor._actors.values())))  # type: ignore[attr-defined]
        finally:
            executor.close()
        return states

    got = second_generation("ray", killing=True)
    expected = second_generation("local", killing=False)
    for key in islands:
        assert got[key].generation == 2
        assert (got[key].genomes == expected[key].genomes).all()
        assert (got[key].fitness == expected[key].fitness).all()


def test_the_time_limit_holds_on_ray(ray_here, mesh: ShellMesh) -> None:  # type: ignore[no-untyped-def]
    work = job(mesh, backend="ray", slide=False)
    executor = start_executor(work, -1.0)
    executor.open([Work(work.problem, mesh)])
    with pytest.raises(TimeUpError):
        list(executor.advance([(IslandState.first(0, 0), None)]))
    done = finish(work, executor=executor)
    assert done.status == "time-limit"
    assert done.mesh.digest == mesh.digest
