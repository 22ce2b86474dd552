"""MlflowRecorder: shows a run in MLflow, live, and never stands in its way."""

from __future__ import annotations

import re
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Event as Signal
from threading import Thread

from tracking.events import Event, RunFinished, RunStarted
from tracking.metrics import Metrics, Point
from tracking.mlflow_store import (
    BATCH,
    EXPERIMENT,
    MlflowStore,
    default_store,
    first_line,
    store_uri,
)

DRAIN_SECONDS = 2.0
CLOSE_SECONDS = 30.0


class MlflowRecorder:
    """Sends events to MLflow from a thread of its own.

    ``record`` only puts points into a queue. The thread empties it every ``DRAIN_SECONDS``. What
    the server does not take is kept and tried again, so a server that comes back gets everything;
    the run hears nothing of it. The user is told once, and at the end how much is missing.

    Parameters
    ----------
    uri : str or None
        An MLflow tracking URI; None for the embedded store ``mlflow.db`` in the current folder,
        with the artifacts in ``mlartifacts`` beside it.
    notify : callable
        Takes a sentence for the user; called from the thread too.
    experiment : str
        Name of the MLflow experiment.
    store : MlflowStore, optional
        Takes the place of a store made of ``uri`` and ``experiment``.
    """

    def __init__(
        self,
        uri: str | None,
        *,
        notify: Callable[[str], None],
        experiment: str = EXPERIMENT,
        store: MlflowStore | None = None,
    ) -> None:
        self._store = store or MlflowStore(uri or store_uri(default_store(Path.cwd())), experiment)
        self._notify = notify
        self._metrics = Metrics()
        self._queue: SimpleQueue[Point] = SimpleQueue()
        self._pending: dict[int, list[Point]] = defaultdict(list)
        self._started: RunStarted | None = None
        self._finished: RunFinished | None = None
        self._files: tuple[Path, ...] = ()
        self._is_open = False
        self._is_complete = False
        self._was_told = False
        self._is_closing = False
        self._wake = Signal()
        # A daemon: a server that never answers must not keep the process from ending.
        self._thread = Thread(target=self._run, name="mlflow-recorder", daemon=True)
        self._thread.start()

    def record(self, event: Event) -> None:
        """Put the event's points into the queue."""
        for point in self._metrics.points(event, time.time_ns() // 1_000_000):
            self._queue.put(point)
        if isinstance(event, RunStarted):
            self._started = event
            self._wake.set()  # the first call takes seconds: let them pass while the run begins
        elif isinstance(event, RunFinished):
            self._finished = event

    def keep(self, paths: Sequence[Path]) -> None:
        """Log the files as artifacts when the recorder is closed."""
        self._files = tuple(paths)

    def close(self) -> None:
        """Send the rest, for ``CLOSE_SECONDS`` at most, and say what is missing."""
        if self._is_closing:
            return
        self._is_closing = True
        self._wake.set()
        self._thread.join(CLOSE_SECONDS)
        if self._is_complete or self._started is None:
            return
        self._was_told = True
        missing = self._queue.qsize() + sum(map(len, list(self._pending.values())))
        what = f"{missing} points" if missing else "the end and the files"
        self._say(f"Of this run {what} are missing at {self._store.uri}; the run folder has them.")

    def _run(self) -> None:
        while True:
            self._wake.wait(DRAIN_SECONDS)
            self._wake.clear()
            is_last = self._is_closing
            has_drained = self._drain(is_last=is_last)
            # A server that fails while the run is closing is not asked again: it may take the
            # full time-out once more, and nobody waits so long.
            if is_last or (self._is_closing and not has_drained):
                return

    def _drain(self, *, is_last: bool) -> bool:
        """Send what there is; return whether all of it was taken."""
        for point in self._queued():
            self._pending[point.island].append(point)
        if self._started is None:
            return True
        try:
            if not self._is_open:
                self._store.open(self._started)
                self._is_open = True
            for points in self._pending.values():
                while points:
                    self._store.log(points[:BATCH])
                    del points[:BATCH]
            if is_last:
                self._store.finish(self._finished)
                self._store.keep(self._files)
                self._is_complete = True
        except Exception as error:
            # Whatever it is, it is not the run's business. What the store has taken of the last
            # call is unknown: it is opened anew.
            self._is_open = False
            self._tell(error)
            return False
        return True

    def _queued(self) -> Iterator[Point]:
        while True:
            try:
                yield self._queue.get_nowait()
            except Empty:
                return

    def _tell(self, error: Exception) -> None:
        if self._was_told:
            return
        self._was_told = True
        is_remote = self._store.uri.startswith("http")
        has_no_answer = any(isinstance(e, OSError) for e in (error, error.__context__))
        place = "server" if is_remote else "store"
        trouble = (
            "does not answer"
            if is_remote and has_no_answer
            else f"does not take the record ({first_line(error)})"
        )
        self._say(
            f"The tracking {place} at {self._store.uri} {trouble}: "
            "the run goes on, its record is in the run folder."
        )

    def _say(self, sentence: str) -> None:
        without_password = re.sub(r"//[^/@\s]*@", "//", sentence)
        self._notify(without_password)
