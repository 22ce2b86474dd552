"""Islands as Ray actors, their operation GAs as Ray tasks.

What is promised: the same answer as in one process, because a generation is a pure function of its
island's state and an operation GA one of its task. What is not promised: how many operation GAs
run, since actors learn apart from each other and those that die are asked again.
"""

from __future__ import annotations

import os
import socket
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
os.environ.setdefault("RAY_AUTH_MODE", "disabled")
os.environ.setdefault("RAY_ENABLE_UV_RUN_RUNTIME_ENV", "0")

import ray

from islands.archipelago import Archipelago, Asked, Milestone, TimeUpError
from islands.executors.crew import Answer, Crew, Job
from islands.executors.ledger import CarefulRunner, LedgerRunner, Parcel, start_ledger
from islands.executors.local import LocalRunner, evolve_here
from islands.executors.sharing import Sharing
from islands.finishing import finished
from islands.integration_ga import Evaluator, Runner, Work, Workbench
from islands.island import IslandPlan, step
from islands.procedure import Step
from meshops.errors import InputError

_KNOCK_SECONDS = 5.0


class _Host:
    """An actor that hosts islands.

    The operation GAs of a whole mesh are tasks. Those of many small places take milliseconds, and
    run here, unless they have ended this process before.

    Parameters
    ----------
    ledger : actor
    deadline : float
        A time of time.time(): another machine may have another monotonic clock.
    limit : float
        Seconds of an operation GA.
    """

    def __init__(self, ledger: Any, deadline: float, limit: float) -> None:
        self._ledger = ledger
        self._deadline = time.monotonic() + deadline - time.time()
        self._limit = limit
        self._bench = Workbench()
        self._scorers: dict[tuple[int, str, bool], Evaluator] = {}

    def evolve(self, archipelago: Archipelago, parcel: Parcel | None) -> Answer:
        """Evolve an archipelago, with care where a parcel is given; milestones until time is up."""
        work, milestones = archipelago.work, list[Milestone]()
        runner = self._running(work)
        if parcel is not None:
            runner = CarefulRunner(self._asking(parcel))
        is_late = False
        try:
            milestones.extend(evolve_here(archipelago, runner))
        except TimeUpError:
            is_late = True
        return Answer(milestones, is_late, _memory())

    def step(self, asked: Asked, plan: IslandPlan, parcel: Parcel, *, is_careful: bool) -> Answer:
        """Step an island; without a value where time is up."""
        try:
            state = step(*asked, self._scorer(parcel, is_careful=is_careful), plan)
        except TimeUpError:
            return Answer(None, is_late=True, memory=_memory())
        return Answer(state, is_late=False, memory=_memory())

    def finish(self, number: int, steps: tuple[Step, ...], parcel: Parcel) -> Answer:
        """Make the piece of a work, from memory where its procedure was found here."""
        scorers = [
            s for k, s in self._scorers.items() if k[:2] == (parcel.batch, parcel.mesh.hex())
        ]
        known = [mesh for s in scorers if (mesh := s.mesh_after(steps)) is not None]
        mesh = known[0] if known else None
        value = number, finished(parcel.open(), steps, mesh)
        return Answer(value, is_late=False, memory=_memory())

    def _scorer(self, parcel: Parcel, *, is_careful: bool) -> Evaluator:
        """Return the evaluator of a work; those of batches before it are forgotten."""
        key = parcel.batch, parcel.mesh.hex(), is_careful and not parcel.is_whole
        if key not in self._scorers:
            work = parcel.open()
            self._scorers = {k: v for k, v in self._scorers.items() if k[0] == parcel.batch}
            if work.is_whole:
                scorer = Evaluator.of(work, self._asking(parcel), parcel.mesh)
            elif is_careful:
                scorer = Evaluator.of(work, CarefulRunner(self._asking(parcel)))
            else:
                scorer = Evaluator.of(work, self._running(work))
            self._scorers[key] = scorer
        return self._scorers[key]

    def _running(self, work: Work) -> Runner:
        return LocalRunner(work.problem, self._deadline, bench=self._bench, limit=self._limit)

    def _asking(self, parcel: Parcel) -> LedgerRunner:
        return LedgerRunner(self._ledger, parcel)


_HostActor = ray.remote(num_cpus=0.001, scheduling_strategy="SPREAD")(_Host)
"""Hosts wait while tasks work: a whole CPU each would leave none for the tasks."""


class RayExecutor:
    """Islands in actors, on a cluster or, without an address, on this machine.

    There are no more actors than CPUs. Where there are many archipelagos, each actor evolves one
    whole archipelago after the other; otherwise their islands are shared out.

    Parameters
    ----------
    address : str or None
        Of a cluster.
    workers : int or None
        CPUs of a Ray that is started here, and actors at the most; None: as many as there are.
    deadline : float
        A time of time.monotonic().
    limit : float
        Seconds of an operation GA, after which its process is ended.
    heed : callable
        Raises KeyboardInterrupt where the user wants to end.
    """

    def __init__(
        self,
        *,
        address: str | None = None,
        workers: int | None = None,
        deadline: float = float("inf"),
        limit: float = float("inf"),
        heed: Callable[[], None] = lambda: None,
    ) -> None:
        self._started_ray = connect(address, workers)
        self._workers = workers
        deadline = time.time() + deadline - time.monotonic()
        self._ledger = start_ledger(limit)
        self._crew = Crew(lambda: _HostActor.remote(self._ledger, deadline, limit), heed, deadline)
        self._batch = 0

    def evolve(self, archipelagos: Sequence[Archipelago]) -> Iterator[Milestone]:
        """Evolve all of them at the same time."""
        cpus = self._cpus()
        islands = sum(archipelago.schedule.islands for archipelago in archipelagos)
        try:
            if len(archipelagos) >= cpus and not any(a.work.is_whole for a in archipelagos):
                yield from self._evolve_whole(archipelagos, cpus)
            else:
                yield from self._evolve_by_islands(archipelagos, min(cpus, islands))
        finally:
            if self._crew.is_busy:
                self._crew.dismiss_all()

    def close(self) -> None:
        """End the actors, and Ray where this executor started it."""
        self._crew.dismiss_all()
        ray.kill(self._ledger)
        if self._started_ray:
            ray.shutdown()

    def _cpus(self) -> int:
        """How many there are now: nodes may join and leave."""
        cpus = max(1, int(ray.cluster_resources().get("CPU", 1)))
        return cpus if self._workers is None else min(cpus, self._workers)

    def _evolve_whole(self, archipelagos: Sequence[Archipelago], hosts: int) -> Iterator[Milestone]:
        """Give each host one archipelago after the other, the largest first."""
        by_size = sorted(archipelagos, key=lambda a: -len(a.work.mesh.elements))
        waiting = deque(self._whole(archipelago) for archipelago in by_size)
        for host in range(min(hosts, len(waiting))):
            self._crew.give(host, waiting.popleft())
        while self._crew.is_busy:
            host, answer = self._crew.next()
            if waiting:
                self._crew.give(host, waiting.popleft())
            yield from answer.value
            if answer.is_late:
                raise TimeUpError

    def _whole(self, archipelago: Archipelago) -> Job:
        """Make evolving an archipelago a job; what it asks the ledger for outlives its host."""
        reference = ray.put(archipelago)
        parcels: list[Parcel] = []

        def arguments(is_careful: bool) -> dict[str, Any]:  # noqa: FBT001
            if is_careful and not parcels:
                parcels.append(Parcel.of(archipelago.work, self._batch))
            return {"archipelago": reference, "parcel": parcels[0] if is_careful else None}

        return Job("evolve", arguments)

    def _evolve_by_islands(
        self, archipelagos: Sequence[Archipelago], hosts: int
    ) -> Iterator[Milestone]:
        """Share islands out to hosts; each steps as soon as it may and its host is free."""
        self._batch += 1
        sharing = Sharing(archipelagos, self._batch, hosts)
        idle = set(range(hosts))
        try:
            while not sharing.is_over:
                for host in sorted(idle):
                    job = sharing.next_job(host)
                    if job is not None:
                        idle.remove(host)
                        self._crew.give(host, job)
                host, answer = self._crew.next()
                if answer.is_late:
                    raise TimeUpError
                idle.add(host)
                yield from sharing.take(answer.value)
        except (TimeUpError, KeyboardInterrupt):
            yield from sharing.without_pieces()
            raise


def connect(address: str | None, cpus: int | None = None) -> bool:
    """Connect to Ray unless that has been done; whether it was done here.

    Without an address, and not within a Ray job, it is started here, with so many CPUs.

    Raises InputError where no cluster answers at the address.
    """
    if ray.is_initialized():
        return False
    wanted = address or os.environ.get("RAY_ADDRESS")
    options: dict[str, Any] = {"log_to_driver": False, "logging_level": "error"}
    try:
        if wanted is None:
            # without this word it would join whatever cluster was started on this machine
            ray.init(address="local", include_dashboard=False, num_cpus=cpus, **options)
        else:
            _knock(wanted)
            ray.init(address=wanted, **options)
    except (OSError, RuntimeError, ValueError) as error:
        reason = (str(error).splitlines() or [type(error).__name__])[0].rstrip(".")
        if wanted is None:
            raise InputError(f"Ray does not start on this machine: {reason}.") from None
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


def _memory() -> int:
    """Bytes that this process has in memory."""
    pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")
