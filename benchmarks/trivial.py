"""Operations that cost next to nothing, so that what is left is the cost of the engine itself."""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from islands.archipelago import Mode, Schedule
from islands.genetics import Breeding
from islands.integration_ga import Problem, Work
from islands.island import IslandPlan
from islands.migration import Migration
from islands.topology import Topology
from meshops.criteria import PAPER
from meshops.edit import Edit
from meshops.examples import SIZE
from meshops.fitness import Fitness
from meshops.mesh import Floats, Ids, Ints, ShellMesh
from meshops.operations import NOTHING
from meshops.workpiece import Setting, Workpiece

STEP = 1e-6
"""How far a node moves, over the element size."""

OPERATIONS = 8
"""Alike, but each makes another mesh."""

Bytes = NDArray[np.uint8]


@dataclass(eq=False)
class Nudges:
    """Which node moves; every genome is as good as any other."""

    workpiece: Workpiece
    bounds: Ids

    def draw(self, rng: np.random.Generator, count: int) -> Ids:
        """(count, 1) nodes."""
        return rng.integers(0, self.bounds[0], (count, 1))

    def evaluate(self, genomes: Ids) -> Floats:
        """(P, TALLY_SIZE) the tally of the mesh as it was, without another look."""
        return np.repeat(self.workpiece.tally[None], len(genomes), axis=0)

    def tally(self, genome: Ids) -> Floats:
        """(TALLY_SIZE,) the same."""
        return self.workpiece.tally

    def parameters(self, genome: Ids) -> Ints:
        """(1, 1) the node."""
        return genome[None].astype(np.int32)


@dataclass(frozen=True, eq=False)
class Nudge:
    """Moves a node a little: another mesh each time, and none is better.

    Attributes
    ----------
    payload : (B,) uint8
        What the problem carries.
    code : int
    seconds : float
        That it sleeps.
    """

    payload: Bytes
    code: int
    seconds: float = 0.0

    @property
    def name(self) -> str:
        """Name it."""
        return f"nudge-{self.code}"

    def search_space(self, workpiece: Workpiece, rng: np.random.Generator) -> Nudges:
        """Any node may move."""
        if self.seconds:
            time.sleep(self.seconds)
        return Nudges(workpiece, np.array([len(workpiece.mesh.points)]))

    def apply(self, workpiece: Workpiece, parameters: Ints) -> Edit:
        """Move the node."""
        if not len(parameters):
            return Edit()
        node = parameters[0]
        place = workpiece.mesh.points[node] + [STEP * SIZE, 0.0, 0.0]
        return Edit(moved=node, moved_to=place)

    def format(self, parameters: Ints) -> str:
        """Name the node."""
        return str(int(parameters[0, 0]))


def trivial_work(payload: int, *, seconds: float = 0.0, is_whole: bool = False) -> Work:
    """Set the problem to nudge a mesh of four elements; it carries `payload` bytes."""
    carried = np.zeros(payload, np.uint8)
    operations = tuple(Nudge(carried, NOTHING + 1 + i, seconds) for i in range(OPERATIONS))
    x, y = np.meshgrid(np.arange(3) * SIZE, np.arange(3) * SIZE, indexing="ij")
    points = np.stack([x.ravel(), y.ravel(), np.zeros(9)], axis=1)
    corner = np.array([0, 1, 3, 4])
    elements = np.stack([corner, corner + 3, corner + 4, corner + 1], axis=1)
    mesh = ShellMesh.build(points=points, elements=elements)
    setting = Setting(PAPER.at(SIZE), Fitness("quality", len(elements)), element_size=SIZE)
    breeding = Breeding(individuals=10, generations=10)
    problem = Problem(1, setting, operations, breeding, improving=False)
    return Work(problem, mesh, is_whole=is_whole)


def trivial_schedule(
    islands: int, individuals: int, genes: int, generations: int, mode: Mode = "synchronous"
) -> Schedule:
    """Put islands in a ring; migrants arrive an epoch late where islands do not wait for them."""
    plan = IslandPlan(Breeding(individuals=individuals), genes, Migration())
    links, delay = Topology("ring").links(islands), int(mode == "overlapped")
    return Schedule((plan,) * islands, generations, links, delay=delay, mode=mode)
