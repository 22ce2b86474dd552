"""Chronicle: what a search tells of itself, made a record that holds together over rounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from tracking.events import Event, GenerationReport, RoundReport, RunFinished


class Chronicle:
    """Gives events a running step, and keeps the best so far of each island.

    A search that stands still goes on from meshes that are no better, and a round begins to count
    its generations anew; who reads the record wants neither.

    Parameters
    ----------
    known : sequence of Event
        What happened before, of a run that goes on.
    """

    def __init__(self, known: Sequence[Event] = ()) -> None:
        self._best: dict[int, GenerationReport] = {}
        self._step = 0
        self._rounds = 0
        for event in known:
            self.told(event)

    def told(self, event: Event) -> Event:
        """Return an event as it belongs into the record."""
        if isinstance(event, GenerationReport):
            self._step = max(self._step, event.generation + 1)
            return self._with_best(event)
        if isinstance(event, RoundReport):
            self._rounds += 1
            return replace(event, number=self._rounds, step=self._step)
        if isinstance(event, RunFinished):
            return replace(event, step=self._step)
        return event

    def _with_best(self, report: GenerationReport) -> GenerationReport:
        best = self._best.get(report.island)
        if best is None or report.best_so_far >= best.best_so_far:
            self._best[report.island] = report
            return report
        return replace(
            report,
            best_so_far=best.best_so_far,
            trias=best.trias,
            failed=best.failed,
            compound_qi=best.compound_qi,
            procedure=best.procedure,
        )
