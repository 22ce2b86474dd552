"""Surfaces in the core: what was recorded of them, and what always holds.

That nearest points are the nearest is shown in ``tests/test_surface.py``.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops import _core
from tests.core.recorded import digest
from tests.meshes import CURVED_KINDS, PLANE_KINDS, meshes, paraboloid, sheet
from tests.test_surface import random_surface

bounded = settings(deadline=None, max_examples=100)


def test_surfaces_are_those_recorded():
    mesh = paraboloid(sheet(9, 8, seed=5, jitter=0.2))
    facets = np.ascontiguousarray(mesh.elements[:, :3])
    spheres = _core.bounding_spheres(mesh.points, facets)
    assert digest(spheres) == "0f947d8882590e70"
    queries = mesh.points[::3] * [1.0, 1.1, 0.5]
    assert digest(*_core.nearest(queries, mesh.points, facets, spheres)) == "c001bcf2d1ba747e"
    vector, area = _core.areas_of(mesh.points, facets)
    assert (digest(vector), area) == ("862e322755850321", 38.93775024700805)
    assert digest(_core.plane_of(mesh.points, facets, 1e-9)[2]) == "3e08a763cc5d9cb6"
    starts, ends = mesh.points[:20], mesh.points[1:21]
    assert digest(*_core.nearest_edges(queries, starts, ends)) == "1c573f01f581937c"


@bounded
@given(st.integers(0, 10**6))
def test_spheres_are_around_their_facets(seed):
    points, facets, _ = random_surface(seed)
    spheres = _core.bounding_spheres(points, facets)
    away = np.linalg.norm(points[facets] - spheres[:, None, :3], axis=2)
    np.testing.assert_allclose(away.max(axis=1), spheres[:, 3], atol=1e-12)


@bounded
@given(meshes(PLANE_KINDS + CURVED_KINDS), st.integers(0, 2**31))
def test_planes_and_areas(mesh, seed):
    facets = np.ascontiguousarray(mesh.elements[:, :3])
    turn, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    points = mesh.points @ turn
    a, b, c = points[facets].transpose(1, 0, 2)
    vectors = np.cross(b - a, c - a) / 2.0
    total, area = _core.areas_of(points, facets)
    np.testing.assert_allclose(total, vectors.sum(axis=0), atol=1e-9)
    assert area == pytest.approx(np.linalg.norm(vectors, axis=1).sum())
    same_total, same_area, normal, is_plane = _core.plane_of(points, facets, 1e-9)
    assert (same_total.tolist(), same_area) == (total.tolist(), area)
    flat = np.ptp(mesh.points[:, 2]) == 0.0
    assert is_plane == (flat and (vectors @ total > 0.0).all())
    if is_plane:
        np.testing.assert_allclose(points @ normal, points[0] @ normal, atol=1e-9)
        assert np.linalg.norm(normal) == pytest.approx(1.0)


@bounded
@given(st.integers(0, 10**6), st.integers(1, 20))
def test_nearest_edges(seed, count):
    rng = np.random.default_rng(seed)
    points, starts = rng.normal(size=(9, 3)), rng.normal(size=(count, 3))
    ends = np.where(rng.random((count, 1)) < 0.2, starts, rng.normal(size=(count, 3)))
    distance, edge, along = _core.nearest_edges(points, starts, ends)
    assert ((along >= 0.0) & (along <= 1.0)).all()
    foot = starts[edge] + along[:, None] * (ends[edge] - starts[edge])
    np.testing.assert_allclose(distance, np.linalg.norm(points - foot, axis=1), atol=1e-12)
    for share in np.linspace(0.0, 1.0, 9):
        others = starts + share * (ends - starts)
        away = np.linalg.norm(points[:, None] - others[None], axis=2)
        assert (distance[:, None] <= away + 1e-12).all()


def test_there_may_be_no_edge():
    distance, *_ = _core.nearest_edges(np.zeros((2, 3)), np.zeros((0, 3)), np.zeros((0, 3)))
    assert np.isinf(distance).all()


def test_what_does_not_fit_is_refused():
    points, facets, queries = random_surface(1)
    spheres = _core.bounding_spheres(points, facets)
    with pytest.raises(ValueError, match="not there"):
        _core.nearest(queries, points[:1], facets, spheres)
    with pytest.raises(ValueError, match="one sphere"):
        _core.nearest(queries, points, facets, spheres[1:])
    with pytest.raises(ValueError, match="no facet"):
        _core.nearest(queries, points, facets[:0], spheres[:0])
    with pytest.raises(ValueError, match="a start and an end"):
        _core.nearest_edges(points, points, points[1:])
    found = _core.nearest(queries[:0], points, facets[:0], spheres[:0])
    assert [len(part) for part in found] == [0, 0, 0]
