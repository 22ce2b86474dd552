"""Meshing from geometry: raw trias in, closed and even quads out."""

import builtins
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from meshops.criteria import STANDARD
from meshops.curves import Curve, curves_of, even_divisions
from meshops.errors import InputError
from meshops.geometry import mesh_geometry, mesh_surface
from meshops.mesh import ShellMesh
from meshops.quality import failed_elements
from meshops.topology import topology
from tests.meshes import area_vectors, doubles, shaped, sheet, tidy, torus, unsound

DATA = Path(__file__).parents[2] / "shared" / "data"


def raw(points, trias):
    return ShellMesh.build(points, np.column_stack([trias, np.full(len(trias), -1)]))


def box(x, y, z):
    """Two trias a side."""
    points = np.array(list(product((0, x), (0, y), (0, z))), float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return raw(points, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])


def tube(radius, height, sides):
    """A cylinder with both lids, in slivers as long as it is."""
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle], axis=1)
    points = np.concatenate([ring, ring + np.array([0, 0, height]), [(0, 0, 0), (0, 0, height)]])
    trias = []
    for i in range(sides):
        j = (i + 1) % sides
        trias += [(i, j, sides + j), (i, sides + j, sides + i)]
        trias += [(j, i, 2 * sides), (sides + i, sides + j, 2 * sides + 1)]
    return raw(points, trias)


def area(mesh):
    return np.linalg.norm(area_vectors(mesh), axis=1).sum()


def volume(mesh):
    """Of a closed mesh, by the divergence theorem on trias."""
    quads = mesh.elements[~mesh.is_tria]
    trias = np.concatenate([mesh.elements[mesh.is_tria, :3], quads[:, :3], quads[:, [0, 2, 3]]])
    a, b, c = mesh.points[trias].transpose(1, 0, 2)
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def assert_closed(mesh):
    assert (topology(mesh).uses == 2).all()
    assert unsound(mesh) == []
    assert doubles(mesh) == []
    assert np.array_equal(np.unique(mesh.elements[mesh.elements >= 0]), np.arange(len(mesh.points)))


def test_a_box_becomes_squares():
    mesh = mesh_surface(box(4, 3, 2), 0.5)
    assert_closed(mesh)
    assert not mesh.is_tria.any()
    assert len(mesh.elements) == 4 * 2 * (12 + 8 + 6)
    assert volume(mesh) == pytest.approx(24)
    assert (mesh.region == 1).all()


@pytest.mark.parametrize("sizes", [(4.1, 3.3, 2.7), (5, 1, 1.4), (2.2, 7.9, 0.4)])
@pytest.mark.parametrize("size", [0.5, 0.37, 1.1])
def test_no_side_of_a_box_is_forced_to_have_a_tria(sizes, size):
    surface = box(*sizes)
    mesh = mesh_surface(surface, size)
    assert_closed(mesh)
    assert mesh.is_tria.sum() == 0
    assert volume(mesh) == pytest.approx(np.prod(sizes))
    corners = {tuple(point) for point in surface.points}
    assert corners <= {tuple(point) for point in mesh.points}


def test_long_slivers_become_even_quads():
    surface = tube(2.0, 10.0, 48)
    mesh = mesh_surface(surface, 0.6)
    assert_closed(mesh)
    assert area(mesh) == pytest.approx(area(surface), rel=0.02)
    assert volume(mesh) == pytest.approx(volume(surface), rel=0.03)
    assert mesh.is_tria.mean() < 0.03
    assert failed_elements(mesh, STANDARD.at(0.6)).mean() < 0.15


def test_a_surface_without_any_edge_to_begin_at_is_meshed():
    surface = torus(36, 60)
    mesh = mesh_surface(surface, 0.5)
    assert (topology(mesh).uses == 2).all()
    assert area(mesh) == pytest.approx(area(surface), rel=0.03)


def test_what_is_smaller_than_the_size_is_kept():
    # two lids that nearly touch: at this size their outlines are much longer than their distance
    surface = tube(2.0, 0.05, 32)
    mesh = mesh_surface(surface, 1.5)
    assert_closed(mesh)
    assert area(mesh) == pytest.approx(area(surface), rel=0.2)


def test_a_lens_between_two_curves_has_corners_enough():
    x = np.linspace(-1, 1, 9)
    lens = np.concatenate(
        [np.stack([x, 0.3 * (1 - x * x) * side, 0 * x], axis=1) for side in (-1, 1)]
    )
    inner = [(i, i + 1, 10 + i) for i in range(8)] + [(i, 10 + i, 9 + i) for i in range(1, 8)]
    mesh = mesh_surface(tidy(raw(lens, [t for t in inner if t[2] != 17])), 5.0)
    assert area(mesh) > 0.3
    assert unsound(mesh) == []


def test_an_open_sheet_with_quads_is_meshed():
    surface = shaped(sheet(8, 8, trias=0.4), lambda x, y: (x, y, 0.02 * x * x))
    mesh = mesh_surface(surface, 0.7)
    assert unsound(mesh) == []
    assert area(mesh) == pytest.approx(area(surface), rel=0.01)


def test_the_same_surface_gives_the_same_mesh():
    assert mesh_surface(tube(2, 3, 16), 0.5).digest == mesh_surface(tube(2, 3, 16), 0.5).digest


@pytest.mark.parametrize("size", [0.0, -1.0, float("nan"), float("inf")])
def test_sizes_that_make_no_mesh_are_refused(size):
    with pytest.raises(InputError, match="element size"):
        mesh_surface(box(1, 1, 1), size)


def test_an_empty_surface_is_refused():
    with pytest.raises(InputError, match="no element"):
        mesh_surface(ShellMesh.build(np.zeros((0, 3)), np.zeros((0, 4))), 1.0)


@pytest.mark.skipif(not DATA.is_dir(), reason="no shared data")
def test_a_drilled_plate_comes_out_closed_and_with_few_trias():
    mesh = mesh_geometry(DATA / "trimesh_plate_holes.STL")
    assert (topology(mesh).uses == 2).all()
    assert mesh.is_tria.mean() <= 0.01
    assert failed_elements(mesh, STANDARD.at(305 / 40)).mean() <= 0.06


# --- curves -------------------------------------------------------------------------------------


def test_a_circle_is_one_closed_curve_and_a_square_four():
    angle = np.linspace(0, 2 * np.pi, 25)[:-1]
    circle = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    ring = np.stack([np.arange(24), np.roll(np.arange(24), -1)], axis=1)
    (curve,) = curves_of(circle, ring, np.ones(24, bool))
    assert curve.is_closed
    assert len(curve.nodes) == 25
    square = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float)
    assert len(curves_of(square, ring[:4] % 4, np.ones(4, bool))) == 4


def test_a_curve_is_divided_evenly_between_its_ends():
    curve = Curve((0, 1, 2), np.array([(0, 0, 0), (3, 0, 0), (4, 0, 0)], float))
    assert curve.divisions(0.5) == 8
    assert curve.divisions(100.0) == 1
    np.testing.assert_allclose(curve.divided(8)[:, 0], np.linspace(0, 4, 9))


def test_odd_zones_are_made_even_across_the_longest_curves():
    # two zones side by side with 7 edges each; the outside has no parity
    counts = even_divisions([3, 4, 4], [(0, 1), (0,), (1,)])
    assert counts == [3, 5, 5] or counts == [4, 4, 4]
    assert (counts[0] + counts[1]) % 2 == (counts[0] + counts[2]) % 2 == 0


# --- CAD ----------------------------------------------------------------------------------------


def test_without_gmsh_the_user_is_told_how_to_install_it(tmp_path, monkeypatch):
    def without_gmsh(name, *args, **kwargs):
        if name == "gmsh":
            raise ImportError(name)
        return imported(name, *args, **kwargs)

    imported = builtins.__import__
    monkeypatch.setattr(builtins, "__import__", without_gmsh)
    path = tmp_path / "part.step"
    path.write_text("")
    with pytest.raises(InputError, match="pip install"):
        mesh_geometry(path, 1.0)


def test_a_cad_file_that_is_not_there_is_told(tmp_path):
    with pytest.raises(InputError, match=r"part\.step is not there"):
        mesh_geometry(tmp_path / "part.step", 1.0)


def test_a_cad_file_that_is_none_is_told_and_gmsh_is_closed(tmp_path):
    gmsh = pytest.importorskip("gmsh")
    path = tmp_path / "part.step"
    path.write_text("nothing of the kind")
    with pytest.raises(InputError, match=r"part\.step"):
        mesh_geometry(path, 1.0)
    assert not gmsh.isInitialized()


@pytest.mark.skipif(not DATA.is_dir(), reason="no shared data")
def test_each_face_of_half_a_tube_is_rows_of_quads(tmp_path):
    """Its arcs are 5 and 3.1 edges long: divided each for itself, the rims would need trias."""
    gmsh = pytest.importorskip("gmsh")
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        occ = gmsh.model.occ
        outer, inner = (occ.addCylinder(0, 0, 0, 0, 0, 2, r, angle=np.pi) for r in (1.6, 1.0))
        occ.cut([(3, outer)], [(3, inner)])
        occ.synchronize()
        gmsh.write(str(tmp_path / "tube.step"))
    finally:
        gmsh.finalize()
    mesh = mesh_geometry(tmp_path / "tube.step", 1.0)
    assert not mesh.is_tria.any()
    arcs, along = 6, 2
    assert len(mesh.elements) == 2 * arcs * along + 2 * arcs + 2 * along


def test_a_solid_of_a_cad_file_comes_out_closed():
    pytest.importorskip("gmsh")
    mesh = mesh_geometry(DATA / "trimesh_featuretype.STEP")
    assert (topology(mesh).uses == 2).all()
    assert unsound(mesh) == []
    assert mesh.is_tria.mean() < 0.1
