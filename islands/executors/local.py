"""Islands in this process, one after the other, sharing what they learn."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from islands.archipelago import Archipelago, Milestone, TimeUpError, evolve_in_turn
from islands.executors.pool import PoolRunner
from islands.executors.watchdog import ending_process_after
from islands.finishing import finished
from islands.integration_ga import (
    Evaluator,
    Handle,
    Outcome,
    Problem,
    Runner,
    Task,
    Work,
    Workbench,
    run_task,
)
from islands.island import step


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
    limit : float
        Seconds that an operation GA may take before it ends this process.
    """

    problem: Problem
    deadline: float
    heed: Callable[[], None] = _never
    bench: Workbench = field(default_factory=Workbench)
    limit: float = float("inf")

    def run(self, jobs: Sequence[tuple[Task, Handle]]) -> list[tuple[Outcome, Handle, bool]]:
        """Run one after the other; TimeUpError where the deadline has passed."""
        results = []
        for task, mesh in jobs:
            self.heed()
            if time.monotonic() >= self.deadline:
                raise TimeUpError
            with ending_process_after(self.limit):
                results.append((*run_task(self.problem, task, mesh, self.bench), True))
        return results


class LocalExecutor:
    """All islands in this process, one archipelago after the other.

    With more than one worker the operation GAs of a whole mesh run in processes of their own; those
    of many small places take milliseconds and stay here.
    """

    def __init__(
        self,
        *,
        workers: int = 1,
        deadline: float = float("inf"),
        heed: Callable[[], None] = _never,
    ) -> None:
        self._workers = workers
        self._pool: PoolRunner | None = None
        self._deadline = deadline
        self._heed = heed

    def evolve(self, archipelagos: Sequence[Archipelago]) -> Iterator[Milestone]:
        """Evolve them in turn."""
        bench = Workbench()
        for archipelago in archipelagos:
            yield from evolve_here(archipelago, self._runner(archipelago.work, bench))

    def close(self) -> None:
        """End the worker processes, if any."""
        if self._pool is not None:
            self._pool.close()
            self._pool = None

    def _runner(self, work: Work, bench: Workbench) -> Runner:
        if self._workers == 1 or not work.is_whole:
            return LocalRunner(work.problem, self._deadline, self._heed, bench)
        self.close()
        self._pool = PoolRunner(work.problem, self._workers, self._deadline, self._heed)
        return self._pool


def evolve_here(archipelago: Archipelago, runner: Runner) -> Iterator[Milestone]:
    """Evolve an archipelago in this process: its islands share what they learn."""
    work, plans = archipelago.work, archipelago.schedule.plans
    scorer = Evaluator.of(work, runner)
    for milestone in evolve_in_turn(
        archipelago, lambda state, migrants: step(state, migrants, scorer, plans[state.island])
    ):
        if milestone.is_last and not work.is_whole:
            steps = archipelago.fittest(milestone).best_steps
            piece = finished(work, steps, scorer.mesh_after(steps))
            yield replace(milestone, piece=piece)
        else:
            yield milestone
