"""The paper's method as one would write it without much thought: DEAP and pymeshlab.

An integration GA of procedures, an operation GA for each gene of each procedure, and every
individual of these performed on the whole mesh. No two procedures share their common beginning.
pymeshlab's remeshing drops all quads of the mesh and its pairing makes new ones of all trias, so
quality is not to be compared; this program is here for its time.
"""

from __future__ import annotations

import random
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import pymeshlab
from deap import algorithms, base, creator, tools

from meshops.mesh import NO_NODE, Floats, Ints, ShellMesh
from meshops.remesher import isotropic_options

POPULATION, GENERATIONS, GENES = 10, 10, 10
CROSSOVER, MUTATION = 0.95, 0.05
RANGES, PAIRS = 5, 10
REMESH, REPLACE_NODE, NOTHING = 0, 1, 2
INVALID = 0.01
"""Fitness of an individual that makes no mesh: roulette needs it above 0."""

_NEAR = 1e-6


@dataclass(frozen=True, eq=False)
class Polygons:
    """A mesh as pymeshlab gives it back: points, and the nodes of each face."""

    points: Floats
    faces: list[list[int]]

    @property
    def trias(self) -> int:
        """How many faces are trias."""
        return sum(len(face) == 3 for face in self.faces)

    @property
    def fitness(self) -> float:
        """The paper's."""
        return max(100.0 - self.trias, INVALID)

    def triangulated(self) -> tuple[Ints, Ints]:
        """(T, 3) trias of all faces, and (T,) the face of each."""
        trias, owners = [], []
        for row, face in enumerate(self.faces):
            for k in range(1, len(face) - 1):
                trias.append((face[0], face[k], face[k + 1]))
                owners.append(row)
        return np.array(trias, np.int32), np.array(owners, np.int32)


@dataclass(frozen=True)
class Timing:
    """How long the program takes.

    Attributes
    ----------
    seconds : float
        Of all individuals of the integration GA.
    measured : int
        Individuals that were run; the seconds of the others follow from these.
    individuals : int
    """

    seconds: float
    measured: int
    individuals: int


def straightforward(mesh: ShellMesh, size: float, seed: int, share: float) -> Timing:
    """Run the program, or a share of its individuals, and tell its time.

    Every generation after the first breeds as many procedures as there are, of which crossover and
    mutation leave hardly any unchanged, so each is counted as evaluated anew.
    """
    random.seed(seed)
    start = Polygons(mesh.points, [[n for n in e if n != NO_NODE] for e in mesh.elements.tolist()])

    def evaluate(procedure: list[int]) -> tuple[float]:
        return (_perform(start, procedure, size).fitness,)

    toolbox = _toolbox(lambda: random.randrange(3), GENES, evaluate)
    individuals = POPULATION * (GENERATIONS + 1)
    started = time.perf_counter()
    if share >= 1.0:
        population = toolbox.population(n=POPULATION)
        algorithms.eaSimple(population, toolbox, CROSSOVER, MUTATION, GENERATIONS, verbose=False)
        return Timing(time.perf_counter() - started, individuals, individuals)
    measured = max(1, round(share * individuals))
    for procedure in toolbox.population(n=measured):
        evaluate(procedure)
    seconds = (time.perf_counter() - started) * individuals / measured
    return Timing(seconds, measured, individuals)


def _perform(mesh: Polygons, procedure: list[int], size: float) -> Polygons:
    """Find parameters for each gene by an operation GA, and go on with the mesh they make."""
    for gene in procedure:
        if gene == REMESH:
            remesh = partial(remeshed, mesh, size)
            mesh = _evolved(mesh, len(mesh.faces), 2 * RANGES, remesh)
        elif gene == REPLACE_NODE:
            edges = sorted({(a, b) for face in mesh.faces for a, b in pairwise(face)})
            mesh = _evolved(mesh, len(edges), PAIRS, partial(merged, mesh, edges))
    return mesh


def _evolved(
    mesh: Polygons, bound: int, genes: int, perform: Callable[[list[int]], Polygons]
) -> Polygons:
    """Run an operation GA on a mesh and return that of its best individual."""

    def evaluate(genome: list[int]) -> tuple[float]:
        try:
            return (perform(genome).fitness,)
        except pymeshlab.PyMeshLabException:
            return (INVALID,)

    toolbox = _toolbox(lambda: random.randrange(bound), genes, evaluate)
    best = tools.HallOfFame(1)
    algorithms.eaSimple(
        toolbox.population(n=POPULATION),
        toolbox,
        CROSSOVER,
        MUTATION,
        GENERATIONS,
        halloffame=best,
        verbose=False,
    )
    try:
        return perform(best[0])
    except pymeshlab.PyMeshLabException:
        return mesh


def remeshed(mesh: Polygons, size: float, ends: list[int]) -> Polygons:
    """Remesh the faces of ranges of numbers, and pair all trias of the mesh anew."""
    trias, owners = mesh.triangulated()
    selected = np.zeros(len(trias))
    for one, other in zip(ends[::2], ends[1::2], strict=True):
        selected[(owners >= min(one, other)) & (owners <= max(one, other))] = 1.0
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(mesh.points, trias, f_scalar_array=selected))
    meshes.compute_selection_by_scalar_per_face(minq=0.5, maxq=2.0)
    meshes.meshing_isotropic_explicit_remeshing(**isotropic_options(size))
    return _paired(meshes)


def merged(mesh: Polygons, edges: list[tuple[int, int]], chosen: list[int]) -> Polygons:
    """Merge the ends of some edges at the second one, and pair all trias of the mesh anew."""
    points = mesh.points.copy()
    for gone, stays in (edges[k] for k in chosen):
        points[gone] = points[stays]
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(points, mesh.triangulated()[0]))
    meshes.meshing_merge_close_vertices(threshold=pymeshlab.PureValue(_NEAR))
    meshes.meshing_remove_null_faces()
    return _paired(meshes)


def _paired(meshes: pymeshlab.MeshSet) -> Polygons:
    meshes.meshing_tri_to_quad_by_smart_triangle_pairing()
    found = meshes.current_mesh()
    return Polygons(found.vertex_matrix(), [list(face) for face in found.polygonal_face_list()])


def _toolbox(
    gene: Callable[[], int], genes: int, evaluate: Callable[[list[int]], tuple[float]]
) -> Any:
    """Return what DEAP's simple evolutionary algorithm needs for lists of numbers."""
    if not hasattr(creator, "Procedure"):
        creator.create("Best", base.Fitness, weights=(1.0,))
        creator.create("Procedure", list, fitness=creator.Best)
    toolbox = base.Toolbox()
    toolbox.register("individual", tools.initRepeat, creator.Procedure, gene, genes)
    toolbox.register("population", tools.initRepeat, list, toolbox.individual)
    toolbox.register("evaluate", evaluate)
    toolbox.register("mate", tools.cxOnePoint)
    toolbox.register("mutate", _redrawn, gene=gene)
    toolbox.register("select", tools.selRoulette)
    return toolbox


def _redrawn(individual: list[int], gene: Callable[[], int]) -> tuple[list[int]]:
    """Draw one gene anew."""
    individual[random.randrange(len(individual))] = gene()
    return (individual,)
