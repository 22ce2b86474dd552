"""Meshing of areas and collars in the core, against the kernels that it was ported from."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops import _core
from meshops.kernels import clipping, lifting, packing, refining, skirt
from meshops.methods.flatten import FlatPatch
from meshops.patch import components, extract
from meshops.remesher import RemeshError
from meshops.surface import PatchSurface
from meshops.topology import topology
from tests.meshes import CURVED_KINDS, FLAT_KINDS, meshes

seeds = st.integers(0, 10**6)
bounded = settings(max_examples=60, deadline=None)
same = np.testing.assert_array_equal

METHODS = {
    "pack_parallelograms": packing.pack_squares,
    "fill_by_refinement": lambda *area: refining.fill_area(*area, 0, 3),
    "fill_by_bubbles": lambda *area: refining.fill_area(*area, 3, 5),
}


def patches(mesh):
    whole = topology(mesh)
    return [extract(whole, rows) for rows in components(whole, np.ones(len(mesh.elements), bool))]


def flattened(patch):
    trias = PatchSurface.of(patch.points, patch.elements).trias
    try:
        return FlatPatch.of(patch.points, trias, patch.border)
    except RemeshError:
        return None


def random_loops(seed):
    """A star-shaped loop around some holes, in a random order; holes may touch or overlap."""
    rng = np.random.default_rng(seed)
    holes = int(rng.integers(0, 5))
    loops = []
    for middle, size, turn in [((0, 0), 10, 1)] + [
        (rng.uniform(-5, 5, 2).round(int(rng.integers(0, 3))), rng.uniform(0.2, 2), -1)
        for _ in range(holes)
    ]:
        count = int(rng.integers(3, 12))
        angle = np.sort(rng.uniform(0, 2 * np.pi, count))[::turn]
        radius = size * rng.uniform(0.6, 1.0, count)
        loops.append(middle + radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))
    loops = [loops[i] for i in rng.permutation(len(loops))]
    start = np.cumsum([0, *map(len, loops)]).astype(np.int32)
    return np.concatenate(loops), start


@settings(max_examples=200, deadline=None)
@given(seeds)
def test_ears_are_clipped_as_by_the_kernel(seed):
    points, start = random_loops(seed)
    expected = clipping.clip_ears(points, start)
    found = _core.clip_ears(points, start)
    if found is None:
        assert not len(expected)
    else:
        same(found, expected)


def filled(method, patch, size):
    """What the kernel makes of a patch, and what the core does."""
    area, room = (patch.flat, patch.trias, patch.border), patch.room(size)
    whole, points, trias = METHODS[method](*area, patch.border_nodes, size, room)
    return (points, trias) if whole else None, getattr(_core, method)(*area, size, room)


@pytest.mark.parametrize("method", ["fill_by_refinement", "fill_by_bubbles"])
@bounded
@given(mesh=meshes((*FLAT_KINDS, *CURVED_KINDS)), size=st.floats(0.4, 2.0))
def test_areas_are_filled_as_by_the_kernel(method, mesh, size):
    for patch in filter(None, map(flattened, patches(mesh))):
        expected, found = filled(method, patch, size)
        assert (expected is None) == (found is None)
        if found is not None:
            same(found[0], expected[0])
            same(found[1], expected[1])


# in an annulus many places are as good as others: the last bit of a sine decides
UNEVEN_KINDS = [kind for kind in (*FLAT_KINDS, *CURVED_KINDS) if kind != "annulus"]


@bounded
@given(mesh=meshes(UNEVEN_KINDS), size=st.floats(0.4, 2.0))
def test_parallelograms_are_packed_as_by_the_kernel(mesh, size):
    for patch in filter(None, map(flattened, patches(mesh))):
        expected, found = filled("pack_parallelograms", patch, size)
        assert (expected is None) == (found is None)
        if found is not None:
            np.testing.assert_allclose(found[0], expected[0], rtol=0.0, atol=1e-9)
            assert turned(found[1]) == turned(expected[1])


def turned(trias):
    """Trias, each from its lowest node on, in any order."""
    return {tuple(np.roll(tria, -int(np.argmin(tria))).tolist()) for tria in trias}


@bounded
@given(mesh=meshes((*FLAT_KINDS, *CURVED_KINDS)), seed=seeds)
def test_places_are_lifted_as_by_the_kernel(mesh, seed):
    rng = np.random.default_rng(seed)
    for patch in filter(None, map(flattened, patches(mesh))):
        low, high = patch.flat.min(axis=0), patch.flat.max(axis=0)
        places = rng.uniform(low - 0.1, high + 0.1, (50, 2))
        surface = patch.flat, patch.trias, patch.points
        same(_core.lift(*surface, places), lifting.lift(*surface, places))
        surface = patch.points, patch.trias
        same(_core.area_normals(*surface), lifting.normals_of(*surface))


@bounded
@given(mesh=meshes((*FLAT_KINDS, *CURVED_KINDS)), doubled=st.booleans())
def test_collars_are_those_of_the_kernel(mesh, doubled):
    for patch in patches(mesh):
        trias = PatchSurface.of(patch.points, patch.elements).trias
        points = patch.points.copy()
        if doubled:
            points[1::3] = points[0]
        apexes = skirt.skirt_apexes(points, trias, patch.border)
        np.testing.assert_allclose(
            _core.collar_apexes(points, trias, patch.border), apexes, rtol=1e-14, atol=1e-15
        )
        assert _core.extents(points) == skirt.extents(points)
        collar = _core.BorderCollar(points, trias, patch.border, 1e-9)
        places, whole, inside = skirt.put_on(points, trias, patch.border, 1e-9)
        same(collar.trias, whole)
        same(collar.inside, inside)
        np.testing.assert_allclose(collar.points, places, rtol=1e-14, atol=1e-15)


@bounded
@given(mesh=meshes(FLAT_KINDS), seed=seeds)
def test_collars_come_off_as_by_the_kernel(mesh, seed):
    rng = np.random.default_rng(seed)
    for patch in patches(mesh):
        trias = PatchSurface.of(patch.points, patch.elements).trias
        collar = _core.BorderCollar(patch.points, trias, patch.border, 1e-3)
        places, whole, inside = collar.points, collar.trias, collar.inside
        count = len(places)
        order = rng.permutation(count)  # nodes come back in another order, moved a little
        out = places[np.argsort(order)] + rng.uniform(-1, 1, (count, 3)) * rng.choice([0, 1e-3, 2])
        if rng.random() < 0.1:
            out[0, 0] = np.nan
        trias_out = order[whole].astype(np.int32)
        if rng.random() < 0.1:
            trias_out[-1, 0] = trias_out[0, 0]
        remeshed = np.asfortranarray(out), np.asfortranarray(trias_out), inside
        points, expected, fault = skirt.take_off(
            out, trias_out, inside, patch.points, patch.border, places, 1e-3
        )
        if fault:
            word = {1: "finite", 2: "changed", 3: "moved"}[fault]
            with pytest.raises(ValueError, match=word):
                collar.take_off(*remeshed)
        else:
            found = collar.take_off(*remeshed)
            same(found[0], points)
            same(found[1], expected)
