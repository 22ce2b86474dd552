"""Other ways to search, with the same operations as the islands and a budget to keep to.

A competitor is a function of a job, a budget and a seed; it returns its curve. Evaluations are
individuals whose quality was found, as the islands count them.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from benchmarks.improving import improved
from islands.operation_ga import evolve
from islands.run import Job
from meshops.edit import Edit, apply
from meshops.mesh import Floats, ShellMesh
from meshops.operations import Operation
from meshops.quality_sums import ELEMENTS, FAILED, TRIAS
from meshops.workpiece import Workpiece

GENES = 10
"""Operations of a procedure of random search, as the islands' default."""

INDIVIDUALS = 10
"""Individuals of each operation that greedy repair compares before it takes one."""

PATIENCE = 5.0
"""How many times the seconds of its budget a competitor may take for the evaluations of it."""


@dataclass(frozen=True)
class Budget:
    """What may be spent: a competitor goes on until both are, or until it is `PATIENCE` late."""

    evaluations: int
    seconds: float


@dataclass(frozen=True)
class Reading:
    """The best mesh after so many evaluations and seconds."""

    evaluations: int
    seconds: float
    failed: int
    trias: int
    fitness: float


Curve = tuple[Reading, ...]
"""Readings in order of time; the first is of the mesh as it was given."""

Competitor = Callable[[Job, Budget, int], Curve]


class Meter:
    """Counts what one competitor spends, and keeps the best that it has reached."""

    def __init__(self, job: Job, budget: Budget) -> None:
        self.evaluations = 0
        self.curve: list[Reading] = []
        self._started = time.perf_counter()
        self._budget = budget
        self._setting = job.problem.setting
        self._surface = Workpiece(job.mesh, self._setting).surface
        self.see(self.workpiece(job.mesh))

    @property
    def seconds(self) -> float:
        """Seconds since the start."""
        return time.perf_counter() - self._started

    @property
    def is_spent(self) -> bool:
        """Whether evaluations and seconds are both used up."""
        budget, seconds = self._budget, self.seconds
        done = self.evaluations >= budget.evaluations and seconds >= budget.seconds
        return done or seconds >= PATIENCE * budget.seconds

    def workpiece(self, mesh: ShellMesh) -> Workpiece:
        """Put a mesh under the job's setting, bound to the surface that the job started from."""
        return Workpiece(mesh, self._setting, self._surface)

    def see(self, workpiece: Workpiece) -> bool:
        """Read a mesh; returns whether it is the fittest so far."""
        tally = workpiece.tally
        fitness = float(workpiece.fitness(tally[None])[0])
        if self.curve and fitness <= self.curve[-1].fitness:
            return False
        self.curve.append(
            Reading(self.evaluations, self.seconds, int(tally[FAILED]), int(tally[TRIAS]), fitness)
        )
        return True


def islands(job: Job, budget: Budget, seed: int) -> Curve:
    """Search with the islands, as long as there is time, and read them after each round.

    A round tells what fails and how many trias there are, not the Q.I.: its fitness is the lowest
    that a mesh with as many can have.
    """
    config = job.config.model_copy(update={"seed": seed})
    problem = replace(job.problem, seed=seed)
    found = improved(replace(job, config=config, problem=problem), budget.seconds)
    count = job.problem.setting.fitness.elements + 1
    rounds = [
        Reading(r.performed, r.seconds, r.failed, r.trias, 100 - r.failed - (r.trias + 1) / count)
        for r in found.rounds
    ]
    first = Meter(job, budget).curve[0]
    last = Meter(replace(job, mesh=found.done.mesh), budget).curve[0]
    done = found.done
    return (first, *rounds, replace(last, evaluations=done.performed, seconds=done.seconds))


def operation_gas(job: Job, budget: Budget, seed: int) -> Curve:
    """Run operation GAs one after the other, in random order, each on what the last one left."""
    rng, meter, mesh = np.random.default_rng(seed), Meter(job, budget), job.mesh
    while not meter.is_spent:
        workpiece = meter.workpiece(mesh)
        operation = _any_of(job, rng)
        found = evolve(operation, workpiece, job.problem.breeding, rng, improving=True)
        meter.evaluations += max(found.evaluations, 1)
        mesh = apply(mesh, found.edit) if not found.edit.is_empty else mesh
        meter.see(meter.workpiece(mesh))
    return tuple(meter.curve)


def hill_climbing(job: Job, budget: Budget, seed: int) -> Curve:
    """Try one random individual of a random operation; keep the mesh if it is not worse."""
    rng, meter = np.random.default_rng(seed), Meter(job, budget)
    workpiece = meter.workpiece(job.mesh)
    while not meter.is_spent:
        edit, tally = _one_individual(_any_of(job, rng), workpiece, rng)
        meter.evaluations += 1
        before, after = workpiece.fitness(np.stack([workpiece.tally, tally]))
        if after >= before and not edit.is_empty:
            workpiece = meter.workpiece(apply(workpiece.mesh, edit))
            meter.see(workpiece)
    return tuple(meter.curve)


def random_search(job: Job, budget: Budget, seed: int) -> Curve:
    """Perform procedures of random operations with random parameters; keep the best mesh."""
    rng, meter = np.random.default_rng(seed), Meter(job, budget)
    while not meter.is_spent:
        workpiece = meter.workpiece(job.mesh)
        for _ in range(GENES):
            edit, _ = _one_individual(_any_of(job, rng), workpiece, rng)
            meter.evaluations += 1
            if not edit.is_empty:
                workpiece = meter.workpiece(apply(workpiece.mesh, edit))
                meter.see(workpiece)
    return tuple(meter.curve)


def greedy_repair(job: Job, budget: Budget, seed: int) -> Curve:
    """Take the best of some individuals of every operation, as long as the mesh gets fitter."""
    rng, meter = np.random.default_rng(seed), Meter(job, budget)
    workpiece = meter.workpiece(job.mesh)
    while not meter.is_spent:
        found = [_best_individual(o, workpiece, rng, meter) for o in job.problem.operations]
        fitness, edit = max(found, key=lambda pair: pair[0])
        if fitness > workpiece.fitness(workpiece.tally[None])[0] and not edit.is_empty:
            workpiece = meter.workpiece(apply(workpiece.mesh, edit))
            meter.see(workpiece)
    return tuple(meter.curve)


OTHERS: Mapping[str, Competitor] = MappingProxyType(
    {
        "operation GAs alone": operation_gas,
        "hill climbing": hill_climbing,
        "random search": random_search,
        "greedy repair": greedy_repair,
    }
)
"""What the islands compete with."""


def _any_of(job: Job, rng: np.random.Generator) -> Operation:
    operations = job.problem.operations
    return operations[int(rng.integers(len(operations)))]


def _one_individual(
    operation: Operation, workpiece: Workpiece, rng: np.random.Generator
) -> tuple[Edit, Floats]:
    """Return the edit of one random individual and the tally that it leads to."""
    space = operation.search_space(workpiece, rng)
    if space is None:
        return Edit(), workpiece.tally
    # the first genome that a space draws may be a greedy one
    genome = space.draw(rng, 2)[1]
    tally = space.tally(genome)
    if not np.isfinite(tally[ELEMENTS]):
        return Edit(), workpiece.tally
    return operation.apply(workpiece, space.parameters(genome)), tally


def _best_individual(
    operation: Operation, workpiece: Workpiece, rng: np.random.Generator, meter: Meter
) -> tuple[float, Edit]:
    """Return the fittest of some individuals, and its edit."""
    meter.evaluations += INDIVIDUALS
    space = operation.search_space(workpiece, rng)
    if space is None:
        return -np.inf, Edit()
    genomes = space.draw(rng, INDIVIDUALS)
    fitness = workpiece.fitness(space.evaluate(genomes))
    best = int(np.argmax(fitness))
    if not np.isfinite(fitness[best]):
        return -np.inf, Edit()
    return float(fitness[best]), operation.apply(workpiece, space.parameters(genomes[best]))
