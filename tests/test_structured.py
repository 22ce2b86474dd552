"""The structured decks of the benchmark of harm: sound where they should be, and as they claim."""

import numpy as np
import pytest

from benchmarks.planting import PLANTS, planted
from benchmarks.structured import DECKS, KINDS, graded, structured
from meshops.criteria import PAPER, STANDARD
from meshops.harm import compare, local_sizes, median_size
from meshops.harm.edges import JUNCTION, Edges, kinds_of
from meshops.mesh import NO_NODE
from tests.meshes import sheet


def standing(mesh):
    return compare(mesh, mesh, PAPER.at(median_size(mesh)), local_sizes(mesh, mesh)).before


@pytest.mark.parametrize("seed", range(DECKS))
def test_a_deck_is_sound_and_has_faults_of_shape_only_where_they_are_planted(seed):
    deck = structured(seed)
    assert deck.mesh.digest == structured(seed).mesh.digest
    found = standing(deck.mesh)
    assert (found.same_nodes, found.inverted > 2 * deck.planted) == (0, False)
    used = np.unique(deck.mesh.elements)
    assert used[used != NO_NODE].tolist() == list(range(len(deck.mesh.points)))
    assert len(deck.mesh.elements) <= 2500
    if deck.planted:
        assert found.failed_by_shape + found.trias >= deck.planted
    elif "perforated" not in deck.name:  # the corners of such cells are skewed by nature
        assert (found.failed_by_shape, found.trias) == (0, 0)


def test_the_decks_are_of_all_kinds_and_most_have_no_fault():
    decks = [structured(seed) for seed in range(DECKS)]
    assert len({deck.mesh.digest for deck in decks}) == DECKS
    assert 15 <= sum(deck.planted > 0 for deck in decks) <= 45
    junctions = {
        list(KINDS)[k % len(KINDS)]
        for k, deck in enumerate(decks)
        if (kinds_of(deck.mesh, Edges.of(deck.mesh)) == JUNCTION).any()
    }
    assert {"I section", "T section", "box with T-junctions", "stiffened panel"} <= junctions
    assert not {"strip", "ring", "graded plate"} & junctions


def test_many_decks_fail_by_size_alone():
    decks = [structured(seed).mesh for seed in range(DECKS)]
    assert sum(standing(mesh).failed_by_size_alone > 0 for mesh in decks) >= 15


@pytest.mark.parametrize("plant", PLANTS, ids=lambda plant: plant.__name__)
def test_a_fault_changes_its_place_alone_and_is_one(plant):
    mesh = sheet(7, 7)
    bad = plant(mesh, 24, np.random.default_rng(5))
    harm = compare(mesh, bad, STANDARD.at(1.0))
    assert 2 <= harm.changed_elements <= 4
    assert harm.after.failed_by_shape + harm.after.trias >= 1
    assert harm.surface.nodes == pytest.approx(0.0, abs=1e-9)
    assert harm.border_deviation == 0.0
    assert harm.area_change == pytest.approx(0.0, abs=1e-9)


def test_faults_are_put_apart():
    mesh, count = planted(sheet(20, 20), np.random.default_rng(3), faults=3)
    assert count == 3
    assert compare(sheet(20, 20), mesh, STANDARD.at(1.0)).places.count == 3


def test_places_of_a_graded_side():
    places = graded(4, 2.0)
    assert places[[0, -1]].tolist() == [0.0, 1.0]
    assert np.diff(places)[1:] / np.diff(places)[:-1] == pytest.approx([2.0] * 3)
