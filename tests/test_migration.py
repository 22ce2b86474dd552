"""Who leaves an island, who comes, who gives way; and who sends to whom."""

from collections import Counter
from dataclasses import replace
from typing import Any, get_args

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from islands.config import load_config
from islands.migration import GivingWay, Leaving, Migrants, Migration, queue, settle
from islands.topology import Topology, TopologyKind
from meshops.errors import InputError


def rng(seed: int = 0) -> np.random.Generator:
    return np.random.default_rng(seed)


def population(fitness: list[float], first: int = 0) -> Migrants:
    """Genomes that differ in every gene."""
    count = len(fitness)
    genomes = first + np.arange(3 * count).reshape(count, 3)
    return Migrants(genomes, np.array(fitness), np.arange(count, dtype=float)[:, None] + first)


NOBODY = np.zeros(0, np.int64)

# --- who leaves ---------------------------------------------------------------------------------


def test_the_best_leave_first_and_the_first_of_equals() -> None:
    assert queue(np.array([1.0, 9.0, 5.0, 9.0]), Migration(), rng()).tolist() == [1, 3, 2, 0]


@pytest.mark.parametrize("leaving", get_args(Leaving))
def test_everyone_has_a_place_in_the_queue_and_the_fitter_rather_before(leaving: Any) -> None:
    fitness = np.array([1.0, -np.inf, 8.0, 4.0])
    migration = Migration(leaving=leaving)
    queues = [queue(fitness, migration, rng(seed)).tolist() for seed in range(300)]
    assert all(sorted(order) == [0, 1, 2, 3] for order in queues)
    first = Counter(order[0] for order in queues)
    if leaving == "random":
        assert min(first[row] for row in range(4)) > 40
    else:
        assert first[2] == max(first.values())
        assert first[2] > first[0]
        assert first[1] == 0


@given(st.integers(0, 9), st.integers(1, 12), st.floats(0, 1))
def test_a_number_or_a_share_of_an_island_leaves(count: int, size: int, share: float) -> None:
    assert Migration(count=count).number(size) == min(count, size)
    assert share * size <= Migration(count=count, share=share).number(size) <= size


# --- who gives way ------------------------------------------------------------------------------


def test_the_worst_give_way() -> None:
    residents, immigrants = population([4.0, 2.0, 3.0]), population([9.0, 5.0], 50)
    after = settle(residents, immigrants, NOBODY, Migration(), rng())
    assert after.fitness.tolist() == [4.0, 9.0, 5.0]
    assert after.genomes[1:].tolist() == immigrants.genomes.tolist()
    assert after.tallies.ravel().tolist() == [0.0, 50.0, 51.0]


def test_the_most_similar_gives_way() -> None:
    residents = population([4.0, 2.0, 3.0])
    immigrants = replace(population([9.0]), genomes=np.array([[0, 1, 77]]))
    after = settle(residents, immigrants, NOBODY, Migration(giving_way="most-similar"), rng())
    assert after.fitness.tolist() == [9.0, 2.0, 3.0]


def test_those_that_have_left_give_way() -> None:
    residents, immigrants = population([4.0, 2.0, 3.0]), population([9.0, 5.0], 50)
    migration = Migration(giving_way="parents")
    after = settle(residents, immigrants, np.array([0]), migration, rng())
    assert after.fitness.tolist() == [9.0, 5.0, 3.0]


def test_anyone_may_give_way_at_random() -> None:
    residents, immigrants = population([4.0, 2.0, 3.0]), population([9.0], 50)
    migration = Migration(giving_way="random")
    gone = Counter(
        settle(residents, immigrants, NOBODY, migration, rng(seed)).fitness.argmax()
        for seed in range(300)
    )
    assert min(gone[row] for row in range(3)) > 60


def test_duplicates_are_refused_if_asked() -> None:
    residents = population([4.0, 2.0, 3.0])
    twins = Migrants.join([residents.take(np.array([0])), *[population([9.0], 50)] * 2])
    refusing = settle(residents, twins, NOBODY, Migration(refuses_duplicates=True), rng())
    assert sorted(refusing.fitness) == [3.0, 4.0, 9.0]
    assert sorted(settle(residents, twins, NOBODY, Migration(), rng()).fitness) == [4.0, 9.0, 9.0]


@given(
    st.lists(st.floats(-5, 5), min_size=1, max_size=7),
    st.lists(st.floats(-5, 5), max_size=9),
    st.builds(
        Migration,
        giving_way=st.sampled_from(get_args(GivingWay)),
        refuses_duplicates=st.booleans(),
    ),
    st.integers(0, 99),
)
def test_an_island_keeps_its_size_and_migrants_are_copies(
    fitness: list[float], coming: list[float], migration: Migration, seed: int
) -> None:
    residents, immigrants = population(fitness), population(coming, 1000)
    after = settle(residents, immigrants, NOBODY, migration, rng(seed))
    assert len(after.genomes) == len(fitness)
    let_in = min(len(fitness), len(coming))
    assert np.count_nonzero(after.genomes[:, 0] >= 1000) == let_in
    known = {row.tobytes(): f for row, f in zip(immigrants.genomes, coming, strict=True)}
    known |= {row.tobytes(): f for row, f in zip(residents.genomes, fitness, strict=True)}
    assert all(
        known[row.tobytes()] == f for row, f in zip(after.genomes, after.fitness, strict=True)
    )
    after.genomes[:] = -1
    after.fitness[:] = -1
    assert (residents.genomes >= 0).all()
    assert residents.fitness.tolist() == fitness
    assert (immigrants.genomes >= 0).all()


# --- who sends to whom --------------------------------------------------------------------------


def test_a_ring_sends_to_the_next() -> None:
    assert Topology("ring").links(1) == ()
    assert Topology("ring").links(3) == ((0, 1), (1, 2), (2, 0))


DEGREES = {"two-way-ring": {2}, "torus": {4}, "hypercube": {4}, "random-regular": {4},
           "fully-connected": {15}, "star": {1, 15}}  # fmt: skip


@pytest.mark.parametrize("kind", sorted(set(get_args(TopologyKind)) - {"unconnected", "edges"}))
def test_every_topology_reaches_everyone(kind: Any) -> None:
    links = Topology(kind).links(16)
    assert links == Topology(kind).links(16)
    assert len(set(links)) == len(links)
    graph = nx.DiGraph(links)
    assert set(graph) == set(range(16))
    assert nx.is_strongly_connected(graph)
    assert all(source != target for source, target in links)
    if kind != "ring":
        assert {(b, a) for a, b in links} == set(links)
    if kind in DEGREES:
        assert {degree for _, degree in graph.out_degree} == DEGREES[kind]
    if kind == "star":
        assert graph.out_degree(0) == 15


@pytest.mark.parametrize("islands", [2, 3, 5, 6, 7])
@pytest.mark.parametrize("kind", ["ring", "two-way-ring", "torus", "star", "fully-connected"])
def test_any_number_of_islands_has_such_a_topology(kind: Any, islands: int) -> None:
    graph = nx.DiGraph(Topology(kind).links(islands))
    assert set(graph) == set(range(islands))
    assert nx.is_strongly_connected(graph)


def test_another_seed_makes_another_small_world() -> None:
    one, other = (Topology("small-world", seed=seed).links(20) for seed in (1, 2))
    assert one != other


def test_an_edge_list_is_taken_as_it_is() -> None:
    assert Topology("edges", edges=((2, 0), (0, 1), (0, 1))).links(3) == ((0, 1), (2, 0))


@pytest.mark.parametrize(
    ("topology", "islands", "words"),
    [
        (Topology("edges", edges=((0, 3),)), 3, "from island 0 to 3"),
        (Topology("edges", edges=((1, 1),)), 3, "nothing to themselves"),
        (Topology("hypercube"), 6, "2, 4, 8"),
        (Topology("random-regular", degree=3), 5, "must be even"),
        (Topology("small-world", degree=9), 5, "2 to 4 neighbours"),
    ],
)
def test_a_topology_that_does_not_fit_is_told(topology: Topology, islands: int, words: str) -> None:
    with pytest.raises(InputError, match=words):
        topology.links(islands)


# --- settings -----------------------------------------------------------------------------------


def test_islands_may_live_in_different_ways(tmp_path: Any) -> None:
    file = tmp_path / "islands.toml"
    file.write_text(
        'islands = 3\ntopology = "star"\nleaving = "tournament"\nmigrant-share = 0.5\n'
        '[[island]]\npopulation = 8\nselection = "rank"\n[[island]]\nmutation = 0.5\n'
    )
    config = load_config(file, {})
    plans = config.plans
    assert [plan.breeding.individuals for plan in plans] == [8, 2, 8]
    assert [plan.breeding.selection for plan in plans] == ["rank", "roulette", "rank"]
    assert [plan.breeding.mutation for plan in plans] == [0.1, 0.5, 0.1]
    assert {plan.migration.leaving for plan in plans} == {"tournament"}
    assert plans[0].migration.number(8) == 4
    assert config.schedule.links == ((0, 1), (0, 2), (1, 0), (2, 0))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("islands = 3\ntopology = 'hypercube'", "hypercube has 2, 4, 8"),
        ("[[island]]\nsize = 3", 'no setting of island 0 "size"; the settings are population'),
        ("[[island]]\npopulation = 1", '"population" is 1'),
        ("leaving = 'worst'", '"leaving" is'),
        ("[[island]]\noperations = ['dance']", "there is no operation 'dance'; there are"),
    ],
)
def test_mistakes_are_told_in_a_sentence(tmp_path: Any, text: str, words: str) -> None:
    file = tmp_path / "islands.toml"
    file.write_text(text)
    with pytest.raises(InputError, match=words):
        load_config(file, {})


def test_a_dense_random_graph_is_drawn_at_once() -> None:
    links = Topology("random-regular", degree=90).links(100)
    assert set(Counter(source for source, _ in links).values()) == {90}


def test_more_islands_and_links_than_a_run_can_have_are_refused() -> None:
    with pytest.raises(InputError, match="more than 250,000 links in a fully-connected"):
        load_config(None, {"islands": 5000, "topology": "fully-connected"})
    with pytest.raises(InputError, match=r"islands.*10000"):
        load_config(None, {"islands": 200_000_000})
