"""Integration GA: what a genome of operations makes of the mesh (the paper's Figure 6)."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, Protocol

import numpy as np

from islands.genetics import Breeding
from islands.operation_ga import evolve
from islands.procedure import Step
from meshops.edit import apply
from meshops.fitness import INVALID, Fitness
from meshops.mesh import Floats, Ids, Ints, ShellMesh
from meshops.operations import NOTHING, Operation
from meshops.operations.smooth import Smoothing
from meshops.quality_sums import ELEMENTS, SHAPE, SIZE, TRIAS
from meshops.subdomain import Aim
from meshops.surface import PatchSurface
from meshops.workpiece import Setting, Workpiece

REMEMBERED_BYTES = 5e8
"""Of the meshes that an island remembers; what was unused for longest goes first."""

STANDING_STILL = 0.5
"""Of a tria: what a drifting individual loses that ends with the mesh that it began with."""

KEPT_WORKPIECES = 8
"""On a workbench. More hardly pay: an individual goes on with the mesh that it has just made."""

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
        Whether an operation that does harm leaves the mesh as it is.
    reference : PatchSurface or None
        The surface that nodes must stay on; None: that of the mesh that an operation is given.
    weights : (C,) float64 or None
        How often each of `codes` is drawn as a gene; None: all alike.
    drifts : bool
        Whether a procedure ends with the last of its meshes that have the fewest faults instead of
        with the fittest one: so a search that stands still moves on.
    turn : int
        The round of the run: another one draws other random numbers on the same mesh.
    """

    seed: int
    setting: Setting
    operations: tuple[Operation, ...]
    breeding: Breeding
    improving: bool
    reference: PatchSurface | None = None
    weights: Floats | None = None
    drifts: bool = False
    turn: int = 0

    @cached_property
    def codes(self) -> tuple[int, ...]:
        """The operation that each value of a gene stands for, in the order of the codes."""
        return tuple(sorted([NOTHING, *(operation.code for operation in self.operations)]))

    def draw(self, rng: np.random.Generator, count: int, genes: int) -> Ids:
        """(count, genes) genomes, each gene a row of `codes`."""
        return rng.choice(len(self.codes), (count, genes), p=self.weights)

    @property
    def fitness(self) -> Fitness:
        """The run's fitness."""
        return self.setting.fitness


class Task(NamedTuple):
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
    fault : str
        Why there is no answer, where the operation GA ended its process each time that it was
        tried; no mesh follows from it then.
    """

    mesh: str
    tally: Floats
    parameters: Ints
    evaluations: int
    fault: str = ""


Handle = Any
"""A mesh as a runner passes it on: the mesh itself, or a reference to it in an object store."""


@dataclass(frozen=True, eq=False)
class Work:
    """A mesh, or a part of one, that an archipelago is to improve.

    Attributes
    ----------
    problem : Problem
    mesh : ShellMesh
    least_trias : int
        The fewest trias that it can have. With so few and no fault that can be mended nothing is
        left to gain; -1 where every generation counts.
    least_size : float
        Severity of the faults of size that no arrangement mends.
    aim : "faults", "flow", "tidy" or None
        What it was cut out for, and so what the guard takes for a gain; None: a whole mesh, of
        which nothing is guarded, as in the paper.
    keeps_neutral : bool
        Whether the guard keeps what neither gains anything nor does harm.
    is_whole : bool
        Whether it is a mesh as one place, whose operation GAs last long enough to be shared out,
        and not one of many small parts.
    polish : tuple of str
        Methods of smoothing that are tried once the fittest procedure is found.
    """

    problem: Problem
    mesh: ShellMesh
    least_trias: int = -1
    least_size: float = 0.0
    aim: Aim | None = None
    keeps_neutral: bool = False
    is_whole: bool = False
    polish: tuple[Smoothing, ...] = ()

    @cached_property
    def root(self) -> Outcome:
        """The mesh that every procedure starts from, as the outcome of no operation."""
        workpiece = Workpiece(self.mesh, self.problem.setting)
        return Outcome(self.mesh.digest, workpiece.tally, self.mesh.elements[:0, :2], 0)

    def is_solved(self, tally: Floats) -> bool:
        """Whether a mesh with this tally (TALLY_SIZE,) leaves nothing to gain."""
        is_sound = tally[SHAPE] == 0 and tally[SIZE] <= self.least_size
        return bool(is_sound and tally[TRIAS] <= self.least_trias)


def remembered(elements: int, most_bytes: float = REMEMBERED_BYTES) -> int:
    """How many meshes of about so many elements are remembered."""
    return int(most_bytes / (BYTES_AN_ELEMENT * elements))


class Runner(Protocol):
    """Runs operation GAs."""

    def run(self, jobs: Sequence[tuple[Task, Handle]]) -> list[tuple[Outcome, Handle, bool]]:
        """Run each task on the mesh that its handle stands for; results in the same order.

        The last of each says whether it was run for this, and not known before.
        """


@dataclass(frozen=True, eq=False)
class Scored:
    """What genomes led to.

    Attributes
    ----------
    fitness : (P,) float64
    tallies : (P, TALLY_SIZE) float64
    steps : list of tuple of Step
        One procedure a genome.
    faults : tuple of str
        Why some have the worst fitness and no mesh.
    """

    fitness: Floats
    tallies: Floats
    steps: list[tuple[Step, ...]]
    faults: tuple[str, ...] = ()


class Workbench:
    """The workpieces lately worked on, so that what is known of a mesh is found out once.

    Most meshes are tried with several operations and by several individuals, one after the other.
    """

    def __init__(self) -> None:
        self._kept: OrderedDict[tuple[Problem, str], Workpiece] = OrderedDict()

    def take(self, problem: Problem, digest: str, mesh: ShellMesh) -> Workpiece:
        """Return the workpiece of a mesh, which has this digest."""
        key = problem, digest
        if key not in self._kept:
            self._kept[key] = Workpiece(mesh, problem.setting, problem.reference)
        self._kept.move_to_end(key)
        while len(self._kept) > KEPT_WORKPIECES:
            self._kept.popitem(last=False)
        return self._kept[key]


def run_task(
    problem: Problem, task: Task, mesh: ShellMesh, bench: Workbench | None = None
) -> tuple[Outcome, ShellMesh]:
    """Run one operation GA: a pure function of the problem and the task.

    What the bench knows of the mesh already is not found out again.
    """
    operation = next(o for o in problem.operations if o.code == task.code)
    rng = np.random.default_rng(
        [problem.seed, problem.turn, int(task.mesh, 16), task.code, task.attempt]
    )
    workpiece = (bench or Workbench()).take(problem, task.mesh, mesh)
    found = evolve(operation, workpiece, problem.breeding, rng, improving=problem.improving)
    if found.edit.is_empty:
        return Outcome(task.mesh, workpiece.tally, found.parameters, found.evaluations), mesh
    after = apply(mesh, found.edit)
    tally = workpiece.tally + workpiece.tally_change(found.edit)
    return Outcome(after.digest, tally, found.parameters, found.evaluations), after


_DOING_NOTHING = Step(NOTHING, np.zeros((0, 2), np.int32))


@dataclass(eq=False)
class _Trail:
    """An individual on its way through its genes."""

    mesh: str
    handle: Handle
    tally: Floats
    attempts: dict[int, int]
    steps: list[Step]
    used: int
    best_fitness: float
    best_tally: Floats
    best_steps: int
    fault: str = ""

    def fail(self, reason: str) -> None:
        """Give it the worst fitness: an operation of it has no answer."""
        self.fault, self.best_steps = reason, 0
        self.best_fitness, self.best_tally = INVALID, np.full_like(self.tally, np.nan)


class Evaluator:
    """Scores genomes of the integration GA and remembers what each prefix of them led to.

    Genomes go through their genes side by side, so that the operation GAs of one gene can run at
    the same time and those that two genomes have in common run once.
    """

    def __init__(
        self,
        problem: Problem,
        runner: Runner,
        root: Outcome,
        handle: Handle,
        *,
        is_enough: Callable[[Floats], bool] = lambda _: False,
        remembered_bytes: float = REMEMBERED_BYTES,
    ) -> None:
        self.problem = problem
        self.runner = runner
        self.root = root
        self.root_handle = handle
        self.evaluations = self.performed = 0
        self._is_enough = is_enough
        self._known: OrderedDict[Task, tuple[Outcome, Handle]] = OrderedDict()
        self._most = remembered(int(root.tally[ELEMENTS]), remembered_bytes)

    @classmethod
    def of(cls, work: Work, runner: Runner, handle: Handle | None = None) -> Evaluator:
        """Make the evaluator of a work; `handle` is its mesh where that is not the mesh itself."""
        handle = work.mesh if handle is None else handle
        return cls(work.problem, runner, work.root, handle, is_enough=work.is_solved)

    def evaluate(self, genomes: Ids, fitness: Fitness | None = None) -> Scored:
        """Score genomes (P, G), by another fitness than the run's where one is given."""
        judge = fitness or self.problem.fitness
        root = self.root
        at_first = float(self._scores(judge, root.tally[None], np.zeros(1, np.int64))[0])
        trails = [
            _Trail(root.mesh, self.root_handle, root.tally, {}, [], 0, at_first, root.tally, 0)
            for _ in genomes
        ]
        for genes in genomes.T:
            self._advance(trails, genes, judge)
            if any(self._is_enough(trail.tally) for trail in trails):
                break
        if not self.problem.improving:
            self._compare([trail for trail in trails if not trail.fault], judge, is_last=True)
        return Scored(
            np.array([trail.best_fitness for trail in trails]),
            np.stack([trail.best_tally for trail in trails]),
            [tuple(trail.steps[: trail.best_steps]) for trail in trails],
            tuple(trail.fault for trail in trails if trail.fault),
        )

    def mesh_after(self, steps: Sequence[Step]) -> Handle | None:
        """Return what steps of a scored genome lead to; None where that is not remembered."""
        mesh, handle = self.root.mesh, self.root_handle
        attempts: dict[int, int] = {}
        for step in steps:
            if step.code == NOTHING:
                continue
            known = self._known.get(Task(mesh, step.code, attempts.get(step.code, 0)))
            if known is None or known[0].fault:
                return None
            outcome, after = known
            if outcome.mesh == mesh:
                attempts[step.code] = attempts.get(step.code, 0) + 1
            else:
                mesh, handle, attempts = outcome.mesh, after, {}
        return handle

    def _scores(self, fitness: Fitness, tallies: Floats, used: Ids) -> Floats:
        """(K,) fitness of (K, TALLY_SIZE) tallies after so many operations (K,)."""
        if not self.problem.drifts:
            return fitness.of(tallies, self.problem.setting.scoring, used)
        faults = np.array([fitness.of_faults(tally) for tally in tallies])
        return np.where(used, faults, faults - STANDING_STILL / (fitness.elements + 1))

    def _compare(self, trails: list[_Trail], judge: Fitness, *, is_last: bool) -> None:
        """Let each remember where it is now if it is fitter by that, or in any case at the last."""
        if not trails:
            return
        tallies = np.stack([trail.tally for trail in trails])
        used = np.array([trail.used for trail in trails])
        scores = self._scores(judge, tallies, used).tolist()
        for trail, fitness in zip(trails, scores, strict=True):
            is_equal = fitness == trail.best_fitness
            if is_last or fitness > trail.best_fitness or (self.problem.drifts and is_equal):
                trail.best_fitness, trail.best_tally = fitness, trail.tally
                trail.best_steps = len(trail.steps)

    def _advance(self, trails: list[_Trail], genes: Ids, judge: Fitness) -> None:
        codes = [self.problem.codes[gene] for gene in genes]
        tasks: list[Task | None] = [
            None
            if code == NOTHING or trail.fault
            else Task(trail.mesh, code, trail.attempts.get(code, 0))
            for trail, code in zip(trails, codes, strict=True)
        ]
        self._learn({t: x.handle for t, x in zip(tasks, trails, strict=True) if t is not None})
        moved = []
        for trail, task in zip(trails, tasks, strict=True):
            if task is None:
                trail.steps.append(_DOING_NOTHING)
                continue
            outcome, handle = self._known[task]
            self.evaluations += outcome.evaluations
            if outcome.fault:
                trail.fail(outcome.fault)
                continue
            trail.steps.append(Step(task.code, outcome.parameters))
            if outcome.mesh == trail.mesh:
                trail.attempts[task.code] = task.attempt + 1
                continue
            trail.mesh, trail.handle, trail.tally = outcome.mesh, handle, outcome.tally
            trail.attempts = {}
            trail.used += 1
            moved.append(trail)
        self._compare(moved, judge, is_last=False)

    def _learn(self, wanted: dict[Task, Handle]) -> None:
        missing = [(task, handle) for task, handle in wanted.items() if task not in self._known]
        for (task, _), found in zip(missing, self.runner.run(missing), strict=True):
            outcome, handle, was_run = found
            self._known[task] = outcome, handle
            self.performed += outcome.evaluations * was_run
        for task in wanted:
            self._known.move_to_end(task)
        while len(self._known) > max(self._most, len(wanted)):
            self._known.popitem(last=False)
