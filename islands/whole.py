"""The whole mesh as one place, as in the paper: one procedure, or one operation GA alone."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace

import numpy as np

from islands.archipelago import (
    Archipelago,
    Executor,
    Milestone,
    Schedule,
    Status,
    evolve_archipelagos,
)
from islands.config import Config
from islands.integration_ga import Problem, Work
from islands.island import IslandState
from islands.operation_ga import generations
from islands.procedure import Place, Round, Step, perform_steps
from islands.reporter import Reporter
from islands.search import Evolution, Watchers
from meshops.mesh import ShellMesh
from meshops.workpiece import Workpiece
from tracking.events import Event


def evolve_whole(
    problem: Problem,
    mesh: ShellMesh,
    schedule: Schedule,
    executor: Executor,
    watch: Watchers,
    begun: Milestone | None = None,
) -> Evolution:
    """Evolve one procedure for the whole mesh, from a milestone on where one is given."""
    work = Work(problem, mesh, is_whole=True)
    reporter = _reporter(work, watch.record, watch.started, begun.generation if begun else 0)

    def follow(milestone: Milestone) -> None:
        reporter.watch(milestone)
        watch.keep(milestone)

    result = evolve_archipelagos([Archipelago(0, work, schedule, begun)], executor, follow)
    done = _evolution(work, result.best[0].best_steps, result.evaluations, result.status)
    return replace(done, performed=result.performed, reason="; ".join(result.reasons))


def evolve_alone(
    problem: Problem,
    mesh: ShellMesh,
    config: Config,
    record: Callable[[Event], None],
    started: float,
) -> Evolution:
    """Run one operation GA on the mesh, as in the paper's section 4."""
    operation = next(o for o in problem.operations if o.code == config.operation_code)
    work = Work(problem, mesh)
    workpiece = Workpiece(mesh, problem.setting)
    rng = np.random.default_rng([problem.seed, 0, int(mesh.digest, 16), operation.code, 0])
    space = operation.search_space(workpiece, rng)
    steps: tuple[Step, ...] = ()
    status: Status = "finished"
    evaluations = 0
    if space is None:
        return _evolution(work, steps, evaluations, status)
    deadline = started + (config.time_limit or np.inf)
    reporter = _reporter(work, record, started)
    state = IslandState.first(0, 0)
    state = replace(state, best_tally=work.root.tally)
    best = float(workpiece.fitness(work.root.tally[None])[0]) if problem.improving else -np.inf
    try:
        for generation in generations(space, workpiece, config.breeding, rng):
            if generation.best_fitness > best:
                best = generation.best_fitness
                steps = (Step(operation.code, space.parameters(generation.best)),)
                state = replace(state, best_tally=generation.best_tally, best_steps=steps)
            evaluations = generation.evaluations
            state = replace(
                state,
                generation=generation.number + 1,
                fitness=generation.fitness,
                tallies=generation.tallies,
                best_fitness=best,
                evaluations=evaluations,
                performed=evaluations,
            )
            reporter.watch(Milestone(0, (state,), (), (), is_last=False, reasons=()))
            if time.monotonic() >= deadline:
                status = "time-limit"
                break
    except KeyboardInterrupt:
        status = "interrupted"
    return _evolution(work, steps, evaluations, status)


def _reporter(
    work: Work, record: Callable[[Event], None], started: float, reported: int = 0
) -> Reporter:
    return Reporter(
        record=record,
        setting=work.problem.setting,
        operations=work.problem.operations,
        tally=work.root.tally,
        roots=work.root.tally[None],
        generation=0,
        evaluations=0,
        performed=0,
        started=started,
        reported=reported,
    )


def _evolution(work: Work, steps: tuple[Step, ...], evaluations: int, status: Status) -> Evolution:
    problem = work.problem
    x, y, z = work.mesh.points.mean(axis=0).tolist()
    mesh = perform_steps(work.mesh, steps, problem.operations, problem.setting)
    rounds = (Round(None, 0, (Place((x, y, z), steps),)),)
    return Evolution(mesh, rounds, evaluations, evaluations, status, "")
