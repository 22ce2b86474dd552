"""Processes below one, and a thread that kills some of them."""

from __future__ import annotations

import os
import signal
import threading
from contextlib import suppress
from pathlib import Path
from typing import Self

LOOK_SECONDS = 0.1


def descendants(pid: int) -> list[tuple[int, str]]:
    """Return the numbers and names of all processes below one."""
    children: dict[int, list[int]] = {}
    for path in Path("/proc").glob("[0-9]*"):
        try:
            parent = int((path / "stat").read_text(errors="replace").rpartition(")")[2].split()[1])
        except OSError:
            continue
        children.setdefault(parent, []).append(int(path.name))
    found, waiting = [], [pid]
    while waiting:
        below = children.get(waiting.pop(), [])
        waiting += below
        found += below
    return sorted((number, _name(number)) for number in found)


class Killer(threading.Thread):
    """Kills a process below one as soon as there is any, and then every so often.

    Parameters
    ----------
    pid : int
        The process above.
    seconds : float
        Between two kills.
    names : tuple of str
        What the names of those that may die begin with; they take turns.
    most : float
        How many.

    Attributes
    ----------
    killed : int
        So far.
    """

    def __init__(
        self, pid: int, seconds: float, names: tuple[str, ...], most: float = float("inf")
    ) -> None:
        super().__init__(daemon=True)
        self._most = most
        self.killed = 0
        self._pid = pid
        self._seconds = seconds
        self._names = names
        self._is_over = threading.Event()

    def run(self) -> None:
        """Kill until it is told to end."""
        pause = 0.0
        while self.killed < self._most and not self._is_over.wait(pause):
            found = [pid for pid, name in descendants(self._pid) if name.startswith(self._names)]
            pause = LOOK_SECONDS
            if found:
                with suppress(ProcessLookupError):
                    os.kill(found[self.killed % len(found)], signal.SIGKILL)
                    self.killed += 1
                pause = self._seconds

    def __enter__(self) -> Self:
        """Begin."""
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        """End."""
        self._is_over.set()
        self.join()


def _name(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0")[0].decode(errors="replace")
    except OSError:
        return ""
