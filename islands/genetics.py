"""The GA of the paper's section 3.3 as plain functions on arrays.

A population is (P, G) int64: individual p's gene g is at [p, g], from 0 to ``bounds[g] - 1``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from meshops.mesh import Floats, Ids


@dataclass(frozen=True)
class Breeding:
    """How a generation follows from the one before.

    Attributes
    ----------
    individuals : int
    generations : int
    crossover : float
        Share of parent pairs whose genes are recombined.
    mutation : float
        Probability of each gene to be drawn anew.
    elites : int
        Best individuals that pass unchanged; the paper has none.
    scaling : "proportional" or "window"
        Whether a roulette slot is as wide as the fitness, as in the paper, or as the fitness above
        that of the worst individual, which selects among nearly equal ones.
    """

    individuals: int = 10
    generations: int = 10
    crossover: float = 0.95
    mutation: float = 0.05
    elites: int = 0
    scaling: Literal["proportional", "window"] = "proportional"


def roulette(
    fitness: Floats, count: int, rng: np.random.Generator, *, scaling: str = "proportional"
) -> Ids:
    """Draw (count,) rows, each with a probability in proportion to its fitness (P,).

    Individuals without a valid mesh (-inf) are drawn only where there is no other. Fitness below 0
    is shifted so that the worst valid individual has a slot of no width.
    """
    valid = np.isfinite(fitness)
    slots = np.where(valid, fitness, 0.0)
    if valid.any():
        worst = slots[valid].min()
        slots = np.where(valid, slots - (worst if scaling == "window" else min(worst, 0.0)), 0.0)
    total = slots.sum()
    if total <= 0.0:
        slots = valid if valid.any() else np.ones(len(fitness))
        total = slots.sum()
    drawn: Ids = rng.choice(len(fitness), size=count, p=slots / total)
    return drawn


def crossover(parents: Ids, rate: float, rng: np.random.Generator) -> Ids:
    """Recombine rows 0 and 1, 2 and 3, … at one point each; an odd last row stays."""
    children = parents.copy()
    pairs, genes = len(parents) // 2, parents.shape[1]
    if genes < 2:
        return children
    points = rng.integers(1, genes, pairs)
    points = np.where(rng.random(pairs) < rate, points, genes)
    swapped = np.arange(genes) >= points[:, None]
    first, second = parents[: 2 * pairs : 2], parents[1 : 2 * pairs : 2]
    children[: 2 * pairs : 2] = np.where(swapped, second, first)
    children[1 : 2 * pairs : 2] = np.where(swapped, first, second)
    return children


def mutate(genomes: Ids, fresh: Ids, rate: float, rng: np.random.Generator) -> Ids:
    """Replace each gene, with a probability, by that of a genome drawn anew."""
    return np.where(rng.random(genomes.shape) < rate, fresh, genomes)


def next_generation(
    genomes: Ids, fitness: Floats, fresh: Ids, breeding: Breeding, rng: np.random.Generator
) -> Ids:
    """Select, recombine, mutate: (P, G) genomes of the next generation, its elites first.

    `fresh` (P, G) are genomes drawn anew, from which mutation takes its genes.
    """
    count = breeding.individuals
    parents = genomes[roulette(fitness, count + count % 2, rng, scaling=breeding.scaling)]
    children = crossover(parents, breeding.crossover, rng)[:count]
    children = mutate(children, fresh, breeding.mutation, rng)
    best = np.argsort(-fitness, kind="stable")[: breeding.elites]
    return np.concatenate([genomes[best], children])[:count]
