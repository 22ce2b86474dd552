"""Evolution of procedures: purity, sharing, migration, the same answer on every backend."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from islands.archipelago import Migration, Result, evolve_archipelago
from islands.config import Config, load_config
from islands.executors.local import LocalExecutor, LocalRunner, root_outcome
from islands.genetics import Breeding
from islands.integration_ga import Evaluator, Handle, Outcome, Problem, Task, run_task
from islands.island import IslandState, Migrants, emigrants, settle, step
from islands.procedure import perform
from islands.run import Finished, Job, run, start_executor
from islands.topology import ring
from meshops.criteria import PAPER
from meshops.mesh import ShellMesh
from meshops.operations import NOTHING
from tests.decks import bad_plate
from tracking.events import Event, GenerationReport, MigrationReport, RunFinished, RunStarted

SMALL = {
    "size": 5.0,
    "criteria": "paper",
    "population": 4,
    "generations": 2,
    "genes": 3,
    "operation-population": 4,
    "operation-generations": 1,
}


@pytest.fixture(scope="module")
def mesh() -> ShellMesh:
    return bad_plate()


def job(mesh: ShellMesh, **settings: object) -> Job:
    given = SMALL | {name.replace("_", "-"): value for name, value in settings.items()}
    return Job.of("plate", mesh, PAPER, load_config(None, given))


def finish(work: Job, events: list[Event] | None = None) -> Finished:
    executor = start_executor(work, float("inf"))
    try:
        return run(work, executor, (events if events is not None else []).append, 0.0)
    finally:
        executor.close()


class CountingRunner:
    """A runner that remembers what it was asked."""

    def __init__(self, problem: Problem) -> None:
        self.inner = LocalRunner(problem, float("inf"))
        self.asked: list[Task] = []

    def run(self, jobs: Sequence[tuple[Task, Handle]]) -> list[tuple[Outcome, Handle]]:
        self.asked += [task for task, _ in jobs]
        return self.inner.run(jobs)


def evaluator(work: Job) -> tuple[Evaluator, CountingRunner]:
    runner = CountingRunner(work.problem)
    root = root_outcome(work.problem, work.mesh)
    return Evaluator(work.problem, runner, root, work.mesh), runner


def test_a_task_is_a_pure_function(mesh: ShellMesh) -> None:
    work = job(mesh)
    for code in (0, 1):
        task = Task(mesh.digest, code, 0)
        (one, mesh_one), (two, mesh_two) = (run_task(work.problem, task, mesh) for _ in range(2))
        assert one.mesh == two.mesh == mesh_one.digest == mesh_two.digest
        assert (one.tally == two.tally).all()
        assert (one.parameters == two.parameters).all()


def test_another_attempt_or_seed_draws_other_numbers(mesh: ShellMesh) -> None:
    problem = job(mesh).problem
    others = [(problem, Task(mesh.digest, 1, attempt)) for attempt in range(3)]
    others.append((replace(problem, seed=99), Task(mesh.digest, 1, 0)))
    found = [run_task(p, task, mesh)[0].parameters.tobytes() for p, task in others]
    assert len(set(found)) >= 3


def test_common_prefixes_are_evaluated_once(mesh: ShellMesh) -> None:
    scorer, runner = evaluator(job(mesh))
    genomes = np.array([[0, 0, 2], [0, 0, 1], [2, 0, 0], [0, 2, 0]])
    fitness, _, steps = scorer.evaluate(genomes)
    assert len(runner.asked) == len(set(runner.asked)) == 3
    assert fitness[0] == fitness[2] == fitness[3]
    assert [step.code for step in steps[3]] == [0, NOTHING, 0]
    scorer.evaluate(genomes)
    assert len(runner.asked) == 3


def test_what_was_forgotten_is_found_again_the_same(
    mesh: ShellMesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    genomes = np.array([[0, 0, 1], [1, 0, 0], [1, 1, 2]])
    remembering, _ = evaluator(job(mesh))
    expected = remembering.evaluate(genomes)[0]
    monkeypatch.setattr("islands.integration_ga.REMEMBERED_BYTES", 0)
    forgetful, runner = evaluator(job(mesh))
    for _ in range(2):
        assert (forgetful.evaluate(genomes)[0] == expected).all()
    assert len(runner.asked) > len(set(runner.asked))


def test_doing_nothing_costs_nothing(mesh: ShellMesh) -> None:
    scorer, runner = evaluator(job(mesh))
    fitness, tallies, _ = scorer.evaluate(np.full((1, 3), NOTHING))
    assert not runner.asked
    assert (tallies[0] == scorer.root.tally).all()
    assert fitness[0] == scorer.problem.fitness.of(tallies, scorer.problem.setting.scoring)[0]


def test_an_operation_has_its_price(mesh: ShellMesh) -> None:
    scorer, _ = evaluator(job(mesh))
    kind, scoring = scorer.problem.fitness, scorer.problem.setting.scoring
    tally = scorer.root.tally[None]
    assert kind.of(tally, scoring, 1)[0] < kind.of(tally, scoring, 0)[0]


def test_the_best_procedure_makes_the_reported_mesh(mesh: ShellMesh) -> None:
    events: list[Event] = []
    work = job(mesh, islands=2)
    done = finish(work, events)
    last = [e for e in events if isinstance(e, GenerationReport) and e.generation == 2]
    best = max(last, key=lambda e: e.best_so_far)
    assert (best.trias, best.failed) == (done.after.trias, done.after.failed)
    assert best.compound_qi == pytest.approx(done.after.compound_qi, rel=1e-9)
    assert done.fitness == best.best_so_far
    assert done.after.failed < done.before.failed
    again = perform(mesh, done.procedure.steps, work.problem.operations, work.problem.setting)
    assert again.digest == done.mesh.digest == done.procedure.result


def test_every_generation_of_every_island_is_reported(mesh: ShellMesh) -> None:
    events: list[Event] = []
    finish(job(mesh, islands=3), events)
    assert isinstance(events[0], RunStarted)
    assert isinstance(events[-1], RunFinished)
    reports = [e for e in events if isinstance(e, GenerationReport)]
    assert sorted((e.island, e.generation) for e in reports) == [
        (i, g) for i in range(3) for g in range(3)
    ]
    for island in range(3):
        best = [e.best_so_far for e in reports if e.island == island]
        assert best == sorted(best)


def test_seeds_repeat_and_differ(mesh: ShellMesh) -> None:
    curves: list[list[float]] = []
    for seed in (1, 1, 2):
        events: list[Event] = []
        finish(job(mesh, seed=seed), events)
        curves.append([e.mean for e in events if isinstance(e, GenerationReport)])
    assert curves[0] == curves[1] != curves[2]


def test_more_generations_continue_the_same_search(mesh: ShellMesh) -> None:
    short: list[Event] = []
    long: list[Event] = []
    finish(job(mesh, generations=1), short)
    finish(job(mesh, generations=2), long)
    figures = [
        [
            (e.island, e.generation, e.best, e.mean)
            for e in events
            if isinstance(e, GenerationReport)
        ]
        for events in (short, long)
    ]
    assert figures[0] == [figure for figure in figures[1] if figure[1] < 2]


def test_ring_sends_each_island_to_the_next() -> None:
    assert ring(1) == []
    assert ring(3) == [(0, 1), (1, 2), (2, 0)]


def state(island: int, fitness: list[float]) -> IslandState:
    genomes = np.arange(3 * len(fitness)).reshape(-1, 3)
    return replace(
        IslandState.first(island), generation=1, genomes=genomes, fitness=np.array(fitness)
    )


def test_the_best_leave_as_copies_and_replace_the_worst() -> None:
    source, target = state(0, [1.0, 9.0, 5.0]), state(1, [4.0, 2.0, 3.0])
    leaving = emigrants(source, 2)
    assert leaving.fitness.tolist() == [9.0, 5.0]
    leaving.genomes[:] = -7
    assert (source.genomes >= 0).all()
    settled = settle(target, leaving)
    assert settled.fitness.tolist() == [4.0, 9.0, 5.0]
    assert target.fitness.tolist() == [4.0, 2.0, 3.0]
    assert settle(target, None).fitness.tolist() == [4.0, 2.0, 3.0]


class ScriptedExecutor:
    """Steps islands without a mesh, in an order of its own, and remembers who arrived when."""

    def __init__(self, order: list[int]) -> None:
        self.order = order
        self.arrived: list[tuple[int, int, float]] = []

    def advance(self, steps: Sequence[tuple[IslandState, Migrants | None]]):  # type: ignore[no-untyped-def]
        for island in self.order:
            before, immigrants = steps[island]
            if immigrants is not None:
                self.arrived.append((before.generation, island, float(immigrants.fitness[0])))
            yield replace(
                state(island, [float(10 * before.generation + island)] * 2),
                generation=before.generation + 1,
                best_fitness=float(before.generation),
            )

    def close(self) -> None:
        pass


def migrate(order: list[int]) -> tuple[ScriptedExecutor, list[Event], Result]:
    executor, events = ScriptedExecutor(order), []  # type: ignore[var-annotated]
    result = evolve_archipelago(
        3,
        5,
        Migration(every=2, count=1),
        executor,
        events.append,
        _report,  # type: ignore[arg-type]
    )
    return executor, events, result


def _report(of: IslandState) -> GenerationReport:
    return GenerationReport(of.island, of.generation, 0, 0, 0, 0, 0, 0, 0.0, 0, 0.0, "")


def test_migrants_arrive_by_generation_whoever_is_ready_first() -> None:
    one, events, _ = migrate([0, 1, 2])
    other, _, _ = migrate([2, 0, 1])
    # after generations 1 and 3, from each island to the next
    assert sorted(one.arrived) == [
        (2, 0, 12.0), (2, 1, 10.0), (2, 2, 11.0), (4, 0, 32.0), (4, 1, 30.0), (4, 2, 31.0)
    ]  # fmt: skip
    assert sorted(one.arrived) == sorted(other.arrived)
    moves = [(e.generation, e.source, e.target) for e in events if isinstance(e, MigrationReport)]
    assert moves == [(1, 0, 1), (1, 1, 2), (1, 2, 0), (3, 0, 1), (3, 1, 2), (3, 2, 0)]


def test_a_generation_is_a_pure_function_of_state_and_immigrants(mesh: ShellMesh) -> None:
    work = job(mesh)
    first, _ = evaluator(work)
    breeding = Breeding(individuals=4)
    start = step(IslandState.first(0), None, first, breeding, 3)
    ahead = step(start, None, first, breeding, 3)
    fresh, _ = evaluator(work)  # as on a worker that was started anew
    again = step(start, None, fresh, breeding, 3)
    assert (ahead.genomes == again.genomes).all()
    assert (ahead.fitness == again.fitness).all()
    assert ahead.best_fitness == again.best_fitness


def test_the_time_limit_ends_a_run_with_the_best_so_far(mesh: ShellMesh) -> None:
    work = job(mesh, time_limit=60.0)
    executor = LocalExecutor(work.problem, mesh, work.config.breeding, 3, deadline=-1.0)
    done = run(work, executor, [].append, 0.0)
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


def test_a_default_run_never_makes_a_mesh_worse(mesh: ShellMesh) -> None:
    for operation in ("remesh", "replace-node"):
        done = finish(job(mesh, operation=operation, generations=1, population=2, islands=1))
        assert (done.after.failed, done.after.trias) <= (done.before.failed, done.before.trias)


@pytest.fixture(scope="module")
def ray_here():  # type: ignore[no-untyped-def]
    ray = pytest.importorskip("ray")
    from islands.executors.ray import connect

    connect(None)
    yield ray
    ray.shutdown()


@pytest.mark.parametrize("islands", [1, 2, 4])
def test_ray_and_local_give_the_same_digest(ray_here, mesh: ShellMesh, islands: int) -> None:  # type: ignore[no-untyped-def]
    here = finish(job(mesh, islands=islands))
    there = finish(job(mesh, islands=islands, backend="ray"))
    assert there.mesh.digest == here.mesh.digest
    assert there.text == here.text
    assert there.fitness == here.fitness


def test_an_actor_that_dies_is_asked_again(ray_here, mesh: ShellMesh) -> None:  # type: ignore[no-untyped-def]
    work = job(mesh, islands=2, backend="ray")
    executor = start_executor(work, float("inf"))
    states = [IslandState.first(i) for i in range(2)]
    try:
        for after in executor.advance([(s, None) for s in states]):
            states[after.island] = after
        ray_here.kill(executor._actors[0])  # type: ignore[attr-defined]
        second = {s.island: s for s in executor.advance([(s, None) for s in states])}
    finally:
        executor.close()
    local = start_executor(job(mesh, islands=2), float("inf"))
    expected = {s.island: s for s in local.advance([(s, None) for s in states])}
    for island in range(2):
        assert (second[island].genomes == expected[island].genomes).all()
        assert (second[island].fitness == expected[island].fitness).all()


def test_config_of_the_paper() -> None:
    config = load_config(None, {"profile": "paper"})
    assert config.fitness == "trias"
    assert (config.population, config.generations, config.genes) == (10, 10, 10)
    assert (config.crossover, config.mutation, config.elites) == (0.95, 0.05, 0)
    assert config.operation_breeding.individuals == config.operation_breeding.generations == 10
    assert isinstance(config, Config)
