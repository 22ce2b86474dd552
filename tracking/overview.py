"""Overview: the reports of all islands seen as one."""

from __future__ import annotations

from dataclasses import replace

from tracking.events import GenerationReport

ALL_ISLANDS = -1
"""Stands for the island in a report about all of them."""


class Overview:
    """Sums the islands up by generation.

    A generation is summed up as soon as all islands have reported it, or a later one has begun:
    islands that run apart do not hold it back. What comes later still counts for the next one.
    """

    def __init__(self, islands: int) -> None:
        self._islands = islands
        self._latest: dict[int, GenerationReport] = {}
        self._current: dict[int, GenerationReport] = {}
        self._last_summed: int | None = None

    def add(self, report: GenerationReport) -> list[GenerationReport]:
        """Take a report; return what is now summed up, the oldest generation first."""
        known = self._latest.get(report.island)
        if known is None or known.generation <= report.generation:
            self._latest[report.island] = report
        if self._last_summed is not None and report.generation <= self._last_summed:
            return []
        open_generation = next(iter(self._current.values()), report).generation
        if report.generation < open_generation:
            return []
        summed = self.rest() if report.generation > open_generation else []
        self._current[report.island] = report
        if len(self._current) >= self._islands:
            summed += self.rest()
        return summed

    def rest(self) -> list[GenerationReport]:
        """Sum up the open generation, if any, without waiting for the other islands."""
        if not self._current:
            return []
        reports = list(self._current.values())
        latest = [self._latest[island] for island in sorted(self._latest)]
        leader = max(latest, key=lambda report: report.best_so_far)
        self._last_summed = reports[0].generation
        self._current = {}
        return [
            replace(
                leader,
                island=ALL_ISLANDS,
                generation=reports[0].generation,
                best=max(report.best for report in reports),
                mean=sum(report.mean for report in reports) / len(reports),
                worst=min(report.worst for report in reports),
                evaluations=max(report.evaluations for report in latest),
                performed=max(report.performed for report in latest),
                seconds=max(report.seconds for report in latest),
            )
        ]
