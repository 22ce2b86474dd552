"""Decks that once went wrong: what is right on each, after every free quad is meshed anew."""

from pathlib import Path

import numpy as np
import pytest

from meshops.formats import read_deck
from tests.abaqus_reader import fanned, free_quads, read_model, written
from tests.test_abaqus_elements import force

FAULTS = Path(__file__).parents[2] / "shared" / "faults" / "abaqus"

pytestmark = pytest.mark.skipif(not FAULTS.exists(), reason="no shared data")


@pytest.fixture
def fault(tmp_path):
    def read(name):
        """The text of a deck, and the deck."""
        path = tmp_path / name
        path.write_text((FAULTS / name).read_text())
        return path.read_text(), read_deck(path)

    return read


def anew(deck):
    """Text of the deck with a new node in each quad that is free."""
    return written(deck, fanned(deck.mesh, *free_quads(deck.mesh)))


def test_f02_new_nodes_are_as_warm_as_all(fault):
    _, deck = fault("f02_new_nodes_miss_nset_thermal.inp")
    assert not deck.mesh.locked_elements.any()
    model = read_model(anew(deck))
    assert len(model.nodes) == 99 + 80
    assert model.nsets["PART-1"] == model.nodes.keys()


def test_f02c_new_nodes_in_the_held_band_are_held(fault):
    before, deck = fault("f02c_new_nodes_miss_support_band.inp")
    old, new = read_model(before), read_model(anew(deck))
    held = old.nsets["MID"]
    middles = [
        np.mean([old.nodes[n] for n in nodes], axis=0)
        for _, nodes in old.elements.values()
        if len(nodes) == 4 and held.issuperset(nodes)
    ]
    born = new.nsets["MID"] - held
    assert len(born) == len(middles) > 20
    places = sorted(new.nodes[node] for node in born)
    np.testing.assert_allclose(places, sorted(map(list, middles)), atol=1e-9)


def test_f03_what_nothing_uses_locks_nothing(fault):
    _, deck = fault("f03_nset_of_all_nodes_locks_all.inp")
    assert [lock.sentence for lock in deck.locks] == [
        "21 nodes: NSET FIX in *BOUNDARY (they neither move nor vanish)"
    ]
    model = read_model(anew(deck))
    assert model.nsets["SET-1"] == model.nodes.keys()
    assert model.elsets["SET-1"] == model.elements.keys()


def test_f04_no_number_has_more_than_20_characters(fault):
    _, deck = fault("f04_numbers_longer_than_20.inp")
    text = anew(deck)
    assert max(len(token.strip()) for line in text.splitlines() for token in line.split(",")) <= 20


def test_f05_trias_beside_s4r_are_s3(fault):
    _, deck = fault("f05_s4r_only.inp")
    kinds = {kind for kind, _ in read_model(anew(deck)).elements.values()}
    assert kinds == {"S3"}


def test_f06_a_quoted_name_stays_as_it_stood(fault):
    before, deck = fault("f06_quoted_name.inp")
    text = anew(deck)
    model = read_model(text)
    assert model.elsets['"Skin Panel-a"'] == model.elements.keys()
    assert text.endswith(before[before.index("*Nset") :])


def test_f07_edges_of_shells_keep_their_heat(fault):
    before, deck = fault("f07_shell_edge_faces.inp")
    assert deck.mesh.element_ids[deck.mesh.locked_elements].tolist() == [*range(9, 73, 9)]

    def heat(text):
        model = read_model(text)
        ((name, label, flux),) = model.rows["DFLUX"]
        corner = int(label[1:]) - 3
        total = 0.0
        for element in model.elsets[name]:
            nodes = [model.nodes[n] for n in model.elements[element][1]]
            total += float(flux) * np.linalg.norm(np.subtract(nodes[corner + 1], nodes[corner]))
        return total

    assert heat(before) == pytest.approx(120.0)
    assert heat(anew(deck)) == pytest.approx(120.0)


def test_f10_an_indented_comment_is_one(fault):
    before, deck = fault("f10_indented_comment.inp")
    assert written(deck, deck.mesh) == before


def test_f11_indented_keywords_are_seen(fault):
    before, deck = fault("f11_indented_keywords.inp")
    loads = force(before, "DLOAD")
    # that of quads is taken to act at the mean of their corners
    np.testing.assert_allclose(force(anew(deck), "DLOAD"), loads, rtol=1e-4)
    assert len(deck.mesh.locked_nodes.nonzero()[0]) == 21


def test_f12_a_nested_include_is_found_in_the_folder_of_the_deck(tmp_path):
    deck = read_deck(FAULTS / "f12_nested_include" / "main.inp")
    assert deck.mesh.node_ids[deck.mesh.locked_nodes].tolist() == [1, 5, 9, 13]
    deck.write(fanned(deck.mesh, 5), tmp_path / "main.inp")
    assert "*INCLUDE, INPUT=sets.inc\n" in (tmp_path / "sub" / "mesh.inc").read_text()
    assert (tmp_path / "sets.inc").read_text().startswith("*NSET")
    assert len(read_deck(tmp_path / "main.inp").mesh.elements) == 12


def test_f16_two_parts_are_two_meshes(fault):
    before, deck = fault("f16_two_parts.inp")
    assert len(deck.mesh.elements) == 2 * 373
    text = anew(deck)
    for start in ("*PART, NAME=P1", "*PART, NAME=P2"):
        model = read_model(text[text.index(start) :].partition("*END PART")[0].partition("\n")[2])
        assert model.nsets["SET-1"] == model.nodes.keys()
        assert model.elsets["SET-1"] == model.elements.keys()
        old = read_model(before[before.index(start) :].partition("*END PART")[0].partition("\n")[2])
        assert sum(map(model.area, model.elements)) == pytest.approx(
            sum(map(old.area, old.elements))
        )
    assert text.endswith(before[before.index("*SURFACE") :])


def test_f19_results_of_another_run_are_not_read(fault):
    _, deck = fault("f19_submodel_frd_is_read_as_deck.inp")
    assert deck.notes == (
        "*SUBMODEL reads global.frd, which is no part of the deck: it stays where it is.",
    )
