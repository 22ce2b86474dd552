"""New elements of an Abaqus deck have what the elements of their region have."""

import numpy as np
import pytest

from meshops.edit import Edit, apply
from meshops.formats import read_deck
from meshops.formats.abaqus_types import pair
from meshops.mesh import NO_NODE
from tests.abaqus_reader import fanned, read_model, written
from tests.test_abaqus_nodes import ELEMENTS, NODES, PLAIN

EVERY = range(1, 11)


@pytest.fixture
def deck(tmp_path):
    def make(text):
        (tmp_path / "deck.inp").write_text(text)
        return read_deck(tmp_path / "deck.inp")

    return make


def force(text, of):
    """Sum of pressure times area, and its moment about the axes x and y."""
    model = read_model(text)
    found = np.zeros(3)
    for subject, _, value in model.rows[of]:
        for element in [int(subject)] if subject.isdigit() else model.elsets[subject.upper()]:
            x, y, _ = np.mean([model.nodes[n] for n in model.elements[element][1]], axis=0)
            found += float(value) * model.area(element) * np.array([1, x, y])
    return found


def test_even_pressures_by_number_are_written_for_new_elements(deck):
    rows = "".join(f"    {element}, P, {0.5 if element < 9 else 0.25}\n" for element in EVERY)
    source = deck(PLAIN + "*STEP\n  *DLOAD\n" + rows + "  *NODE FILE\nU\n*END STEP\n")
    assert source.mesh.region.tolist() == [0] * 8 + [1] * 2
    text = written(source, fanned(source.mesh, 2, 10))
    assert force(text, "DLOAD").tolist() == pytest.approx(force(PLAIN + "*DLOAD\n" + rows, "DLOAD"))
    assert "    8, P, 0.5\n    11, P, 0.5\n    12, P, 0.5\n" in text
    assert "    9, P, 0.25\n    15, P, 0.25\n" in text
    assert len(read_model(text).rows["DLOAD"]) == 16


def test_pressures_that_differ_are_a_field_and_keep_force_and_moment(deck):
    rows = "".join(f"{element}, P, {0.1 + 0.01 * element:.6g}\n" for element in EVERY)
    text = PLAIN + "*DLOAD\n" + rows
    source = deck(text)
    mesh = source.mesh
    assert mesh.region.tolist() == [0] * 10
    moved = apply(mesh, Edit(moved=np.array([7, 8]), moved_to=mesh.points[[7, 8]] + (0.2, 0.1, 0)))
    after = written(source, fanned(moved, 5, 7))
    np.testing.assert_allclose(force(after, "DLOAD"), force(text, "DLOAD"), rtol=1e-3)
    assert len(read_model(after).rows["DLOAD"]) == 16
    values = [float(row[2]) for row in read_model(after).rows["DLOAD"]]
    assert min(values) > 0.1
    assert max(values) < 0.21


def test_pressures_of_a_set_follow_it(deck):
    text = PLAIN + "*ELSET, ELSET=TOP\n6, 7, 8\n9, 10\n*DLOAD\nTOP, P, 2.\n"
    source = deck(text)
    assert source.mesh.region.tolist() == [0] * 5 + [1] * 5
    after = written(source, fanned(source.mesh, 1, 8))
    assert after.endswith("ELSET=TOP\n6, 7\n9, 10\n15, 16, 17, 18\n*DLOAD\nTOP, P, 2.\n")
    assert force(after, "DLOAD").tolist() == pytest.approx(force(text, "DLOAD"))


def test_two_lines_of_one_load_on_an_element_lock_it(deck):
    mesh = deck(PLAIN + "*DLOAD\n3, P, 1.\n3, P, 2.\n4, P, 1.\n*STEP\n*DLOAD\n4, P, 1.\n").mesh
    assert mesh.element_ids[mesh.locked_elements].tolist() == [3]


def test_a_surface_of_sides_gets_the_new_elements(deck):
    source = deck(PLAIN + "*SURFACE, NAME=S\n6, SPOS\n7, SPOS\n8, SNEG\n*DSLOAD\nS, P, 1.\n")
    assert source.mesh.region.tolist() == [0] * 5 + [1, 1, 2, 0, 0]
    text = written(source, fanned(source.mesh, 6))
    assert "7, SPOS\n11, SPOS\n12, SPOS\n13, SPOS\n14, SPOS\n8, SNEG\n*DSLOAD" in text


@pytest.mark.parametrize(
    ("rows", "elements", "nodes"),
    [
        ("*DFLUX\nEDGE, S4, 3.\n", [5, 10], [16, 26, 36]),
        ("*FILM\nEDGE, F4, 20., 0.1\n", [5, 10], [16, 26, 36]),
        ("*SURFACE, NAME=R\nOUTER, E2\n", [5, 10], [16, 26, 36]),
        ("*DLOAD\n5, EDNOR2, 1.\n", [5], [16, 26]),
        ("*DLOAD\n5, P4, 1.\n", [5], [16, 26]),
        ("*DSLOAD\nR, EDNOR, 1.\n", [], []),
        ("*DFLUX\nEDGE, S1, 3.\n", [], []),
        ("*DFLUX\nEDGE, SPOS, 3.\n", [], []),
    ],
)
def test_elements_keep_the_edges_that_are_named(deck, rows, elements, nodes):
    sets = "*ELSET, ELSET=EDGE\n5, 10\n*ELSET, ELSET=OUTER\nEDGE\n"
    mesh = deck(PLAIN + sets + rows).mesh
    assert mesh.element_ids[mesh.locked_elements].tolist() == elements
    assert mesh.node_ids[mesh.locked_nodes].tolist() == nodes


def test_a_face_of_a_plane_element_is_an_edge(deck):
    mesh = deck(PLAIN.replace("S4", "CPS4") + "*DLOAD\n5, P2, 1.\n6, BX, 2.\n").mesh
    assert mesh.element_ids[mesh.locked_elements].tolist() == [5]
    assert mesh.node_ids[mesh.locked_nodes].tolist() == [16, 26]


def test_distributions_by_element_lock_their_elements(deck):
    rows = "*DISTRIBUTION, LOCATION=ELEMENT, NAME=D, TABLE=T\n, 1.\n3, 2.\n4, 5.\n"
    mesh = deck(PLAIN + rows).mesh
    assert mesh.element_ids[mesh.locked_elements].tolist() == [3, 4]
    assert not mesh.locked_nodes.any()


def test_shells_on_the_same_nodes_and_repeated_nodes_stay(deck):
    source = deck(PLAIN + "*ELEMENT, TYPE=S4, ELSET=D\n11, 11, 12, 22, 21\n12, 16, 26, 26, 15\n")
    mesh = source.mesh
    assert mesh.element_ids[mesh.locked_elements].tolist() == [1, 11, 12]
    assert source.notes == (
        "On the same nodes as another shell, and left as they are: elements 1, 11.",
        "A quad that names a node twice is a tria, and left as it is: element 12.",
    )


@pytest.mark.parametrize(
    ("quad", "tria"),
    [
        *(("S4", "S3"), ("S4R", "S3"), ("CPS4R", "CPS3"), ("CPE4", "CPE3"), ("CAX4", "CAX3")),
        *(("M3D4R", "M3D3"), ("S4R5", "STRI3"), ("DS4", "DS3"), ("CPE4H", "CPE3H")),
    ],
)
def test_a_tria_has_the_type_that_belongs_to_the_quads(deck, quad, tria):
    source = deck(PLAIN.replace("TYPE=S4", f"TYPE={quad.lower()}"))
    text = written(source, fanned(source.mesh, 4))
    assert f"*ELEMENT, TYPE={tria}, ELSET=E\n11, " in text


def test_types_are_paired_as_the_deck_does():
    assert pair("S4R", {"S4R": 5, "S3R": 2}, {}) == ("S4R", "S3R")
    assert pair("S4R", {"S4R": 5}, {"S4R": 5, "S3R": 2}) == ("S4R", "S3R")
    assert pair("S3", {"S3": 2, "S4": 1, "S4R": 7}, {}) == ("S4R", "S3")
    assert pair("STRI3", {"S4": 3, "STRI3": 2}, {}) == ("S4", "STRI3")
    assert pair("CPS3", {"CPS3": 3}, {"CPS3": 3, "S4": 2}) == ("CPS4", "CPS3")


def test_plane_nodes_keep_two_coordinates(deck):
    plane = PLAIN.replace(", 0.\n", "\n").replace("S4", "CPE4")
    source = deck(plane)
    text = written(source, fanned(source.mesh, 1))
    assert "36, 6., 3.\n37, 1.5, 1.5\n" in text


def test_what_gmsh_writes_is_read(deck):
    text = (
        "*Heading\n /tmp/x.inp\n*NODE\n"
        + "".join(NODES.values())
        + "******* E L E M E N T S *************\n"
        + "*ELEMENT, type=T3D2, ELSET=Line1\n51, 11, 12\n52, 12, 13\n"
        + f"*ELEMENT, type=CPS4, ELSET=Surface1\n{ELEMENTS}"
        + "*ELEMENT, type=CPS3, ELSET=Surface1\n21, 31, 32, 99\n"
        + "*ELSET,ELSET=PLATE\n1,2,3,4,5,6,7,8,9,10,\n21,\n*NSET,NSET=PLATE\n"
        + ",".join(map(str, NODES))
        + ",\n99,\n"
    ).replace("*****", "99, 1.5, 4., 0.\n*****", 1)
    source = deck(text)
    mesh = source.mesh
    assert len(mesh.elements) == 11
    assert mesh.region.tolist() == [0] * 11
    assert mesh.node_ids[mesh.locked_nodes].tolist() == [11, 12, 13]
    model = read_model(written(source, fanned(mesh, 7)))
    assert model.elsets["PLATE"] == {*range(1, 11), 21} - {7} | {53, 54, 55, 56}
    assert 100 in model.nsets["PLATE"]


def test_a_quad_that_becomes_a_tria_keeps_its_number_and_its_sets(deck):
    source = deck(PLAIN + "*ELSET, ELSET=A, GENERATE\n1, 10\n*SURFACE, NAME=S\n3, SPOS\n")
    corners = [*source.mesh.elements[2][:3], NO_NODE]
    mesh = apply(source.mesh, Edit(rewired=np.array([2]), rewired_to=np.array([corners])))
    text = written(source, mesh)
    assert "*ELEMENT, TYPE=S3, ELSET=E\n3, 13, 14, 24\n*ELSET, ELSET=A, GENERATE\n1, 10\n" in text
