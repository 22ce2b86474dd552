"""Surfaces in the core: bit for bit what the compiled Python gave."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops import _core
from meshops.kernels import rings as old_rings
from meshops.kernels import surface as old
from tests.core.test_topology import assert_equal
from tests.meshes import CURVED_KINDS, FLAT_KINDS, meshes
from tests.test_surface import random_surface

bounded = settings(deadline=None, max_examples=100)


@bounded
@given(st.integers(0, 10**6))
def test_nearest_points(seed):
    points, facets, queries = random_surface(seed)
    spheres = _core.bounding_spheres(points, facets)
    assert_equal([spheres], [old.bounding_spheres(points, facets)])
    assert_equal(
        _core.nearest(queries, points, facets, spheres),
        old.nearest(queries, points, facets, spheres),
    )


@bounded
@given(meshes(FLAT_KINDS + CURVED_KINDS), st.sampled_from([1e-9, 0.1]))
def test_planes_and_areas(mesh, tolerance):
    facets = np.ascontiguousarray(mesh.elements[:, :3])
    for found, expected in (
        (_core.areas_of(mesh.points, facets), old.areas_of(mesh.points, facets)),
        (
            _core.plane_of(mesh.points, facets, tolerance),
            old.plane_of(mesh.points, facets, tolerance),
        ),
    ):
        for one, other in zip(found, expected, strict=True):
            np.testing.assert_array_equal(one, other)


@bounded
@given(st.integers(0, 10**6), st.integers(0, 20))
def test_nearest_edges(seed, count):
    rng = np.random.default_rng(seed)
    points, starts = rng.normal(size=(9, 3)), rng.normal(size=(count, 3))
    ends = np.where(rng.random((count, 1)) < 0.2, starts, rng.normal(size=(count, 3)))
    assert_equal(
        _core.nearest_edges(points, starts, ends), old_rings.nearest_edges(points, starts, ends)
    )


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
