"""Sharing: which job each host has next where the islands of archipelagos are shared out.

What is promised: an island is always with the same host, which remembers what it has learned; each
steps as soon as it may and its host is free. An archipelago that is over is finished by the host
that knows what its fittest procedure leads to, as soon as that has taken the step that it is at.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from islands.archipelago import Archipelago, Milestone
from islands.executors.crew import Job
from islands.executors.ledger import Parcel
from islands.finishing import Piece
from islands.island import IslandState


class Sharing:
    """The islands of some archipelagos, and what they wait for.

    Parameters
    ----------
    archipelagos : sequence of Archipelago
    batch : int
        That sets them apart from those before.
    hosts : int
    """

    def __init__(self, archipelagos: Sequence[Archipelago], batch: int, hosts: int) -> None:
        self._archipelagos = archipelagos
        self._parcels = [Parcel.of(archipelago.work, batch) for archipelago in archipelagos]
        self._waiting: list[deque[tuple[int, Job]]] = [deque() for _ in range(hosts)]
        self._unfinished = {a.number for a in archipelagos if not a.is_over}
        self._finishing: dict[int, Milestone] = {}
        for archipelago in archipelagos:
            self._queue_steps(archipelago)

    @property
    def is_over(self) -> bool:
        """Whether all last milestones were given out."""
        return not self._unfinished

    def next_job(self, host: int) -> Job | None:
        """Take the next job of a host from its queue, if there is any."""
        queue = self._waiting[host]
        while queue:
            number, job = queue.popleft()
            if job.method == "finish" or not self._archipelagos[number].is_over:
                return job
        return None

    def take(self, value: IslandState | tuple[int, Piece]) -> Iterator[Milestone]:
        """Take what a host has made: an island after its step, or the piece of a work."""
        if not isinstance(value, IslandState):
            number, piece = value
            yield self._given_out(replace(self._finishing.pop(number), piece=piece))
            return
        archipelago = self._archipelagos[value.work]
        for milestone in archipelago.take(value):
            if milestone.is_last and not archipelago.work.is_whole:
                self._finishing[milestone.work] = milestone
                self._queue_finish(milestone)
            else:
                yield self._given_out(milestone)
        self._queue_steps(archipelago)

    def without_pieces(self) -> Iterator[Milestone]:
        """Give out the last milestones whose pieces are not known yet, where time is up."""
        while self._finishing:
            _, milestone = self._finishing.popitem()
            yield self._given_out(milestone)

    def _given_out(self, milestone: Milestone) -> Milestone:
        if milestone.is_last:
            self._unfinished.discard(milestone.work)
        return milestone

    def _queue_steps(self, archipelago: Archipelago) -> None:
        for asked in archipelago.ready():
            plan = archipelago.schedule.plans[asked[0].island]
            given = {"asked": asked, "plan": plan, "parcel": self._parcels[archipelago.number]}
            job = Job("step", partial(_with_care, given))
            self._waiting[self._host_of(asked[0])].append((archipelago.number, job))

    def _queue_finish(self, milestone: Milestone) -> None:
        number = milestone.work
        fittest = self._archipelagos[number].fittest(milestone)
        given = {"number": number, "steps": fittest.best_steps, "parcel": self._parcels[number]}
        self._waiting[self._host_of(fittest)].appendleft((number, Job("finish", lambda _: given)))

    def _host_of(self, state: IslandState) -> int:
        islands = self._archipelagos[state.work].schedule.islands
        return (state.work * islands + state.island) % len(self._waiting)


def _with_care(given: dict[str, Any], is_careful: bool) -> dict[str, Any]:  # noqa: FBT001
    return {**given, "is_careful": is_careful}
