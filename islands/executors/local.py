"""Islands in this process, one after the other, sharing what they learn."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field

from islands.archipelago import TimeUpError
from islands.executors.pool import PoolRunner
from islands.integration_ga import (
    REMEMBERED_BYTES,
    Evaluator,
    Handle,
    Outcome,
    Problem,
    Task,
    Work,
    Workbench,
    run_task,
)
from islands.island import IslandPlan, IslandState, step
from islands.migration import Migrants


def _never() -> None:
    """Heed nothing."""


@dataclass(frozen=True, eq=False)
class LocalRunner:
    """Runs operation GAs here.

    Attributes
    ----------
    problem : Problem
    deadline : float
        A time of time.monotonic().
    heed : callable
        Raises KeyboardInterrupt where the user wants to end.
    bench : Workbench
        Other runners may share it.
    """

    problem: Problem
    deadline: float
    heed: Callable[[], None] = _never
    bench: Workbench = field(default_factory=Workbench)

    def run(self, jobs: Sequence[tuple[Task, Handle]]) -> list[tuple[Outcome, Handle]]:
        """Run one after the other; TimeUpError where the deadline has passed."""
        results = []
        for task, mesh in jobs:
            self.heed()
            if time.monotonic() >= self.deadline:
                raise TimeUpError
            results.append(run_task(self.problem, task, mesh, self.bench))
        return results


class LocalExecutor:
    """All islands in this process.

    With more than one worker the operation GAs of a mesh that is one place run in processes of
    their own; those of many small places take milliseconds and stay here.
    """

    def __init__(
        self,
        plans: Sequence[IslandPlan],
        *,
        workers: int = 1,
        deadline: float = float("inf"),
        heed: Callable[[], None] = _never,
    ) -> None:
        self._plans = plans
        self._workers = workers
        self._pool: PoolRunner | None = None
        self._deadline = deadline
        self._heed = heed
        self._evaluators: list[Evaluator] = []

    def open(self, works: Sequence[Work]) -> None:
        """Forget what earlier works have taught."""
        self.close()
        if self._workers > 1 and len(works) == 1:
            work = works[0]
            self._pool = PoolRunner(work.problem, self._workers, self._deadline, self._heed)
            self._evaluators = [
                Evaluator(work.problem, self._pool, work.root, work.mesh, is_enough=work.is_solved)
            ]
            return
        bench = Workbench()
        self._evaluators = [
            evaluator(work, self._deadline, len(works), bench, self._heed) for work in works
        ]

    def advance(
        self, steps: Sequence[tuple[IslandState, Migrants | None]]
    ) -> Iterator[IslandState]:
        """Step the islands in turn."""
        for state, immigrants in steps:
            scorer = self._evaluators[state.work]
            yield step(state, immigrants, scorer, self._plans[state.island])

    def close(self) -> None:
        """End the worker processes, if any."""
        if self._pool is not None:
            self._pool.close()
            self._pool = None


def evaluator(
    work: Work,
    deadline: float,
    sharers: int,
    bench: Workbench,
    heed: Callable[[], None] = _never,
) -> Evaluator:
    """Make an evaluator that works in this process; `sharers` share its memory, and the bench."""
    return Evaluator(
        work.problem,
        LocalRunner(work.problem, deadline, heed, bench),
        work.root,
        work.mesh,
        is_enough=work.is_solved,
        remembered_bytes=REMEMBERED_BYTES / sharers,
    )
