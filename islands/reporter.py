"""Reporter: what islands tell of themselves, summed up over the works of a round."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import numpy as np

from islands.archipelago import Milestone
from islands.island import IslandState
from islands.procedure import steps_text
from meshops._core import compound_index
from meshops.mesh import Floats
from meshops.operations import Operation
from meshops.quality_sums import FAILED, TRIAS
from meshops.workpiece import Setting
from tracking.events import Event, FaultReport, GenerationReport, MigrationReport


class Reporter:
    """Makes reports of generations; the clock is read here and nowhere in the search.

    A generation is reported once all works have scored it or are over. The mesh as a whole is
    scored: its tally at the start of the round, and what the works change.

    Parameters
    ----------
    record : callable
        Takes the events.
    setting : Setting
    operations : tuple of Operation
    tally : (TALLY_SIZE,) float64
        Of the whole mesh at the start of the round.
    roots : (W, TALLY_SIZE) float64
        Of each work at the start of the round.
    generation : int
        Of the run, at which the round starts.
    evaluations, performed : int
        Before the round.
    started : float
        The time.monotonic() of the run's start.
    reported : int
        Generations that were told before.
    """

    def __init__(
        self,
        *,
        record: Callable[[Event], None],
        setting: Setting,
        operations: tuple[Operation, ...],
        tally: Floats,
        roots: Floats,
        generation: int,
        evaluations: int,
        performed: int,
        started: float,
        reported: int = 0,
    ) -> None:
        self._record = record
        self._setting = setting
        self._operations = operations
        self._tally = tally
        self._roots = roots
        self._generation = generation
        self._evaluations = evaluations
        self._performed = performed
        self._started = started
        self._reported = reported
        self._reached: list[list[Milestone]] = [[] for _ in roots]

    def watch(self, milestone: Milestone) -> None:
        """Take a milestone; reports follow as soon as a generation is complete."""
        self._reached[milestone.work].append(milestone)
        while self._is_complete(self._reported + 1):
            self._reported += 1
            self._report()
            for i, reached in enumerate(self._reached):
                newer = [m for m in reached if m.generation >= self._reported]
                self._reached[i] = newer or reached[-1:]

    def _is_complete(self, generation: int) -> bool:
        last = [reached[-1] for reached in self._reached if reached]
        return (
            len(last) == len(self._reached)
            and all(m.is_last or m.generation >= generation for m in last)
            and any(m.generation >= generation for m in last)
        )

    def _report(self) -> None:
        """Report a generation, island by island, and who leaves after it."""
        now = [
            next((m for m in reached if m.generation == self._reported), reached[-1])
            for reached in self._reached
        ]
        islands = [[milestone.islands[i] for milestone in now] for i in range(len(now[0].islands))]
        asked = self._evaluations + sum(s.evaluations for states in islands for s in states)
        scored = self._performed + sum(s.performed for states in islands for s in states)
        for states in islands:
            self._report_island(states, asked, scored)
        for milestone in now:
            if milestone.generation == self._reported:
                self._report_events(milestone)

    def _report_island(self, states: list[IslandState], asked: int, scored: int) -> None:
        """Report a generation of one island; individuals without a valid mesh count as 0.

        An individual of the whole is made of the works' individuals of the same rank.
        """
        ranked = np.stack([s.tallies[np.argsort(-s.fitness, kind="stable")] for s in states])
        wholes = self._tally + (ranked - self._roots[:, None]).sum(axis=0)
        fitness = self._fitness(wholes)
        found = np.stack([state.best_tally for state in states])
        found = np.where(np.isfinite(found), found, self._roots)
        best = self._tally + (found - self._roots).sum(axis=0)
        self._record(
            GenerationReport(
                island=states[0].island,
                generation=self._generation + self._reported - 1,
                best=float(fitness.max()),
                mean=float(fitness.mean()),
                worst=float(fitness.min()),
                best_so_far=float(self._fitness(best[None])[0]),
                trias=int(best[TRIAS]),
                failed=int(best[FAILED]),
                compound_qi=compound_index(best, self._setting.scoring.core),
                evaluations=asked,
                performed=scored,
                seconds=time.monotonic() - self._started,
                procedure=self._procedure(states),
            )
        )

    def _report_events(self, milestone: Milestone) -> None:
        """Report emigrants, and individuals that could not be scored."""
        generation = self._generation + milestone.generation - 1
        for group in milestone.left:
            for genome, fitness in zip(group.migrants.genomes, group.migrants.fitness, strict=True):
                self._record(
                    MigrationReport(
                        generation=generation,
                        source=group.source,
                        target=group.target,
                        fitness=float(fitness),
                        genome=tuple(int(gene) for gene in genome),
                    )
                )
        for state in milestone.islands:
            for reason in state.faults:
                self._record(FaultReport(generation, state.island, reason))

    def _fitness(self, tallies: Floats) -> Floats:
        fitness = self._setting.fitness.of(tallies, self._setting.scoring)
        return np.where(np.isfinite(fitness), fitness, 0.0)

    def _procedure(self, states: Sequence[IslandState]) -> str:
        if len(states) == 1:
            return steps_text(states[0].best_steps, self._operations)
        changed = sum(len(state.best_steps) > 0 for state in states)
        return f"{len(states)} places, {changed} of them changed"
