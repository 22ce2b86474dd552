"""Reporter: what islands tell of themselves, summed up over the works of a round."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from islands.island import IslandState
from islands.migration import Migrants
from islands.procedure import steps_text
from meshops.kernels.quality import FAILED, TRIAS, compound_index
from meshops.mesh import Floats
from meshops.operations import Operation
from meshops.workpiece import Setting
from tracking.events import Event, GenerationReport, MigrationReport


@dataclass(eq=False)
class Reporter:
    """Makes reports of generations; the clock is read here and nowhere in the search.

    The mesh as a whole is scored: its tally at the start of the round, and what the works change.

    Attributes
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
    evaluations : int
        Before the round.
    started : float
        The time.monotonic() of the run's start.
    """

    record: Callable[[Event], None]
    setting: Setting
    operations: tuple[Operation, ...]
    tally: Floats
    roots: Floats
    generation: int
    evaluations: int
    started: float

    def watch(self, island: int, states: Sequence[IslandState]) -> None:
        """Report a generation of one island; individuals without a valid mesh count as 0.

        An individual of the whole is made of the works' individuals of the same rank.
        """
        done = [state for state in states if state.generation > 0]
        if not done:
            return
        roots = self.roots[[state.work for state in done]]
        ranked = np.stack([s.tallies[np.argsort(-s.fitness, kind="stable")] for s in done])
        wholes = self.tally + (ranked - roots[:, None]).sum(axis=0)
        fitness = self._fitness(wholes)
        best = self.tally + (np.stack([s.best_tally for s in done]) - roots).sum(axis=0)
        best_so_far = float(self._fitness(best[None])[0])
        generation = self.generation + max(state.generation for state in done) - 1
        self.record(
            GenerationReport(
                island=island,
                generation=generation,
                best=float(fitness.max()),
                mean=float(fitness.mean()),
                worst=float(fitness.min()),
                best_so_far=best_so_far,
                trias=int(best[TRIAS]),
                failed=int(best[FAILED]),
                compound_qi=float(compound_index(best, *self.setting.scoring.arrays)),
                evaluations=self.evaluations + sum(state.evaluations for state in done),
                seconds=time.monotonic() - self.started,
                procedure=self._procedure(done),
            )
        )

    def post(self, state: IslandState, target: int, leaving: Migrants) -> None:
        """Report the emigrants of an island."""
        for genome, fitness in zip(leaving.genomes, leaving.fitness, strict=True):
            self.record(
                MigrationReport(
                    generation=self.generation + state.generation - 1,
                    source=state.island,
                    target=target,
                    fitness=float(fitness),
                    genome=tuple(int(gene) for gene in genome),
                )
            )

    def _fitness(self, tallies: Floats) -> Floats:
        fitness = self.setting.fitness.of(tallies, self.setting.scoring)
        return np.where(np.isfinite(fitness), fitness, 0.0)

    def _procedure(self, states: Sequence[IslandState]) -> str:
        if len(states) == 1:
            return steps_text(states[0].best_steps, self.operations)
        changed = sum(len(state.best_steps) > 0 for state in states)
        return f"{len(states)} places, {changed} of them changed"
