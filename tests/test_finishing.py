"""Finishing: what a procedure leads to is remembered, polished, and the same on all backends."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from islands import finishing
from islands.archipelago import Archipelago, Milestone
from islands.executors.local import LocalExecutor, LocalRunner
from islands.finishing import Piece, finished, polish_for
from islands.integration_ga import Evaluator, Work
from islands.procedure import perform_steps
from meshops.mesh import ShellMesh
from meshops.operations.smooth import Smoothing
from meshops.quality_sums import FAILED, TRIAS
from meshops.workpiece import Workpiece
from tests.decks import bad_plate
from tests.jobs import job, problem_of


@pytest.fixture(scope="module")
def mesh() -> ShellMesh:
    return bad_plate()


def scorer_of(work: Work, remembered_bytes: float = 1e8) -> Evaluator:
    runner = LocalRunner(work.problem, float("inf"))
    return Evaluator(work.problem, runner, work.root, work.mesh, remembered_bytes=remembered_bytes)


def performed(work: Work, piece: Piece) -> ShellMesh:
    problem = work.problem
    return perform_steps(work.mesh, piece.steps, problem.operations, problem.setting)


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    seed=st.integers(0, 10**6),
    improving=st.booleans(),
    drifts=st.booleans(),
    is_paper=st.booleans(),
)
def test_what_is_remembered_of_a_procedure_is_what_performing_it_makes(
    seed: int, *, improving: bool, drifts: bool, is_paper: bool
) -> None:
    mesh = bad_plate()
    problem = replace(problem_of(mesh), improving=improving, drifts=drifts, seed=seed)
    if not is_paper:  # among the others are those that remember their edits
        problem = replace(problem, operations=job(mesh).problem.operations)
    work = Work(problem, mesh)
    scorer = scorer_of(work)
    genomes = problem.draw(np.random.default_rng(seed), 4, 5)
    for steps in scorer.evaluate(genomes).steps:
        found = scorer.mesh_after(steps)
        assert found is not None
        assert found.digest == performed(work, Piece(steps, mesh)).digest


def test_what_is_forgotten_is_performed(mesh: ShellMesh) -> None:
    work = Work(problem_of(mesh), mesh)
    genomes = work.problem.draw(np.random.default_rng(3), 4, 5)
    forgetful = scorer_of(work, remembered_bytes=0.0)
    steps = max(forgetful.evaluate(genomes).steps, key=len)
    assert forgetful.mesh_after(steps) is None
    known = scorer_of(work)
    known.evaluate(genomes)
    assert finished(work, steps).mesh.digest == known.mesh_after(steps).digest != mesh.digest


@pytest.mark.parametrize("polish", [("even",), ("laplace", "even")])
def test_polish_does_no_harm_and_can_be_performed(
    mesh: ShellMesh, polish: tuple[Smoothing, ...]
) -> None:
    operations = job(mesh).problem.operations
    work = Work(replace(problem_of(mesh), operations=operations), mesh)
    steps = scorer_of(work).evaluate(work.problem.draw(np.random.default_rng(1), 1, 4)).steps[0]
    plain, polished = finished(work, steps), finished(replace(work, polish=polish), steps)
    assert len(polished.steps) > len(plain.steps)
    assert performed(work, polished).digest == polished.mesh.digest
    before, after = (Workpiece(p.mesh, work.problem.setting).tally for p in (plain, polished))
    assert after[FAILED] <= before[FAILED]
    assert after[TRIAS] == before[TRIAS]


def test_no_polish_where_smoothing_is_not_asked_for(mesh: ShellMesh) -> None:
    assert polish_for("flow", problem_of(mesh).operations) == ()
    assert polish_for("faults", job(mesh).problem.operations) == ("even",)
    assert polish_for("flow", job(mesh).problem.operations) == ("laplace", "even")


def test_nothing_done_leaves_the_mesh(mesh: ShellMesh) -> None:
    piece = finished(Work(problem_of(mesh), mesh, polish=("even",)), ())
    assert piece.steps == ()
    assert piece.mesh is mesh


def test_the_last_milestone_alone_has_the_piece(mesh: ShellMesh) -> None:
    work = Work(problem_of(mesh), mesh)
    schedule = replace(job(mesh).config.schedule, generations=2)
    archipelago = Archipelago(0, work, schedule)
    *others, last = list[Milestone](LocalExecutor().evolve([archipelago]))
    assert others
    assert all(milestone.piece is None for milestone in others)
    assert last.piece is not None
    assert last.piece.mesh.digest == performed(work, last.piece).digest
    assert last.piece.steps[: len(archipelago.fittest(last).best_steps)] == (
        archipelago.fittest(last).best_steps
    )


def test_where_islands_run_nothing_is_performed_again(
    mesh: ShellMesh, monkeypatch: pytest.MonkeyPatch
) -> None:
    def never(*_: object) -> ShellMesh:
        raise AssertionError("performed again")

    monkeypatch.setattr(finishing, "perform_steps", never)
    archipelago = Archipelago(0, Work(problem_of(mesh), mesh), job(mesh).config.schedule)
    *_, last = LocalExecutor().evolve([archipelago])
    assert last.piece is not None
    assert last.piece.mesh.digest != mesh.digest
