"""Islands as Ray actors, their operation GAs as Ray tasks: the only file that imports ray.

What is promised: the same answer as in one process, because a generation is a pure function of its
island's state and an operation GA one of its task. An actor keeps nothing but what it has learned,
so one that dies is started anew and asked again. What is not promised: how many operation GAs run,
since actors learn apart from each other.
"""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
os.environ.setdefault("RAY_AUTH_MODE", "disabled")
os.environ.setdefault("RAY_ENABLE_UV_RUN_RUNTIME_ENV", "0")

import ray
from ray.exceptions import RayError, RayTaskError

from islands.archipelago import TimeUpError
from islands.executors.local import evaluator
from islands.integration_ga import Evaluator, Handle, Outcome, Task, Work, Workbench, run_task
from islands.island import IslandPlan, IslandState, step
from islands.migration import Migrants
from meshops.errors import InputError

TRIES = 3
"""Times that a generation is asked for before a fault of the cluster ends the run."""

_KNOCK_SECONDS = 5.0

_LISTEN_SECONDS = 0.5


_run_remotely = ray.remote(num_returns=2, max_retries=TRIES)(run_task)


@dataclass(frozen=True, eq=False)
class RayRunner:
    """Runs operation GAs as tasks; meshes stay in the object store, handles are references."""

    problem: Any

    def run(self, jobs: Sequence[tuple[Task, Handle]]) -> list[tuple[Outcome, Handle]]:
        """Run all at the same time."""
        results = [_run_remotely.remote(self.problem, task, mesh) for task, mesh in jobs]
        outcomes = ray.get([outcome for outcome, _ in results])
        return list(zip(outcomes, [mesh for _, mesh in results], strict=True))


class _Islands:
    """An actor that hosts islands. References arrive in lists, which keeps Ray from fetching them.

    An island that has the mesh for itself runs its operation GAs as tasks. Where there are many
    works each is small, its operation GAs take milliseconds, and they run here.
    """

    def __init__(self, works: list[Any], plans: Sequence[IslandPlan]) -> None:
        self._works = works
        self._plans = plans
        self._bench = Workbench()
        self._evaluators: dict[int, Evaluator] = {}

    def step(
        self, steps: list[tuple[IslandState, Migrants | None]], deadline: float
    ) -> list[IslandState]:
        """Step islands by one generation each; less of them where time is up."""
        seconds = time.monotonic() + deadline - time.time()
        states = []
        try:
            for state, immigrants in steps:
                scorer = self._evaluator(state.work, seconds)
                states.append(step(state, immigrants, scorer, self._plans[state.island]))
        except TimeUpError:
            pass
        return states

    def _evaluator(self, work: int, deadline: float) -> Evaluator:
        if work not in self._evaluators:
            got = ray.get(self._works[work])
            if len(self._works) == 1:
                runner = RayRunner(ray.put(got.problem))
                self._evaluators[work] = Evaluator(
                    got.problem, runner, got.root, ray.put(got.mesh), is_enough=got.is_solved
                )
            else:
                self._evaluators[work] = evaluator(got, deadline, len(self._works), self._bench)
        return self._evaluators[work]


# Actors wait while their tasks work: a whole CPU each would leave none for the tasks.
_Actor = ray.remote(num_cpus=0.01, scheduling_strategy="SPREAD")(_Islands)


class RayExecutor:
    """Islands in actors, on a cluster or, without an address, on this machine.

    The islands of a work share an actor, and with it what they learn, where there are at least as
    many works as CPUs; otherwise each island has one of its own.
    """

    def __init__(
        self,
        plans: Sequence[IslandPlan],
        *,
        address: str | None = None,
        deadline: float = float("inf"),
        heed: Callable[[], None] = lambda: None,
    ) -> None:
        self._heed = heed
        self._started_ray = connect(address)
        self._plans = plans
        # actors may be on machines with another monotonic clock
        self._deadline = time.time() + deadline - time.monotonic()
        self._cpus = max(1, int(ray.cluster_resources().get("CPU", 1)))
        self._works: list[Any] = []
        self._actors: dict[int, Any] = {}

    def open(self, works: Sequence[Work]) -> None:
        """Put the works into the object store, each once."""
        for actor in list(self._actors):
            self._forget(actor)
        self._works = [ray.put(work) for work in works]

    def advance(
        self, steps: Sequence[tuple[IslandState, Migrants | None]]
    ) -> Iterator[IslandState]:
        """Step all islands, those of one actor in turn and the actors at the same time."""
        shares: dict[int, list[tuple[IslandState, Migrants | None]]] = {}
        for asked in steps:
            shares.setdefault(self._actor_of(asked[0]), []).append(asked)
        tries = dict.fromkeys(shares, 1)
        running = {self._ask(actor, share): actor for actor, share in shares.items()}
        while running:
            self._heed()
            ready, _ = ray.wait(list(running), timeout=min(_LISTEN_SECONDS, self._seconds_left()))
            if not ready and not self._seconds_left():
                raise TimeUpError
            if not ready:
                continue
            actor = running.pop(ready[0])
            try:
                states = ray.get(ready[0])
            except RayTaskError:
                raise  # our own code failed, and would again
            except RayError:
                if tries[actor] == TRIES:
                    raise
                tries[actor] += 1
                self._forget(actor)
                running[self._ask(actor, shares[actor])] = actor
                continue
            yield from states
            if len(states) < len(shares[actor]):
                raise TimeUpError

    def close(self) -> None:
        """End the actors, and Ray where this executor started it."""
        for actor in list(self._actors):
            self._forget(actor)
        if self._started_ray:
            ray.shutdown()

    def _actor_of(self, state: IslandState) -> int:
        works = len(self._works)
        return state.work % self._cpus if works >= self._cpus else state.island * works + state.work

    def _ask(self, actor: int, share: list[tuple[IslandState, Migrants | None]]) -> Any:
        if actor not in self._actors:
            self._actors[actor] = _Actor.remote(self._works, self._plans)
        return self._actors[actor].step.remote(share, self._deadline)

    def _forget(self, actor: int) -> None:
        ray.kill(self._actors.pop(actor))

    def _seconds_left(self) -> float:
        return max(0.0, self._deadline - time.time())


def connect(address: str | None) -> bool:
    """Connect to Ray unless that has been done; whether it was done here.

    Raises InputError where no cluster answers at the address.
    """
    if ray.is_initialized():
        return False
    wanted = address or os.environ.get("RAY_ADDRESS")
    options: dict[str, Any] = {"log_to_driver": False, "logging_level": "error"}
    try:
        if wanted is None:
            ray.init(include_dashboard=False, **options)
        else:
            _knock(wanted)
            ray.init(address=wanted, **options)
    except (OSError, RuntimeError, ValueError) as error:
        reason = (str(error).splitlines() or [type(error).__name__])[0].rstrip(".")
        raise InputError(
            f"No Ray cluster answers at {wanted} ({reason}); check --address, or leave it out "
            "to use this machine."
        ) from None
    return True


def _knock(address: str) -> None:
    """See that something listens: Ray itself waits for minutes and writes pages before it says so.

    Raises OSError where nothing does.
    """
    host, _, port = address.rpartition("://")[2].rpartition(":")
    if host and port.isdecimal():
        socket.create_connection((host.strip("[]"), int(port)), _KNOCK_SECONDS).close()
