"""Shapes and limits of elements, against VTK, against known ones and against the definitions."""

from dataclasses import replace
from math import acos, asin, degrees, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from meshops.criteria import PAPER, STANDARD
from meshops.harm.limits import failures
from meshops.harm.shapes import Shapes
from meshops.mesh import ShellMesh
from meshops.quality import element_values, failed_elements

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
TRIA = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, sqrt(3) / 2, 0]])
NAMES = [
    "least_angle",
    "greatest_angle",
    "scaled_jacobian",
    "skew",
    "taper",
    "warpage",
    "jacobian",
    "shortest",
    "longest",
    "height",
    "area",
]


def soup(corners, count=300, seed=1, bend=0.3):
    """Separate elements around a regular one, as one mesh."""
    rng = np.random.default_rng(seed)
    points = corners + rng.uniform(-bend, bend, (count, *corners.shape))
    size = len(corners)
    elements = np.full((count, 4), -1)
    elements[:, :size] = np.arange(count * size).reshape(count, size)
    return ShellMesh.build(points.reshape(-1, 3), elements)


def alone(*corners):
    elements = np.full((1, 4), -1)
    elements[0, : len(corners)] = np.arange(len(corners))
    return ShellMesh.build(np.array(corners, float), elements)


def vtk_cells(mesh):
    model = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    for element in mesh.elements:
        nodes = element[element >= 0]
        cell = model.vtkQuad() if len(nodes) == 4 else model.vtkTriangle()
        for i, node in enumerate(nodes):
            cell.GetPoints().SetPoint(i, mesh.points[node])
        yield cell


@pytest.fixture(scope="module")
def verdict():
    return pytest.importorskip("vtkmodules.vtkFiltersVerdict").vtkMeshQuality


def test_quads_agree_with_vtk(verdict):
    mesh = soup(SQUARE)
    found = Shapes.of(mesh)
    for k, cell in enumerate(vtk_cells(mesh)):
        assert found.least_angle[k] == pytest.approx(verdict.QuadMinAngle(cell), abs=1e-9)
        assert found.greatest_angle[k] == pytest.approx(verdict.QuadMaxAngle(cell), abs=1e-9)
        expected = verdict.QuadScaledJacobian(cell)
        assert found.scaled_jacobian[k] == pytest.approx(expected, abs=1e-9)
        assert found.aspect()[k] == pytest.approx(verdict.QuadEdgeRatio(cell), rel=1e-12)
        assert found.skew[k] == pytest.approx(degrees(asin(verdict.QuadSkew(cell))), abs=1e-9)
        warpage = degrees(acos(np.cbrt(verdict.QuadWarpage(cell))))
        assert found.warpage[k] == pytest.approx(warpage, abs=1e-6)


def test_concave_and_inverted_quads_agree_with_vtk(verdict):
    mesh = soup(SQUARE * [1, 1, 0], bend=0.9, seed=3)
    flat = ShellMesh.build(mesh.points * [1, 1, 0], mesh.elements)
    found = Shapes.of(flat)
    assert (found.scaled_jacobian < 0).sum() > 30
    for k, cell in enumerate(vtk_cells(flat)):
        # VTK's normal is that of the diagonals too, so it sees no quad upside down
        expected = verdict.QuadScaledJacobian(cell)
        assert found.scaled_jacobian[k] == pytest.approx(expected, abs=1e-9)


def test_trias_agree_with_vtk(verdict):
    mesh = soup(TRIA)
    found = Shapes.of(mesh)
    for k, cell in enumerate(vtk_cells(mesh)):
        assert found.least_angle[k] == pytest.approx(verdict.TriangleMinAngle(cell), abs=1e-9)
        assert found.greatest_angle[k] == pytest.approx(verdict.TriangleMaxAngle(cell), abs=1e-9)
        expected = verdict.TriangleScaledJacobian(cell)
        assert found.scaled_jacobian[k] == pytest.approx(expected, abs=1e-9)
        assert found.aspect()[k] == pytest.approx(verdict.TriangleEdgeRatio(cell), rel=1e-12)


@pytest.mark.parametrize("corners", [SQUARE, TRIA], ids=["quads", "trias"])
def test_two_independent_implementations_of_the_definitions_agree(corners):
    mesh = soup(corners, bend=0.25)
    found, values = Shapes.of(mesh), element_values(mesh, PAPER.at(1.0))
    columns = {"warpage": 3, "skew": 8, "jacobian": 9, "taper": 11, "shortest": 0, "longest": 1}
    for name, column in columns.items():
        assert getattr(found, name) == pytest.approx(values[:, column], abs=1e-9), name
    normalised = replace(PAPER, normalised_size=True).at(1.0)
    assert found.height == pytest.approx(element_values(mesh, normalised)[:, 0], abs=1e-9)


def test_a_square_and_a_regular_tria_are_perfect():
    for mesh, angle in ((alone(*SQUARE), 90.0), (alone(*TRIA), 60.0)):
        found = Shapes.of(mesh)
        assert found.least_angle[0] == pytest.approx(angle)
        assert found.greatest_angle[0] == pytest.approx(angle)
        assert found.scaled_jacobian[0] == pytest.approx(1.0)
        assert found.aspect()[0] == pytest.approx(1.0)
        assert [found.skew[0], found.taper[0], found.warpage[0]] == pytest.approx([0, 0, 0])


@pytest.mark.parametrize(
    "corners",
    [
        [(0, 0, 0), (1, 0, 0), (2, 0, 0)],
        [(0, 0, 0), (1, 0, 0), (1, 0, 0)],
        [(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)],
        [(0, 0, 0), (0, 0, 0), (0, 0, 0), (0, 0, 0)],
    ],
)
def test_what_has_no_area_is_the_worst_and_fails_by_shape(corners):
    found = Shapes.of(alone(*corners))
    assert found.scaled_jacobian[0] == 0.0
    assert failures(found, STANDARD.at(1.0)).shape[0]


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.floats(0.01, 100.0))
def test_shape_does_not_depend_on_where_how_large_and_which_corner_first(seed, scale):
    mesh = soup(SQUARE, count=5, seed=seed)
    turn = Rotation.random(random_state=seed % 1000).as_matrix()
    there = ShellMesh.build(
        scale * (mesh.points @ turn.T) + [3, 4, 5], np.roll(mesh.elements, seed % 4, axis=1)
    )
    one, other = Shapes.of(mesh), Shapes.of(there)
    for name in NAMES:
        power = {"shortest": 1, "longest": 1, "height": 1, "area": 2}.get(name, 0)
        expected = getattr(one, name) * scale**power
        assert getattr(other, name) == pytest.approx(expected, rel=1e-6, abs=1e-6), name


@pytest.mark.parametrize("criteria", [PAPER, STANDARD], ids=["paper", "standard"])
def test_what_fails_is_what_fails_by_shape_or_by_size(criteria):
    for corners in (SQUARE, TRIA):
        mesh = soup(corners, bend=0.45)
        found = failures(Shapes.of(mesh), criteria.at(1.0))
        assert (found.shape | found.size).tolist() == failed_elements(
            mesh, criteria.at(1.0)
        ).tolist()
        assert found.shape.any()
        assert found.size.any()


def test_a_long_rectangle_fails_by_size_alone_and_a_needle_by_shape():
    oblong = failures(Shapes.of(alone((0, 0, 0), (10, 0, 0), (10, 1, 0), (0, 1, 0))), PAPER.at(3.0))
    assert (oblong.size_alone[0], oblong.shape[0]) == (True, False)
    assert oblong.severity["aspect ratio"][0] == pytest.approx((10 - 3) / (6 - 3))
    needle = failures(Shapes.of(alone((0, 0, 0), (3, 0, 0), (0, 0.1, 0))), PAPER.at(3.0))
    assert (needle.size_alone[0], needle.shape[0]) == (False, True)


def test_a_limit_is_kept_up_to_it_and_severity_grows_from_there():
    def of(angle):
        x, y = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        rhomb = alone((0, 0, 0), (1, 0, 0), (1 + x, y, 0), (x, y, 0))
        return failures(Shapes.of(rhomb), STANDARD.at(1.0)).severity["min angle quad"][0]

    assert of(40.0) == 0.0
    assert of(30.0) == pytest.approx(0.5)
    assert of(20.0) == pytest.approx(1.0)


def test_lengths_are_judged_by_the_size_of_each_element():
    mesh = soup(SQUARE, count=2, bend=0.0)
    found = failures(Shapes.of(mesh), PAPER.at(1.0), np.array([1.0, 0.5]))
    assert found.size.tolist() == [False, True]
    assert found.severity["max length"][1] == pytest.approx((1.0 - 0.75) / (0.9 - 0.75))


def test_a_criterion_that_is_not_active_does_not_count():
    needle = Shapes.of(alone((0, 0, 0), (3, 0, 0), (0, 0.1, 0)))
    off = [replace(c, active=False) for c in PAPER.criteria]
    found = failures(needle, PAPER.having(*off, name="none").at(1.0))
    assert not found.shape.any()
    assert not found.size.any()
    assert not found.shape_severity.any()
