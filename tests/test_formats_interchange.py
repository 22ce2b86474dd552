"""Interchange formats and whole new files."""

from pathlib import Path

import meshio
import numpy as np
import pytest

from meshops.examples import EXAMPLES
from meshops.formats import KNOWN, read_deck, write_mesh
from meshops.mesh import NO_NODE, ShellMesh

DATA = Path(__file__).parents[2] / "shared" / "data"


@pytest.fixture
def mesh():
    """Trias and quads in turn, two regions, coordinates that no short decimal holds."""
    points = [[i / 3 + j / 5, j / 7, (i - j) ** 2 / 11] for j in range(3) for i in range(4)]
    elements = [[0, 1, 5, 4], [1, 2, 6, NO_NODE], [1, 6, 5, NO_NODE], [2, 3, 7, 6], [4, 5, 9, 8]]
    elements += [[5, 6, 9, NO_NODE], [6, 10, 9, NO_NODE], [6, 7, 11, 10]]
    return ShellMesh.build(points, elements, region=[1, 1, 2, 2, 1, 1, 2, 2])


def by_place(mesh):
    """Region of each element, by its nodes' places."""
    return {
        tuple(map(tuple, mesh.points[e[e >= 0]].round(9))): int(r)
        for e, r in zip(mesh.elements, mesh.region, strict=True)
    }


@pytest.mark.parametrize("suffix", sorted(set(KNOWN) - {".stl"}))
def test_a_new_file_holds_the_mesh(mesh, tmp_path, suffix):
    path = tmp_path / f"mesh{suffix.upper()}"
    write_mesh(mesh, path)
    again = read_deck(path).mesh
    expected, found = by_place(mesh), by_place(again)
    assert set(found) == set(expected)
    if suffix not in (".obj", ".off"):
        regions = {(expected[place], found[place]) for place in expected}
        assert len(regions) == 2
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("suffix", [".obj", ".off", ".bdf"])
def test_elements_keep_their_order(mesh, tmp_path, suffix):
    write_mesh(mesh, tmp_path / f"mesh{suffix}")
    again = read_deck(tmp_path / f"mesh{suffix}").mesh
    assert (again.elements == mesh.elements).all()
    np.testing.assert_allclose(again.points, mesh.points, rtol=1e-12)


def test_an_stl_file_has_the_quads_split_and_the_same_area(mesh, tmp_path):
    write_mesh(mesh, tmp_path / "mesh.stl")
    again = read_deck(tmp_path / "mesh.stl").mesh
    assert again.is_tria.all()
    assert len(again.elements) == 4 * 2 + 4
    assert len(again.points) == len(mesh.points)
    p, e = mesh.points, mesh.elements[0]
    assert np.linalg.norm(p[e[0]] - p[e[2]]) > np.linalg.norm(p[e[1]] - p[e[3]])
    # so the first quad is split between its second and fourth node
    first = np.linalg.norm(again.points[again.elements[0, :3]][:, None] - p[e], axis=2).argmin(1)
    assert sorted(first) == [0, 1, 3]


def test_cell_data_stay_with_their_elements(mesh, tmp_path):
    centres = np.array([mesh.points[e[e >= 0]].mean(axis=0) for e in mesh.elements])
    write_mesh(mesh, tmp_path / "m.vtu", cell_data={"centre": centres, "x": centres[:, 0]})
    found = meshio.read(tmp_path / "m.vtu")
    for block, centre, x in zip(
        found.cells, found.cell_data["centre"], found.cell_data["x"], strict=True
    ):
        np.testing.assert_allclose(found.points[block.data].mean(axis=1), centre)
        np.testing.assert_allclose(centre[:, 0], x)


def test_ids_are_kept_and_new_ones_given(mesh, tmp_path):
    numbered = ShellMesh.build(
        mesh.points,
        mesh.elements,
        node_ids=[100, *range(1, 11), 0],
        element_ids=[50, 0, 0, 3, 4, 5, 6, 7],
    )
    for name in ("m.bdf", "m.inp"):
        write_mesh(numbered, tmp_path / name)
        again = read_deck(tmp_path / name).mesh
        assert again.node_ids.tolist() == [100, *range(1, 11), 101]
        assert sorted(again.element_ids.tolist()) == [3, 4, 5, 6, 7, 50, 51, 52]


@pytest.mark.parametrize("suffix", [".bdf", ".inp"])
def test_locks_are_kept_in_a_new_deck(tmp_path, suffix):
    plate = EXAMPLES["plate"]()
    path = tmp_path / f"plate{suffix}"
    write_mesh(plate, path)
    again = read_deck(path).mesh
    assert again.locked_nodes.tolist() == plate.locked_nodes.tolist()
    for mesh in (plate, again):
        assert mesh.locked_elements.sum() == 19
    assert set(again.element_ids[again.locked_elements]) == set(
        plate.element_ids[plate.locked_elements]
    )


def test_plane_points_and_other_cells(tmp_path):
    cells = [("line", [[0, 1]]), ("quad", [[0, 1, 2, 3]]), ("triangle", [[1, 4, 2]])]
    points = [[0, 0], [1, 0], [1, 1], [0, 1], [2, 0], [9, 9]]
    meshio.write(tmp_path / "m.vtu", meshio.Mesh(np.array(points, float), cells))
    mesh = read_deck(tmp_path / "m.vtu").mesh
    assert mesh.elements.tolist() == [[0, 1, 2, 3], [1, 4, 2, NO_NODE]]
    assert mesh.points.shape == (5, 3)


def test_obj_faces_of_every_style(tmp_path):
    text = "# x\nv 0 0 0 1\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nvt 0 0\ng part\nf 1/1/1 2//1 3\nv 0 1 0\n"
    (tmp_path / "m.obj").write_text(text + "f -4 -2 -1\n")
    mesh = read_deck(tmp_path / "m.obj").mesh
    assert mesh.elements[:, :3].tolist() == [[0, 1, 2], [0, 2, 3]]


def test_a_deck_written_to_another_format_is_a_new_file(mesh, tmp_path):
    write_mesh(mesh, tmp_path / "m.bdf")
    deck = read_deck(tmp_path / "m.bdf")
    deck.write(deck.mesh, tmp_path / "m.vtu")
    assert set(by_place(read_deck(tmp_path / "m.vtu").mesh)) == set(by_place(mesh))


@pytest.mark.skipif(not DATA.is_dir(), reason="no shared data")
def test_the_public_stl_is_closed():
    mesh = read_deck(DATA / "trimesh_plate_holes.STL").mesh
    assert len(mesh.elements) == 1252
    edges = np.sort(mesh.elements[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    # V - E + F = 2 - 2 g with genus 5
    assert len(mesh.points) - len(edges) // 2 + len(mesh.elements) == 2 - 2 * 5
