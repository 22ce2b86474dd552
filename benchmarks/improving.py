"""The one call of the optimiser that the benchmarks of quality make, and the processes for many."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from multiprocessing import get_context
from typing import Any

import numpy as np

from benchmarks.measures import parity_bound
from islands.config import load_config
from islands.operation_ga import evolve
from islands.run import Finished, Job, improve
from meshops.criteria_files import load_criteria
from meshops.examples import SIZE, plate
from meshops.mesh import ShellMesh
from meshops.workpiece import Workpiece
from tracking.events import Event, RoundReport

CRITERIA = "paper"

MARGIN = 0.5
"""Seconds before a target's time at which the optimiser is asked to end."""


@dataclass(frozen=True, eq=False)
class Improvement:
    """What came of a run.

    Attributes
    ----------
    done : Finished
    rounds : tuple of RoundReport
    bound : int
        Fewest trias that the borders of the result allow.
    """

    done: Finished
    rounds: tuple[RoundReport, ...]
    bound: int

    @property
    def solved_after(self) -> float:
        """Seconds until no element failed and just the bound of trias was left; else infinite."""
        if (self.done.after.failed, self.done.after.trias) != (0, self.bound):
            return float("inf")
        solved = [r.seconds for r in self.rounds if (r.failed, r.trias) == (0, self.bound)]
        return min(solved, default=self.done.seconds)


def job_of(
    name: str, mesh: ShellMesh, *, size: float | None = None, seed: int = 1, **settings: Any
) -> Job:
    """Set the job to improve a mesh by the paper's criteria.

    `size` is the element size; None: lengths are judged by the mesh's median edge, and each place
    keeps the size that it has.
    """
    given = {"criteria": CRITERIA, "seed": seed, **settings}
    if size is not None:
        given["size"] = size
    config = load_config(None, given)
    return Job.of(name, mesh, load_criteria(config.criteria), config)


def improved(
    job: Job, seconds: float, is_enough: Callable[[ShellMesh], bool] = lambda _: False
) -> Improvement:
    """Improve a mesh within so many seconds, or until it `is_enough`, in this process."""
    rounds: list[RoundReport] = []

    def record(event: Event) -> None:
        if isinstance(event, RoundReport):
            rounds.append(event)

    limit = max(seconds - MARGIN, MARGIN)
    config = job.config.model_copy(update={"time_limit": limit})
    done = improve(replace(job, config=config), record=record, is_enough=is_enough)
    return Improvement(done, tuple(rounds), parity_bound(done.mesh))


def processes(count: int) -> ProcessPoolExecutor:
    """Start processes in which everything is loaded, so that no run waits for that."""
    return ProcessPoolExecutor(count, mp_context=get_context("spawn"), initializer=warm_up)


def warm_up() -> None:
    """Load what the optimiser and every operation need."""
    job = job_of("warm-up", plate(), size=SIZE, rounds=1)
    improve(job)
    workpiece = Workpiece(job.mesh, job.problem.setting)
    for operation in job.problem.operations:
        rng = np.random.default_rng(1)
        evolve(operation, workpiece, job.problem.breeding, rng, improving=False)
