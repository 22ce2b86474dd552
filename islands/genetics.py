"""The GA of the paper's section 3.3 as plain functions on arrays, and its usual variants.

A population is (P, G) int64: individual p's gene g is at [p, g], from 0 to ``bounds[g] - 1``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from meshops.mesh import Floats, Ids

Scaling = Literal["proportional", "window"]
Selection = Literal["roulette", "tournament", "rank"]
Recombination = Literal["single-point", "two-point", "uniform"]


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
    selection : "roulette", "tournament" or "rank"
        How parents are drawn: by roulette, as in the paper; the fitter of two drawn at random; by
        a roulette whose slots fall evenly from the best to none for the worst.
    recombination : "single-point", "two-point" or "uniform"
        Which genes a pair of parents exchange: those after a point, as in the paper; those between
        two; each with a probability of one half.
    """

    individuals: int = 10
    generations: int = 10
    crossover: float = 0.95
    mutation: float = 0.05
    elites: int = 0
    scaling: Scaling = "proportional"
    selection: Selection = "roulette"
    recombination: Recombination = "single-point"


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


def tournament(fitness: Floats, count: int, rng: np.random.Generator) -> Ids:
    """Draw (count,) rows, each the fitter of two drawn at random; the first of equals."""
    drawn = rng.integers(0, len(fitness), (count, 2))
    first, second = drawn.T
    winners: Ids = np.where(fitness[second] > fitness[first], second, first)
    return winners


def rank_roulette(fitness: Floats, count: int, rng: np.random.Generator) -> Ids:
    """Draw (count,) rows by their rank alone; only where all are valid is the worst never drawn."""
    ranks = np.empty(len(fitness))
    ranks[np.argsort(fitness, kind="stable")] = np.arange(len(fitness), dtype=np.float64)
    return roulette(np.where(np.isfinite(fitness), ranks, -np.inf), count, rng, scaling="window")


def select(fitness: Floats, count: int, breeding: Breeding, rng: np.random.Generator) -> Ids:
    """Draw (count,) rows of parents."""
    if breeding.selection == "tournament":
        return tournament(fitness, count, rng)
    if breeding.selection == "rank":
        return rank_roulette(fitness, count, rng)
    return roulette(fitness, count, rng, scaling=breeding.scaling)


def crossover(
    parents: Ids, rate: float, rng: np.random.Generator, *, recombination: str = "single-point"
) -> Ids:
    """Recombine rows 0 and 1, 2 and 3, …; an odd last row stays."""
    children = parents.copy()
    pairs, genes = len(parents) // 2, parents.shape[1]
    if genes < 2:
        return children
    if recombination == "single-point":
        points = rng.integers(1, genes, pairs)
        points = np.where(rng.random(pairs) < rate, points, genes)
        swapped = np.arange(genes) >= points[:, None]
    else:
        if recombination == "two-point":
            first_point, last_point = np.sort(rng.integers(0, genes + 1, (2, pairs)), axis=0)
            places = np.arange(genes)
            swapped = (places >= first_point[:, None]) & (places < last_point[:, None])
        else:
            swapped = rng.random((pairs, genes)) < 0.5
        swapped &= (rng.random(pairs) < rate)[:, None]
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
    parents = genomes[select(fitness, count + count % 2, breeding, rng)]
    children = crossover(parents, breeding.crossover, rng, recombination=breeding.recombination)
    children = children[:count]
    children = mutate(children, fresh, breeding.mutation, rng)
    best = np.argsort(-fitness, kind="stable")[: breeding.elites]
    return np.concatenate([genomes[best], children])[:count]
