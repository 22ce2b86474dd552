"""A run: a deck goes in, a procedure is evolved, a better deck and its record come out."""

from __future__ import annotations

import time
import uuid
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from islands.archipelago import Executor, Reporter, Result, evolve_archipelago
from islands.config import Config
from islands.executors.local import LocalExecutor, root_outcome
from islands.integration_ga import Problem
from islands.island import IslandState
from islands.operation_ga import generations
from islands.procedure import Procedure, Step, perform
from meshops.criteria import Criteria
from meshops.errors import InputError
from meshops.fitness import Fitness
from meshops.mesh import ShellMesh
from meshops.quality import median_edge
from meshops.quality_index import QualityIndex, quality_index
from meshops.topology import topology
from meshops.workpiece import Setting, Workpiece
from tracking.events import Event, MeshSummary, RunFinished, RunStarted


@dataclass(frozen=True, eq=False)
class Job:
    """A mesh and how it is to be improved.

    Attributes
    ----------
    name : str
        The deck's base name.
    mesh : ShellMesh
    config : Config
    problem : Problem
    """

    name: str
    mesh: ShellMesh
    config: Config
    problem: Problem

    @classmethod
    def of(cls, name: str, mesh: ShellMesh, criteria: Criteria, config: Config) -> Job:
        """Set the problem; raises InputError where the mesh is locked throughout."""
        if not topology(mesh, feature_angle=config.feature_angle).editable.any():
            raise InputError(
                f"{name}: all {len(mesh.elements)} elements are locked, since other cards refer to "
                "them; there is nothing that may be changed."
            )
        setting = Setting(
            scoring=criteria.at(config.size or median_edge(mesh)),
            fitness=Fitness(config.fitness, len(mesh.elements)),
            element_size=config.size,
            feature_angle=config.feature_angle,
        )
        problem = Problem(
            seed=config.seed,
            setting=setting,
            operations=config.operations,
            breeding=config.operation_breeding,
            improving=config.improving,
        )
        return cls(name, mesh, config, problem)

    def quality(self, mesh: ShellMesh) -> QualityIndex:
        """Return the QualityIndex of a mesh under the job's criteria."""
        return quality_index(mesh, self.problem.setting.scoring)


@dataclass(frozen=True, eq=False)
class Finished:
    """What came of a job.

    Attributes
    ----------
    mesh : ShellMesh
    procedure : Procedure
    text : str
        The procedure in the notation of Figure 10.
    fitness : float
    evaluations : int
    seconds : float
    status : "finished", "time-limit" or "interrupted"
    before, after : QualityIndex
    """

    mesh: ShellMesh
    procedure: Procedure
    text: str
    fitness: float
    evaluations: int
    seconds: float
    status: Literal["finished", "time-limit", "interrupted"]
    before: QualityIndex
    after: QualityIndex


_REASONS = {
    "finished": "all generations are done",
    "time-limit": "the time limit was reached",
    "interrupted": "it was interrupted",
}


def start_executor(job: Job, deadline: float) -> Executor:
    """Start the backend that the config names; raises InputError where it cannot be reached."""
    config = job.config
    if config.backend == "local":
        return LocalExecutor(
            job.problem, job.mesh, config.breeding, config.genes, deadline=deadline
        )
    from islands.executors.ray import RayExecutor

    return RayExecutor(
        job.problem,
        job.mesh,
        config.breeding,
        config.genes,
        address=config.address,
        deadline=deadline,
    )


def run(job: Job, executor: Executor, record: Callable[[Event], None], started: float) -> Finished:
    """Evolve a procedure and perform it; every generation is recorded.

    `started` is the time.monotonic() from which seconds and time limit count.
    """
    config = job.config
    before = job.quality(job.mesh)
    record(
        RunStarted(
            name=job.name,
            run_id=uuid.uuid4().hex,
            seed=config.seed,
            backend=config.backend,
            islands=config.islands,
            settings=config.flat() | {"size": job.problem.setting.scoring.size},
            before=summary(before),
        )
    )
    result = (
        _evolve_alone(job, record, started)
        if config.operation
        else _evolve_procedure(job, executor, record, started)
    )
    finished = _finish(job, before, result, started)
    record(
        RunFinished(
            status=finished.status,
            reason=_REASONS[finished.status],
            after=summary(finished.after),
            fitness=finished.fitness,
            seconds=finished.seconds,
            evaluations=finished.evaluations,
            procedure=finished.text,
            digest=finished.mesh.digest,
        )
    )
    return finished


def summary(quality: QualityIndex) -> MeshSummary:
    """Put a report in figures."""
    return MeshSummary(
        elements=quality.elements,
        quads=quality.quads,
        trias=quality.trias,
        failed=quality.failed,
        compound_qi=quality.compound_qi,
    )


def _evolve_procedure(
    job: Job, executor: Executor, record: Callable[[Event], None], started: float
) -> Result:
    reporter = Reporter(job.problem.setting.scoring, job.problem.operations, started)
    config = job.config
    return evolve_archipelago(
        config.islands, config.generations, config.migration, executor, record, reporter
    )


def _evolve_alone(job: Job, record: Callable[[Event], None], started: float) -> Result:
    """Run one operation GA on the mesh, as in the paper's section 4."""
    config, problem = job.config, job.problem
    operation = next(o for o in problem.operations if o.name == config.operation)
    workpiece = Workpiece(job.mesh, problem.setting)
    rng = np.random.default_rng([config.seed, int(job.mesh.digest, 16), operation.code, 0])
    space = operation.search_space(workpiece, rng)
    state = IslandState.first(0)
    status: Literal["finished", "time-limit", "interrupted"] = "finished"
    if space is None:
        return Result(state, 0, status)
    deadline = started + (config.time_limit or np.inf)
    reporter = Reporter(problem.setting.scoring, problem.operations, started)
    root = root_outcome(problem, job.mesh)
    state = replace(state, best_tally=root.tally)
    if config.improving:
        state = replace(state, best_fitness=float(workpiece.fitness(root.tally[None])[0]))
    try:
        for generation in generations(space, workpiece, config.breeding, rng):
            state = replace(
                state,
                generation=generation.number + 1,
                fitness=generation.fitness,
                evaluations=generation.evaluations,
            )
            if generation.best_fitness > state.best_fitness:
                state = replace(
                    state,
                    best_fitness=generation.best_fitness,
                    best_tally=generation.best_tally,
                    best_steps=(Step(operation.code, space.parameters(generation.best)),),
                )
            record(reporter(state))
            if time.monotonic() >= deadline:
                status = "time-limit"
                break
    except KeyboardInterrupt:
        status = "interrupted"
    return Result(state, state.evaluations, status)


def _finish(job: Job, before: QualityIndex, result: Result, started: float) -> Finished:
    problem = job.problem
    steps = result.best.best_steps
    mesh = perform(job.mesh, steps, problem.operations, problem.setting)
    procedure = Procedure(
        steps=steps,
        mesh=job.mesh.digest,
        result=mesh.digest,
        element_size=problem.setting.element_size,
        feature_angle=problem.setting.feature_angle,
        seed=problem.seed,
    )
    fitness = result.best.best_fitness
    if not np.isfinite(fitness):  # nothing was evolved: the fitness is that of the mesh as it is
        workpiece = Workpiece(mesh, problem.setting)
        fitness = float(workpiece.fitness(workpiece.tally[None])[0])
    return Finished(
        mesh=mesh,
        procedure=procedure,
        text=procedure.text(problem.operations),
        fitness=fitness,
        evaluations=result.evaluations,
        seconds=time.monotonic() - started,
        status=result.status,
        before=before,
        after=job.quality(mesh),
    )
