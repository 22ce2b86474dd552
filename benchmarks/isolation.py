"""A call in a process of its own: what crashes or hangs there does no harm here."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any, Literal, TypeVar

Value = TypeVar("Value")


class IsolatedError(Exception):
    """The process raised, crashed or did not end in time."""


def isolated(
    call: Callable[..., Value],
    *arguments: object,
    timeout: float,
    method: Literal["spawn", "forkserver"] = "forkserver",
) -> Value:
    """Return what ``call(*arguments)`` returns in a new process.

    `timeout` in seconds. With the method "spawn" the memory of the process is its own from the
    first page on. Raises IsolatedError where no value comes back.
    """
    context: Any = multiprocessing.get_context(method)
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_answer, args=(sender, call, arguments), daemon=True)
    process.start()
    sender.close()
    try:
        if not receiver.poll(timeout):
            raise IsolatedError(f"no answer within {timeout:g} s")
        value, failure = receiver.recv()
    except EOFError:
        process.join()
        raise IsolatedError(f"the process ended with exit code {process.exitcode}") from None
    finally:
        process.kill()
        process.join()
    if failure is not None:
        raise IsolatedError(failure)
    answer: Value = value
    return answer


def _answer(sender: Connection, call: Callable[..., Any], arguments: tuple[object, ...]) -> None:
    try:
        sender.send((call(*arguments), None))
    except Exception as error:  # whatever a peer raises is an answer too
        sender.send((None, f"{type(error).__name__}: {error}"))
