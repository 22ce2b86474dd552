"""Stopping: why a search ends before its generations and rounds are done, in words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from islands.island import IslandState


@dataclass(frozen=True)
class Stopping:
    """Rules that end a search, each on its own; what is None or 0 is no rule.

    They say nothing of the clock: the same search ends at the same place.

    Attributes
    ----------
    evaluations : int or None
        Individuals of operation GAs that are scored at the most; a generation, or a round, is
        finished first.
    target : float or None
        Fitness that is good enough.
    stagnation : int or None
        Generations in which no island of an archipelago found a better procedure.
    diversity : float
        Share of different genomes among all of an archipelago below which breeding is in vain.
    """

    evaluations: int | None = None
    target: float | None = None
    stagnation: int | None = None
    diversity: float = 0.0

    def of_run(self, evaluations: int, fitness: float) -> list[str]:
        """Reasons by what a run has spent and reached."""
        reasons = []
        if self.target is not None and fitness >= self.target:
            reasons.append(f"the fitness is {fitness:.6g} and {self.target:.6g} was asked for")
        if self.evaluations is not None and evaluations >= self.evaluations:
            reasons.append(f"{evaluations} of {self.evaluations} evaluations are made")
        return reasons

    def of_both(self, islands: Sequence[IslandState]) -> list[str]:
        """Reasons by the state of the islands of one archipelago that is the whole run."""
        if not all(island.generation for island in islands):
            return []
        evaluations = sum(island.evaluations for island in islands)
        reasons = self.of_run(evaluations, max(island.best_fitness for island in islands))
        stagnant = min(island.stagnant for island in islands)
        if self.stagnation is not None and stagnant >= self.stagnation:
            reasons.append(f"{stagnant} generations found nothing better")
        if self.diversity:
            genomes = {row.tobytes() for island in islands for row in island.genomes}
            share = len(genomes) / sum(len(island.genomes) for island in islands)
            if share < self.diversity:
                reasons.append(f"{share:.0%} of the genomes differ")
        return reasons
