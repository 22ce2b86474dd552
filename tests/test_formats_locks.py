"""Nodes and elements that other cards of a Nastran deck refer to are locked."""

import pytest

from meshops.formats import read_deck

# nodes 11 to 16 and 21 to 26, elements 31 to 35: no number is both
GRIDS = "".join(
    f"GRID,{10 * j + i},,{i}.,{j}.,0.\n" for j in (1, 2) for i in range(1, 7) if i + j < 9
)
SHELLS = "".join(f"CQUAD4,{30 + i},1,{10 + i},{11 + i},{21 + i},{20 + i}\n" for i in range(1, 6))


@pytest.fixture
def locks(tmp_path):
    def locks(cards, head=""):
        path = tmp_path / "deck.bdf"
        path.write_text(head + GRIDS + SHELLS + cards + "\n")
        mesh = read_deck(path).mesh
        return (
            mesh.node_ids[mesh.locked_nodes].tolist(),
            mesh.element_ids[mesh.locked_elements].tolist(),
        )

    return locks


@pytest.mark.parametrize(
    ("card", "nodes"),
    [
        ("SPC,1,12,123,0.,13,11,0.", [12, 13]),
        ("SPC1,1,123,11,THRU,13", [11, 12, 13]),
        ("SPC1,1,12,21,22", [21, 22]),
        ("SPCD,1,12,13,0.", [12]),
        ("MPC,1,11,1,1.,12,1,-1.,,+\n+,,13,1,1.", [11, 12, 13]),
        ("FORCE,11,12,13,1.,0.,0.,1.", [12]),
        ("FORCE1,1,12,1.,13,14", [12, 13, 14]),
        ("TEMP,1,11,20.,12,20.,13,20.", [11, 12, 13]),
        ("PLOAD,1,2.,11,12,22,21", [11, 12, 21, 22]),
        ("RBE1,9,11,123456,,,,,,+\n+,UM,12,123,13,123,,,,+\n+,,14,123", [11, 12, 13, 14]),
        ("RBE2,99,11,123456,12,13,1.2-5", [11, 12, 13]),
        ("RBE3,99,,11,123456,1.0,12,21,22,+\n+,23,2.0,13,24,UM,25,16", [11, 21, 22, 23, 24, 25]),
        ("RBAR,99,11,12,123456", [11, 12]),
        ("CBAR,99,1,11,12,13", [11, 12, 13]),
        ("CBAR,99,1,11,12,1.,0.,0.", [11, 12]),
        ("CONROD,99,11,12,13,1.", [11, 12]),
        ("CBUSH,99,1,11,12,,,,13", [11, 12]),
        ("CELAS2,99,1.,11,1,12,1", [11, 12]),
        ("CONM2,99,11,12,1.", [11]),
        ("PLOTEL,98,11,12,,99,13,14", [11, 12, 13, 14]),
        ("SUPORT,11,123,12,123", [11, 12]),
        ("ASET1,123,11,12", [11, 12]),
        ("ASET,11,12,13,14", [11, 13]),
        ("CORD1R,9,11,12,22", [11, 12, 22]),
        ("CQUAD8,99,12,11,13,23,21,12,24,+\n+,22,25", [11, 12, 13, 21, 22, 23, 24, 25]),
        ("CHEXA,99,16,11,12,22,21,901,902,+\n+,903,904", [11, 12, 21, 22]),
        ("CSHEAR,99,16,11,12,22,21", [11, 12, 21, 22]),
        ("SET3,1,GRID,11,THRU,15,BY,2", [11, 13, 15]),
        ("SET3,1,PROP,11,31", []),
        ("RFORCE,13,11,12,100.,0.,0.,1.", [11]),
        ("DAREA,1,11,12,1.", [11]),
        ("GRAV,11,12,9.8,0.,0.,1.", []),
        ("PARAM,ANY,11", []),
        ("MAT1,11,1.,,.3", []),
        ("PSHELL,11,12,.1,13", []),
        ("LOAD,11,1.,1.,12", []),
        ("CORD2R,11,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.", []),
        ("TABLED1,11\n,12.,13.,ENDT", []),
    ],
)
def test_nodes_that_a_card_names(locks, card, nodes):
    assert locks(card) == (nodes, [])


@pytest.mark.parametrize(
    ("card", "nodes", "elements"),
    [
        ("PLOAD4,1,31,2.", [], []),
        ("PLOAD4,1,31,2.,2.,2.,.2+1", [], []),
        ("PLOAD4,1,31,2.,1.", [], []),
        ("PLOAD4,1,31,2.,,,0.", [], []),
        ("PLOAD4,1,31,2.,,,,11", [11], [31]),
        ("PLOAD4,1,31,2.,,,,,,+\n+,0,0.,0.,1.", [], []),
        ("PLOAD4,1,31,2.,,,,,,+\n+,0,0.,x,1.", [], [31]),
        ("PLOAD4,1,31,2.,,,,,,+\n+,,,,,LINE,TANG", [], [31]),
        ("PLOAD4,1,31,2.,,,,THRU,33", [], []),
        ("PLOAD4,1,31,2.,1.,,,THRU,33", [], []),
        ("PLOAD4,1,34,2.,,,,THRU,99999999", [], []),
        ("PLOAD4,1,31,2.,,,,,22", [22], [31]),
        ("PLOAD4,1,31,x", [], [31]),
        ("PLOAD4,,31,2.", [], [31]),
        ("PLOAD4,1,31,2.\nTEMPP1,1,31,20.", [], [31]),
        ("PLOAD4,1,99,2.,,,,11,22", [11, 22], []),
        ("PLOAD2,1,2.,31", [], []),
        ("PLOAD2,1,2.,31,33", [], []),
        ("PLOAD2,1,2.,31,THRU,33", [], []),
        ("PLOAD2,1,2.,31,99", [], []),
        ("PLOAD2,1,x,31,33", [], [31, 33]),
        ("PLOAD1,1,31,FZ,LE,0.,1.,1.,1.", [], [31]),
        ("TEMPP1,1,31,20.,,,,,,+\n+,33,THRU,35", [], [31, 33, 34, 35]),
        ("BSURF,11,31,THRU,33", [], [31, 32, 33]),
        ("SET3,11,ELEM,31,32", [], [31, 32]),
        ("SET1,1,11,31", [11], [31]),
        ("NOVELTY,11,2.5,words,31,THRU,900", [11], [31, 32, 33, 34, 35]),
        ("NOVELTY,12,THRU,14", [12, 13, 14], []),
        ("NOVELTY,ALL", [], []),
        (f"NOVELTY,{10**30},12", [12], []),
        ("PLOAD2,1,2.,ALL", [], [31, 32, 33, 34, 35]),
    ],
)
def test_elements_that_a_card_names(locks, card, nodes, elements):
    assert locks(card) == (nodes, elements)


@pytest.mark.parametrize("fields", ["7", ",123456", ",456"])
def test_a_grid_with_its_own_output_system_or_constraint_is_locked(locks, tmp_path, fields):
    assert locks("") == ([], [])
    text = (GRIDS + SHELLS).replace("GRID,12,,2.,1.,0.", f"GRID,12,,2.,1.,0.,{fields}")
    (tmp_path / "deck.bdf").write_text(text)
    mesh = read_deck(tmp_path / "deck.bdf").mesh
    assert mesh.node_ids[mesh.locked_nodes].tolist() == [12]


@pytest.mark.parametrize(
    ("request_line", "nodes"),
    [
        ("DISP = 1", [11, 12, 21, 22]),
        ("DISPLACEMENT(PLOT,SORT1) = 1", [11, 12, 21, 22]),
        ("SPCFORCES=1", [11, 12, 21, 22]),
        ("STRESS(PLOT) = 1", []),
        ("FORCE = 1", []),
        ("ESE = 1", []),
        ("DISP = ALL", []),
        ("DISP = 2", []),
    ],
)
def test_sets_of_node_output_lock_their_nodes(locks, request_line, nodes):
    head = (
        f"CEND\nSET 1 = 11,12, $ and on\n   21 THRU 22\n{request_line}\nSET 2 = ALL\nBEGIN BULK\n"
    )
    assert locks("", head) == (nodes, [])


def test_locked_elements_do_not_lock_their_nodes(locks):
    assert locks("TEMPP1,1,31,20.") == ([], [31])
