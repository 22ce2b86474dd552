"""A run: a deck goes in, a procedure is evolved, a better deck and its record come out."""

from __future__ import annotations

import json
import time
import uuid
from collections.abc import Callable
from dataclasses import dataclass, replace
from hashlib import blake2b
from pathlib import Path

import numpy as np

from islands.archipelago import Executor, Milestone, Status
from islands.assessing import assessment_of
from islands.config import Config
from islands.executors.local import LocalExecutor
from islands.integration_ga import Problem
from islands.left_in_rows import LeftInRows
from islands.procedure import Procedure, Round
from islands.replay import read_procedure
from islands.rounds import evolve_rounds
from islands.search import Evolution, SearchState, State, Watchers
from islands.transfer import transfer
from islands.whole import evolve_alone, evolve_whole
from meshops.assessment import Assessment
from meshops.criteria import Criteria
from meshops.criteria_files import dump_criteria
from meshops.errors import InputError
from meshops.fitness import Fitness
from meshops.formats.locks import Lock
from meshops.guard import count_changed
from meshops.mesh import ShellMesh
from meshops.operations import ALL_OPERATIONS
from meshops.quality_index import QualityIndex
from meshops.quality_sums import IRREGULAR
from meshops.reference import Reference
from meshops.sizing import LOCAL
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
    assessment : Assessment
        What its mesh and all that comes of it are judged by.
    known : Procedure or None
        What to begin from.
    locks : tuple of Lock
        What of the mesh is locked, by which cards, and what that forbids.
    told : tuple of str
        What the user should know of the mesh before it runs.
    """

    name: str
    mesh: ShellMesh
    config: Config
    problem: Problem
    assessment: Assessment
    known: Procedure | None = None
    locks: tuple[Lock, ...] = ()
    told: tuple[str, ...] = ()

    @classmethod
    def of(
        cls,
        name: str,
        mesh: ShellMesh,
        criteria: Criteria,
        config: Config,
        locks: tuple[Lock, ...] = (),
        told: tuple[str, ...] = (),
    ) -> Job:
        """Set the problem; `told` is what the user should know of the mesh before it runs.

        Raises InputError where the mesh is locked throughout, or a file that the config names is
        not what it should be.
        """
        if not topology(mesh, feature_angle=config.feature_angle).editable.any():
            raise InputError(
                f"{name}: all {len(mesh.elements)} elements are locked, since other cards refer to "
                "them; there is nothing that may be changed."
            )
        assessment = assessment_of(
            mesh, criteria, config.judged_by, judged_size=config.judged_size, reference=mesh
        )
        setting = Setting.of(
            mesh,
            assessment,
            Fitness(config.fitness, len(mesh.elements), config.irregularity, config.price),
            element_size=config.element_size,
            feature_angle=config.feature_angle,
            slides=config.slide,
        )
        problem = Problem(
            seed=config.seed,
            setting=setting,
            operations=config.operations,
            breeding=config.operation_breeding,
            improving=config.improving,
        )
        known = None
        if config.warm_start:
            known = read_procedure(Path(config.warm_start) / "procedure.json")
        return cls(name, mesh, config, problem, assessment, known, locks, told)

    @property
    def key(self) -> str:
        """Digest of all that the answer depends on."""
        size = Path(self.config.size_field or "")
        parts = {
            "mesh": self.mesh.digest,
            "settings": self.config.decisive,
            "sizes": size.read_text(encoding="utf-8") if size.is_file() else None,
            "criteria": dump_criteria(self.problem.setting.scoring.criteria),
            "known": self.known.result if self.known else None,
        }
        return blake2b(json.dumps(parts, sort_keys=True).encode(), digest_size=16).hexdigest()

    @property
    def size_field(self) -> str | None:
        """What lengths are judged by instead of one size: ``local`` or a file."""
        if self.config.size_field or self.assessment.sizes is None:
            return self.config.size_field
        return LOCAL

    def quality(self, mesh: ShellMesh) -> QualityIndex:
        """Return the QualityIndex of a mesh under the job's criteria."""
        return self.assessment.quality(mesh)


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
    evaluations, performed : int
    seconds : float
    status : "finished", "time-limit" or "interrupted"
    before, after : QualityIndex
    irregular_before, irregular_after : int
        Inner nodes at which not just four elements meet.
    changed_elements, changed_nodes : int
    left_in_rows : LeftInRows
    """

    mesh: ShellMesh
    procedure: Procedure
    text: str
    fitness: float
    evaluations: int
    performed: int
    seconds: float
    status: Status
    before: QualityIndex
    after: QualityIndex
    irregular_before: int
    irregular_after: int
    changed_elements: int
    changed_nodes: int
    left_in_rows: LeftInRows

    @property
    def changed_per_fault(self) -> float | None:
        """Changed elements for each failed element and tria that went; None where none went."""
        went = self.before.failed - self.after.failed + self.before.trias - self.after.trias
        return self.changed_elements / went if went > 0 else None

    @property
    def worse(self) -> tuple[str, ...]:
        """In what the mesh is worse than it was, a phrase each; empty where in nothing."""
        before, after = self.before, self.after
        figures = {
            "elements that fail by shape": (before.failed_by_shape, after.failed_by_shape),
            "elements that fail by size alone": (before.failed_by_size, after.failed_by_size),
            "trias": (before.trias, after.trias),
            "compound Q.I.": (round(before.compound_qi, 2), round(after.compound_qi, 2)),
            "irregular nodes": (self.irregular_before, self.irregular_after),
        }
        return tuple(f"{name} {old} -> {new}" for name, (old, new) in figures.items() if new > old)


_REASONS = {
    "finished": "all generations are done",
    "time-limit": "the time limit was reached",
    "interrupted": "it was interrupted",
}


def start_executor(job: Job, deadline: float, heed: Callable[[], None] = lambda: None) -> Executor:
    """Start the backend that the config names; raises InputError where it cannot be reached.

    `heed` raises KeyboardInterrupt where the user wants to end.
    """
    config = job.config
    if config.backend == "local":
        return LocalExecutor(workers=config.workers or 1, deadline=deadline, heed=heed)
    from islands.executors.ray import RayExecutor

    return RayExecutor(
        address=config.address,
        workers=config.workers,
        deadline=deadline,
        limit=config.evaluation_limit,
        heed=heed,
    )


def improve(
    job: Job,
    *,
    record: Callable[[Event], None] = lambda _: None,
    is_enough: Callable[[ShellMesh], bool] = lambda _: False,
) -> Finished:
    """Run a job in this process; its time limit counts from now.

    A mesh that is the fittest so far and that `is_enough` ends it earlier.
    """
    started = time.monotonic()
    executor = start_executor(job, started + (job.config.time_limit or float("inf")))
    try:
        return run(job, executor, record, started, is_enough)
    finally:
        executor.close()


def run(
    job: Job,
    executor: Executor,
    record: Callable[[Event], None],
    started: float,
    is_enough: Callable[[ShellMesh], bool] = lambda _: False,
    *,
    keep: Callable[[State], None] = lambda _: None,
    state: State | None = None,
    run_id: str = "",
) -> Finished:
    """Evolve a procedure and perform it; every generation is recorded.

    `started` is the time.monotonic() from which seconds and time limit count. `keep` takes the
    state between two rounds or generations; with a `state` and a `run_id` an earlier run goes on
    from there.
    """
    config = job.config
    before = job.quality(job.mesh)
    record(
        RunStarted(
            name=job.name,
            run_id=run_id or uuid.uuid4().hex,
            seed=config.seed,
            backend=config.backend,
            islands=config.islands,
            settings=config.flat() | _judged_by(job),
            before=summary(before),
            told=(
                f"judged by {job.assessment.text()}",
                f"fails at {job.assessment.limits_text()}",
                *job.told,
            ),
        )
    )
    evolution = _evolve(job, executor, Watchers(record, keep, is_enough, started), state)
    finished = _finish(job, before, evolution, started)
    record(
        RunFinished(
            status=finished.status,
            reason=evolution.reason or _REASONS[finished.status],
            after=summary(finished.after),
            fitness=finished.fitness,
            seconds=finished.seconds,
            evaluations=finished.evaluations,
            performed=finished.performed,
            procedure=finished.text,
            digest=finished.mesh.digest,
            worse=finished.worse,
        )
    )
    return finished


def _judged_by(job: Job) -> dict[str, str | float]:
    """Size, gradation and whole levels, for the record."""
    return {
        "size": job.config.size or job.assessment.scoring.size,
        "judged-size": job.assessment.scoring.size,
        "gradation": job.assessment.gradation,
        "levels": dump_criteria(job.assessment.criteria),
    }


def summary(quality: QualityIndex) -> MeshSummary:
    """Put a report in figures."""
    return MeshSummary(
        elements=quality.elements,
        quads=quality.quads,
        trias=quality.trias,
        failed=quality.failed,
        failed_by_shape=quality.failed_by_shape,
        failed_by_size=quality.failed_by_size,
        compound_qi=quality.compound_qi,
    )


def _evolve(job: Job, executor: Executor, watch: Watchers, state: State | None) -> Evolution:
    config, problem = job.config, job.problem
    if config.operation:
        return evolve_alone(problem, job.mesh, config, watch.record, watch.started)
    schedule = config.schedule
    if config.profile == "paper":
        begun = state if isinstance(state, Milestone) else None
        return evolve_whole(problem, job.mesh, schedule, executor, watch, begun)
    rounds: tuple[Round, ...] = ()
    mesh = job.mesh
    if job.known:
        mesh, rounds = transfer(job.known, mesh, ALL_OPERATIONS, problem.setting)
    reference = Reference(job.mesh, problem.setting.feature_angle)
    start = state if isinstance(state, SearchState) else mesh
    evolution = evolve_rounds(problem, start, reference, config.plan, schedule, executor, watch)
    return replace(evolution, rounds=rounds + evolution.rounds)


def _finish(job: Job, before: QualityIndex, evolution: Evolution, started: float) -> Finished:
    problem, setting = job.problem, job.problem.setting
    mesh = evolution.mesh
    corners = [job.mesh.points.min(axis=0), job.mesh.points.max(axis=0)]
    procedure = Procedure(
        rounds=evolution.rounds,
        mesh=job.mesh.digest,
        result=mesh.digest,
        box=np.array(corners),
        criteria=setting.scoring.criteria,
        size=setting.scoring.size,
        element_size=setting.element_size,
        size_field=job.size_field,
        feature_angle=setting.feature_angle,
        slides=setting.slides,
        seed=problem.seed,
        only=job.config.only,
    )
    after = Workpiece(mesh, setting)
    tally = after.tally
    changed_elements, changed_nodes = count_changed(job.mesh, mesh)
    return Finished(
        mesh=mesh,
        procedure=procedure,
        text=procedure.text(ALL_OPERATIONS),
        fitness=float(setting.fitness.of(tally[None], setting.scoring)[0]),
        evaluations=evolution.evaluations,
        performed=evolution.performed,
        seconds=time.monotonic() - started,
        status=evolution.status,
        before=before,
        after=job.quality(mesh),
        irregular_before=int(np.count_nonzero(Workpiece(job.mesh, setting).irregular)),
        irregular_after=int(tally[IRREGULAR]),
        changed_elements=changed_elements,
        changed_nodes=changed_nodes,
        left_in_rows=LeftInRows.of(after),
    )
