from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from islands.genetics import (
    Breeding,
    crossover,
    mutate,
    next_generation,
    rank_roulette,
    roulette,
    tournament,
)


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def test_roulette_draws_in_proportion_to_fitness() -> None:
    drawn = roulette(np.array([1.0, 2.0, 5.0]), 40_000, rng())
    share = np.bincount(drawn, minlength=3) / len(drawn)
    assert share == pytest.approx([1 / 8, 2 / 8, 5 / 8], abs=0.01)


def test_window_scaling_measures_from_the_worst() -> None:
    drawn = roulette(np.array([99.0, 99.1, 99.3]), 40_000, rng(), scaling="window")
    share = np.bincount(drawn, minlength=3) / len(drawn)
    assert share == pytest.approx([0, 1 / 4, 3 / 4], abs=0.01)


@pytest.mark.parametrize("scaling", ["proportional", "window"])
def test_individuals_without_a_mesh_are_not_drawn(scaling: str) -> None:
    drawn = roulette(np.array([-np.inf, 3.0, -np.inf, 2.0]), 500, rng(), scaling=scaling)
    assert set(drawn) <= {1, 3}


def test_roulette_survives_a_population_without_any_mesh() -> None:
    assert set(roulette(np.full(3, -np.inf), 300, rng())) == {0, 1, 2}


def test_negative_fitness_still_prefers_the_fitter() -> None:
    drawn = roulette(np.array([-239.0, -200.0, -230.0]), 2_000, rng())
    share = np.bincount(drawn, minlength=3)
    assert share[1] > share[2] > share[0]


def test_crossover_swaps_tails_at_one_point() -> None:
    parents = np.array([[0] * 8, [1] * 8] * 50)
    children = crossover(parents, 1.0, rng())
    for first, second in zip(children[::2], children[1::2], strict=True):
        assert (first + second == 1).all()
        assert np.count_nonzero(np.diff(first)) == 1
        assert first[0] == 0
        assert first[-1] == 1


def test_a_tournament_is_won_by_the_fitter_of_two() -> None:
    drawn = tournament(np.array([5.0, -np.inf, 9.0]), 40_000, rng())
    share = np.bincount(drawn, minlength=3) / len(drawn)
    assert share == pytest.approx([3 / 9, 1 / 9, 5 / 9], abs=0.01)


def test_ranks_select_whatever_the_distances() -> None:
    fitness = np.array([99.9, 3.0, 100.0, -np.inf])
    drawn = rank_roulette(fitness, 40_000, rng())
    share = np.bincount(drawn, minlength=4) / len(drawn)
    assert share == pytest.approx([1 / 3, 0, 2 / 3, 0], abs=0.01)


def test_two_points_bound_what_is_exchanged() -> None:
    parents = np.array([[0] * 8, [1] * 8] * 200)
    children = crossover(parents, 1.0, rng(), recombination="two-point")
    changes = np.abs(np.diff(children[::2], axis=1)).sum(axis=1)
    assert set(changes) == {0, 1, 2}
    assert (children[::2] + children[1::2] == 1).all()


def test_uniform_crossover_exchanges_half_of_the_genes() -> None:
    parents = np.array([[0] * 8, [1] * 8] * 2_000)
    children = crossover(parents, 0.6, rng(), recombination="uniform")
    assert (children[::2] + children[1::2] == 1).all()
    assert children[::2].mean() == pytest.approx(0.3, abs=0.02)


def test_crossover_happens_at_its_rate() -> None:
    parents = np.array([[0] * 8, [1] * 8] * 5_000)
    children = crossover(parents, 0.95, rng())[::2]
    assert (children != 0).any(axis=1).mean() == pytest.approx(0.95, abs=0.01)


def test_mutation_draws_genes_anew_at_its_rate() -> None:
    fresh = np.arange(40_000).reshape(-1, 2)
    mutated = mutate(np.full((20_000, 2), -1), fresh, 0.05, rng())
    changed = mutated >= 0
    assert changed.mean(axis=0) == pytest.approx([0.05, 0.05], abs=0.005)
    assert (mutated[changed] == fresh[changed]).all()


@settings(deadline=None)
@given(
    st.integers(2, 12),
    st.integers(1, 7),
    st.integers(0, 3),
    st.sampled_from(["proportional", "window"]),
    st.sampled_from(["roulette", "tournament", "rank"]),
    st.sampled_from(["single-point", "two-point", "uniform"]),
    st.integers(0, 2**32),
)
def test_generations_keep_size_and_bounds(
    individuals: int,
    genes: int,
    elites: int,
    scaling: Any,
    selection: Any,
    recombination: Any,
    seed: int,
) -> None:
    random = rng(seed)
    bounds = random.integers(1, 9, genes)
    genomes = random.integers(0, bounds, (individuals, genes))
    fitness = random.normal(size=individuals)
    breeding = Breeding(
        individuals=individuals,
        elites=elites,
        scaling=scaling,
        selection=selection,
        recombination=recombination,
    )
    fresh = random.integers(0, bounds, (individuals, genes))
    following = next_generation(genomes, fitness, fresh, breeding, random)
    assert following.shape == genomes.shape
    assert (following >= 0).all()
    assert (following < bounds).all()
    best = np.argsort(-fitness, kind="stable")[:elites]
    assert (following[: len(best)] == genomes[best]).all()


def test_genomes_are_copied_not_shared() -> None:
    genomes = np.zeros((4, 3), np.int64)
    fresh = np.full((4, 3), 5)
    following = next_generation(
        genomes, np.ones(4), fresh, Breeding(individuals=4, elites=2), rng()
    )
    following[:] = 9
    assert (genomes == 0).all()
    assert (fresh == 5).all()
