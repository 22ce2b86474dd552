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
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
os.environ.setdefault("RAY_AUTH_MODE", "disabled")
os.environ.setdefault("RAY_ENABLE_UV_RUN_RUNTIME_ENV", "0")

import ray
from ray.exceptions import RayError, RayTaskError

from islands.archipelago import TimeUpError
from islands.executors.local import root_outcome
from islands.genetics import Breeding
from islands.integration_ga import Evaluator, Handle, Outcome, Problem, Task, run_task
from islands.island import IslandState, Migrants, step
from meshops.errors import InputError
from meshops.mesh import ShellMesh

TRIES = 3
"""Times that a generation is asked for before a fault of the cluster ends the run."""

_KNOCK_SECONDS = 5.0


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


class _Island:
    """An island's actor. References arrive in lists, which keeps Ray from fetching them."""

    def __init__(
        self, problem: list[Any], root: Outcome, mesh: list[Any], breeding: Breeding, genes: int
    ) -> None:
        runner = RayRunner(problem[0])
        self._evaluator = Evaluator(ray.get(problem[0]), runner, root, mesh[0])
        self._breeding = breeding
        self._genes = genes

    def step(self, state: IslandState, immigrants: Migrants | None) -> IslandState:
        """Step the island by one generation."""
        return step(state, immigrants, self._evaluator, self._breeding, self._genes)


# Actors wait while their tasks work: a whole CPU each would leave none for the tasks.
_IslandActor = ray.remote(num_cpus=0.01, scheduling_strategy="SPREAD")(_Island)


class RayExecutor:
    """One actor an island, on a cluster or, without an address, on this machine."""

    def __init__(
        self,
        problem: Problem,
        mesh: ShellMesh,
        breeding: Breeding,
        genes: int,
        *,
        address: str | None = None,
        deadline: float = float("inf"),
    ) -> None:
        self._started_ray = connect(address)
        self._deadline = deadline
        self._actors: dict[int, Any] = {}
        self._arguments = (
            [ray.put(problem)],
            root_outcome(problem, mesh),
            [ray.put(mesh)],
            breeding,
            genes,
        )

    def advance(
        self, steps: Sequence[tuple[IslandState, Migrants | None]]
    ) -> Iterator[IslandState]:
        """Step all islands at the same time."""
        tries = dict.fromkeys(range(len(steps)), 1)
        running = {self._ask(*asked): number for number, asked in enumerate(steps)}
        while running:
            ready, _ = ray.wait(list(running), timeout=self._seconds_left())
            if not ready:
                raise TimeUpError
            number = running.pop(ready[0])
            try:
                yield ray.get(ready[0])
            except RayTaskError:
                raise  # our own code failed, and would again
            except RayError:
                if tries[number] == TRIES:
                    raise
                tries[number] += 1
                self._forget(steps[number][0].island)
                running[self._ask(*steps[number])] = number

    def close(self) -> None:
        """End the actors, and Ray where this executor started it."""
        for island in list(self._actors):
            self._forget(island)
        if self._started_ray:
            ray.shutdown()

    def _ask(self, state: IslandState, immigrants: Migrants | None) -> Any:
        if state.island not in self._actors:
            self._actors[state.island] = _IslandActor.remote(*self._arguments)
        return self._actors[state.island].step.remote(state, immigrants)

    def _forget(self, island: int) -> None:
        ray.kill(self._actors.pop(island))

    def _seconds_left(self) -> float | None:
        if self._deadline == float("inf"):
            return None
        return max(0.0, self._deadline - time.monotonic())


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
