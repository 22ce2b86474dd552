"""Gmsh's files keep their version, groups, entities, other cells and values when shells change."""

from itertools import pairwise
from pathlib import Path

import meshio
import numpy as np
import pytest

from meshops.edit import Edit, apply
from meshops.errors import InputError
from meshops.formats import read_deck
from meshops.mesh import NO_NODE
from tests.test_formats_splice import synthetic_edit

FAULTS = Path(__file__).parents[2] / "shared" / "faults" / "other"
KINDS = [(2.2, 0), (2.2, 1), (4.0, 0), (4.1, 0), (4.1, 1)]

ASCII_22 = """\
$MeshFormat
2.2 0 8
$EndMeshFormat
$Comments
kept $ as it is
$EndComments
$PhysicalNames
3
1 5 "clamp"
2 11 "skin left"
2 22 "skin_right"
$EndPhysicalNames
$Nodes
12
1 0 0 0
2 1.0 0 0
3 2 0 0
4 3 0 0
5 0 1 0
6 1 1 0
7 2 1 0
8 3 1 0
9 0 2 0
10 1 2 0
11 2 2 0
40 3 2 0
$EndNodes
$Elements
10
1 15 2 7 1 1
2 1 2 5 4 1 5
3 1 2 5 4 5 9
4 3 2 11 1 1 2 6 5
5 3 2 11 1 5 6 10 9
6 3 2 11 2 2 3 7 6
7 3 2 11 2 6 7 11 10
8 2 2 22 3 3 4 8
9 2 2 22 3 3 8 7
20 3 2 22 3 7 8 40 11
$EndElements
$NodeData
1
"height"
1
0
3
0
1
12
1 0
2 1
3 2
4 3
5 10
6 11
7 12
8 13
9 20
10 21
11 22
40 23
$EndNodeData
$ElementData
1
"thickness"
1
0
3
0
1
10
1 9
2 9
3 9
4 .5
5 .5
6 .5
7 .5
8 2
9 2
20 2
$EndElementData
"""


def drawn(gmsh, path, version, binary):
    """Two plates with names, a hole, points and lines in groups, and one quad in two groups."""
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        for name, value in {
            "General.Terminal": 0,
            "Mesh.MshFileVersion": version,
            "Mesh.Binary": binary,
            "Mesh.RecombineAll": 1,
            "Mesh.MeshSizeMax": 1.0,
            "Mesh.SaveParametric": int(version == 4.1),
        }.items():
            gmsh.option.setNumber(name, value)
        occ = gmsh.model.occ
        left = occ.addRectangle(0, 0, 0, 5, 4)
        right = occ.addRectangle(5, 0, 0, 5, 4)
        occ.cut([(2, left)], [(2, occ.addDisk(2.5, 2, 0, 1, 1))])
        occ.fragment([(2, left)], [(2, right)])
        occ.synchronize()
        group = gmsh.model.addPhysicalGroup
        group(2, [left], 11, "skin left")
        group(2, [right], 22, "skin_right")
        group(2, [left, right], 33, "both")
        ends = [c for _, c in gmsh.model.getEntitiesInBoundingBox(-1, -1, -1, 0.1, 9, 1, 1)]
        group(1, ends, 5, "clamp")
        group(0, [p for _, p in gmsh.model.getEntities(0)][:1], 7, "corner")
        gmsh.model.mesh.generate(2)
        gmsh.write(str(path))
    finally:
        gmsh.finalize()


def groups(gmsh, path):
    """Names, places of all cells by group, and what gmsh complains of."""
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.logger.start()
        gmsh.open(str(path))
        found = {}
        for dimension, tag in gmsh.model.getPhysicalGroups():
            cells = []
            for entity in gmsh.model.getEntitiesForPhysicalGroup(dimension, tag):
                kinds, _, nodes = gmsh.model.mesh.getElements(dimension, entity)
                for kind, some in zip(kinds, nodes, strict=True):
                    count = gmsh.model.mesh.getElementProperties(kind)[3]
                    places = [tuple(gmsh.model.mesh.getNode(n)[0].round(9)) for n in some]
                    cells += [
                        tuple(sorted(places[i : i + count])) for i in range(0, len(places), count)
                    ]
            found[dimension, tag, gmsh.model.getPhysicalName(dimension, tag)] = sorted(cells)
        complaints = [line for line in gmsh.logger.get() if not line.startswith("Info")]
        gmsh.logger.stop()
        return found, complaints
    finally:
        gmsh.finalize()


def heights(text):
    """Places and the values of $NodeData by the tags of nodes, of an ASCII file of version 2.2."""
    lines = text.split("\n")
    at = lines.index("$Nodes")
    count = int(lines[at + 1])
    rows = [line.split() for line in lines[at + 2 : at + 2 + count]]
    places = {int(r[0]): np.array(r[1:], float) for r in rows}
    at = lines.index("$NodeData")
    values = dict(line.split() for line in lines[at + 9 : lines.index("$EndNodeData")])
    assert int(lines[at + 8]) == len(values) == count
    return places, {int(tag): float(value) for tag, value in values.items()}


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "part.msh"
    path.write_text(ASCII_22)
    return path


@pytest.mark.parametrize(("version", "binary"), KINDS)
def test_what_gmsh_writes_is_written_back_with_all_groups(tmp_path, version, binary):
    gmsh = pytest.importorskip("gmsh")
    source, out = tmp_path / "part.msh", tmp_path / "out.msh"
    drawn(gmsh, source, version, binary)
    deck = read_deck(source)
    assert len(set(deck.mesh.region.tolist())) == 2
    deck.write(deck.mesh, out)
    assert out.read_bytes() == source.read_bytes()
    edited = apply(deck.mesh, synthetic_edit(deck.mesh))
    deck.write(edited, out)
    assert out.read_bytes()[:40] == source.read_bytes()[:40]
    before, _ = groups(gmsh, source)
    after, complaints = groups(gmsh, out)
    assert complaints == []
    assert set(after) == set(before)
    for key, cells in before.items():
        if key[0] < 2:
            assert after[key] == cells
    cells = [c for key, found in after.items() if key[2].startswith("skin") for c in found]
    expected = [
        tuple(sorted(tuple(p) for p in edited.points[e[e != NO_NODE]].round(9).tolist()))
        for e in edited.elements
    ]
    # version 2.2 writes an element once for each group that it is in
    assert set(cells) == set(expected)
    assert set(after[2, 33, "both"]) == set(expected)
    again = read_deck(out)
    assert len(again.mesh.elements) == len(edited.elements)
    assert [lock.count for lock in again.locks] == [lock.count for lock in deck.locks]


def test_untouched_numbers_keep_their_text_and_tags(file, tmp_path):
    deck = read_deck(file)
    assert deck.mesh.region.tolist() == [11, 11, 11, 11, 22, 22, 22]
    assert deck.mesh.element_ids.tolist() == [4, 5, 6, 7, 8, 9, 20]
    assert deck.mesh.node_ids[-1] == 40
    locked = deck.mesh.node_ids[deck.mesh.locked_nodes].tolist()
    assert locked == [1, 5, 9]
    joined = Edit(
        removed=np.array([4, 5]),
        added_elements=np.array([[2, 3, 7, 6]]),
        added_region=np.array([22]),
        moved=np.array([5]),
        moved_to=np.array([[1.125, 1.0, 0.0]]),
    )
    deck.write(apply(deck.mesh, joined), tmp_path / "out.msh")
    text = (tmp_path / "out.msh").read_text()
    expected = ASCII_22.replace("\n6 1 1 0\n", "\n6 1.125 1.0 0.0\n")
    expected = expected.replace("$Elements\n10\n", "$Elements\n9\n")
    expected = expected.replace("8 2 2 22 3 3 4 8\n9 2 2 22 3 3 8 7\n", "")
    expected = expected.replace("8 40 11\n", "8 40 11\n21 3 2 22 3 3 4 8 7\n")
    assert text[: text.index("$NodeData")] == expected[: expected.index("$NodeData")]
    places, values = heights(text)
    assert values == pytest.approx({tag: p[0] + 10 * p[1] for tag, p in places.items()})
    assert "$ElementData" in text
    data = text[text.index('"thickness"') :].split("\n")
    assert data[6:10] == ["9", "1 9.0", "2 9.0", "3 9.0"]
    assert data[10:16] == ["4 0.5", "5 0.5", "6 0.5", "7 0.5", "20 2.0", "21 2.0"]


def test_new_nodes_have_values_and_a_place_of_their_own(file, tmp_path):
    deck = read_deck(file)
    edited = apply(deck.mesh, synthetic_edit(deck.mesh))
    deck.write(edited, tmp_path / "out.msh")
    places, values = heights((tmp_path / "out.msh").read_text())
    assert len(places) == len(edited.points)
    x, y, _ = edited.points[edited.node_ids == 0][0]
    assert values[41] == pytest.approx(x + 10 * y)


def test_binary_of_version_4_0(tmp_path):
    """Only meshio writes it."""
    source = tmp_path / "four.msh"
    x, y = np.meshgrid(np.arange(4.0), np.arange(3.0))
    points = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1)
    quads = [[0, 1, 5, 4], [4, 5, 9, 8], [1, 2, 6, 5], [5, 6, 10, 9], [6, 7, 11, 10]]
    cells = [("vertex", [[0]]), ("line", [[0, 4]]), ("quad", quads), ("triangle", [[2, 3, 7]])]
    found = meshio.Mesh(points, cells)
    meshio.gmsh.write(source, found, "4.0", binary=True)
    deck = read_deck(source)
    edited = apply(deck.mesh, synthetic_edit(deck.mesh))
    deck.write(edited, tmp_path / "out.msh")
    again = meshio.read(tmp_path / "out.msh")
    assert len(again.points) == len(found.points) + 1
    assert sum(len(c) for c in again.cells if c.type in ("quad", "triangle")) == len(
        edited.elements
    )
    assert {c.type for c in again.cells} == {"vertex", "line", "quad", "triangle"}


@pytest.mark.skipif(not FAULTS.is_dir(), reason="no shared faults")
def test_the_file_with_physical_groups(tmp_path):
    source = FAULTS / "f13_physical_groups.msh"
    deck = read_deck(source)
    deck.write(apply(deck.mesh, synthetic_edit(deck.mesh)), tmp_path / "out.msh")
    before, after = source.read_text(), (tmp_path / "out.msh").read_text()
    assert before[: before.index("$Nodes")] == after[: after.index("$Nodes")]
    lines = [line for line in before.splitlines() if line.split()[1:2] == ["1"]]
    assert lines
    assert set(lines) <= set(after.splitlines())
    found = meshio.read(tmp_path / "out.msh")
    assert set(found.field_data) == {"clamp", "skin left", "skin_right"}


def test_an_edge_under_a_line_stays(tmp_path):
    inner = ASCII_22.replace("$Elements\n10\n", "$Elements\n11\n").replace(
        "4 3 2 11 1 1", "30 1 2 5 4 6 7\n4 3 2 11 1 1"
    )
    (tmp_path / "m.msh").write_text(inner)
    deck = read_deck(tmp_path / "m.msh")
    assert deck.mesh.element_ids[deck.mesh.locked_elements].tolist() == [6]
    assert any("lines inside a region" in lock.sentence for lock in deck.locks)


def test_faces_of_solids_stay(tmp_path):
    solid = ASCII_22.replace("$Elements\n10\n", "$Elements\n11\n").replace(
        "4 3 2 11 1 1", "30 4 2 5 4 3 4 8 1\n4 3 2 11 1 1"
    )
    (tmp_path / "m.msh").write_text(solid)
    mesh = read_deck(tmp_path / "m.msh").mesh
    assert mesh.element_ids[mesh.locked_elements].tolist() == [8]


def test_periodic_nodes_are_locked(tmp_path):
    pairs = (
        "$Periodic\n1\n1 4 9\nAffine 1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1\n2\n2 10\n3 11\n$EndPeriodic\n"
    )
    (tmp_path / "m.msh").write_text(ASCII_22 + pairs)
    mesh = read_deck(tmp_path / "m.msh").mesh
    assert {2, 3, 10, 11} <= set(mesh.node_ids[mesh.locked_nodes].tolist())
    for old, new in pairwise(
        [pairs, pairs.replace("Affine" + " 1 0 0 1 0 1 0 0 0 0 1 0 0 0 0 1\n", "")]
    ):
        assert old != new
        (tmp_path / "m.msh").write_text(ASCII_22 + new)
        assert read_deck(tmp_path / "m.msh").mesh.locked_nodes.sum() == mesh.locked_nodes.sum()


def test_a_quad_that_names_a_node_twice_stays(tmp_path):
    text = ASCII_22.replace("20 3 2 22 3 7 8 40 11", "20 3 2 22 3 7 8 8 11")
    (tmp_path / "m.msh").write_text(text)
    deck = read_deck(tmp_path / "m.msh")
    assert 20 not in deck.mesh.element_ids
    assert deck.notes == ("1 cells name a node twice: they stay as they are.",)
    deck.write(apply(deck.mesh, synthetic_edit(deck.mesh)), tmp_path / "out.msh")
    assert "20 3 2 22 3 7 8 8 11" in (tmp_path / "out.msh").read_text()


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("2.2 0 8", "1.0 0 8", "save it in version 2.2, 4.0 or 4.1"),
        ("2 1.0 0 0", "2 x 0 0", "'x' is no number"),
        ("2 1.0 0 0", "1 1.0 0 0", "node 1 a second time"),
        ("$Nodes\n12", "$Nodes\n99999999999", "is cut short"),
        ("$Elements\n10", "$Elements\n99999999999", "is cut short"),
        ("6 10 9\n", "6 10 99\n", "names node 99, which is not defined"),
        ("$EndElements", "$EndElement", "does not end"),
        ("4 3 2 11", "4 34 2 11", "gmsh's type 34"),
        ("1 0 0 0", "1 nan 0 0", "not a finite number"),
    ],
)
def test_what_is_wrong_is_told(tmp_path, old, new, words):
    assert old in ASCII_22
    (tmp_path / "m.msh").write_text(ASCII_22.replace(old, new, 1))
    with pytest.raises(InputError, match=words):
        read_deck(tmp_path / "m.msh")
