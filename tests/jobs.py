"""Small jobs on a small bad plate, and how tests run them."""

from islands.archipelago import Executor
from islands.config import load_config
from islands.genetics import Breeding
from islands.integration_ga import Problem
from islands.run import Finished, Job, run, start_executor
from meshops.criteria import PAPER
from meshops.fitness import Fitness
from meshops.mesh import ShellMesh
from meshops.operations import PAPER_OPERATIONS
from meshops.workpiece import Setting
from tracking.events import Event

SIZE = 5.0
SMALL = {"size": SIZE, "criteria": "paper"}
WHOLE = {
    "profile": "paper",
    "population": 4,
    "generations": 2,
    "genes": 3,
    "operation-population": 4,
    "operation-generations": 1,
}
"""One procedure for the whole mesh, as in the paper, but less of it."""


def job(mesh: ShellMesh, **settings: object) -> Job:
    given = SMALL | {name.replace("_", "-"): value for name, value in settings.items()}
    return Job.of("plate", mesh, PAPER, load_config(None, given))


def whole_job(mesh: ShellMesh, **settings: object) -> Job:
    return job(mesh, **{name.replace("-", "_"): v for name, v in WHOLE.items()} | settings)


def finish(
    work: Job, events: list[Event] | None = None, executor: Executor | None = None
) -> Finished:
    """Run a job to its end; its events are appended to a list."""
    where = executor or start_executor(work, float("inf"))
    try:
        return run(work, where, (events if events is not None else []).append, 0.0)
    finally:
        where.close()


def setting_of(mesh: ShellMesh) -> Setting:
    return Setting(PAPER.at(SIZE), Fitness("quality", len(mesh.elements)), element_size=SIZE)


def problem_of(mesh: ShellMesh) -> Problem:
    """The paper's operations, where gene and code are the same; nothing that does harm is done."""
    return Problem(
        seed=1,
        setting=setting_of(mesh),
        operations=PAPER_OPERATIONS,
        breeding=Breeding(individuals=4, generations=1, elites=1, scaling="window"),
        improving=True,
    )


def faults(mesh: ShellMesh) -> tuple[int, int]:
    """Failed elements and trias under the criteria of these jobs."""
    report = job(mesh).quality(mesh)
    return report.failed, report.trias
