"""Operation GA: evolves the parameters of one operation on one mesh."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from islands.genetics import Breeding, next_generation
from meshops.edit import Edit
from meshops.mesh import Floats, Ids, Ints
from meshops.operations import Operation, Remembering, SearchSpace
from meshops.workpiece import Workpiece


@dataclass(frozen=True, eq=False)
class Generation:
    """One generation of an operation GA.

    Attributes
    ----------
    number : int
        From 0, the first drawn.
    fitness : (P,) float64
        Of its individuals; -inf where one makes no valid mesh.
    tallies : (P, TALLY_SIZE) float64
        Of the meshes that its individuals lead to.
    best : (G,) int64
        The fittest genome so far.
    best_fitness : float
    best_tally : (TALLY_SIZE,) float64
    evaluations : int
        Individuals scored so far.
    """

    number: int
    fitness: Floats
    tallies: Floats
    best: Ids
    best_fitness: float
    best_tally: Floats
    evaluations: int


@dataclass(frozen=True, eq=False)
class Evolved:
    """What an operation GA found on a mesh; no parameters: the mesh stays as it is."""

    parameters: Ints
    edit: Edit
    evaluations: int


def generations(
    space: SearchSpace, workpiece: Workpiece, breeding: Breeding, rng: np.random.Generator
) -> Iterator[Generation]:
    """Evolve genomes of a search space: the first generation and those that follow from it."""
    genomes = space.draw(rng, breeding.individuals)
    best, best_fitness, best_tally = genomes[0], -np.inf, workpiece.tally
    for number in range(breeding.generations + 1):
        tallies = space.evaluate(genomes)
        fitness = workpiece.fitness(tallies)
        top = int(np.argmax(fitness))
        if fitness[top] > best_fitness:
            best, best_fitness = genomes[top], float(fitness[top])
            best_tally = space.tally(best)
        evaluations = (number + 1) * breeding.individuals
        yield Generation(number, fitness, tallies, best, best_fitness, best_tally, evaluations)
        if number < breeding.generations:
            fresh = space.draw(rng, breeding.individuals)
            genomes = next_generation(genomes, fitness, fresh, breeding, rng)


def evolve(
    operation: Operation,
    workpiece: Workpiece,
    breeding: Breeding,
    rng: np.random.Generator,
    *,
    improving: bool,
) -> Evolved:
    """Run the operation GA and make the edit of its fittest genome.

    With `improving`, a mesh stays as it is unless the fittest genome makes it fitter or leaves it
    with as many failed elements and trias: without such neutral steps the search would stand still
    where it takes two operations to gain something. Without, the fittest valid genome is applied
    even where it does harm, as in the paper.
    """
    space = operation.search_space(workpiece, rng)
    nothing = np.zeros((0, 2), np.int32)
    if space is None:
        return Evolved(nothing, Edit(), 0)
    *_, last = generations(space, workpiece, breeding, rng)
    fit = np.isfinite(last.best_fitness) and (not improving or workpiece.accepts(last.best_tally))
    parameters = space.parameters(last.best) if fit else nothing
    if not len(parameters):
        return Evolved(nothing, Edit(), last.evaluations)
    if isinstance(space, Remembering):
        edit = space.edit_of(last.best)
    else:
        edit = operation.apply(workpiece, parameters)
    return Evolved(nothing if edit.is_empty else parameters, edit, last.evaluations)
