"""Watchdog: ends this process where something takes too long, even within compiled code."""

from __future__ import annotations

import faulthandler
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def ending_process_after(seconds: float) -> Iterator[None]:
    """Exit from the process, its stack on stderr, unless what follows is done in so many seconds.

    A signal or a thread of Python would wait for a hanging library to come back; this thread is C's
    and needs no lock.
    """
    if seconds == float("inf"):
        yield
        return
    faulthandler.dump_traceback_later(seconds, exit=True, file=sys.__stderr__ or 2)
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()
