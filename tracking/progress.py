"""Live progress: a table on a terminal, plain lines elsewhere."""

from __future__ import annotations

import textwrap
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from tracking.events import (
    Event,
    FaultReport,
    GenerationReport,
    MeshSummary,
    Recorder,
    RoundReport,
    RunFinished,
    RunStarted,
)

if TYPE_CHECKING:
    from rich.live import Live
    from rich.table import Table

_COLUMNS = (
    "island",
    "generation",
    "best fitness",
    "failed",
    "trias",
    "compound Q.I.",
    "evaluations",
    "elapsed",
)
_WIDTH = 80
_REFRESHES_PER_SECOND = 2.0


def progress(stream: TextIO) -> Recorder:
    """Return the recorder that suits the stream."""
    return ProgressDisplay(stream) if stream.isatty() else ProgressLines(stream)


class ProgressLines:
    """Writes a line a generation, and one each for the start and the end of the run."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream

    def record(self, event: Event) -> None:
        """Write the event's line."""
        if isinstance(event, RunStarted):
            lines = [f"{_title(event)}  {_before(event.before)}", *_told(event)]
            print("\n".join(lines), file=self._stream, flush=True)
        elif isinstance(event, GenerationReport):
            print(_line(event), file=self._stream, flush=True)
        elif isinstance(event, FaultReport):
            print(_fault(event), file=self._stream, flush=True)
        elif isinstance(event, RoundReport):
            print(_round(event), file=self._stream, flush=True)
        elif isinstance(event, RunFinished):
            print(_end(event), file=self._stream, flush=True)

    def keep(self, paths: Sequence[Path]) -> None:
        """Do nothing: files are no progress."""

    def close(self) -> None:
        """Do nothing: the stream is the caller's."""


class ProgressDisplay:
    """Shows a table with a row an island, which is drawn again as the run goes on."""

    def __init__(self, stream: TextIO) -> None:
        self._stream = stream
        self._started: RunStarted | None = None
        self._finished: RunFinished | None = None
        self._reports: dict[int, GenerationReport] = {}
        self._start = time.monotonic()
        self._live: Live | None = None

    def record(self, event: Event) -> None:
        """Take the event into the table."""
        if isinstance(event, RunStarted):
            self._started = event
            self._begin()
        elif isinstance(event, GenerationReport):
            # A new dict: the thread that draws may be reading the old one.
            self._reports = dict(sorted({**self._reports, event.island: event}.items()))
        elif isinstance(event, FaultReport) and self._live is not None:
            self._live.console.print(_fault(event), highlight=False)
        elif isinstance(event, RunFinished):
            self._finished = event

    def keep(self, paths: Sequence[Path]) -> None:
        """Do nothing: files are no progress."""

    def close(self) -> None:
        """Draw the table a last time and leave it on the screen."""
        if self._live is None:
            return
        self._live.stop()
        self._live = None

    def _begin(self) -> None:
        from rich.console import Console
        from rich.live import Live

        self._start = time.monotonic()
        self._live = Live(
            get_renderable=self._table,
            console=Console(file=self._stream),
            refresh_per_second=_REFRESHES_PER_SECOND,
        )
        self._live.start()

    def _table(self) -> Table:
        from rich.markup import escape
        from rich.table import Table

        table = Table(caption=escape(self._caption()), caption_justify="left", title_justify="left")
        if self._started is not None:
            lines = [_title(self._started), _before(self._started.before), *_told(self._started)]
            table.title = escape("\n".join(lines))
        for column in _COLUMNS:
            table.add_column(column, justify="right")
        for report in self._reports.values():
            table.add_row(
                str(report.island),
                str(report.generation),
                f"{report.best_so_far:.1f}",
                str(report.failed),
                str(report.trias),
                f"{report.compound_qi:.2f}",
                str(report.evaluations),
                f"{report.seconds:.1f} s",
            )
        return table

    def _caption(self) -> str:
        if self._finished is not None:
            return _end(self._finished)
        return f"{time.monotonic() - self._start:.0f} s"


def _title(started: RunStarted) -> str:
    islands = "1 island" if started.islands == 1 else f"{started.islands} islands"
    return f"{started.name}  seed {started.seed}  {islands}  {started.backend}"


def _told(started: RunStarted) -> list[str]:
    """Lines of at most 80 columns."""
    return [textwrap.fill(line, _WIDTH, subsequent_indent="    ") for line in started.told]


def _before(mesh: MeshSummary) -> str:
    return (
        f"before: {mesh.elements} elements  failed {mesh.failed} "
        f"({mesh.failed_by_shape} by shape, {mesh.failed_by_size} by size alone)  "
        f"trias {mesh.trias}  "
        f"Q.I. {mesh.compound_qi:.2f}"
    )


def _line(report: GenerationReport) -> str:
    return (
        f"generation {report.generation}  island {report.island}  "
        f"fitness {report.best_so_far:.3f}  failed {report.failed}  trias {report.trias}  "
        f"Q.I. {report.compound_qi:.2f}  evaluations {report.evaluations}  {report.seconds:.1f} s"
    )


def _fault(fault: FaultReport) -> str:
    return f"generation {fault.generation}  island {fault.island}  not scored: {fault.reason}"


def _round(report: RoundReport) -> str:
    return (
        f"round {report.number}  {report.places} places of {report.rings} rings  "
        f"{report.changed} better, {report.solved} without a fault  failed {report.failed}  "
        f"trias {report.trias}  irregular {report.irregular}  {report.seconds:.1f} s"
    )


def _end(finished: RunFinished) -> str:
    return (
        f"{finished.status}: {finished.reason}  fitness {finished.fitness:.3f}  "
        f"evaluations {finished.evaluations}  {finished.seconds:.1f} s"
    )
