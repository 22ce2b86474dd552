"""Ledger: operation GAs as Ray tasks, each of which runs once however many islands ask for it."""

from __future__ import annotations

import itertools
import os
from collections import Counter, OrderedDict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import ray
from ray.exceptions import RayError, RayTaskError

from islands.executors.watchdog import ending_process_after
from islands.integration_ga import (
    Handle,
    Outcome,
    Problem,
    Task,
    Work,
    remembered,
    run_task,
)
from meshops.mesh import ShellMesh
from meshops.quality_sums import TALLY_SIZE

TRIES = 4
"""Processes that an operation GA may end before it has no answer."""

ASKED_AGAIN = 10
"""Times, where the ledger was lost."""

CALLS = 500
"""Of a worker process, which is replaced then: libraries leak."""

CPUS = 0.95
"""Of a task: the actors that wait for it take a little of each machine."""

Key = tuple[str, Task]
"""A task, and the problem that it is of."""

Ticket = tuple[Key, int]
"""A task as it was given to Ray once: the task and a number of its own."""

_OF_THE_MACHINE = (RayError, MemoryError)
"""Errors within a process that another one need not meet."""


def is_our_own(error: RayError) -> bool:
    """Whether our own code has failed, and would again in another process."""
    return isinstance(error, RayTaskError) and not isinstance(error.cause, _OF_THE_MACHINE)


def _run(
    ledger: Any, ticket: Ticket, problem: Problem, task: Task, mesh: ShellMesh, limit: float
) -> tuple[Outcome, ShellMesh | None]:
    """Run an operation GA within `limit` seconds; no mesh where it stays as it is.

    Ray tries it again wherever its process or its machine is lost, which may be by chance. It has
    no answer where it has begun too often and never come to its end.
    """
    if ray.get(ledger.begin.remote(ticket)) > TRIES:
        ledger.end.remote(ticket)
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
    ledger.end.remote(ticket)
    return outcome, None if after is mesh else after


_run_remotely = ray.remote(num_returns=2, num_cpus=CPUS, max_retries=-1, max_calls=CALLS)(_run)


@dataclass(frozen=True, eq=False)
class Parcel:
    """A work whose parts are in the object store, where each machine takes them from once.

    Attributes
    ----------
    batch : int
        Of works that are evolved at the same time.
    problem, mesh : ObjectRef
    elements : int
        Of the mesh.
    terms : dict
        The other fields of the work.
    """

    batch: int
    problem: Any
    mesh: Any
    elements: int
    terms: Mapping[str, Any]

    @property
    def is_whole(self) -> bool:
        """Whether the work is a mesh as one place."""
        return bool(self.terms["is_whole"])

    @classmethod
    def of(cls, work: Work, batch: int) -> Parcel:
        """Put a work there."""
        problem, mesh = ray.put(work.problem), ray.put(work.mesh)
        names = {field.name for field in fields(work)} - {"problem", "mesh"}
        terms = {name: getattr(work, name) for name in names}
        return cls(batch, problem, mesh, len(work.mesh.elements), terms)

    def open(self) -> Work:
        """Take the work out."""
        problem, mesh = ray.get([self.problem, self.mesh])
        return Work(problem, mesh, **self.terms)


class _Ledger:
    """An actor that knows the tasks that were asked for lately, and how often each has begun.

    One that dies is started anew and knows nothing: tasks are run again, to the same end.
    """

    def __init__(self, limit: float) -> None:
        self._limit = limit
        self._self = ray.get_runtime_context().current_actor
        self._known: OrderedDict[Key, tuple[Any, Any]] = OrderedDict()
        self._running: set[Key] = set()
        self._begun: Counter[Ticket] = Counter()
        self._tickets = itertools.count()

    def ask(self, parcel: Parcel, jobs: Sequence[tuple[Task, Any]]) -> list[tuple[Any, Any, bool]]:
        """Return references to the outcome and the mesh of each, and whether it is new."""
        found = []
        for task, mesh in jobs:
            key = parcel.problem.hex(), task
            is_new = key not in self._known
            if is_new:
                ticket = key, next(self._tickets)
                self._running.add(key)
                self._known[key] = _run_remotely.remote(
                    self._self, ticket, parcel.problem, task, mesh, self._limit
                )
            self._known.move_to_end(key)
            found.append((*self._known[key], is_new))
        self._shrink(max(remembered(parcel.elements), len(jobs)))
        return found

    def begin(self, ticket: Ticket) -> int:
        """Count how often a task has begun."""
        self._begun[ticket] += 1
        return self._begun[ticket]

    def end(self, ticket: Ticket) -> None:
        """Forget how often: it has come to its end."""
        del self._begun[ticket]
        self._running.discard(ticket[0])

    def forget(self, parcel: Parcel, tasks: Sequence[Task]) -> None:
        """Forget tasks whose answers are lost."""
        for task in tasks:
            self._known.pop((parcel.problem.hex(), task), None)

    def _shrink(self, most: int) -> None:
        """Forget what was asked for longest ago, but none that is running."""
        excess = max(len(self._known) - most, 0)
        oldest = itertools.islice(self._known, excess + len(self._running) if excess else 0)
        ended = [key for key in oldest if key not in self._running]
        for key in ended[:excess]:
            del self._known[key]


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

    What it asked for is lost where the ledger dies: RayError then.

    Attributes
    ----------
    ledger : actor
    parcel : Parcel
    """

    ledger: Any
    parcel: Parcel

    def run(self, jobs: Sequence[tuple[Task, Handle]]) -> list[tuple[Outcome, Handle, bool]]:
        """Run all at the same time."""
        if not jobs:
            return []
        asked = ray.get(self.ledger.ask.remote(self.parcel, jobs))
        try:
            outcomes = ray.get([outcome for outcome, _, _ in asked])
        except RayError:
            ray.get(self.ledger.forget.remote(self.parcel, [task for task, _ in jobs]))
            raise
        return [
            (outcome, mesh, is_new)
            for outcome, (_, mesh, is_new) in zip(outcomes, asked, strict=True)
        ]


@dataclass(frozen=True, eq=False)
class CarefulRunner:
    """Runs operation GAs as tasks, and keeps the meshes, which are small, itself.

    Where this process dies the ledger knows what was done, and where the ledger does this process
    has it: however often either is lost, a step comes to its end.

    Attributes
    ----------
    asking : LedgerRunner
    """

    asking: LedgerRunner

    def run(self, jobs: Sequence[tuple[Task, Handle]]) -> list[tuple[Outcome, Handle, bool]]:
        """Run all at the same time, again where the ledger was lost meanwhile."""
        for _ in range(ASKED_AGAIN):
            try:
                return self._run(jobs)
            except RayError as error:
                if is_our_own(error):
                    raise
        return self._run(jobs)

    def _run(self, jobs: Sequence[tuple[Task, Handle]]) -> list[tuple[Outcome, Handle, bool]]:
        found = self.asking.run(jobs)
        meshes = ray.get([mesh for _, mesh, _ in found])
        return [
            (outcome, before if after is None else after, is_new)
            for (outcome, _, is_new), (_, before), after in zip(found, jobs, meshes, strict=True)
        ]
