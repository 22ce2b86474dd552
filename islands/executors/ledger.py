"""Ledger: operation GAs as Ray tasks, each of which runs once however many islands ask for it."""

from __future__ import annotations

import os
from collections import Counter, OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import ray

from islands.executors.watchdog import ending_process_after
from islands.integration_ga import (
    BYTES_AN_ELEMENT,
    REMEMBERED_BYTES,
    Handle,
    Outcome,
    Problem,
    Task,
    Work,
    run_task,
)
from meshops.kernels.quality import TALLY_SIZE
from meshops.mesh import ShellMesh

TRIES = 4
"""Processes that an operation GA may end before it has no answer."""

CALLS = 500
"""Of a worker process, which is replaced then: libraries leak."""

CPUS = 0.95
"""Of a task: the actors that wait for it take a little of each machine."""

Key = tuple[str, Task]
"""A task, and the problem that it is of."""


def _run(
    ledger: Any, key: Key, problem: Problem, task: Task, mesh: ShellMesh, limit: float
) -> tuple[Outcome, ShellMesh | None]:
    """Run an operation GA within `limit` seconds; no mesh where it stays as it is.

    Ray tries it again wherever its process or its machine is lost, which may be by chance. It has
    no answer where it has begun too often and never come to its end.
    """
    if ray.get(ledger.begin.remote(key)) > TRIES:
        reason = (
            f"operation {task.code} on mesh {task.mesh} has ended its process {TRIES} times: a "
            f"crash, too much memory, or more than {limit:g} s"
        )
        none = np.zeros((0, 2), np.int32)
        return Outcome(task.mesh, np.full(TALLY_SIZE, np.nan), none, 0, reason), None
    try:
        with ending_process_after(limit):
            outcome, after = run_task(problem, task, mesh)
    except MemoryError:
        os._exit(1)  # to be tried again in another process, as where the system ends this one
    ledger.end.remote(key)
    return outcome, None if after is mesh else after


_run_remotely = ray.remote(num_returns=2, num_cpus=CPUS, max_retries=-1, max_calls=CALLS)(_run)


@dataclass(frozen=True, eq=False)
class Parcel:
    """A work in the object store: each part crosses the wire once.

    Attributes
    ----------
    batch : int
        Of works that are evolved at the same time.
    work, problem, mesh : ObjectRef
    """

    batch: int
    work: Any
    problem: Any
    mesh: Any

    @classmethod
    def of(cls, work: Work, batch: int) -> Parcel:
        """Put a work there."""
        return cls(batch, ray.put(work), ray.put(work.problem), ray.put(work.mesh))


class _Ledger:
    """An actor that knows the tasks that were asked for lately, and how often each has begun.

    One that dies is started anew and knows nothing: tasks are run again, to the same end.
    """

    def __init__(self, limit: float) -> None:
        self._limit = limit
        self._self = ray.get_runtime_context().current_actor
        self._known: OrderedDict[Key, tuple[Any, Any]] = OrderedDict()
        self._begun: Counter[Key] = Counter()

    def ask(
        self, parcel: Parcel, most: int, jobs: Sequence[tuple[Task, Any]]
    ) -> list[tuple[Any, Any, bool]]:
        """Return references to the outcome and the mesh of each, and whether it is new."""
        found = []
        for task, mesh in jobs:
            key = parcel.problem.hex(), task
            is_new = key not in self._known
            if is_new:
                self._known[key] = _run_remotely.remote(
                    self._self, key, parcel.problem, task, mesh, self._limit
                )
            self._known.move_to_end(key)
            found.append((*self._known[key], is_new))
        while len(self._known) > max(most, len(jobs)):
            self._known.popitem(last=False)
        return found

    def begin(self, key: Key) -> int:
        """Count how often a task has begun."""
        self._begun[key] += 1
        return self._begun[key]

    def end(self, key: Key) -> None:
        """Forget how often: it has come to its end."""
        del self._begun[key]


def start_ledger(limit: float) -> Any:
    """Start one where this process runs, so that it ends with it; `limit` is of an operation GA."""
    here = ray.util.scheduling_strategies.NodeAffinitySchedulingStrategy(
        ray.get_runtime_context().get_node_id(), soft=True
    )
    actor = ray.remote(
        num_cpus=0, max_restarts=-1, max_task_retries=-1, scheduling_strategy=here
    )(_Ledger)  # fmt: skip
    return actor.remote(limit)


@dataclass(frozen=True, eq=False)
class LedgerRunner:
    """Runs operation GAs as tasks; meshes stay in the object store, handles are references.

    Attributes
    ----------
    ledger : actor
    parcel : Parcel
    elements : int
        Of the mesh that the work began with.
    """

    ledger: Any
    parcel: Parcel
    elements: int

    def run(self, jobs: Sequence[tuple[Task, Handle]]) -> list[tuple[Outcome, Handle, bool]]:
        """Run all at the same time."""
        if not jobs:
            return []
        most = int(REMEMBERED_BYTES / (BYTES_AN_ELEMENT * self.elements))
        asked = ray.get(self.ledger.ask.remote(self.parcel, most, jobs))
        outcomes = ray.get([outcome for outcome, _, _ in asked])
        return [
            (outcome, mesh, is_new)
            for outcome, (_, mesh, is_new) in zip(outcomes, asked, strict=True)
        ]
