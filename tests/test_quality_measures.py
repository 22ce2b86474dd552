"""The measures of one element, against VTK and against their definitions."""

from math import acos, asin, degrees, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from meshops._core import measure_elements
from meshops.criteria import (
    ASPECT_RATIO,
    CHORDAL_DEV,
    JACOBIAN,
    MAX_ANGLE_QUAD,
    MAX_ANGLE_TRIA,
    MAX_LENGTH,
    MIN_ANGLE_QUAD,
    MIN_ANGLE_TRIA,
    MIN_SIZE,
    SKEW,
    TAPER,
    WARPAGE,
)

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
TRIA = np.array([[0.0, 0, 0], [1, 0, 0], [0.5, sqrt(3) / 2, 0]])


def measure(points, *, normalised=False, order=(0, 1, 2, 3)):
    nodes = (*order[: len(points)], -1)[:4]
    sizing = np.array([normalised, 0, 0, 0, 0, 0, 0], float)
    return measure_elements(np.asarray(points, float), np.array([nodes], np.int32), sizing)[0]


def shapes(corners, bend=0.3):
    """Warped elements around a regular one."""
    offsets = st.floats(-bend, bend, allow_nan=False).map(lambda x: round(x, 6))
    return arrays(np.float64, corners.shape, elements=offsets).map(lambda d: corners + d)


def random_elements(corners, count, seed):
    rng = np.random.default_rng(seed)
    return corners + rng.uniform(-0.3, 0.3, (count, *corners.shape))


def vtk_cell(points):
    model = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    cell = model.vtkQuad() if len(points) == 4 else model.vtkTriangle()
    for i, point in enumerate(points):
        cell.GetPoints().SetPoint(i, point)
    return cell


@pytest.fixture(scope="module")
def verdict():
    return pytest.importorskip("vtkmodules.vtkFiltersVerdict").vtkMeshQuality


def test_quads_agree_with_vtk(verdict):
    for points in random_elements(SQUARE, 500, seed=1):
        v, cell = measure(points), vtk_cell(points)
        assert v[MAX_ANGLE_QUAD] == pytest.approx(verdict.QuadMaxAngle(cell), abs=1e-9)
        assert v[MIN_ANGLE_QUAD] == pytest.approx(verdict.QuadMinAngle(cell), abs=1e-9)
        assert v[ASPECT_RATIO] == pytest.approx(verdict.QuadEdgeRatio(cell), rel=1e-12)
        assert v[SKEW] == pytest.approx(degrees(asin(verdict.QuadSkew(cell))), abs=1e-9)
        warpage = degrees(acos(np.cbrt(verdict.QuadWarpage(cell))))
        assert v[WARPAGE] == pytest.approx(warpage, abs=1e-6)


def test_taper_agrees_with_vtk_on_plane_convex_quads(verdict):
    flat = random_elements(SQUARE, 500, seed=2) * [1, 1, 0]
    convex = [points for points in flat if measure(points)[MAX_ANGLE_QUAD] < 180]
    assert len(convex) > 400
    for points in convex:
        assert 1 - measure(points)[TAPER] == pytest.approx(
            verdict.QuadDistortion(vtk_cell(points)), abs=1e-9
        )


def test_trias_agree_with_vtk(verdict):
    for points in random_elements(TRIA, 500, seed=3):
        v, cell = measure(points), vtk_cell(points)
        assert v[MAX_ANGLE_TRIA] == pytest.approx(verdict.TriangleMaxAngle(cell), abs=1e-9)
        assert v[MIN_ANGLE_TRIA] == pytest.approx(verdict.TriangleMinAngle(cell), abs=1e-9)
        assert v[ASPECT_RATIO] == pytest.approx(verdict.TriangleEdgeRatio(cell), rel=1e-12)


def angle(u, v):
    return degrees(acos(np.clip(u @ v / np.linalg.norm(u) / np.linalg.norm(v), -1, 1)))


@settings(max_examples=100, deadline=None)
@given(shapes(TRIA, bend=0.2))
def test_skew_of_a_tria_is_that_of_its_definition(points):
    angles = []
    for corner in range(3):
        p, q, r = np.roll(points, -corner, axis=0)
        between = angle((q + r) / 2 - p, (p + r) / 2 - (p + q) / 2)
        angles.append(min(between, 180 - between))
    assert measure(points)[SKEW] == pytest.approx(90 - min(angles), abs=1e-5)


def test_jacobian_is_that_of_the_shape_functions_at_the_gauss_points():
    place = 1 / sqrt(3)
    for points in random_elements(SQUARE, 100, seed=4) * [1, 1, 0]:
        determinants = []
        for x, y in ((-place, -place), (place, -place), (place, place), (-place, place)):
            by_x = np.array([y - 1, 1 - y, 1 + y, -1 - y]) / 4 @ points
            by_y = np.array([x - 1, -1 - x, 1 + x, 1 - x]) / 4 @ points
            determinants.append(np.cross(by_x, by_y)[2])
        ratio = min(determinants) / max(determinants)
        assert measure(points)[JACOBIAN] == pytest.approx(ratio, abs=1e-12)


def test_normalised_size_is_that_of_its_definition():
    for points in random_elements(SQUARE, 100, seed=5):
        edges = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
        heights = []
        for corner in range(4):
            for first in (corner + 1, corner + 2):
                a, b = points[first % 4], points[(first + 1) % 4]
                along = (b - a) / np.linalg.norm(b - a)
                heights.append(np.linalg.norm(np.cross(points[corner] - a, along)))
        size = min(*edges, *heights)
        assert measure(points, normalised=True)[MIN_SIZE] == pytest.approx(size)
    assert measure(TRIA * 3, normalised=True)[MIN_SIZE] == pytest.approx(3)
    flat = TRIA * [1, 0.1, 1]
    assert measure(flat, normalised=True)[MIN_SIZE] == pytest.approx(0.1)


def test_ideal_elements():
    quad, tria = measure(SQUARE * 5), measure(TRIA * 5)
    assert quad[:6] == pytest.approx([5, 5, 1, 0, 90, 90])
    assert quad[[SKEW, JACOBIAN, TAPER]] == pytest.approx([0, 1, 0])
    assert tria[:4] == pytest.approx([5, 5, 1, 0])
    assert tria[[MAX_ANGLE_TRIA, MIN_ANGLE_TRIA]] == pytest.approx([60, 60])
    assert tria[[SKEW, JACOBIAN, TAPER]] == pytest.approx([0, 1, 0], abs=1e-6)


def test_what_does_not_apply_is_nan():
    quad, tria = measure(SQUARE), measure(TRIA)
    assert set(np.flatnonzero(np.isnan(quad))) == {MAX_ANGLE_TRIA, MIN_ANGLE_TRIA, CHORDAL_DEV}
    assert set(np.flatnonzero(np.isnan(tria))) == {MAX_ANGLE_QUAD, MIN_ANGLE_QUAD, CHORDAL_DEV}


@pytest.mark.parametrize("lift", [0.0, 0.02])
def test_a_concave_corner_is_over_180_degrees(lift):
    arrow = np.array([[0.0, 0, 0], [2, 0, 0], [0.5, 0.5, lift], [0, 2, 0]])
    v = measure(arrow)
    assert v[MAX_ANGLE_QUAD] == pytest.approx(360 - angle(arrow[1] - arrow[2], arrow[3] - arrow[2]))
    assert v[MAX_ANGLE_QUAD] > 180
    assert v[JACOBIAN] < 0.3
    assert v[TAPER] > 1


@settings(max_examples=100, deadline=None)
@given(shapes(SQUARE, bend=0.2), st.integers(1, 3), st.booleans())
def test_measures_do_not_depend_on_where_an_element_starts(points, shift, turned_over):
    order = np.roll([0, 1, 2, 3], shift)
    if turned_over:
        order = order[::-1]
    np.testing.assert_allclose(measure(points, order=order), measure(points), atol=1e-6)


@settings(max_examples=50, deadline=None)
@given(
    st.one_of(shapes(SQUARE, bend=0.2), shapes(TRIA, bend=0.2)),
    st.integers(0, 1000),
    arrays(np.float64, 3, elements=st.floats(-100, 100)),
    st.floats(0.01, 100),
)
def test_measures_do_not_depend_on_place_and_scale(points, seed, shift, scale):
    moved = Rotation.random(random_state=seed).apply(points) * scale + shift * scale
    expected = measure(points)
    expected[[MIN_SIZE, MAX_LENGTH]] *= scale
    np.testing.assert_allclose(measure(moved), expected, rtol=1e-7, atol=1e-6)


DEGENERATE = {
    "nodes of a quad coincide": SQUARE[[0, 1, 1, 3]],
    "opposite nodes of a quad coincide": SQUARE[[0, 1, 0, 3]],
    "all nodes of a quad coincide": SQUARE[[0, 0, 0, 0]],
    "quad on a line": np.array([[0.0, 0, 0], [1, 0, 0], [3, 0, 0], [2, 0, 0]]),
    "quad on a slanting line": np.outer([0, 1, 3, 2], [0.1, 0.7, 0.3]),
    "nodes of a tria coincide": TRIA[[0, 1, 1]],
    "all nodes of a tria coincide": TRIA[[0, 0, 0]],
    "tria on a line": np.outer([0, 1, 3], [0.1, 0.7, 0.3]),
    "a coordinate is not a number": np.where(np.arange(12).reshape(4, 3) == 1, np.nan, SQUARE),
}


@pytest.mark.parametrize("points", DEGENERATE.values(), ids=DEGENERATE)
@pytest.mark.parametrize("normalised", [False, True])
def test_degenerate_elements_have_the_worst_angles(points, normalised):
    v = measure(points, normalised=normalised)
    largest, smallest = (
        (MAX_ANGLE_QUAD, MIN_ANGLE_QUAD) if len(points) == 4 else (MAX_ANGLE_TRIA, MIN_ANGLE_TRIA)
    )
    assert (v[largest], v[smallest], v[SKEW]) == (180, 0, 90)
