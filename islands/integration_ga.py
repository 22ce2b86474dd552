"""Integration GA: what a genome of operations makes of the mesh (the paper's Figure 6)."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from islands.genetics import Breeding
from islands.operation_ga import evolve
from islands.procedure import Step
from meshops.edit import apply
from meshops.fitness import Fitness
from meshops.kernels.quality import ELEMENTS
from meshops.mesh import Floats, Ids, Ints, ShellMesh
from meshops.operations import NOTHING, Operation
from meshops.workpiece import Setting, Workpiece

GENES = 10
"""Genes of an individual (section 4.1)."""

REMEMBERED_BYTES = 5e8
"""Of the meshes that an island remembers; what was unused for longest goes first."""

BYTES_AN_ELEMENT = 150
"""Of a `ShellMesh`, with its share of nodes."""


@dataclass(frozen=True, eq=False)
class Problem:
    """What is to be solved, the same on every island and every worker.

    Attributes
    ----------
    seed : int
    setting : Setting
    operations : tuple of Operation
    breeding : Breeding
        Of the operation GAs.
    improving : bool
        Whether an operation that gains nothing leaves the mesh as it is.
    """

    seed: int
    setting: Setting
    operations: tuple[Operation, ...]
    breeding: Breeding
    improving: bool

    @property
    def fitness(self) -> Fitness:
        """The run's fitness."""
        return self.setting.fitness


@dataclass(frozen=True)
class Task:
    """An operation GA to run: what it does follows from the run's seed and these three alone.

    Attributes
    ----------
    mesh : str
        Digest of the mesh that it runs on.
    code : int
        The operation.
    attempt : int
        How often the same procedure has tried this operation on this very mesh before.
    """

    mesh: str
    code: int
    attempt: int


@dataclass(frozen=True, eq=False)
class Outcome:
    """What an operation GA made of a mesh.

    Attributes
    ----------
    mesh : str
        Digest of the mesh after it.
    tally : (TALLY_SIZE,) float64
        Of the mesh after it.
    parameters : (K, C) int32
        Without rows where the mesh stays as it was.
    evaluations : int
        Individuals that were scored.
    """

    mesh: str
    tally: Floats
    parameters: Ints
    evaluations: int


Handle = Any
"""A mesh as a runner passes it on: the mesh itself, or a reference to it in an object store."""


class Runner(Protocol):
    """Runs operation GAs."""

    def run(self, jobs: Sequence[tuple[Task, Handle]]) -> list[tuple[Outcome, Handle]]:
        """Run each task on the mesh that its handle stands for; results in the same order."""


def run_task(problem: Problem, task: Task, mesh: ShellMesh) -> tuple[Outcome, ShellMesh]:
    """Run one operation GA: a pure function of the problem and the task."""
    operation = next(o for o in problem.operations if o.code == task.code)
    rng = np.random.default_rng([problem.seed, int(task.mesh, 16), task.code, task.attempt])
    workpiece = Workpiece(mesh, problem.setting)
    found = evolve(operation, workpiece, problem.breeding, rng, improving=problem.improving)
    if found.edit.is_empty:
        return Outcome(task.mesh, workpiece.tally, found.parameters, found.evaluations), mesh
    after = apply(mesh, found.edit)
    tally = Workpiece(after, problem.setting).tally
    return Outcome(after.digest, tally, found.parameters, found.evaluations), after


@dataclass(eq=False)
class _Trail:
    """An individual on its way through its genes."""

    mesh: str
    handle: Handle
    tally: Floats
    attempts: dict[int, int]
    steps: list[Step]


class Evaluator:
    """Scores genomes of the integration GA and remembers what each prefix of them led to.

    Genomes go through their genes side by side, so that the operation GAs of one gene can run at
    the same time and those that two genomes have in common run once.
    """

    def __init__(self, problem: Problem, runner: Runner, root: Outcome, handle: Handle) -> None:
        self.problem = problem
        self.runner = runner
        self.root = root
        self.root_handle = handle
        self.evaluations = 0
        self._known: OrderedDict[Task, tuple[Outcome, Handle]] = OrderedDict()
        self._most = int(REMEMBERED_BYTES / (BYTES_AN_ELEMENT * root.tally[ELEMENTS]))

    def evaluate(self, genomes: Ids) -> tuple[Floats, Floats, list[tuple[Step, ...]]]:
        """Score genomes (P, G).

        Returns fitness (P,), tallies (P, TALLY_SIZE) and the steps of each.
        """
        trails = [
            _Trail(self.root.mesh, self.root_handle, self.root.tally, {}, []) for _ in genomes
        ]
        for genes in genomes.T:
            self._advance(trails, genes)
        tallies = np.stack([trail.tally for trail in trails])
        used = [sum(len(step.parameters) > 0 for step in trail.steps) for trail in trails]
        scoring, score = self.problem.setting.scoring, self.problem.fitness.of
        fitness = np.concatenate(
            [score(tally[None], scoring, n) for tally, n in zip(tallies, used, strict=True)]
        )
        return fitness, tallies, [tuple(trail.steps) for trail in trails]

    def _advance(self, trails: list[_Trail], genes: Ids) -> None:
        tasks: list[Task | None] = [
            None
            if gene == NOTHING
            else Task(trail.mesh, int(gene), trail.attempts.get(int(gene), 0))
            for trail, gene in zip(trails, genes, strict=True)
        ]
        self._learn({t: x.handle for t, x in zip(tasks, trails, strict=True) if t is not None})
        for trail, task in zip(trails, tasks, strict=True):
            if task is None:
                trail.steps.append(Step(NOTHING, np.zeros((0, 2), np.int32)))
                continue
            outcome, handle = self._known[task]
            trail.steps.append(Step(task.code, outcome.parameters))
            if outcome.mesh == trail.mesh:
                trail.attempts[task.code] = task.attempt + 1
                continue
            trail.mesh, trail.handle, trail.tally = outcome.mesh, handle, outcome.tally
            trail.attempts = {}

    def _learn(self, wanted: dict[Task, Handle]) -> None:
        missing = [(task, handle) for task, handle in wanted.items() if task not in self._known]
        for (task, _), result in zip(missing, self.runner.run(missing), strict=True):
            self._known[task] = result
            self.evaluations += result[0].evaluations
        for task in wanted:
            self._known.move_to_end(task)
        while len(self._known) > max(self._most, len(wanted)):
            self._known.popitem(last=False)
