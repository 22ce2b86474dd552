"""Interruption: Ctrl-C as a wish that is heeded where nothing is half done."""

from __future__ import annotations

import signal
from types import FrameType, TracebackType
from typing import Any, Self

SIGNALS = (signal.SIGINT, signal.SIGTERM)


class Interruption:
    """Takes the first signal as a wish to end, the second as an order to stop at once.

    A KeyboardInterrupt wherever the program happens to be can hit a library in the middle of its
    work, which may turn it into another error.
    """

    def __init__(self) -> None:
        self._is_asked = False
        self._before: list[Any] = []

    def __enter__(self) -> Self:
        """Take over the signals."""
        self._before = [signal.signal(number, self._ask) for number in SIGNALS]
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        """Give the signals back."""
        for number, handler in zip(SIGNALS, self._before, strict=True):
            signal.signal(number, handler)

    def heed(self) -> None:
        """Raise KeyboardInterrupt where a signal has come."""
        if self._is_asked:
            raise KeyboardInterrupt

    def _ask(self, number: int, frame: FrameType | None) -> None:
        if self._is_asked:
            raise KeyboardInterrupt
        self._is_asked = True
