"""Several parts in one Abaqus deck: each is a mesh of its own, and counts its own."""

import numpy as np
import pytest

from meshops.edit import Edit, apply
from meshops.formats import read_deck
from meshops.topology import topology
from tests.abaqus_reader import fanned, read_model, written
from tests.test_abaqus_nodes import ALL, ELEMENTS, NODES, listed

MESH = "*NODE\n" + "".join(NODES.values()) + "*ELEMENT, TYPE=S4R\n" + ELEMENTS
SETS = f"*NSET, NSET=ALL\n{listed(ALL)}*ELSET, ELSET=ALL, GENERATE\n1, 10\n"
SECTION = "*SHELL SECTION, ELSET=ALL, MATERIAL=STEEL\n1.\n"
DECK = f"""\
*PART, NAME="Part 1"
{MESH}{SETS}{SECTION}*END PART
*PART, NAME=two
{MESH}{SETS}{SECTION}*END PART
*ASSEMBLY, NAME=all
*INSTANCE, NAME=One, PART="Part 1"
*END INSTANCE
*INSTANCE, NAME=Two-1, PART=Two
0., 0., 50.
*END INSTANCE
*NSET, NSET=FIX, INSTANCE=One
11, 21, 31
*NSET, NSET=FIX, INSTANCE=TWO-1
16, 26
*ELSET, ELSET=_S_SPOS, INTERNAL, INSTANCE=Two-1
1, 2, 6, 7
*SURFACE, NAME=S
_S_SPOS, SPOS
*END ASSEMBLY
*STEP
*BOUNDARY
FIX, 1, 6
One.22, 3
*TEMPERATURE
Two-1.ALL, 20.
*DSLOAD
S, P, 1.
*END STEP
"""


@pytest.fixture
def deck(tmp_path):
    def make(text):
        (tmp_path / "deck.inp").write_text(text)
        return read_deck(tmp_path / "deck.inp")

    return make


def parts(text):
    """Models of the two parts."""
    bodies = [body.partition("*END PART")[0] for body in text.split("*PART, ")[1:]]
    return [read_model(body.partition("\n")[2]) for body in bodies]


def test_parts_share_no_node_and_no_region(deck):
    source = deck(DECK)
    mesh = source.mesh
    assert len(mesh.elements) == 20
    assert len(set(mesh.node_ids.tolist())) == 36
    assert not set(mesh.region[:10]) & set(mesh.region[10:])
    assert not set(mesh.elements[:10].ravel()) & set(mesh.elements[10:].ravel())
    assert topology(mesh).crossable.sum() == 13 + 11
    assert source.notes == (
        "Ids of PART TWO are counted from 1,000,000,000, since other parts have the same.",
    )
    locked = mesh.node_ids[mesh.locked_nodes].tolist()
    assert locked == [11, 21, 22, 31, 1_000_000_016, 1_000_000_026]


def test_each_part_is_written_in_its_own_ids(deck):
    source = deck(DECK)
    assert written(source, source.mesh, "same.inp") == DECK
    text = written(source, fanned(source.mesh, 2, 1_000_000_001, 1_000_000_010))
    first, second = parts(text)
    assert len(first.nodes) == 19
    assert len(second.nodes) == 20
    assert first.nsets["ALL"] == first.nodes.keys()
    assert second.nsets["ALL"] == second.nodes.keys()
    assert first.elsets["ALL"] == first.elements.keys()
    assert second.elsets["ALL"] == {*range(2, 10), *range(11, 19)}
    assert second.elements.keys() == second.elsets["ALL"]
    assert "INSTANCE=Two-1\n2, 6, 7\n11, 12, 13, 14\n*SURFACE" in text
    assert text.endswith(DECK[DECK.index("*SURFACE") :])


def test_what_leaves_one_part_stays_in_the_other(deck):
    source = deck(DECK)
    mesh = apply(source.mesh, Edit(removed=np.array([19])))
    first, second = parts(written(source, mesh))
    assert len(first.nodes) == 18
    assert second.nodes.keys() == {*ALL} - {36}


def test_parts_of_different_ids_keep_them(deck):
    head, tail = DECK.split("*PART, NAME=two")
    tria = "*NODE\n901,0,0\n902,1,0\n903,1,1\n*ELEMENT, TYPE=S3\n77,901,902,903\n"
    other = tail.replace(MESH, tria)
    mesh = deck(f"{head}*PART, NAME=two{other}").mesh
    assert mesh.element_ids.tolist() == [*range(1, 11), 77]
