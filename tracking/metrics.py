"""Events as metrics: the names under which the figures of a run are drawn."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from tracking.events import (
    Event,
    GenerationReport,
    MeshSummary,
    RoundReport,
    RunFinished,
    RunStarted,
    known_before,
)
from tracking.overview import ALL_ISLANDS, Overview


class Point(NamedTuple):
    """One value of one curve.

    Attributes
    ----------
    island : int
        ``ALL_ISLANDS`` for the curves of the run as a whole.
    key : str
        What stands before the slash groups the curves.
    value : float
    timestamp : int
        Milliseconds since 1970.
    step : int
        The generation.
    """

    island: int
    key: str
    value: float
    timestamp: int
    step: int


class Metrics:
    """Turns events into points, one after the other."""

    def __init__(self) -> None:
        self._overview = Overview(1)
        self._last = -1

    def points(self, event: Event, timestamp: int) -> Iterator[Point]:
        """Yield the points of the event, and those of the run that it completes."""
        if isinstance(event, RunStarted):
            self._overview = Overview(event.islands)
            yield from _points(ALL_ISLANDS, _mesh_figures("before", event.before), timestamp, 0)
        elif isinstance(event, GenerationReport):
            yield from _report_points(event, timestamp)
            self._last = max(self._last, event.generation)
            for report in self._overview.add(event):
                yield from _report_points(report, timestamp)
                yield from _cost_points(report, timestamp)
        elif isinstance(event, RoundReport):
            figures = {
                "round/places": event.places,
                "round/changed": event.changed,
                "round/solved": event.solved,
                "round/rings": event.rings,
                "round/failed": event.failed,
                "round/trias": event.trias,
                "round/irregular": event.irregular,
            } | {f"rate/{name}": rate for name, rate in event.rates.items()}
            yield from _points(ALL_ISLANDS, figures, timestamp, event.step)
        elif isinstance(event, RunFinished):
            for report in self._overview.rest():
                yield from _report_points(report, timestamp)
                yield from _cost_points(report, timestamp)
            if event.after is not None:
                figures = _mesh_figures("after", event.after) | {"after/fitness": event.fitness}
                yield from _points(ALL_ISLANDS, figures, timestamp, 0)
            step = max(event.step, self._last + 1)
            yield from _points(ALL_ISLANDS, _result_figures(event), timestamp, step)


def _report_points(report: GenerationReport, timestamp: int) -> Iterator[Point]:
    figures = {
        "fitness/best": report.best,
        "fitness/mean": report.mean,
        "fitness/worst": report.worst,
        "fitness/best_so_far": report.best_so_far,
        "mesh/trias": report.trias,
        "mesh/failed": report.failed,
        "mesh/compound_qi": report.compound_qi,
    }
    return _points(report.island, figures, timestamp, report.generation)


def _cost_points(report: GenerationReport, timestamp: int) -> Iterator[Point]:
    """Make the points of what a generation has cost: of the run as a whole, and there alone."""
    return _points(report.island, _cost_figures(report), timestamp, report.generation)


def _cost_figures(report: GenerationReport | RunFinished) -> dict[str, float]:
    return {
        "cost/evaluations": report.evaluations,
        "cost/known_before": known_before(report),
        "cost/seconds": report.seconds,
    }


def _result_figures(finished: RunFinished) -> dict[str, float]:
    """Last values of the curves of the run: those of its result."""
    figures = _cost_figures(finished)
    if finished.after is not None:
        figures |= {
            "fitness/best_so_far": finished.fitness,
            "mesh/trias": finished.after.trias,
            "mesh/failed": finished.after.failed,
            "mesh/compound_qi": finished.after.compound_qi,
        }
    return figures


def _mesh_figures(group: str, mesh: MeshSummary) -> dict[str, float]:
    return {
        f"{group}/elements": mesh.elements,
        f"{group}/quads": mesh.quads,
        f"{group}/trias": mesh.trias,
        f"{group}/failed": mesh.failed,
        f"{group}/failed_by_shape": mesh.failed_by_shape,
        f"{group}/failed_by_size": mesh.failed_by_size,
        f"{group}/compound_qi": mesh.compound_qi,
    }


def _points(
    island: int, figures: Mapping[str, float], timestamp: int, step: int
) -> Iterator[Point]:
    for key, value in figures.items():
        yield Point(island, key, float(value), timestamp, step)
