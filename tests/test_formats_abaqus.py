"""Reading and splicing Abaqus decks."""

import numpy as np
import pytest

from meshops.edit import Edit, apply
from meshops.formats import read_deck
from meshops.mesh import NO_NODE

HEAD = "*Heading\n plate, 11, 12\n** a comment\n"
NODES = "".join(f"{10 * j + i}, {i}., {j}.\n" for j in range(1, 4) for i in range(1, 5))
FLAT = f"""{HEAD}*Node, nset=all
{NODES}*Element, type=S4R, elset=plate
 101, 11, 12,
 22, 21
 102, 12, 13, 23, 22
*ELEMENT, ELSET = plate , TYPE=S3
103, 13, 14, 24
104, 13, 24, 23
** rest
*Shell Section, elset=plate, material=steel
0.1, 5
*Elset, elset=loaded, generate
101, 102, 1
*Elset, elset=listed
103, 104
*Material, name=steel
*Elastic
210000., 0.3
*Dsload
loaded, P, 1.
*Node Output, nset=all
U,
"""


@pytest.fixture
def deck(tmp_path):
    def make(text):
        (tmp_path / "deck.inp").write_bytes(text.encode("latin-1"))
        return read_deck(tmp_path / "deck.inp")

    return make


def rows(mesh, ids):
    return [int(np.flatnonzero(mesh.node_ids == i)[0]) for i in ids]


def test_reading(deck):
    mesh = deck(FLAT).mesh
    assert mesh.element_ids.tolist() == [101, 102, 103, 104]
    assert mesh.node_ids[mesh.elements[0]].tolist() == [11, 12, 22, 21]
    assert mesh.node_ids[mesh.elements[3, :3]].tolist() == [13, 24, 23]
    assert mesh.region.tolist() == [0, 0, 1, 1]
    assert not mesh.locked_nodes.any()
    assert not mesh.locked_elements.any()


def test_identity(deck, tmp_path):
    for text in (FLAT, FLAT.replace("\n", "\r\n"), FLAT.rstrip()):
        source = deck(text)
        source.write(source.mesh, tmp_path / "out.inp")
        assert (tmp_path / "out.inp").read_bytes() == text.encode()


def test_an_edit_changes_lines_and_lists(deck, tmp_path):
    source = deck(FLAT)
    mesh = source.mesh
    edit = Edit(
        removed=np.array([1, 3]),
        rewired=np.array([0, 2]),
        rewired_to=np.array([[*rows(mesh, (11, 12, 22)), NO_NODE], rows(mesh, (13, 14, 24, 23))]),
        added_points=np.array([[1.5, 1.75, 0.1]]),
        added_elements=np.array(
            [[*rows(mesh, (12, 13)), len(mesh.points), NO_NODE], rows(mesh, (12, 13, 24, 22))]
        ),
        added_region=np.array([0, 0]),
        moved=np.array(rows(mesh, (24,))),
        moved_to=np.array([[4.25, 2.0, 0.0]]),
    )
    after = apply(mesh, edit)
    source.write(after, tmp_path / "out.inp")
    text = (tmp_path / "out.inp").read_text()
    added = """\
*ELEMENT, TYPE=S3, ELSET=plate
101, 11, 12, 22
105, 12, 13, 21
*ELEMENT, TYPE=S4R, ELSET=plate
103, 13, 14, 24, 23
106, 12, 13, 24, 22
"""
    expected = (
        FLAT.replace("24, 4., 2.\n", "24, 4.25, 2.0\n")
        # the new node is in the sets of the one that goes
        .replace("21, 1., 2.\n", "21, 1.5, 1.75, 0.1\n")
        .replace(FLAT[FLAT.index("*Element") : FLAT.index("** rest")], added)
        .replace("101, 102, 1\n", "101, 101, 1\n105, 106, 1\n")
        .replace("*Elset, elset=listed\n103, 104\n", "*Elset, elset=listed\n103\n")
    )
    assert text == expected
    again = read_deck(tmp_path / "out.inp").mesh
    order = np.argsort(again.element_ids)
    places = [again.points[e[e >= 0]] for e in again.elements[order]]
    wanted = [after.points[e[e >= 0]] for e in after.elements[[0, 1, 2, 3]]]
    assert again.element_ids[order].tolist() == [101, 103, 105, 106]
    assert all((a == b).all() for a, b in zip(places, wanted, strict=True))
    # 101 and 105 stay with the load, 103 with its list
    assert (
        again.region[order].tolist()
        == [again.region[order][0], again.region[order][1]] + [again.region[order][0]] * 2
    )


@pytest.mark.parametrize(
    ("lines", "nodes", "elements"),
    [
        ("*NSET, NSET=a\n11, 12,\n13\n*BOUNDARY\na, 1", [11, 12, 13], []),
        ("*Nset, nset=a, Generate\n11, 13, 2\n*Boundary\nA, 1", [11, 13], []),
        ("*BOUNDARY\n12, 1, 6", [12], []),
        ("*CLOAD\n13, 2, 22.", [13], []),
        ("*ELEMENT, TYPE=B31\n103, 11, 12", [11, 12], []),
        (
            "*ELEMENT, TYPE=S8R\n901, 11, 12, 22, 21, 902,\n903, 23, 24",
            [11, 12, 21, 22, 23, 24],
            [],
        ),
        ("*RIGID BODY, REF NODE=14, ELSET=none", [14], []),
        ("*DLOAD\n102, P, 1.", [], []),
        ("*DLOAD\n102, EDNOR2, 1.", [13, 23], [102]),
        ("*DLOAD\n104, EDNOR3, 1.", [13, 23], [104]),
        ("*DFLUX\n102, S4, 1.", [13, 23], [102]),
        ("*SURFACE, NAME=s\n102, SPOS", [], []),
        ("*SURFACE, NAME=s\n102, S5", [22, 23], [102]),
        ("*SURFACE, NAME=s\n102, EDGE", [12, 13, 22, 23], [102]),
        ("*SURFACE, NAME=s, TYPE=NODE\n12,", [12], []),
        ("*SURFACE, NAME=s\nloaded, E1", [11, 12, 13], [101, 102]),
        ("*SURFACE, NAME=s\nloaded, SPOS", [], []),
        ("*NOVELTY\n12, 103", [12], [103]),
        ("*MPC\nBEAM, 11, 12", [11, 12], []),
        ("*EQUATION\n2\n11, 1, 1., 12, 1, -1.", [11, 12], []),
        ("*PLASTIC\n11., 12.", [], []),
    ],
)
def test_what_is_named_by_number_is_locked(deck, lines, nodes, elements):
    text = FLAT.replace("*Material", f"{lines}\n*Material")
    mesh = deck(text.replace("*ELEMENT, TYPE=B31\n103", "*ELEMENT, TYPE=B31\n903")).mesh
    assert mesh.node_ids[mesh.locked_nodes].tolist() == nodes
    assert mesh.element_ids[mesh.locked_elements].tolist() == elements


def test_one_part_with_instances(deck, tmp_path):
    part = FLAT[len(HEAD) : FLAT.index("*Material")]
    text = (
        f"*PART, NAME=shell\n{part}*END PART\n*PART, NAME=block\n*NODE\n11, 5., 5., 5.\n*END PART\n"
        "*ASSEMBLY, NAME=all\n*INSTANCE, NAME=one, PART=shell\n1., 0., 0.\n*END INSTANCE\n"
        "*INSTANCE, NAME=two, PART=block\n*END INSTANCE\n"
        "*NSET, NSET=a, INSTANCE=one\n12\n*NSET, NSET=a, INSTANCE=two\n13\n"
        "*ELSET, ELSET=e, INSTANCE=one\n101, 102, 103, 104\n*END ASSEMBLY\n"
        '*BOUNDARY\none.14, 1\na, 1\n"one.24", 1\ntwo.11, 1\n'
    )
    source = deck(text)
    mesh = source.mesh
    assert mesh.node_ids[mesh.locked_nodes].tolist() == [12, 14, 24]
    assert (mesh.points[0] == [1, 1, 0]).all()
    source.write(apply(mesh, Edit(removed=np.array([3]))), tmp_path / "out.inp")
    assert "101, 102, 103\n*END ASSEMBLY" in (tmp_path / "out.inp").read_text()


def test_cylindrical_nodes_and_input_files(tmp_path, deck):
    (tmp_path / "nodes.txt").write_text(
        "1, 2., 0., 0.\n2, 2., 90., 0.\n3, 1., 90., 0.\n4, 1., 0., 0.\n"
    )
    source = deck("*NODE, SYSTEM=C, INPUT=nodes.txt\n*ELEMENT, TYPE=S4\n1, 1, 2, 3, 4\n")
    mesh = source.mesh
    np.testing.assert_allclose(mesh.points[1], [0, 2, 0], atol=1e-15)
    moved = apply(mesh, Edit(moved=np.array([2]), moved_to=np.array([[0.3, 1.1, 0.2]])))
    source.write(moved, tmp_path / "out" / "new.inp")
    again = read_deck(tmp_path / "out" / "new.inp").mesh
    np.testing.assert_allclose(again.points, moved.points, rtol=1e-12, atol=1e-15)
    assert len((tmp_path / "out" / "nodes.txt").read_text().splitlines()) == 4
    source.write(moved, tmp_path / "beside.inp")
    assert "*NODE, SYSTEM=C, INPUT=beside_nodes.txt" in (tmp_path / "beside.inp").read_text()


def test_nodes_of_a_used_set_are_locked_where_new_ones_would_not_join(deck):
    nodes = NODES.splitlines(keepends=True)
    two = FLAT.replace(NODES, "".join(nodes[:4]) + "*NODE, NSET=rest\n" + "".join(nodes[4:]))
    assert not deck(two.replace("*Node Output, nset=all\nU,\n", "")).mesh.locked_nodes.any()
    mesh = deck(two + "*BOUNDARY\nALL, 1\n").mesh
    assert mesh.node_ids[mesh.locked_nodes].tolist() == [11, 12, 13, 14]
