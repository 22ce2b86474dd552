"""The nearest point of a surface, and what a patch knows of its own."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops._core import bounding_spheres, nearest
from meshops.patch import components, extract
from meshops.surface import PatchSurface
from meshops.topology import topology
from tests.meshes import cylinder, distances_to_trias, folded, paraboloid, shaped, sheet, with_

bounded = settings(max_examples=100, deadline=None)


def find(queries, points, trias):
    return nearest(queries, points, trias, bounding_spheres(points, trias))


def random_surface(seed):
    """Trias anywhere, some of them slivers or without area."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(int(rng.integers(3, 40)), 3))
    if rng.random() < 0.5:
        points = np.round(points)  # many nodes at one place and on one line
    trias = rng.integers(0, len(points), (int(rng.integers(1, 60)), 3)).astype(np.int32)
    return points, trias, 2 * rng.normal(size=(int(rng.integers(1, 20)), 3))


@bounded
@given(st.integers(0, 10**6))
def test_nearest_is_what_trying_all_finds(seed):
    points, trias, queries = random_surface(seed)
    found, distance, tria = find(queries, points, trias)
    for query, at, reach, t in zip(queries, found, distance, tria, strict=True):
        all_distances = distances_to_trias(query, points[trias])
        assert reach == pytest.approx(all_distances.min(), abs=1e-9)
        assert np.linalg.norm(query - at) == pytest.approx(reach, abs=1e-12)
        assert all_distances[t] == pytest.approx(reach, abs=1e-9)
        assert distances_to_trias(at, points[trias[[t]]])[0] == pytest.approx(0, abs=1e-9)


@bounded
@given(st.integers(0, 10**6))
def test_nearest_is_what_vtk_finds(seed):
    core = pytest.importorskip("vtkmodules.vtkCommonCore")
    model = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    mesh = paraboloid(sheet(4, 4, seed=seed, jitter=0.2, trias=1.0))
    trias = np.ascontiguousarray(mesh.elements[:, :3])
    surface, nodes, cells = model.vtkPolyData(), core.vtkPoints(), model.vtkCellArray()
    nodes.SetDataTypeToDouble()
    for point in mesh.points:
        nodes.InsertNextPoint(point)
    for tria in trias:
        cells.InsertNextCell(3, tria.tolist())
    surface.SetPoints(nodes)
    surface.SetPolys(cells)
    locator = model.vtkStaticCellLocator()
    locator.SetDataSet(surface)
    locator.BuildLocator()
    queries = np.random.default_rng(seed).uniform(-1, 5, (10, 3))
    found, distance, _ = find(queries, mesh.points, trias)
    for query, at, reach in zip(queries, found, distance, strict=True):
        place, square = [0.0] * 3, core.mutable(0.0)
        locator.FindClosestPoint(query, place, core.mutable(0), core.mutable(0), square)
        assert reach**2 == pytest.approx(float(square), abs=1e-9)
        np.testing.assert_allclose(at, place, atol=1e-6)


@pytest.mark.parametrize("order", [(0, 1, 2), (0, 2, 1), (2, 0, 1), (1, 1, 2), (2, 2, 2)])
def test_a_tria_without_area_is_a_line_or_a_point(order):
    points = np.array([(0, 0, 0), (1, 0, 0), (3, 0, 0)], float)
    trias = np.array([order], np.int32)
    queries = np.array([(2, 1, 0), (-1, 0, 0), (9, 0, 2)], float)
    _, distance, _ = find(queries, points, trias)
    for query, reach in zip(queries, distance, strict=True):
        assert reach == pytest.approx(distances_to_trias(query, points[trias]).min())


def test_of_equally_near_trias_it_is_the_first():
    points = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)], float)
    trias = np.array([(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 1)], np.int32)
    order = np.array([2, 3, 0, 1])
    query = np.array([(-0.5, -0.5, 3), (0, 0, 1)], float)
    assert find(query, points, trias)[2][1] == 0
    assert find(query, points, trias[order])[2][1] == 0


def surface_of(mesh):
    found = topology(mesh)
    (rows,) = components(found, np.ones(len(mesh.elements), bool))
    patch = extract(found, rows)
    return patch, PatchSurface.of(patch.points, patch.elements)


def test_a_plane_patch_knows_its_normal_and_area():
    tilted = shaped(sheet(4, 3, seed=1, jitter=0.2, trias=0.3), lambda x, y: (x, y, x + 2 * y))
    patch, surface = surface_of(tilted)
    assert surface.plane == pytest.approx(np.array([-1, -2, 1]) / np.sqrt(6))
    assert surface.area == pytest.approx(12 * np.sqrt(6))
    trias = np.count_nonzero(patch.elements[:, 3] < 0)
    assert surface.mean_edge(patch) ** 2 * (len(patch.elements) - trias / 2) == pytest.approx(
        surface.area
    )


@pytest.mark.parametrize("bend", [cylinder, paraboloid])
def test_a_bent_patch_is_not_plane(bend):
    assert surface_of(bend(sheet(4, 3)))[1].plane is None


@pytest.mark.parametrize("bend", [lambda mesh: mesh, cylinder, paraboloid])
def test_nodes_are_brought_back_to_the_surface_and_the_border_is_not(bend):
    patch, surface = surface_of(bend(sheet(5, 5, seed=2, jitter=0.1)))
    lifted = patch.points + np.array([0.0, 0.0, 0.05])
    projected = lifted.copy()
    surface.project(projected, patch.border_nodes)
    assert np.array_equal(projected[: patch.border_nodes], lifted[: patch.border_nodes])
    trias = patch.points[surface.trias]
    for point in projected[patch.border_nodes :]:
        assert distances_to_trias(point, trias).min() < 1e-12


def test_elements_off_the_surface_have_no_normal_there():
    patch, surface = surface_of(cylinder(sheet(4, 4)))
    normals = surface.normals_at(patch.points, patch.elements, 0.05)
    assert normals == pytest.approx(np.linalg.norm(normals, axis=1)[:, None] * normals)
    outward = patch.points[patch.elements].mean(axis=1) * (1, 0, 1)
    assert (np.einsum("ij,ij->i", normals, outward) > 7.5).all()
    lifted = patch.points + np.array([0.0, 0.0, 0.2])
    assert surface.normals_at(lifted, patch.elements, 0.05) is None


@pytest.mark.parametrize("bend", [lambda mesh: mesh, cylinder])
def test_a_surface_with_a_hole_in_it_is_not_covered(bend):
    patch, surface = surface_of(bend(sheet(5, 5)))
    assert surface.is_covered(patch, patch.points, patch.elements, 0.1)
    middle = np.linalg.norm(
        patch.points[patch.elements].mean(axis=1) - patch.points.mean(axis=0), axis=1
    )
    around = np.argsort(middle)[:9]
    assert not surface.is_covered(patch, patch.points, np.delete(patch.elements, around, 0), 0.1)


def test_a_mesh_lapped_over_in_its_plane_is_not_covered_as_it_was():
    mesh = sheet(3, 3)
    patch, surface = surface_of(mesh)
    points = patch.points.copy()
    points[patch.border_nodes] += (1.5, 0, 0)
    assert not surface.is_covered(patch, points, patch.elements, 0.1)


def test_a_fold_is_a_border_of_surfaces():
    mesh = folded(sheet(4, 2), 2.0)
    found = topology(mesh)
    normals = [
        PatchSurface.of(patch.points, patch.elements).plane
        for rows in components(found, np.ones(len(mesh.elements), bool))
        for patch in [extract(found, rows)]
    ]
    assert np.array(normals) == pytest.approx(np.array([(0, 0, 1), (-1, 0, 0)]))


def test_a_sheet_far_from_the_origin_is_still_plane():
    mesh = sheet(4, 4, seed=3, jitter=0.2)
    far = with_(mesh, points=mesh.points + np.array([1e4, -2e4, 3e4]))
    assert surface_of(far)[1].plane == pytest.approx((0, 0, 1))
