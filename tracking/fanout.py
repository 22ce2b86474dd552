"""Fanout: one recorder that stands for several."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from tracking.events import Event, Recorder


class Fanout:
    """Passes everything on to each of its recorders, in their order."""

    def __init__(self, recorders: Sequence[Recorder]) -> None:
        self._recorders = tuple(recorders)

    def record(self, event: Event) -> None:
        """Pass one event on."""
        for recorder in self._recorders:
            recorder.record(event)

    def keep(self, paths: Sequence[Path]) -> None:
        """Pass the files on."""
        for recorder in self._recorders:
            recorder.keep(paths)

    def close(self) -> None:
        """Close all in their order, even where one of them raises."""
        with ExitStack() as stack:
            for recorder in reversed(self._recorders):
                stack.callback(recorder.close)
