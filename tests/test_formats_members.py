"""New nodes of a Nastran deck have what all nodes around them share, in every card that says it."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from meshops.edit import Edit, apply
from meshops.formats import read_deck
from meshops.formats.nastran_cards import lex
from meshops.mesh import NO_NODE

FAULTS = Path(__file__).parents[2] / "shared" / "faults" / "nastran"
COLUMNS, ROWS = 4, 3


def number(i, j):
    return 10 * j + i + 11


NODES = [number(i, j) for j in range(ROWS + 1) for i in range(COLUMNS + 1)]
ALL = ",".join(map(str, NODES))
QUADS = {
    100 + 10 * j + i: [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)]
    for j in range(ROWS)
    for i in range(COLUMNS)
}


def grids(tail=""):
    return "".join(
        f"GRID,{number(i, j)},,{i}.,{j}.,0.{tail}\n"
        for j in range(ROWS + 1)
        for i in range(COLUMNS + 1)
    )


SHELLS = "".join(f"CQUAD4,{e},1,{','.join(map(str, nodes))}\n" for e, nodes in QUADS.items())


@pytest.fixture
def deck(tmp_path):
    def make(text, name="deck.bdf"):
        (tmp_path / name).write_text(text)
        return read_deck(tmp_path / name)

    return make


def with_new_node(mesh, element):
    """The mesh with an element split about a new node in its middle."""
    row = int(np.flatnonzero(mesh.element_ids == element)[0])
    a, b, c, d = mesh.elements[row]
    new = len(mesh.points)
    fan = [(p, q, new, NO_NODE) for p, q in ((a, b), (b, c), (c, d), (d, a))]
    edit = Edit(
        removed=np.array([row]),
        added_points=mesh.points[[a, b, c, d]].mean(axis=0)[None],
        added_elements=np.array(fan, np.int32),
        added_region=np.full(4, mesh.region[row], np.int32),
    )
    return apply(mesh, edit)


def without_node(mesh, node):
    """The mesh with the two elements right and left of an inner node's column made one."""
    i, j = (node - 11) % 10, (node - 11) // 10
    rows = {int(e): k for k, e in enumerate(mesh.element_ids)}
    at = {int(n): k for k, n in enumerate(mesh.node_ids)}
    four = [rows[100 + 10 * b + a] for b in (j - 1, j) for a in (i - 1, i)]
    ring = [(i - 1, j - 1), (i, j - 1), (i + 1, j - 1), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
    ring += [(i - 1, j + 1), (i - 1, j)]
    ring = [at[number(a, b)] for a, b in ring]
    quads = [[ring[7], ring[0], ring[1], ring[2]], [ring[7], ring[2], ring[3], ring[4]]]
    quads += [[ring[7], ring[4], ring[5], ring[6]]]
    edit = Edit(
        removed=np.array(four),
        added_elements=np.array(quads, np.int32),
        added_region=np.full(3, mesh.region[four[0]], np.int32),
    )
    return apply(mesh, edit)


def written(deck, mesh, tmp_path):
    deck.write(mesh, tmp_path / "out.bdf")
    return (tmp_path / "out.bdf").read_text()


def listed(text, name):
    """Nodes by the fields before them that cards of a list name, ranges written out."""
    found = {}
    for card in lex(text.splitlines(), 0):
        lead = 2 if card.name in ("SPC1", "USET1") else 1
        if card.name == name:
            words = [word for word in card.fields[lead:] if word]
            if "THRU" in words:
                words = range(int(words[0]), int(words[2]) + 1)
            found.setdefault(tuple(card.fields[:lead]), set()).update(map(int, words))
    return found


NEW = 124
"""The id of the first new node: one above the highest of nodes and shells."""


def new_grid(text):
    cards = [card for card in lex(text.splitlines(), 0) if card.name == "GRID"]
    return next(card for card in cards if card.fields[0] == str(NEW))


@pytest.mark.parametrize(
    ("tail", "fields"),
    [
        (",7", ["7", "", ""]),
        (",,345", ["", "345", ""]),
        (",,,2", ["", "", "2"]),
        (",7,6,2", ["7", "6", "2"]),
    ],
)
def test_fields_of_the_grid(deck, tmp_path, tail, fields):
    system = "CORD2C,7,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n"
    source = deck(system + grids(tail) + SHELLS)
    assert not source.mesh.locked_nodes.any()
    assert source.mesh.region.max() == 0
    text = written(source, with_new_node(source.mesh, 111), tmp_path)
    grid = new_grid(text)
    assert [grid.field(i) for i in (5, 6, 7)] == fields


def test_what_grdset_says_need_not_be_said_again_but_its_opposite_must(deck, tmp_path):
    head = "GRDSET,,,,,,,6\n"
    source = deck(head + grids() + SHELLS)
    text = written(source, with_new_node(source.mesh, 111), tmp_path)
    grid = new_grid(text)
    assert grid.field(6) == ""
    source = deck(head + grids(",,0") + SHELLS)
    text = written(source, with_new_node(source.mesh, 111), tmp_path)
    grid = new_grid(text)
    assert grid.field(6) == "0"


def test_new_nodes_are_in_the_system_of_those_around(deck, tmp_path):
    system = "CORD2C,7,,0.,0.,5.,0.,0.,6.\n,1.,0.,5.\n"
    source = deck(system + grids().replace(",,", ",7,") + SHELLS)
    mesh = with_new_node(source.mesh, 111)
    text = written(source, mesh, tmp_path)
    grid = new_grid(text)
    assert grid.field(1) == "7"
    again = read_deck(tmp_path / "out.bdf").mesh
    np.testing.assert_allclose(again.points[again.node_ids == NEW], mesh.points[-1:], atol=1e-8)


@pytest.mark.parametrize(
    ("cards", "expected"),
    [
        (f"SPC1,3,345,{ALL}\n", "SPC1,3,345,124"),
        ("SPC1         3     345      11    THRU      45\n", "SPC1           3     345     124"),
        ("".join(f"SPC,3,{n},26,0.,{n},5\n" for n in NODES), "SPC1,3,256,124"),
        ("".join(f"SPC,3,{n},6,.5\n" for n in NODES), "SPC,3,124,6,.5"),
        (f"SPC1,3,4,{ALL}\n" + f"SPC1,3,35,{ALL}\n", "SPC1,3,345,124"),
        ("".join(f"TEMP,8,{n},20.\n" for n in NODES), "TEMP,8,124,20."),
        (f"ASET1,12,{ALL}\n", "ASET1,12,124"),
        ("".join(f"ASET,{n},3\n" for n in NODES), "ASET1,3,124"),
        (f"QSET1,12,{ALL}\nOMIT1,3,{ALL}\n", "QSET1,12,124\nOMIT1,3,124"),
        (f"USET1,U6,12,{ALL}\n", "USET1,U6,12,124"),
        ("".join(f"TIC,5,{n},3,.1,2.\n" for n in NODES), "TIC,5,124,3,.1,2."),
        (f"SESET,2,{ALL}\n", "SESET,2,124"),
    ],
)
def test_a_further_card_of_the_same_kind(deck, tmp_path, cards, expected):
    source = deck(grids() + SHELLS + cards)
    assert not source.mesh.locked_nodes.any()
    assert not source.mesh.locked_elements.any()
    text = written(source, with_new_node(source.mesh, 111), tmp_path)
    assert text.startswith(grids() + f"GRID*{NEW:>19}")
    added = text[text.index(cards.splitlines()[0]) :]
    rest = added
    for line in expected.splitlines():
        assert line + "\n" in rest
        rest = rest.replace(line + "\n", "")
    assert rest == cards


def test_many_new_nodes_make_one_card(deck, tmp_path):
    source = deck(grids() + SHELLS + f"SPC1,3,345,{ALL}\n")
    mesh = source.mesh
    for element in (101, 111, 121):
        mesh = with_new_node(mesh, element)
    assert "SPC1,3,345,124,THRU,126\n" in written(source, mesh, tmp_path)


def test_a_range_that_holds_the_new_id_says_it_already(deck, tmp_path):
    cards = "SPC1,3,345,11,THRU,99999999\n"
    source = deck(grids() + SHELLS + cards)
    source.check_room()
    text = written(source, with_new_node(source.mesh, 111), tmp_path)
    assert text.endswith(cards)
    assert f"{NEW:19d}" in text


def test_a_node_that_goes_leaves_its_cards(deck, tmp_path):
    spc = "".join(f"SPC,3,{n},6,0.\n" for n in NODES)
    source = deck(grids() + SHELLS + f"ASET1,12,{ALL}\n" + spc)
    text = written(source, without_node(source.mesh, 22), tmp_path)
    assert listed(text, "ASET1") == {("12",): set(NODES) - {22}}
    assert "SPC,3,22," not in text
    assert text.count("SPC,3,") == len(NODES) - 1


def test_a_range_is_parted_where_a_node_goes(deck, tmp_path):
    # all ids of the range are nodes, so that it names none that is not there
    more = "".join(f"GRID,{n},,0.,0.,9.\n" for n in range(11, 46) if n not in NODES)
    source = deck(grids() + more + SHELLS + "SPC1,3,345,11,THRU,45\n")
    text = written(source, without_node(source.mesh, 22), tmp_path)
    assert listed(text, "SPC1") == {("3", "345"): set(range(11, 46)) - {22}}
    assert "SPC1,3,345,11,THRU,21\nSPC1,3,345,23,THRU,45\n" in text


def test_a_new_node_takes_over_the_id_of_one_that_went(deck, tmp_path):
    cards = f"SPC1,3,345,{ALL}\n"
    source = deck(grids() + SHELLS + cards)
    mesh = with_new_node(without_node(source.mesh, 22), 112)
    text = written(source, mesh, tmp_path)
    assert text.endswith(cards)
    assert "GRID,22,,2.5,1.5,0.\n" in text


def test_a_held_band_is_a_region_and_a_held_line_is_not(deck):
    band = [number(i, j) for i in (0, 1) for j in range(ROWS + 1)]
    line = [number(0, j) for j in range(ROWS + 1)]
    mesh = deck(grids() + SHELLS + f"SPC1,3,123,{','.join(map(str, band))}\n").mesh
    assert len(set(mesh.region[mesh.element_ids % 10 == 0])) == 1
    assert len(set(mesh.region.tolist())) == 2
    assert sorted(mesh.node_ids[mesh.locked_nodes]) == sorted(number(1, j) for j in range(ROWS + 1))
    mesh = deck(grids() + SHELLS + f"SPC1,3,123,{','.join(map(str, line))}\n").mesh
    assert mesh.region.max() == 0
    assert sorted(mesh.node_ids[mesh.locked_nodes]) == sorted(line)


@pytest.mark.parametrize(
    ("cards", "elements"),
    [
        ("RBE2,900,11,123456,12,22,21\n", [100]),
        ("RBE3,900,,99,123456,1.,123,11,12,+\n+,22,21\nGRID,99,,0.,0.,9.\n", [100]),
        ("".join(f"TEMP,8,{n},{n}.\n" for n in (11, 12, 22, 21)), [100]),
        ("".join(f"TEMP,8,{n},20.\n" for n in (11, 12, 22, 21)), []),
        ("RBE2,900,99,123456,11,12,13\nGRID,99,,0.,0.,9.\n", []),
    ],
)
def test_no_node_is_born_where_it_would_lack_something(deck, cards, elements):
    mesh = deck(grids() + SHELLS + cards).mesh
    assert mesh.element_ids[mesh.locked_elements].tolist() == elements


def test_supports_in_other_output_systems_are_not_the_same(deck):
    system = "CORD2C,7,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n"
    text = grids().replace("GRID,12,,1.,0.,0.", "GRID,12,,1.,0.,0.,7")
    source = deck(system + text + SHELLS + f"SPC1,3,1,{ALL}\n")
    shared = {frozenset(m.kind[0] for m in item) for item in source.parts[0].shared}
    assert shared == {frozenset(), frozenset({"SPC"})}


def test_sets_of_all_nodes_and_of_shells_grow(deck, tmp_path):
    head = (
        "CEND\nSET 1 = 11 THRU 45\nDISP = 1\nSUBCASE 1\nSET 7 = 100,101,110,111 $ corner\n"
        "STRESS = 7\nBEGIN BULK\n"
    )
    source = deck(head + grids() + SHELLS)
    assert not source.mesh.locked_nodes.any()
    assert len(set(source.mesh.region.tolist())) == 2
    text = written(source, with_new_node(source.mesh, 111), tmp_path)
    assert "SET 1 = 124,\n     11 THRU 45\n" in text
    assert "SET 7 = 124 THRU 127,\n     100,101,110,111 $ corner\n" in text


def test_locks_are_told_by_their_cards(deck):
    cards = "RBE2,900,11,123456,12,22,21\nFORCE,1,33,,1.,0.,0.,1.\nPLOAD1,1,121,FZ,LE,0.,1.,1.,1.\n"
    locks = deck(grids() + SHELLS + cards + "SPC1,3,123,15,25,35\n").locks
    assert [lock.sentence for lock in locks] == [
        "1 element: PLOAD1 (it stays as it is)",
        "1 element: RBE2 (it stays as it is)",
        "4 nodes: RBE2 (they neither move nor vanish)",
        "3 nodes: SPC (they neither move nor vanish)",
        "1 node: FORCE (it neither moves nor vanishes)",
    ]
    assert deck(grids(",7") + "CORD2C,7,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n" + SHELLS).locks == ()


@settings(
    max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    held=st.lists(st.sampled_from(NODES), unique=True, min_size=1),
    others=st.lists(st.sampled_from(NODES), unique=True),
    element=st.sampled_from(sorted(QUADS)),
    form=st.sampled_from(["SPC1,3,345,{}\n", "ASET1,345,{}\n"]),
)
def test_a_new_node_is_held_exactly_where_all_around_it_are(
    deck, tmp_path, held, others, element, form
):
    cards = form.format(",".join(map(str, held)))
    cards += f"SPC1,4,12,{','.join(map(str, others))}\n" if others else ""
    source = deck(grids() + SHELLS + cards)
    text = written(source, with_new_node(source.mesh, element), tmp_path)
    around = set(QUADS[element])
    name = form.partition(",")[0]
    for key, nodes in ((("3", "345"), held), (("4", "12"), others)):
        mine = listed(text, "SPC1" if key[0] == "4" else name)
        found = mine.get(key if name == "SPC1" or key[0] == "4" else key[1:], set())
        assert found == set(nodes) | ({NEW} if around <= set(nodes) else set())


@pytest.mark.skipif(not FAULTS.is_dir(), reason="no shared faults")
@pytest.mark.parametrize("name", ["new_nodes_without_ps6", "new_nodes_without_cd"])
def test_faults_of_grid_fields(tmp_path, name):
    source = read_deck(FAULTS / f"{name}.bdf")
    mesh = source.mesh
    a, b, c, _ = mesh.elements[0]
    new = len(mesh.points)
    fan = [(p, q, new, NO_NODE) for p, q in ((a, b), (b, c), (c, a))]
    edit = Edit(
        removed=np.array([0]),
        added_points=mesh.points[[a, b, c]].mean(axis=0)[None],
        added_elements=np.array(fan, np.int32),
        added_region=np.full(3, mesh.region[0], np.int32),
    )
    text = written(source, apply(mesh, edit), tmp_path)
    found = {
        (card.field(5), card.field(6))
        for card in lex(text.splitlines(), 6)
        if card.name == "GRID" and int(card.field(0)) > 40
    }
    assert found == {("9", "") if name.endswith("cd") else ("", "6")}


@pytest.mark.skipif(not FAULTS.is_dir(), reason="no shared faults")
def test_faults_of_supports_and_ranges(tmp_path):
    source = read_deck(FAULTS / "new_nodes_without_spc345.bdf")
    assert source.mesh.region.max() == 0
    assert [m.kind[:3] for m in sorted(source.parts[0].shared[0])] == [
        ("SPC", "1", digit) for digit in "345"
    ]
    source = read_deck(FAULTS / "no_ids_left_spc1_thru.bdf")
    source.check_room()
