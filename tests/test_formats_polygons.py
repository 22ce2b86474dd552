"""OBJ, OFF and STL: faces that share no points are welded, and what else there is stays."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.edit import Edit, apply
from meshops.errors import InputError
from meshops.formats import read_deck, write_mesh
from meshops.formats.welding import weld
from meshops.mesh import NO_NODE
from meshops.topology import topology
from tests.decks import bad_plate
from tests.test_formats_splice import synthetic_edit

FAULTS = Path(__file__).parents[2] / "shared" / "faults" / "other"

OBJ = """\
# a plate
mtllib plate.mtl
o plate
v 0 0 0 1 0 0
v 1 0 0 1 0 0
v 2 0 0 0 0 1
v 0 1 0 1 0 0
vt 0 0
vt 1 1
vn 0 0 1
v 1.0 1 0 1 0 0
v 2 1 0 0 0 1
v 0 2 0 1 0 0
v 1 2 0 1 0 0
v 2 2 0 0 0 1
s off
usemtl steel
f 1/1/1 2/1/1 5/2/1 4/2/1
f -6//1 -5//1 -2//1 -3//1
g rib
usemtl copper
f 2/1/1 3/1/1 6/2/1 \\
  5/2/1
f 5 6 9 8   # the last
l 1 4 7
"""


def soup(mesh, digits=6):
    """Text of an OBJ file in which no face shares a point with another."""
    rows, faces, count = [], [], 0
    for element in mesh.elements.tolist():
        nodes = [node for node in element if node != NO_NODE]
        rows += [
            "v " + " ".join(f"{value:.{digits}f}" for value in mesh.points[node]) for node in nodes
        ]
        faces.append("f " + " ".join(str(count + k + 1) for k in range(len(nodes))))
        count += len(nodes)
    return "\n".join([*rows, *faces, ""])


def shapes(mesh, digits=5):
    return sorted(
        tuple(sorted(map(tuple, mesh.points[e[e != NO_NODE]].round(digits).tolist())))
        for e in mesh.elements
    )


# --- OBJ ----------------------------------------------------------------------------------------


@pytest.fixture
def obj(tmp_path):
    (tmp_path / "m.obj").write_text(OBJ)
    return tmp_path / "m.obj"


def test_groups_and_materials_are_regions_and_lines_lock(obj):
    deck = read_deck(obj)
    assert deck.mesh.region.tolist() == [1, 1, 2, 2]
    assert deck.mesh.node_ids[deck.mesh.locked_nodes].tolist() == [1, 4, 7]
    assert deck.notes == ()


def test_an_edited_obj_keeps_all_that_was_not_touched(obj, tmp_path):
    deck = read_deck(obj)
    mesh = deck.mesh
    a, b, c, d = mesh.elements[2]
    new = len(mesh.points)
    edit = Edit(
        removed=np.array([2]),
        added_points=np.array([[1.5, 0.5, 0.0]]),
        added_elements=np.array([[a, b, new, NO_NODE], [b, c, new, NO_NODE], [c, d, a, new]]),
        added_region=np.full(3, 2),
        moved=np.array([4]),
        moved_to=np.array([[1.125, 1.0, 0.0]]),
    )
    deck.write(apply(mesh, edit), tmp_path / "out.obj")
    assert (
        (tmp_path / "out.obj").read_text()
        == """\
# a plate
mtllib plate.mtl
o plate
v 0 0 0 1 0 0
v 1 0 0 1 0 0
v 2 0 0 0 0 1
v 0 1 0 1 0 0
v 1.125 1.0 0.0 0.875 0.0 0.125
v 2 1 0 0 0 1
v 0 2 0 1 0 0
v 1 2 0 1 0 0
v 2 2 0 0 0 1
v 1.5 0.5 0.0 0.5 0.0 0.5
vt 0 0
vt 1 1
vn 0 0 1
s off
usemtl steel
f 1/1/1 2/1/1 5/2/1 4/2/1
f 4//1 5//1 8//1 7//1
g rib
usemtl copper
f 5 6 9 8   # the last
f 2 3 10
f 3 6 10
f 6 5 2 10
l 1 4 7
"""
    )
    assert shapes(read_deck(tmp_path / "out.obj").mesh) == shapes(apply(mesh, edit))


def test_what_is_unchanged_is_written_byte_for_byte(obj, tmp_path):
    deck = read_deck(obj)
    deck.write(deck.mesh, tmp_path / "out.obj")
    assert (tmp_path / "out.obj").read_bytes() == obj.read_bytes()
    with pytest.raises(InputError, match="choose another name"):
        deck.write(deck.mesh, obj)


@pytest.mark.parametrize("digits", [3, 4, 6, 12])
def test_faces_that_share_no_points_are_welded_and_told(tmp_path, digits):
    plate = bad_plate()
    plate = type(plate).build(plate.points.round(digits), plate.elements)
    (tmp_path / "soup.obj").write_text(soup(plate, digits))
    deck = read_deck(tmp_path / "soup.obj")
    assert len(deck.mesh.points) == len(plate.points)
    corners = int((plate.elements != NO_NODE).sum())
    assert deck.notes == (
        f"Faces shared no points: {corners:,} points are welded to {len(plate.points):,}.",
    )
    assert shapes(deck.mesh, digits) == shapes(plate, digits)
    edited = apply(deck.mesh, synthetic_edit(deck.mesh))
    deck.write(edited, tmp_path / "out.obj")
    again = read_deck(tmp_path / "out.obj")
    assert again.notes == ()
    assert shapes(again.mesh) == shapes(edited)


@pytest.mark.skipif(not FAULTS.is_dir(), reason="no shared faults")
def test_the_unwelded_file():
    deck = read_deck(FAULTS / "f15_unwelded.obj")
    found = topology(deck.mesh)
    assert found.crossable.any()
    assert "are welded to" in deck.notes[0]
    used = len(np.unique(deck.mesh.elements[deck.mesh.elements != NO_NODE]))
    assert used == len(deck.mesh.points) < int((deck.mesh.elements != NO_NODE).sum()) / 3


@settings(max_examples=30, deadline=None)
@given(gap=st.floats(1e-3, 0.5), noise=st.floats(0, 1e-7), seed=st.integers(0, 99))
def test_real_gaps_stay_open(gap, noise, seed):
    """Two strips of loose quads, a gap apart, with noise in what should be the same point."""
    rng = np.random.default_rng(seed)
    squares = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
    places, corners = [], []
    for row in range(2):
        for column in range(4):
            corners.append(np.arange(4) + len(places) * 4)
            places.append(squares + np.array([column, row * (1 + gap)]))
    points = np.column_stack([np.concatenate(places), np.zeros(32)])
    points += rng.uniform(-noise, noise, points.shape)
    found = weld(points, np.array(corners), 0.0)
    assert found.after == 20
    for one, other in enumerate(found.point_of):
        assert np.linalg.norm(points[one] - points[other]) < 1e-6


def test_the_border_between_joined_faces_that_only_touch_is_locked(tmp_path):
    """Two strips of two quads that each share points: a crack, or parts in contact."""
    plate = "".join(f"v {x} {y} 0\n" for y in (0, 1) for x in (0, 1, 2))
    plate += "".join(f"v {x} {y} 0\n" for y in (1, 2) for x in (0, 1, 2))
    plate += "f 1 2 5 4\nf 2 3 6 5\nf 7 8 11 10\nf 8 9 12 11\n"
    (tmp_path / "m.obj").write_text(plate)
    deck = read_deck(tmp_path / "m.obj")
    assert len(deck.mesh.points) == 12
    assert deck.mesh.node_ids[deck.mesh.locked_nodes].tolist() == [4, 5, 6, 7, 8, 9]
    assert "6 points lie on others without being the same" in deck.notes[0]


# --- OFF ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "text",
    [
        "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1\n2\n3 0 2\n3\n",
        "OFF 4 2 0 0 0 0 1 0 0 1 1 0 0 1 0 3 0 1 2\n3 0 2 3",
        "OFF 4 2 0 0 0 0 1 0 0 1 1 0 0 1 0 3 0 1 2 3 0\n2 3",
        "OFF # a file\n# of\n\n4\n2 0\n0 0\n0 1 0 0 1 1 0\n0 1 0\n3 0 1 2 # red\n3\n0 2 3\n",
        "OFF\n4 2\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
        "COFF\n4 2 0\n0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n1 1 0 1 0 0 1\n0 1 0 1 0 0 1\n"
        "3 0 1 2 255 0 0\n3 0 2 3 0 0 255\n",
        "NOFF 4 2 0\n0 0 0 0 0 1 1 0 0\n0 0 1 1 1 0 0 0 1 0 1 0 0 0 1\n3 0 1 2\n3 0 2 3\n",
        "STCNOFF\r\n4 2 0\r\n"
        + "0 0 0 0 0 1 1 0 0 1 0 0\r\n1 0 0 0 0 1 1 0 0 1 0 0\r\n"
        + "1 1 0 0 0 1 1 0 0 1 0 0\r\n0 1 0 0 0 1 1 0 0 1 0 0\r\n3 0 1 2\r\n3 0 2 3\r\n",
    ],
)
def test_off_of_every_style(tmp_path, text):
    (tmp_path / "m.off").write_text(text)
    mesh = read_deck(tmp_path / "m.off").mesh
    assert mesh.points.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    assert mesh.elements[:, :3].tolist() == [[0, 1, 2], [0, 2, 3]]


def test_colours_of_points_and_faces_are_kept(tmp_path):
    rows = [f"{x} {y} 0 {x / 2} 0 {1 - x / 2} 1" for y in range(3) for x in range(3)]
    faces = ["4 0 1 4 3 255 0 0", "4 1 2 5 4 0 255 0", "4 3 4 7 6", "4 4 5 8 7 0 0 255"]
    (tmp_path / "m.off").write_text("\n".join(["COFF", "9 4 0", *rows, *faces, ""]))
    deck = read_deck(tmp_path / "m.off")
    a, b, c, d = deck.mesh.elements[1]
    edit = Edit(
        removed=np.array([1]),
        added_points=np.array([[1.5, 0.5, 0.0]]),
        added_elements=np.array([[a, b, 9, NO_NODE], [b, c, 9, NO_NODE], [c, d, a, 9]]),
        added_region=np.zeros(3),
    )
    deck.write(apply(deck.mesh, edit), tmp_path / "out.off")
    lines = (tmp_path / "out.off").read_text().splitlines()
    assert lines[:2] == ["COFF", "10 6 0"]
    assert lines[2:11] == rows
    assert lines[11] == "1.5 0.5 0.0 0.75 0.0 0.25 1.0"
    assert lines[12:] == [
        "4 0 1 4 3 255 0 0",
        "4 3 4 7 6",
        "4 4 5 8 7 0 0 255",
        "3 1 2 9 0 255 0",
        "3 2 5 9 0 255 0",
        "4 5 4 1 9 0 255 0",
    ]


# --- STL ----------------------------------------------------------------------------------------


def two_solids(tmp_path):
    write_mesh(bad_plate(seed=1), tmp_path / "one.stl")
    one = (tmp_path / "one.stl").read_text()
    plate = bad_plate(seed=1)
    beside = type(plate).build(plate.points + np.array([50.0, 0, 0]), plate.elements)
    write_mesh(beside, tmp_path / "two.stl")
    two = (tmp_path / "two.stl").read_text()
    named = [
        text.replace("endsolid", f"endsolid {name}").replace("solid\n", f"solid {name}\n", 1)
        for text, name in ((one, "left part"), (two, "right"))
    ]
    (tmp_path / "both.stl").write_text("".join(named))
    return tmp_path / "both.stl"


def test_solids_of_an_stl_file_are_regions_and_keep_their_names(tmp_path):
    deck = read_deck(two_solids(tmp_path))
    assert set(deck.mesh.region.tolist()) == {1, 2}
    assert len(deck.mesh.points) == 2 * 99 - 9
    edited = apply(deck.mesh, Edit(moved=np.array([20]), moved_to=deck.mesh.points[[20]] + 0.1))
    deck.write(edited, tmp_path / "out.stl")
    text = (tmp_path / "out.stl").read_text()
    assert [line for line in text.splitlines() if "solid" in line] == [
        "solid left part",
        "endsolid left part",
        "solid right",
        "endsolid right",
    ]
    assert shapes(read_deck(tmp_path / "out.stl").mesh) == shapes(edited)


def test_a_binary_stl_file_stays_one_with_its_head_and_attributes(tmp_path):
    plate = bad_plate(seed=2)
    trias = np.concatenate([plate.elements[:, :3], plate.elements[~plate.is_tria][:, [0, 2, 3]]])
    kind = np.dtype([("n", "<f4", 3), ("at", "<f4", (3, 3)), ("a", "<u2")])
    rows = np.zeros(len(trias), kind)
    rows["at"], rows["a"] = plate.points[trias], np.arange(len(trias)) % 3
    head = b"solid of colours".ljust(80)
    data = head + np.array(len(rows), "<u4").tobytes() + rows.tobytes()
    (tmp_path / "m.stl").write_bytes(data)
    deck = read_deck(tmp_path / "m.stl")
    assert len(deck.mesh.points) == len(plate.points)
    deck.write(deck.mesh, tmp_path / "same.stl")
    assert (tmp_path / "same.stl").read_bytes() == data
    edited = apply(deck.mesh, Edit(moved=np.array([50]), moved_to=deck.mesh.points[[50]] + 0.1))
    deck.write(edited, tmp_path / "out.stl")
    found = (tmp_path / "out.stl").read_bytes()
    assert found[:84] == data[:84]
    assert (np.frombuffer(found, kind, offset=84)["a"] == rows["a"]).all()
    assert shapes(read_deck(tmp_path / "out.stl").mesh) == shapes(edited)


def test_trias_without_a_height_are_left_out_and_told(tmp_path):
    write_mesh(bad_plate(), tmp_path / "m.stl")
    text = (tmp_path / "m.stl").read_text()
    line = "facet normal 0 0 0\n outer loop\n" + " vertex 5 5 0\n" * 2 + " vertex 0 0 0\n"
    (tmp_path / "m.stl").write_text(text.replace("endsolid", line + " endloop\nendfacet\nendsolid"))
    deck = read_deck(tmp_path / "m.stl")
    assert deck.notes[-1] == "1 trias without a height are left out."


@pytest.mark.parametrize("data", [b"", b" \n", b"\0" * 83, b"\0" * 84, b"solid\0\xff" * 20])
def test_an_empty_stl_file_is_one_sentence(tmp_path, data):
    (tmp_path / "m.stl").write_bytes(data)
    with pytest.raises(InputError, match=r"m\.stl") as caught:
        read_deck(tmp_path / "m.stl")
    assert "\n" not in str(caught.value)
