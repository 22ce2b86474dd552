"""Procedures and islands: purity, sharing, stopping early, who leaves and who gives way."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from islands.archipelago import Archipelago, Milestone, Schedule, TimeUpError, evolve_archipelagos
from islands.config import Config, load_config
from islands.executors.local import LocalExecutor, LocalRunner
from islands.executors.pool import PoolRunner
from islands.genetics import Breeding
from islands.integration_ga import (
    Evaluator,
    Handle,
    Outcome,
    Problem,
    Task,
    Work,
    Workbench,
    run_task,
)
from islands.island import IslandPlan, IslandState, OwnFitness, step
from islands.migration import Migration
from islands.procedure import perform_steps
from meshops.mesh import ShellMesh
from meshops.operations import NOTHING
from meshops.quality_sums import SHAPE, TALLY_SIZE, TRIAS
from tests.decks import bad_plate
from tests.jobs import problem_of


@pytest.fixture(scope="module")
def mesh() -> ShellMesh:
    return bad_plate()


class CountingRunner:
    """A runner that remembers what it was asked."""

    def __init__(self, problem: Problem) -> None:
        self.inner = LocalRunner(problem, float("inf"))
        self.asked: list[Task] = []

    def run(self, jobs: Sequence[tuple[Task, Handle]]) -> list[tuple[Outcome, Handle, bool]]:
        self.asked += [task for task, _ in jobs]
        return self.inner.run(jobs)


def evaluator(mesh: ShellMesh, **options: object) -> tuple[Evaluator, CountingRunner]:
    changes = {name: options.pop(name) for name in ("improving",) if name in options}
    problem = replace(problem_of(mesh), **changes)
    runner = CountingRunner(problem)
    root = Work(problem, mesh).root
    return Evaluator(problem, runner, root, mesh, **options), runner  # type: ignore[arg-type]


# --- tasks --------------------------------------------------------------------------------------


@pytest.mark.parametrize("code", [0, 1])
def test_a_task_is_a_pure_function(mesh: ShellMesh, code: int) -> None:
    task = Task(mesh.digest, code, 0)
    (one, mesh_one), (two, mesh_two) = (run_task(problem_of(mesh), task, mesh) for _ in range(2))
    assert one.mesh == two.mesh == mesh_one.digest == mesh_two.digest
    assert (one.tally == two.tally).all()
    assert (one.parameters == two.parameters).all()


def test_another_attempt_seed_or_turn_draws_other_numbers(mesh: ShellMesh) -> None:
    problem = replace(problem_of(mesh), improving=False)
    tasks = [(problem, Task(mesh.digest, 0, attempt)) for attempt in range(3)]
    tasks += [(replace(problem, **other), tasks[0][1]) for other in ({"seed": 99}, {"turn": 1})]
    found = [run_task(p, task, mesh)[0].parameters.tobytes() for p, task in tasks]
    assert len(set(found)) == 5


def test_a_workbench_changes_nothing_and_keeps_problems_apart(mesh: ShellMesh) -> None:
    bench = Workbench()
    for problem in (problem_of(mesh), replace(problem_of(mesh), seed=99)):
        assert bench.take(problem, mesh.digest, mesh) is bench.take(problem, mesh.digest, mesh)
        for code in (0, 1):
            task = Task(mesh.digest, code, 0)
            alone, known = run_task(problem, task, mesh), run_task(problem, task, mesh, bench)
            assert alone[0].mesh == known[0].mesh
            assert (alone[0].parameters == known[0].parameters).all()
    assert bench.take(problem_of(mesh), mesh.digest, mesh) is not bench.take(
        problem, mesh.digest, mesh
    )


def test_processes_find_what_one_process_finds(mesh: ShellMesh) -> None:
    problem = problem_of(mesh)
    jobs = [(Task(mesh.digest, code, attempt), mesh) for code in (0, 1) for attempt in (0, 1)]
    pool = PoolRunner(problem, 2, float("inf"), lambda: None)
    there = pool.run(jobs)
    here = LocalRunner(problem, float("inf")).run(jobs)
    late = PoolRunner(problem, 2, 0.0, lambda: None)
    with pytest.raises(TimeUpError):
        late.run(jobs)
    for runner in (pool, late):
        runner.close()
    assert [outcome.mesh for outcome, _, _ in there] == [outcome.mesh for outcome, _, _ in here]
    assert [found.digest for _, found, _ in there] == [found.digest for _, found, _ in here]
    assert not any(found.points.flags.writeable for _, found, _ in there)


def test_genes_are_drawn_as_often_as_their_weight_says(mesh: ShellMesh) -> None:
    problem = problem_of(mesh)
    assert problem.codes == (0, 1, NOTHING)
    drawn = problem.draw(np.random.default_rng(0), 300, 100)
    assert np.bincount(drawn.ravel()) / drawn.size == pytest.approx([1 / 3] * 3, abs=0.01)
    weighted = replace(problem, weights=np.array([0.7, 0.1, 0.2]))
    drawn = weighted.draw(np.random.default_rng(0), 300, 100)
    assert np.bincount(drawn.ravel()) / drawn.size == pytest.approx([0.7, 0.1, 0.2], abs=0.01)


# --- procedures ---------------------------------------------------------------------------------


def test_common_prefixes_are_evaluated_once(mesh: ShellMesh) -> None:
    scorer, runner = evaluator(mesh, improving=False)
    genomes = np.array([[0, 0, 2], [0, 0, 1], [2, 0, 0], [0, 2, 0]])
    scored = scorer.evaluate(genomes)
    assert len(runner.asked) == len(set(runner.asked)) == 3
    assert scored.fitness[0] == scored.fitness[2] == scored.fitness[3]
    assert [step.code for step in scored.steps[3]] == [0, NOTHING, 0]
    performed, evaluations = scorer.performed, scorer.evaluations
    assert performed < evaluations
    scorer.evaluate(genomes)
    assert len(runner.asked) == 3
    assert (scorer.performed, scorer.evaluations) == (performed, 2 * evaluations)


def test_what_was_forgotten_is_found_again_the_same(mesh: ShellMesh) -> None:
    genomes = np.array([[0, 0, 1], [1, 0, 0], [1, 1, 2]])
    remembering, _ = evaluator(mesh)
    expected = remembering.evaluate(genomes).fitness
    forgetful, runner = evaluator(mesh, remembered_bytes=0)
    for _ in range(2):
        assert (forgetful.evaluate(genomes).fitness == expected).all()
    assert len(runner.asked) > len(set(runner.asked))
    remembering.evaluate(genomes)
    assert forgetful.evaluations == remembering.evaluations
    assert forgetful.performed > remembering.performed


def test_doing_nothing_costs_nothing(mesh: ShellMesh) -> None:
    scorer, runner = evaluator(mesh)
    scored = scorer.evaluate(np.full((1, 3), NOTHING))
    assert not runner.asked
    assert scored.steps == [()]
    assert (scored.tallies[0] == scorer.root.tally).all()
    expected = scorer.problem.fitness.of(scored.tallies, scorer.problem.setting.scoring)
    assert scored.fitness[0] == expected[0]


def test_an_operation_has_its_price(mesh: ShellMesh) -> None:
    scorer, _ = evaluator(mesh)
    kind, scoring = scorer.problem.fitness, scorer.problem.setting.scoring
    tally = scorer.root.tally[None]
    assert kind.of(tally, scoring, 1)[0] < kind.of(tally, scoring, 0)[0]


def test_a_procedure_ends_with_its_last_step_that_gains(mesh: ShellMesh) -> None:
    """And its steps make the mesh of its tally."""
    genomes = np.array([[0, 0, 0, 0, 0, 1, 1, 2], [1, 0, 2, 0, 2, 2, 2, 2]])
    scorer, _ = evaluator(mesh)
    scored = scorer.evaluate(genomes)
    fitness, tallies, steps = scored.fitness, scored.tallies, scored.steps
    before = scorer.problem.fitness.of(scorer.root.tally[None], scorer.problem.setting.scoring)[0]
    assert (fitness > before).all()
    for tally, done in zip(tallies, steps, strict=True):
        assert len(done[-1].parameters)
        problem = scorer.problem
        after = perform_steps(mesh, done, problem.operations, problem.setting)
        np.testing.assert_allclose(Work(problem, after).root.tally, tally, rtol=1e-9, atol=1e-8)
    assert len(steps[1]) <= 4


def test_evaluation_stops_where_it_is_enough(mesh: ShellMesh) -> None:
    genomes = np.array([[0, 1, 0, 1], [1, 0, 0, 0]])
    searching, all_asked = evaluator(mesh)
    searching.evaluate(genomes)
    content, asked = evaluator(mesh, is_enough=lambda _: True)
    scored = content.evaluate(genomes)
    assert len(asked.asked) == 2 < len(all_asked.asked)
    assert all(len(done) <= 1 for done in scored.steps)
    assert len(scored.fitness) == 2


def test_a_work_is_solved_with_no_failed_element_and_the_fewest_trias(mesh: ShellMesh) -> None:
    def tally(failed: int, trias: int) -> np.ndarray:
        values = np.zeros(TALLY_SIZE)
        values[[SHAPE, TRIAS]] = failed, trias
        return values

    odd, never = Work(problem_of(mesh), mesh, 1), Work(problem_of(mesh), mesh)
    assert odd.is_solved(tally(0, 1))
    assert odd.is_solved(tally(0, 0))
    assert not odd.is_solved(tally(0, 3))
    assert not odd.is_solved(tally(1, 1))
    assert not never.is_solved(tally(0, 0))


class CrashingRunner(CountingRunner):
    """A runner for which one task has no answer."""

    def __init__(self, problem: Problem, crashing: int) -> None:
        super().__init__(problem)
        self.crashing = crashing

    def run(self, jobs: Sequence[tuple[Task, Handle]]) -> list[tuple[Outcome, Handle, bool]]:
        found = super().run(jobs)
        return [
            (replace(outcome, fault="it crashed", evaluations=0), mesh, was_run)
            if task.code == self.crashing
            else (outcome, mesh, was_run)
            for (task, _), (outcome, mesh, was_run) in zip(jobs, found, strict=True)
        ]


@pytest.mark.parametrize("improving", [True, False])
def test_an_individual_without_an_answer_has_the_worst_fitness_and_its_reason(
    mesh: ShellMesh,
    improving: bool,  # noqa: FBT001
) -> None:
    problem = replace(problem_of(mesh), improving=improving)
    genomes = np.array([[0, 0, 2], [0, 1, 0], [2, 0, 0]])
    root = Work(problem, mesh).root
    scorer = Evaluator(problem, CrashingRunner(problem, 1), root, mesh)
    scored = scorer.evaluate(genomes)
    healthy = Evaluator(problem, LocalRunner(problem, float("inf")), root, mesh).evaluate(genomes)
    assert scored.fitness[1] == -np.inf
    assert np.isnan(scored.tallies[1]).all()
    assert scored.steps[1] == ()
    assert scored.faults == ("it crashed",)
    assert (scored.fitness[[0, 2]] == healthy.fitness[[0, 2]]).all()
    assert healthy.faults == ()
    plan = IslandPlan(Breeding(individuals=6), 3, Migration())
    state = IslandState.first(0, 0)
    for _ in range(4):
        state = step(state, None, scorer, plan)
    assert np.isfinite(state.best_fitness)
    assert np.isfinite(state.fitness).any()


# --- islands ------------------------------------------------------------------------------------


def test_a_generation_is_a_pure_function_of_state_and_immigrants(mesh: ShellMesh) -> None:
    first, _ = evaluator(mesh)
    plan = IslandPlan(Breeding(individuals=4), 3, Migration())
    start = step(IslandState.first(0, 0), None, first, plan)
    immigrants = start.residents.take(start.leaving[:1])
    ahead = step(start, immigrants, first, plan)
    fresh, _ = evaluator(mesh)  # as on a worker that was started anew
    again = step(start, immigrants, fresh, plan)
    assert (ahead.genomes == again.genomes).all()
    assert (ahead.fitness == again.fitness).all()
    assert ahead.best_fitness == again.best_fitness >= start.best_fitness


def test_what_an_island_does_depends_on_its_mesh_and_not_on_the_number_of_its_work(
    mesh: ShellMesh,
) -> None:
    plan = IslandPlan(Breeding(individuals=4), 3, Migration())
    one, other = (
        step(IslandState.first(work, 0), None, evaluator(mesh)[0], plan) for work in (0, 7)
    )
    assert (one.genomes == other.genomes).all()
    assert (one.tallies == other.tallies).all()
    third = step(IslandState.first(0, 1), None, evaluator(mesh)[0], plan)
    assert (one.genomes != third.genomes).any()


def test_an_island_draws_its_own_operations(mesh: ShellMesh) -> None:
    problem = problem_of(mesh)
    name = problem.operations[0].name
    plan = IslandPlan(Breeding(individuals=4), 3, Migration(), operations=(name,))
    drawn = {problem.codes[gene] for gene in step_genes(mesh, plan)}
    assert drawn == {NOTHING, problem.operations[0].code}
    rest = IslandPlan(Breeding(individuals=4), 3, Migration())
    assert len({problem.codes[gene] for gene in step_genes(mesh, rest)}) == len(problem.codes)


def step_genes(mesh: ShellMesh, plan: IslandPlan) -> list[int]:
    genes: list[int] = []
    for island in range(6):
        done = step(IslandState.first(0, island), None, evaluator(mesh)[0], plan)
        genes += done.genomes.ravel().tolist()
    return genes


def test_an_island_with_a_fitness_of_its_own_judges_immigrants_anew(mesh: ShellMesh) -> None:
    scorer, _ = evaluator(mesh)
    usual = IslandPlan(Breeding(individuals=4, elites=4), 3, Migration())
    trias = replace(usual, fitness=OwnFitness(kind="trias"))
    source, target = (
        step(IslandState.first(0, island), None, scorer, plan)
        for island, plan in enumerate((usual, trias))
    )
    np.testing.assert_allclose(target.fitness, 100.0 - target.tallies[:, TRIAS])
    immigrants = source.residents
    after = step(target, immigrants, scorer, trias)
    # all have settled and all are elites
    assert sorted(after.fitness) == sorted(100.0 - immigrants.tallies[:, TRIAS])


def test_the_best_of_islands_that_judge_otherwise_is_the_best_by_the_measure_of_the_run(
    mesh: ShellMesh,
) -> None:
    work = Work(problem_of(mesh), mesh)
    usual = IslandPlan(Breeding(individuals=4), 3, Migration())
    generous = replace(usual, fitness=OwnFitness(kind="trias", price=0.0))
    for plans in ((usual, generous), (generous, usual)):
        schedule = Schedule(plans, 1)
        seen: list[Milestone] = []
        going = Archipelago(0, work, schedule)
        result = evolve_archipelagos([going], LocalExecutor(), seen.append)
        scoring = work.problem.setting.scoring
        tallies = np.stack([state.best_tally for state in seen[-1].islands])
        best = work.problem.fitness.of(tallies, scoring).tolist()
        (found,) = work.problem.fitness.of(result.best[0].best_tally[None], scoring)
        assert found == max(best)


# --- settings -----------------------------------------------------------------------------------


def test_config_of_the_paper() -> None:
    config = load_config(None, {"profile": "paper"})
    assert config.fitness == "trias"
    assert (config.population, config.generations, config.genes) == (10, 10, 10)
    assert (config.crossover, config.mutation, config.elites) == (0.95, 0.05, 0)
    assert config.operation_breeding.individuals == config.operation_breeding.generations == 10
    assert [operation.code for operation in config.operations] == [0, 1]
    assert isinstance(config, Config)


@pytest.mark.parametrize("profile", ["default", "thorough"])
def test_the_plan_has_an_extent_for_each_pair_of_rings_and_elements(profile: str) -> None:
    config = load_config(None, {"profile": profile, "rings": [2, 5], "largest": [30, 90]})
    extents = [(extent.rings, extent.elements) for extent in config.plan.extents]
    assert extents == [(2, 30), (5, 90)]
    assert config.improving
