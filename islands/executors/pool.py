"""Operation GAs in processes of this machine, for a mesh that is one place."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_EXCEPTION, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context

from islands.archipelago import TimeUpError
from islands.integration_ga import Handle, Outcome, Problem, Task, run_task
from meshops.errors import InputError

_LISTEN_SECONDS = 0.5


class PoolRunner:
    """Runs operation GAs side by side; the answer is that of one process.

    Parameters
    ----------
    problem : Problem
    workers : int
        Processes.
    deadline : float
        A time of time.monotonic().
    heed : callable
        Raises KeyboardInterrupt where the user wants to end.
    """

    def __init__(
        self, problem: Problem, workers: int, deadline: float, heed: Callable[[], None]
    ) -> None:
        self._problem = problem
        self._deadline = deadline
        self._heed = heed
        # forked processes would inherit the threads of others, as those of MLflow, in any state
        self._pool = ProcessPoolExecutor(workers, get_context("spawn"), _leave_signals)

    def run(self, jobs: Sequence[tuple[Task, Handle]]) -> list[tuple[Outcome, Handle, bool]]:
        """Run all; TimeUpError where time is up, InputError where a process has ended."""
        results = [self._pool.submit(run_task, self._problem, task, mesh) for task, mesh in jobs]
        waiting = set(results)
        while waiting:
            self._heed()
            seconds = self._deadline - time.monotonic()
            if seconds <= 0.0:
                raise TimeUpError
            waiting = wait(waiting, min(seconds, _LISTEN_SECONDS), FIRST_EXCEPTION).not_done
        try:
            return [(*result.result(), True) for result in results]
        except BrokenProcessPool:
            raise InputError(
                "A process of this machine that ran operation GAs has ended; go on with "
                "meshipelago resume, with --backend ray where such processes are replaced."
            ) from None

    def close(self) -> None:
        """Let the processes end when what they are at is done."""
        self._pool.shutdown(wait=False, cancel_futures=True)


def _leave_signals() -> None:
    """Leave Ctrl-C, which goes to all processes of a terminal, to the one that started this."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
