"""Writing decks: what an edit does not touch stays byte for byte."""

import difflib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from meshops.edit import Edit, apply
from meshops.errors import InputError
from meshops.formats import read_deck
from meshops.mesh import NO_NODE

DATA = Path(__file__).parents[2] / "shared" / "data"
DECKS = sorted(DATA.glob("*.bdf"))

GRIDS = "".join(f"GRID,{10 * j + i},,{i}.,{j}.,0.\n" for j in range(1, 4) for i in range(1, 5))
SHELLS = """\
CQUAD4         1       7      11      12      22      21
CQUAD4         2       7      12      13      23      22
CQUAD4         3       7      13      14      24      23
CTRIA3         4       7      21      22      32
CTRIA3         5       7      21      32      31
$ the last
CQUAD4         6       7      22      23      33      32      30
"""


def shape(mesh):
    """Elements by id as the places of their nodes: what a mesh is, whatever its numbering."""
    return {
        int(i): tuple(map(tuple, mesh.points[e[e != NO_NODE]]))
        for i, e in zip(mesh.element_ids, mesh.elements, strict=True)
    }


def synthetic_edit(mesh):
    """Remove an element and its nodes, split a quad, rewire another to a tria, move a node."""
    free = np.flatnonzero(~mesh.locked_elements)
    quads = free[~mesh.is_tria[free]]
    gone, split, rewired = quads[0], quads[len(quads) // 2], quads[-1]
    centre = mesh.points[mesh.elements[split]].mean(axis=0)
    a, b, c, d = mesh.elements[split]
    new = len(mesh.points)
    fan = [[a, b, new, NO_NODE], [b, c, new, NO_NODE], [c, d, a, new]]
    to = [*mesh.elements[rewired][:3], NO_NODE]
    touched = {int(i) for e in (gone, split, rewired) for i in mesh.elements[e]}
    movable = [i for i in np.flatnonzero(~mesh.locked_nodes) if int(i) not in touched]
    moved = movable[len(movable) // 3] if movable else int(a)
    return Edit(
        removed=np.array([gone, split]),
        rewired=np.array([rewired]),
        rewired_to=np.array([to]),
        added_points=centre[None],
        added_elements=np.array(fan),
        added_region=np.full(3, mesh.region[split]),
        moved=np.array([moved]),
        moved_to=mesh.points[[moved]] * (1 + 1 / 3) + 1 / 7,
    )


def assert_same(written, mesh):
    """The ids of the deck and every node's place agree; new elements are compared by place."""
    kept = mesh.element_ids != 0
    found = shape(written)
    for i, places in zip(mesh.element_ids[kept], mesh.elements[kept], strict=True):
        np.testing.assert_allclose(found.pop(int(i)), mesh.points[places[places >= 0]], rtol=1e-9)
    new = mesh.elements[~kept]
    assert len(found) == len(new)
    for places, expected in zip(found.values(), new, strict=True):
        np.testing.assert_allclose(places, mesh.points[expected[expected >= 0]], rtol=1e-9)
    assert len(written.points) == len(np.unique(mesh.elements[mesh.elements >= 0]))


def changed_lines(before, after):
    diff = difflib.ndiff(before.splitlines(keepends=True), after.splitlines(keepends=True))
    rows = list(diff)
    return [r[2:] for r in rows if r[0] == "-"], [r[2:] for r in rows if r[0] == "+"]


@pytest.fixture
def deck(tmp_path):
    def make(text, name="deck.bdf"):
        path = tmp_path / name
        path.write_bytes(text.encode("latin-1"))
        return read_deck(path)

    return make


def written(deck, mesh, tmp_path, name="out.bdf"):
    out = tmp_path / name
    deck.write(mesh, out)
    return out.read_bytes().decode("latin-1")


@pytest.mark.parametrize("path", DECKS, ids=lambda path: path.stem)
def test_writing_what_was_read_gives_every_byte_back(path, tmp_path):
    deck = read_deck(path)
    deck.write(deck.mesh, tmp_path / "out.bdf")
    assert (tmp_path / "out.bdf").read_bytes() == path.read_bytes()


@pytest.mark.parametrize("path", DECKS, ids=lambda path: path.stem)
def test_public_decks_survive_an_edit(path, tmp_path):
    deck = read_deck(path)
    mesh = apply(deck.mesh, synthetic_edit(deck.mesh))
    deck.write(mesh, tmp_path / "out.bdf")
    again = read_deck(tmp_path / "out.bdf")
    assert_same(again.mesh, mesh)
    before = set(path.read_text("latin-1").splitlines())
    after = (tmp_path / "out.bdf").read_text("latin-1").splitlines()
    lost = before - set(after)
    shells = {"GRID", "CQUAD4", "CQUADR", "CTRIA3", "CTRIAR"}
    assert {line[:6].strip() for line in lost} <= {*shells, "PLOAD4"}
    assert len(lost) < 12
    # what was not moved is bit for bit where it was
    same = np.isin(again.mesh.node_ids, deck.mesh.node_ids)
    rows = np.searchsorted(np.sort(deck.mesh.node_ids), again.mesh.node_ids[same])
    old = deck.mesh.points[np.argsort(deck.mesh.node_ids)][rows]
    assert (old != again.mesh.points[same]).any(axis=1).sum() == 1


def test_only_the_lines_that_must_differ_differ(deck, tmp_path):
    source = deck("$ head\n" + GRIDS + "$ between\n" + SHELLS + "SPC1,1,123,11\nENDDATA\nrest\n")
    mesh = source.mesh
    edit = Edit(
        removed=np.array([3, 4]),
        rewired=np.array([0]),
        rewired_to=np.array([[0, 1, 5, NO_NODE]]),
        added_points=np.array([[0.25, 2.5, 0.1]]),
        added_elements=np.array([[4, 5, 9, 11]]),
        added_region=np.array([0]),
        moved=np.array([6]),
        moved_to=np.array([[3.125, 2.0, 0.0]]),
    )
    after = written(source, apply(mesh, edit), tmp_path)
    removed, added = changed_lines((tmp_path / "deck.bdf").read_text(), after)
    assert removed == [
        "GRID,23,,3.,2.,0.\n",
        "GRID,31,,1.,3.,0.\n",
        "CQUAD4         1       7      11      12      22      21\n",
        "CTRIA3         4       7      21      22      32\n",
        "CTRIA3         5       7      21      32      31\n",
    ]
    assert added == [
        "GRID,23,,3.125,2.,0.\n",
        "GRID*                 35                             .25             2.5\n",
        "*                     .1\n",
        "CTRIA3         1       7      11      12      22\n",
        "CQUAD4        35       7      21      22      32      35\n",
    ]
    assert after.index("$ the last") < after.index("CQUAD4        35") < after.index("SPC1")


def test_attributes_follow_the_region(deck, tmp_path):
    tail = ",,.1,+\n+,,1,.5,.5,.5,.5"
    source = deck(GRIDS + f"CQUADR,1,7,11,12,22,21{tail}\nCQUADR,2,7,12,13,23,22{tail}\n")
    edit = Edit(
        rewired=np.array([0]),
        rewired_to=np.array([[0, 1, 4, NO_NODE]]),
        added_elements=np.array([[0, 1, 5, NO_NODE], [1, 2, 3, 5]]),
        added_region=np.array([0, 0]),
    )
    text = written(source, apply(source.mesh, edit), tmp_path)
    assert "CTRIAR,1,7,11,12,22,,.1,,+\n+,,1,.5,.5,.5\n" in text
    again = read_deck(tmp_path / "out.bdf")
    assert again.mesh.region.tolist() == [0, 0, 0, 0]
    names = [line.split(",")[0] for line in text.splitlines() if line.startswith("C")]
    assert names == ["CTRIAR", "CQUADR", "CTRIAR", "CQUADR"]


def test_line_ends_and_a_missing_last_one_are_kept(deck, tmp_path):
    text = (GRIDS + SHELLS).replace("\n", "\r\n").rstrip()
    source = deck(text)
    after = written(source, apply(source.mesh, synthetic_edit(source.mesh)), tmp_path)
    assert after.count("\n") == after.count("\r\n") > 10
    assert "30\r\nC" in after


def test_a_form_gives_way_where_ids_do_not_fit(deck, tmp_path):
    grids = GRIDS.replace("GRID,34,", "GRID,99999998,").replace("GRID,33,", "GRID,8,")
    source = deck(grids + SHELLS.replace("33", " 8"))
    mesh = source.mesh
    edit = Edit(
        added_points=np.array([[0.3, 0.3, 0.3], [0.4, 0.4, 0.4]]),
        added_elements=np.array([[0, 1, 11, NO_NODE], [1, 2, 12, NO_NODE]]),
        added_region=np.array([0, 0]),
    )
    text = written(source, apply(mesh, edit), tmp_path)
    # 99,999,998 and one more leave no room for two: the lowest free ids are taken
    assert [line[8:24].split() for line in text.splitlines() if "GRID*" in line] == [["7"], ["9"]]


def test_new_ids_keep_out_of_ranges_of_other_cards(deck, tmp_path):
    source = deck(GRIDS + SHELLS + "SPC1,1,6,11,THRU,500\nPLOAD2,1,2.,3,THRU,700\n")
    mesh = source.mesh
    edit = Edit(
        added_points=np.array([[0.3, 0.3, 0.3]]),
        added_elements=np.array([[0, 1, len(mesh.points), NO_NODE]]),
        added_region=np.array([0]),
    )
    written(source, apply(mesh, edit), tmp_path)
    again = read_deck(tmp_path / "out.bdf").mesh
    # a range that holds all nodes may hold a new one; one that loads some shells must not
    assert again.node_ids.max() == 35
    assert again.element_ids.max() == 701


def test_new_nodes_are_written_in_the_system_of_grdset(deck, tmp_path):
    head = "GRDSET,,5\nCORD2C,5,,1.,2.,3.,1.,2.,4.\n,2.,2.,3.\n"
    source = deck(head + GRIDS + SHELLS)
    mesh = apply(source.mesh, synthetic_edit(source.mesh))
    written(source, mesh, tmp_path)
    assert_same(read_deck(tmp_path / "out.bdf").mesh, mesh)


@settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    point=st.lists(st.floats(-50, 50), min_size=3, max_size=3),
    system=st.sampled_from([0, 1, 2, 3, 4]),
    form=st.sampled_from(
        ["GRID,23,{},3.,20.,30.", "GRID          23{:8d}      3.     20.     30."]
    ),
)
def test_a_moved_node_comes_back_to_its_place_in_any_system(deck, tmp_path, point, system, form):
    systems = (
        "CORD2R,1,,1.,2.,3.,4.,4.,9.\n,7.,1.,3.\n"
        "CORD2C,2,1,1.,2.,3.,4.,4.,9.\n,7.,1.,3.\n"
        "CORD2S,3,2,1.,20.,3.,4.,40.,9.\n,7.,1.,3.\n"
        "CORD1C,4,11,14,34\n"
    )
    grids = GRIDS.replace("GRID,23,,3.,2.,0.", form.format(system))
    source = deck(systems + grids + SHELLS)
    row = int(np.flatnonzero(source.mesh.node_ids == 23)[0])
    mesh = apply(source.mesh, Edit(moved=np.array([row]), moved_to=np.array([point])))
    text = written(source, mesh, tmp_path)
    again = read_deck(tmp_path / "out.bdf").mesh
    np.testing.assert_allclose(again.points[row], point, rtol=1e-9, atol=1e-8)
    others = np.arange(len(mesh.points)) != row
    assert (again.points[others] == mesh.points[others]).all()
    assert f"23,{system}," in text or f"{system:16d}" in text or f"{system:8d}" in text


def test_included_files_go_along(tmp_path):
    home = tmp_path / "home"
    (home / "parts").mkdir(parents=True)
    (tmp_path / "lib").mkdir()
    (home / "parts" / "nodes.bdf").write_text(GRIDS)
    (home / "parts" / "loads.bdf").write_text("FORCE,1,11,,1.,0.,0.,1.\n")
    (tmp_path / "lib" / "shells.bdf").write_text(SHELLS)
    (tmp_path / "lib" / "props.bdf").write_text("PSHELL,7,1,.1\n")
    main = (
        "INCLUDE 'parts/nodes.bdf'\nINCLUDE 'parts/loads.bdf'\n"
        "INCLUDE '../lib/shells.bdf'\nINCLUDE '../lib/props.bdf'\n"
        f"INCLUDE '{tmp_path}/lib/props.bdf'\n"
    )
    (home / "deck.bdf").write_text(main)
    sources = {path: path.read_bytes() for path in tmp_path.rglob("*.bdf")}
    source = read_deck(home / "deck.bdf")
    mesh = apply(source.mesh, synthetic_edit(source.mesh))
    out = tmp_path / "far" / "out"
    source.write(mesh, out / "new.bdf")
    assert_same(read_deck(out / "new.bdf").mesh, mesh)
    lines = (out / "new.bdf").read_text().splitlines()
    assert lines[:2] == main.splitlines()[:2]
    # what lies elsewhere goes below the new deck where it changes or its path no longer leads to it
    assert lines[2:4] == ["INCLUDE 'lib/shells.bdf'", "INCLUDE 'lib/props.bdf'"]
    assert (out / "lib" / "props.bdf").read_bytes() == sources[tmp_path / "lib" / "props.bdf"]
    assert lines[4:] == main.splitlines()[4:]
    assert (out / "parts" / "loads.bdf").read_bytes() == sources[home / "parts" / "loads.bdf"]
    assert (out / "parts" / "nodes.bdf").read_text() != GRIDS
    assert all(path.read_bytes() == data for path, data in sources.items())


def test_beside_its_source_a_deck_takes_other_names_for_its_includes(tmp_path):
    (tmp_path / "nodes.bdf").write_text(GRIDS)
    (tmp_path / "deck.bdf").write_text("INCLUDE 'nodes.bdf'\n" + SHELLS)
    source = read_deck(tmp_path / "deck.bdf")
    mesh = apply(source.mesh, synthetic_edit(source.mesh))
    source.write(mesh, tmp_path / "new.bdf")
    assert_same(read_deck(tmp_path / "new.bdf").mesh, mesh)
    assert (tmp_path / "new_nodes.bdf").is_file()
    assert (tmp_path / "nodes.bdf").read_text() == GRIDS
    assert_same(read_deck(tmp_path / "deck.bdf").mesh, source.mesh)


def test_the_source_is_never_overwritten(tmp_path):
    (tmp_path / "nodes.bdf").write_text(GRIDS)
    (tmp_path / "deck.bdf").write_text("INCLUDE 'nodes.bdf'\n" + SHELLS)
    source = read_deck(tmp_path / "deck.bdf")
    for name in ("deck.bdf", "nodes.bdf"):
        with pytest.raises(InputError, match="choose another name"):
            source.write(source.mesh, tmp_path / name)


def test_no_temporary_files_are_left(deck, tmp_path):
    source = deck(GRIDS + SHELLS)
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="not a folder"):
        source.write(source.mesh, tmp_path / "file" / "out.bdf")
    source.write(source.mesh, tmp_path / "out.bdf")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["deck.bdf", "file", "out.bdf"]


def test_a_mesh_of_another_deck_is_refused(deck, tmp_path):
    source = deck(GRIDS + SHELLS)
    other = deck(GRIDS.replace("GRID,11", "GRID,99") + SHELLS.replace("11", "99"), "b.bdf")
    with pytest.raises(ValueError, match="does not descend"):
        source.write(other.mesh, tmp_path / "out.bdf")
