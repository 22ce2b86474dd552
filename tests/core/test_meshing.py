"""Meshing of areas and collars in the core: what was recorded, what holds, that nothing panics.

What holds of a patch that is meshed anew is in tests/test_methods.py.
"""

from contextlib import suppress
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops import _core
from meshops.patch import components, extract
from meshops.topology import topology
from tests.core.recorded import digest
from tests.meshes import CURVED_KINDS, FLAT_KINDS, meshes, paraboloid, sheet

FILLS = {
    "pack": _core.pack_parallelograms,
    "refine": _core.fill_by_refinement,
    "bubbles": _core.fill_by_bubbles,
}
seeds = st.integers(0, 10**6)
bounded = settings(max_examples=60, deadline=None)


class Area:
    """A mesh as trias, and its largest patch as an area of the plane."""

    def __init__(self, mesh):
        whole = topology(mesh)
        rows = max(components(whole, np.ones(len(mesh.elements), bool)), key=len)
        self.patch = patch = extract(whole, rows)
        self.trias = _core.as_trias(patch.points, patch.elements)
        self.border = patch.border
        self.points = patch.points
        self.flat = np.ascontiguousarray(patch.points[:, :2])

    def filled(self, method, size, room=2000):
        return FILLS[method](self.flat, self.trias, self.border, size, room)


AREAS = {
    "sheet": Area(sheet(12, 9, seed=5, jitter=0.2, trias=0.3)),
    "holes": Area(sheet(20, 14, seed=3, jitter=0.3, trias=0.4, holes=0.05)),
    "paraboloid": Area(paraboloid(sheet(8, 8, seed=3, jitter=0.2, trias=0.3))),
}


FILLED = {
    "sheet": {
        "pack 0.6": "e23667851591aec5",
        "pack 1": "d7c41883c81c2917",
        "pack 1.7": "5357a1a8fed6f139",
        "refine 0.6": "5978b553041d74c5",
        "refine 1": "69d161056fdd5b7b",
        "refine 1.7": "c456facff76a9fed",
        "bubbles 0.6": "1b8a568a2d9c0dd6",
        "bubbles 1": "669ac1c9bb096bd7",
        "bubbles 1.7": "dbdf50b86f92adca",
    },
    "holes": {
        "pack 0.6": "dd4158446185f00c",
        "pack 1": "cb4d3199329f6a91",
        "pack 1.7": "59eba3373e3505d1",
        "refine 0.6": "0a7d47d6d87a5cb6",
        "refine 1": "bf50bf51b51eb005",
        "refine 1.7": "9342701f87369288",
        "bubbles 0.6": "ccbae4d22d8278e1",
        "bubbles 1": "2aa520e74e818189",
        "bubbles 1.7": "86bcd77d0213ee50",
    },
    "paraboloid": {
        "pack 0.6": "27099f963a7bb246",
        "pack 1": "c509c5f4eb55be31",
        "pack 1.7": "df5805c3bb909918",
        "refine 0.6": "96cd9db0376f12bb",
        "refine 1": "62c92bf868fbc02d",
        "refine 1.7": "c6138aca295fee98",
        "bubbles 0.6": "b3fb86c78ef119ff",
        "bubbles 1": "ffbd4a97dc3f4d73",
        "bubbles 1.7": "6ea3830bf2b682d5",
    },
}


@pytest.mark.parametrize("name", AREAS)
def test_the_recorded_trias_fill_an_area(name):
    """Each node hangs on all before it, so that nothing has changed where this is the same."""
    found = {
        f"{method} {size:g}": digest(*AREAS[name].filled(method, size))
        for method in FILLS
        for size in (0.6, 1.0, 1.7)
    }
    assert found == FILLED[name]


def test_the_recorded_places_are_lifted():
    area = AREAS["paraboloid"]
    places = np.random.default_rng(1).uniform(-0.5, 8.5, (500, 2))
    lifted = _core.lift(area.flat, area.trias, area.points, places)
    assert digest(lifted, _core.area_normals(area.points, area.trias)) == "98f25e503146d80a"


def test_the_recorded_collar_is_put_on():
    area = AREAS["paraboloid"]
    points = area.points.copy()
    points[5] = points[7] = points[2]
    collar = _core.BorderCollar(points, area.trias, area.border, 1e-9)
    assert digest(collar.points, collar.trias, collar.inside) == "66c1b3acfd42ff2e"


# --- clipping ears ------------------------------------------------------------------------------


def loops(seed, most=5):
    """A star around some holes, in any order; the holes may touch, overlap or lie outside."""
    rng = np.random.default_rng(seed)
    middles = [np.zeros(2), *rng.uniform(-5, 5, (int(rng.integers(0, most)), 2)).round(1)]
    found = []
    for middle in middles:
        outer = not found
        places = rng.uniform(-1, 1, (int(rng.integers(3, 12)), 2))
        order = np.argsort(np.arctan2(*places.T[::-1]))
        size = 10.0 if outer else rng.uniform(0.2, 2.0)
        found.append(middle + size * places[order if outer else order[::-1]])
    found = [found[i] for i in rng.permutation(len(found))]
    return np.concatenate(found), np.cumsum([0, *map(len, found)]).astype(np.int32)


def areas_of(points, trias):
    a, b, c = points[trias].transpose(1, 0, 2)
    return 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])


def test_the_recorded_ears_are_clipped():
    # the first loop of a graded lattice of triangular holes
    outer = [(x, 0) for x in range(9)] + [(8, y) for y in range(1, 9)]
    outer += [(x, 8) for x in range(7, -1, -1)] + [(0, y) for y in range(7, 0, -1)]
    hole = np.array([(0, 0), (0.25, 0.5), (0.5, 0.125)])
    middles = [(x + 0.0625 * y, y) for x in (1, 3.5, 6) for y in (1, 3, 5.5)]
    points = np.concatenate([np.array(outer, float), *(hole + middle for middle in middles)])
    start = np.array([0, *range(len(outer), len(points) + 1, 3)], np.int32)
    trias = _core.clip_ears(points, start)
    assert len(trias) == len(points) + 2 * len(middles) - 2
    assert digest(trias) == "a743602717c636a7"


@settings(max_examples=200, deadline=None)
@given(seeds)
def test_ears_cover_what_the_loops_bound(seed):
    points, start = loops(seed)
    trias = _core.clip_ears(points, start)
    if trias is None:
        return
    holes = len(start) - 2
    assert len(trias) == len(points) + 2 * holes - 2
    areas = areas_of(points, trias)
    assert (areas > 0.0).all()
    ring = [np.arange(a, b) for a, b in pairwise(start)]
    fans = [np.column_stack([np.full(len(r) - 2, r[0]), r[1:-1], r[2:]]) for r in ring]
    whole = sum(areas_of(points, fan).sum() for fan in fans)
    assert areas.sum() == pytest.approx(whole)


# --- lifting ------------------------------------------------------------------------------------


@bounded
@given(mesh=meshes(("plain", "holes", "annulus")), seed=seeds)
def test_a_lifted_place_lies_over_where_it_was(mesh, seed):
    area = Area(mesh)
    shares = np.random.default_rng(seed).dirichlet((1.0, 1.0, 1.0), len(area.trias))
    places = np.einsum("tk,tki->ti", shares, area.flat[area.trias])
    slope = np.column_stack([area.flat, area.flat @ (0.5, -0.25)])
    lifted = _core.lift(area.flat, area.trias, slope, places)
    np.testing.assert_allclose(lifted[:, :2], places, atol=1e-12)
    np.testing.assert_allclose(lifted[:, 2], places @ (0.5, -0.25), atol=1e-12)


# --- collars ------------------------------------------------------------------------------------


@bounded
@given(mesh=meshes((*FLAT_KINDS, *CURVED_KINDS)))
def test_collars_lie_outside_and_share_no_place(mesh):
    area = Area(mesh)
    collar = _core.BorderCollar(area.points, area.trias, area.border, 1e-9)
    kept, inner = len(area.points), len(area.trias)
    np.testing.assert_allclose(collar.points[:kept], area.points, atol=1e-7)
    np.testing.assert_array_equal(collar.trias[:inner], area.trias)
    np.testing.assert_array_equal(collar.trias[inner:, 1::-1], area.border)
    np.testing.assert_array_equal(collar.inside, np.arange(len(collar.trias)) < inner)
    assert len(np.unique(collar.points, axis=0)) == len(collar.points)
    a, b = area.points[area.border].transpose(1, 0, 2)
    height = np.linalg.norm(collar.points[kept:] - 0.5 * (a + b), axis=1)
    np.testing.assert_allclose(height, 0.3 * np.linalg.norm(b - a, axis=1), atol=1e-8)
    apexes = _core.collar_apexes(area.points, area.trias, area.border)
    np.testing.assert_allclose(collar.points[kept:], apexes, atol=1e-7)


def test_nodes_at_one_place_are_set_apart():
    area = Area(sheet(3, 3))
    points = area.points.copy()
    points[1:4] = points[0]
    collar = _core.BorderCollar(points, area.trias, area.border, 1e-3)
    expected = points[0] + 1e-3 * np.arange(4)[:, None]
    np.testing.assert_allclose(collar.points[:4], expected, rtol=0.0, atol=1e-15)


@bounded
@given(mesh=meshes(FLAT_KINDS), seed=seeds, fault=st.sampled_from(["", "finite", "border"]))
def test_a_collar_comes_off_whatever_order_the_nodes_are_in(mesh, seed, fault):
    area = Area(mesh)
    rng = np.random.default_rng(seed)
    collar = _core.BorderCollar(area.points, area.trias, area.border, 1e-3)
    order = rng.permutation(len(collar.points))
    out = collar.points[np.argsort(order)] + rng.uniform(-1e-4, 1e-4, (len(order), 3))
    trias = order[collar.trias].astype(np.int32)
    if fault == "finite":
        out[0, 0] = np.nan
    elif fault == "border":
        out[order[area.border[0, 0]]] += rng.choice([0.01, 2.0])
    remeshed = np.asfortranarray(out), np.asfortranarray(trias), collar.inside
    if fault:
        with pytest.raises(ValueError, match=fault):
            collar.take_off(*remeshed)
        return
    points, anew = collar.take_off(*remeshed)
    kept = area.patch.border_nodes
    np.testing.assert_array_equal(points[:kept], area.points[:kept])
    assert len(points) == len(area.points)
    np.testing.assert_allclose(points[anew], area.points[area.trias], atol=2e-4)


def test_extents_are_infinite_where_a_coordinate_is_not_finite():
    points = np.array([[1.0, 0.0, 0.0], [0.0, -4.0, 0.0]])
    assert _core.extents(points) == (4.0, 4.0)
    points[1, 2] = np.nan
    assert _core.extents(points) == (np.inf, np.inf)
    assert _core.extents(points[:0]) == (0.0, 0.0)


# --- what makes no sense ------------------------------------------------------------------------


numbers = st.one_of(st.integers(-3, 3), st.floats(-3.0, 3.0), st.sampled_from([1e-300, 1e160]))


def rows(data, width, nodes, most):
    row = st.lists(st.integers(0, nodes - 1), min_size=width, max_size=width)
    drawn = data.draw(st.lists(row, max_size=most))
    return np.reshape(drawn, (-1, width)).astype(np.int32)


@settings(max_examples=300, deadline=None)
@given(data=st.data(), nodes=st.integers(3, 9), size=st.sampled_from([1e-9, 0.5, 1.0, 1e9]))
def test_no_area_is_so_wrong_that_it_panics(data, nodes, size):
    drawn = data.draw(st.lists(numbers, min_size=27, max_size=27))
    points = np.reshape(drawn, (9, 3))[:nodes].astype(float)
    trias, border = rows(data, 3, nodes, 12), rows(data, 2, nodes, 12)
    flat = np.ascontiguousarray(points[:, :2])
    for fill in FILLS.values():
        filled = fill(flat, trias, border, size, 30)
        if filled is not None:
            assert filled[1].max(initial=-1) < len(filled[0])
    assert _core.lift(flat, trias, points, flat + 0.1).shape == (nodes, 3)
    assert _core.BorderCollar(points, trias, border, 1e-9).inside.sum() == len(trias)
    starts = np.array(sorted(data.draw(st.lists(st.integers(0, nodes), min_size=1))), np.int32)
    _core.clip_ears(flat, starts)


@settings(max_examples=200, deadline=None)
@given(data=st.data(), nodes=st.integers(3, 9))
def test_nothing_that_comes_back_is_so_wrong_that_it_panics(data, nodes):
    area = AREAS["sheet"]
    collar = _core.BorderCollar(area.points, area.trias, area.border, 1e-9)
    points, trias = np.zeros((nodes, 3)), rows(data, 3, nodes, 12)
    inside = np.array(
        data.draw(
            st.lists(st.sampled_from([0.0, 1.0, np.nan]), min_size=len(trias), max_size=len(trias))
        )
    )
    with pytest.raises(ValueError, match="border"):
        collar.take_off(points, trias, inside)
    small = _core.BorderCollar(points, trias, trias[:, :2], 10.0)
    with suppress(ValueError):
        small.take_off(small.points, small.trias, small.inside)


def test_what_does_not_fit_is_refused():
    area = AREAS["sheet"]
    for fill in FILLS.values():
        with pytest.raises(ValueError, match="above 0"):
            fill(area.flat, area.trias, area.border, np.nan, 10)
        with pytest.raises(ValueError, match="names a point"):
            fill(area.flat[:5], area.trias, area.border, 1.0, 10)
        with pytest.raises(ValueError, match="not finite"):
            fill(area.flat + np.inf, area.trias, area.border, 1.0, 10)
    with pytest.raises(ValueError, match="do not ascend"):
        _core.clip_ears(area.flat, np.array([3, 0], np.int32))
    with pytest.raises(ValueError, match="beyond the points"):
        _core.clip_ears(area.flat[:3], np.array([0, 4], np.int32))
    with pytest.raises(ValueError, match="no surface"):
        _core.lift(area.flat[:0], area.trias[:0], area.points[:0], area.flat)
