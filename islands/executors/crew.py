"""Crew: Ray actors that host islands, the jobs that they are at, and what follows when one dies.

What is promised: each job is answered, whatever becomes of the actors, as long as Ray itself
answers and not all of `TRIES` actors die of the same job. An actor keeps nothing but what it has
learned, so one that dies is started anew and asked again. What is not promised: how often a job is
begun.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import ray
from ray.exceptions import RayError

from islands.archipelago import TimeUpError
from islands.executors.ledger import is_our_own
from meshops.errors import InputError

TRIES = 60
"""Actors that may die of one job before the run ends: each of a fault of its own, since what kills
an actor for sure is taken out of it before."""

CAREFUL = 3
"""One actor of so many has operation GAs run as tasks, where one that ends its process can be told;
the others run them themselves, which is faster and needs fewer processes to live."""

MOST_MEMORY = 2e9
"""Bytes of an actor above which another takes its place: libraries leak."""

_LISTEN_SECONDS = 0.5


@dataclass(eq=False)
class Job:
    """A call of an actor.

    Attributes
    ----------
    method : str
    arguments : callable
        Makes them by name, told whether this try is a careful one.
    tries : int
        Actors that have died of it, or by chance beside it.
    """

    method: str
    arguments: Callable[[bool], dict[str, Any]]
    tries: int = 0

    @property
    def is_careful(self) -> bool:
        """Whether operation GAs are run as tasks: one that ends its process can be told then."""
        return self.tries % CAREFUL == CAREFUL - 1


@dataclass(frozen=True, eq=False)
class Answer:
    """What an actor has to say.

    Attributes
    ----------
    value : object
    is_late : bool
        Whether time was up before it was done.
    memory : int
        Bytes that its process takes.
    """

    value: Any
    is_late: bool
    memory: int


@dataclass(eq=False)
class Crew:
    """Actors by number, each at one job at the most.

    Attributes
    ----------
    start : callable
        Starts an actor.
    heed : callable
        Raises KeyboardInterrupt where the user wants to end.
    deadline : float
        A time of time.time().
    """

    start: Callable[[], Any]
    heed: Callable[[], None]
    deadline: float
    _actors: dict[int, Any] = field(default_factory=dict)
    _calls: dict[Any, tuple[int, Job]] = field(default_factory=dict)

    @property
    def is_busy(self) -> bool:
        """Whether an answer is to come."""
        return bool(self._calls)

    def give(self, number: int, job: Job) -> None:
        """Give an actor a job; it is started where it is not there yet."""
        if number not in self._actors:
            self._actors[number] = self.start()
        method = getattr(self._actors[number], job.method)
        self._calls[method.remote(**job.arguments(job.is_careful))] = number, job

    def next(self) -> tuple[int, Answer]:
        """Wait for the next answer, with the actor's number.

        Raises TimeUpError where time is up, InputError where too many actors have died.
        """
        while True:
            self.heed()
            left = max(0.0, self.deadline - time.time())
            ready, _ = ray.wait(list(self._calls), timeout=min(_LISTEN_SECONDS, left))
            if not ready:
                if not left:
                    raise TimeUpError
                continue
            number, job = self._calls.pop(ready[0])
            try:
                answer: Answer = ray.get(ready[0])
            except RayError as error:
                self._replace(number, job, error)
                continue
            if answer.memory > MOST_MEMORY:
                self.dismiss(number)
            return number, answer

    def dismiss(self, number: int) -> None:
        """End an actor."""
        ray.kill(self._actors.pop(number))

    def dismiss_all(self) -> None:
        """End all actors and forget what they were at."""
        self._calls.clear()
        for number in list(self._actors):
            self.dismiss(number)

    def _replace(self, number: int, job: Job, error: RayError) -> None:
        """Give the job to another actor, unless our own code has failed, which would again."""
        if is_our_own(error):
            raise error
        job.tries += 1
        if job.tries == TRIES:
            raise InputError(
                f"Ray has lost {TRIES} processes at the same piece of work (the last one: "
                f"{str(error).splitlines()[0]}); look into Ray's logs, then go on with "
                "meshipelago resume."
            ) from None
        self.dismiss(number)
        self.give(number, job)
