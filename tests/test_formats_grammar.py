"""What Nastran decks may say and how: markers, replication, sections, sets by subcase."""

from pathlib import Path

import numpy as np
import pytest

from meshops.edit import Edit, apply
from meshops.errors import InputError
from meshops.formats import read_deck
from meshops.formats.nastran_cards import lex
from meshops.mesh import NO_NODE
from tests.strips import GRIDS, SHELLS, deck_maker, halved, written

FAULTS = Path(__file__).parents[2] / "shared" / "faults" / "nastran"
needs_faults = pytest.mark.skipif(not FAULTS.is_dir(), reason="no shared faults")


@pytest.fixture
def deck(tmp_path):
    return deck_maker(tmp_path)


def locked(mesh):
    return mesh.node_ids[mesh.locked_nodes].tolist()


# --- markers ----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "fields"),
    [
        ("CORD2R,5,0,3.,2.,0.,3.,2.,1.,-1.,5.,0.", {8: "-1.", 9: "5.", 10: "0."}),
        ("CORD2R,5,0,3.,2.,0.,3.,2.,1.,.5,5.,0.", {8: ".5", 9: "5."}),
        ("CORD2R,5,0,3.,2.,0.,3.,2.,1.,+,5.,0.,1.", {8: "5.", 9: "0.", 10: "1."}),
        ("CORD2R,5,0,3.,2.,0.,3.,2.,1.,*A1,5.,0.", {8: "5."}),
        ("CORD2R,5,0,3.,2.,0.,3.,2.,1.,,5.,0.", {8: "5."}),
        ("CORD2R,5,0,3.,2.,0.,3.,2.,1.,CD1,5.,0.", {8: "5."}),
        ("SPC1,1,123456,1,2,3,4,5,6,7,8", {8: "7", 9: "8"}),
        ("SET1,1,2,3,4,5,6,7,8,THRU,20", {8: "THRU", 9: "20"}),
        ("MPC,5,49,3,1.,50,3,-1.,,,62,3,-1.", {8: "", 9: "62", 10: "3"}),
        ("MPC,5,49,3,1.,50,3,-1.,,+,,62,3,-1.", {8: "", 9: "62"}),
        ("MPC,5,49,3,1.,50,3,-1.,,,,62,3,-1.", {8: "", 9: "62"}),
        ("   SPC1 , 1,123456,1", {0: "1", 1: "123456"}),
        ("  SPC1         1  123456       1", {0: "1", 1: "123456"}),
    ],
)
def test_the_ninth_field_is_a_marker_or_data(text, fields):
    (card,) = lex([text], 0)
    assert {i: card.field(i) for i in fields} == fields


@pytest.mark.parametrize(("parent", "child"), [("CORD1", "+ORD1"), ("+A", "+A"), ("A", "+A")])
def test_markers_old_and_new(parent, child):
    fixed = f"{'CORD2C':8}{'1':8}".ljust(64) + f"{'1.':8}{parent}"
    (card,) = lex([fixed, f"{child:8}1."], 0)
    assert [card.field(i) for i in (0, 7, 8)] == ["1", "1.", "1."]


@pytest.mark.parametrize("place", [0, 1, 2])
def test_a_sorted_deck_has_its_continuations_elsewhere(deck, place):
    cards = SHELLS.splitlines(keepends=True)
    away = "+Q1                    1      .5      .5      .5      .5\n"
    cards[1] = f"{'CQUAD4':8}{2:8}{1:8}{12:8}{13:8}{23:8}{22:8}".ljust(72) + "+Q1\n"
    pieces = [GRIDS, "".join(cards)]
    pieces.insert(place, away)
    source = deck("".join(pieces))
    assert source.mesh.region.tolist() == [0, 1, 0, 0, 0]
    assert source.regions[1].thickness == (".5", ".5", ".5", ".5")
    # both lines go with the shell
    text = written(source, halved(source.mesh, 2))
    assert "Q1" not in text
    assert text.startswith(GRIDS)


def test_a_chain_of_continuations_in_any_order():
    head = f"{'SPC1':8}{1:8}{123:8}".ljust(72)
    lines = ["+B            30", f"{head}+A", "GRID,9,,0.,0.,0.", "+A      20".ljust(72) + "+B"]
    first, grid = lex(lines, 0)
    assert [first.field(i) for i in (0, 1, 8, 16)] == ["1", "123", "20", "30"]
    assert first.lines == [1, 3, 0]
    assert grid.lines == [2]


@needs_faults
@pytest.mark.parametrize(
    ("name", "nodes"),
    [
        ("free_field_mpc_one_line", [49, 50, 62]),
        ("grdpnt_node_deleted", [49]),
        ("set_defined_again_in_subcase", [47, 49, 62, 75]),
    ],
)
def test_faults_of_references(name, nodes):
    mesh = read_deck(FAULTS / f"{name}.bdf").mesh
    assert locked(mesh) == [*range(1, 12), *nodes]


@needs_faults
def test_fault_of_a_negative_ninth_field():
    mesh = read_deck(FAULTS / "free_field_negative_ninth.bdf").mesh
    # the nodes are those of the plate that all these decks have, in another system
    plate = read_deck(FAULTS / "old_continuation_marker.bdf").mesh
    np.testing.assert_allclose(mesh.points, plate.points, atol=1e-4)
    assert len(mesh.elements) == 84


# --- replication ------------------------------------------------------------------------------

REPLICATED = """\
GRID    11              1.      1.      0.
=       *(1)    =       *(1.)   ==
=(4)
GRID,21,,1.,2.,0.
=,*1,=,*1.,==
=4
CQUAD4  1       1       11      12      22      21
=       *(1)    =       *(1)    *(1)    *(1)    *(1)
=(3)
"""


def test_replicated_cards_are_those_that_they_stand_for(deck):
    mesh = deck(REPLICATED).mesh
    plain = deck(GRIDS + SHELLS, "plain.bdf").mesh
    assert mesh.node_ids.tolist() == plain.node_ids.tolist()
    assert (mesh.points == plain.points).all()
    assert (mesh.elements == plain.elements).all()
    assert mesh.element_ids.tolist() == plain.element_ids.tolist()


def test_replicated_cards_stay_where_none_changes_and_are_written_out_where_one_does(deck):
    source = deck(REPLICATED)
    assert written(source, source.mesh) == REPLICATED
    row = int(np.flatnonzero(source.mesh.node_ids == 13)[0])
    edit = Edit(moved=np.array([row]), moved_to=np.array([[3.25, 1.0, 0.0]]))
    text = written(source, apply(source.mesh, edit))
    # the lower nodes are written out, the upper ones and the shells are as they were
    assert text.endswith(REPLICATED[REPLICATED.index("GRID,21") :])
    again = deck(text, "again.bdf").mesh
    assert again.points[row].tolist() == [3.25, 1.0, 0.0]
    assert (
        np.delete(again.points, row, 0).tolist() == np.delete(source.mesh.points, row, 0).tolist()
    )
    text = written(source, halved(source.mesh, 3))
    again = deck(text, "again.bdf").mesh
    assert again.element_ids.tolist()[:4] == [1, 2, 4, 5]
    assert len(again.elements) == 6


@needs_faults
def test_fault_of_replicated_cards():
    source = read_deck(FAULTS / "replicated_cards.bdf")
    grids = source.parts[0].contents.grid_by_id
    assert [grids[i].field(2) for i in (201, 202, 210)] == ["0.", "1.", "9."]
    assert [grids[210].field(i) for i in (3, 4)] == ["20.", "0."]


# --- sections ---------------------------------------------------------------------------------


def test_each_superelement_has_shells_of_its_own(deck):
    other = GRIDS.replace(".,0.\n", ".,9.\n") + SHELLS
    text = f"CEND\nBEGIN BULK\n{GRIDS}{SHELLS}SPC1,1,123,11\nBEGIN SUPER=2\n{other}ENDDATA\n"
    source = deck(text)
    mesh = source.mesh
    assert len(mesh.elements) == 10
    assert mesh.element_ids.tolist() == [*range(1, 6), *range(2 * 10**9 + 1, 2 * 10**9 + 6)]
    # what a section names is its own
    assert locked(mesh) == [11]
    assert any("2" in note or "n,000" in note for note in source.notes)
    after = written(source, halved(mesh, 2, 2 * 10**9 + 3))
    main, part = after.split("BEGIN SUPER=2\n")
    assert [line for line in main.splitlines() if line.startswith("CTRIA3")] == [
        "CTRIA3,27,1,12,13,23",
        "CTRIA3,28,1,23,22,12",
    ]
    assert [line for line in part.splitlines() if line.startswith("CTRIA3")] == [
        "CTRIA3,27,1,13,14,24",
        "CTRIA3,28,1,24,23,13",
    ]
    assert "CQUAD4,2,1" not in main
    assert "CQUAD4,2,1" in part
    assert written(source, mesh) == text


def test_ids_that_differ_are_those_of_the_deck_and_joined_nodes_stay(deck):
    other = GRIDS.replace("GRID,1", "GRID,51").replace("GRID,2", "GRID,52")
    shells = "".join(
        f"CQUAD4,9{i},1,{510 + i},{511 + i},{521 + i},{520 + i}\n" for i in range(1, 6)
    )
    # the part lies on top: its lower nodes are where the upper ones of the deck are
    other = other.replace(",2.,0.\n", ",3.,0.\n").replace(",1.,0.\n", ",2.,0.\n")
    source = deck(f"CEND\nBEGIN BULK\n{GRIDS}{SHELLS}BEGIN SUPER=2\n{other}{shells}ENDDATA\n")
    assert source.mesh.element_ids.tolist() == [1, 2, 3, 4, 5, 91, 92, 93, 94, 95]
    assert len(set(locked(source.mesh))) == len(locked(source.mesh))
    assert set(range(21, 27)) <= set(locked(source.mesh))


@needs_faults
def test_faults_of_sections_and_marks():
    for name in ("begin_super", "utf8_bom", "old_continuation_marker"):
        mesh = read_deck(FAULTS / f"{name}.bdf").mesh
        assert (len(mesh.points), len(mesh.elements)) == (99, 84)


# --- shells on the same nodes, and nodes named twice -------------------------------------------


def test_a_doubler_is_locked_with_what_it_lies_on_and_told(deck):
    source = deck(GRIDS + SHELLS + "CQUAD4,9,2,23,22,12,13\n")
    mesh = source.mesh
    assert mesh.element_ids[mesh.locked_elements].tolist() == [2, 9]
    assert source.notes == (
        "On the same nodes as another shell, and left as they are: elements 2, 9.",
    )
    assert len(read_deck(source.sources.files[0].path).mesh.elements) == 6
    assert "CQUAD4,9,2,23,22,12,13\n" in written(source, halved(mesh, 4))


@pytest.mark.parametrize("nodes", ["13,14,24,24", "13,13,14,24", "13,14,14,24", "13,14,24,13"])
def test_a_quad_that_names_a_node_twice_is_a_tria(deck, nodes):
    cards = SHELLS.replace("CQUAD4,3,1,13,14,24,23\n", f"CQUAD4,3,1,{nodes}\nCTRIA3,6,1,13,24,23\n")
    source = deck(GRIDS + cards)
    mesh = source.mesh
    row = int(np.flatnonzero(mesh.element_ids == 3)[0])
    assert mesh.elements[row, 3] == NO_NODE
    assert mesh.node_ids[mesh.elements[row, :3]].tolist() == [13, 14, 24]
    assert mesh.locked_elements.nonzero()[0].tolist() == [row]
    assert "element 3" in source.notes[0]
    assert f"CQUAD4,3,1,{nodes}\n" in written(source, halved(mesh, 1))


@needs_faults
def test_faults_of_doublers_and_repeated_nodes():
    source = read_deck(FAULTS / "doubler_on_same_nodes_refused.bdf")
    mesh = source.mesh
    assert sorted(mesh.element_ids[mesh.locked_elements]) == [70, 71, 5070, 5071]
    source = read_deck(FAULTS / "quad_with_repeated_node.bdf")
    assert source.mesh.element_ids[source.mesh.locked_elements].tolist() == [5001]
    assert source.notes


def test_a_new_shell_on_the_nodes_of_a_gone_one_keeps_its_id(deck):
    source = deck(GRIDS + SHELLS)
    mesh = source.mesh
    again = mesh.elements[[1, 3]][:, [2, 3, 0, 1]]
    edit = Edit(np.array([1, 3]), added_elements=again, added_region=np.zeros(2, np.int32))
    assert written(source, apply(mesh, edit)) == GRIDS + SHELLS
    turned = mesh.elements[[1]][:, ::-1]
    edit = Edit(np.array([1]), added_elements=turned, added_region=np.zeros(1, np.int32))
    assert "CQUAD4,27,1,22,23,13,12" in written(source, apply(mesh, edit))


# --- case control and what it names ------------------------------------------------------------


@pytest.mark.parametrize(
    ("head", "nodes"),
    [
        ("SUBCASE 1\nSET 1 = 12\nDISP = 1\nSUBCASE 2\nSET 1 = 15\nDISP = 1\n", [12, 15]),
        ("SET 1 = 12/T3, 15/R1\nPARTN = 1\n", [12, 15]),
        ("GROUNDCHECK(GRID=13,SET=ALL) = YES\n", [13]),
        ("WEIGHTCHECK(GRID = 14) = YES\n", [14]),
        ("PARAM,GRDPNT,15\n", [15]),
        ("XYPLOT DISP RESPONSE / 12(T3), 25(T1)\n", [12, 25]),
        ("  SET 4 = 13\n  DISPLACEMENT(SORT1,REAL)=4\n", [13]),
        ("SET 4 = 13\nSTRESS = 5\n", []),
    ],
)
def test_nodes_that_case_control_names(deck, head, nodes):
    assert locked(deck(f"CEND\n{head}BEGIN BULK\n{GRIDS}{SHELLS}").mesh) == nodes


@pytest.mark.parametrize(
    ("request_", "cards", "nodes"),
    [
        ("DISP = 5\n", "SET,5,GRID,LIST,,,,,,+\n+,12,THRU,14\n", [12, 13, 14]),
        ("DISP = 6\n", "SET,5,GRID,LIST,,,,,,+\n+,12,THRU,14\n", []),
        ("", "SET,5,GRID,LIST,,,,,,+\n+,12,THRU,14\nNOVELTY,5\n", [12, 13, 14]),
    ],
)
def test_a_set_card_locks_where_it_is_used(deck, request_, cards, nodes):
    source = deck(f"CEND\n{request_}BEGIN BULK\n{GRIDS}{SHELLS}{cards}", "deck.fem")
    assert locked(source.mesh) == nodes


def test_a_param_names_a_node(deck):
    assert locked(deck(GRIDS + SHELLS + "PARAM,GRDPNT,15\nPARAM,WTMASS,12\n").mesh) == [15]


# --- ids ----------------------------------------------------------------------------------------


def test_too_few_ids_are_told_before_a_search(deck):
    source = deck(GRIDS + SHELLS + "PLOAD2,1,2.,3,THRU,99999999\n")
    with pytest.raises(InputError, match="leaves 0 ids of elements free"):
        source.check_room()


def test_the_suffix_of_optistruct(deck):
    source = deck("BEGIN BULK\n" + GRIDS + SHELLS + "ENDDATA\n", "deck.fem")
    source.write(source.mesh, source.sources.files[0].path.with_name("out.fem"))
    assert len(source.mesh.elements) == 5
