"""Methods of Remesh: the border stays, the area is covered, and the front makes rows of squares."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops._core import unite_trias
from meshops.methods import METHODS
from meshops.patch import components, extract
from meshops.remesher import RemeshError
from meshops.remeshing import TRIA_OF_QUAD, recombine, remesh_patch
from meshops.surface import PatchSurface
from meshops.topology import topology
from tests.meshes import (
    CURVED_KINDS,
    FLAT_KINDS,
    annulus,
    area_vectors,
    cylinder,
    doubles,
    meshes,
    sheet,
    sides,
    torus,
    unsound,
)
from tests.meshes import ShellMesh as Mesh

IN_A_PLANE = [method for method in METHODS if method.name != "isotropic"]
each_method = pytest.mark.parametrize("method", METHODS, ids=lambda method: method.name)
each_in_a_plane = pytest.mark.parametrize("method", IN_A_PLANE, ids=lambda method: method.name)
bounded = settings(max_examples=25, deadline=None)


def patches(mesh):
    whole = topology(mesh)
    return [extract(whole, rows) for rows in components(whole, np.ones(len(mesh.elements), bool))]


def trias_of(patch):
    return PatchSurface.of(patch.points, patch.elements).trias


def mesh_of(points, trias):
    return Mesh.build(points, np.column_stack([trias, np.full(len(trias), -1)]))


def loose_sides(mesh):
    """Directed sides that no other element has the other way round."""
    directed = Counter(side for element in mesh.elements for side in sides(element))
    return {side for side in directed if side[::-1] not in directed}


def quads_of(patch, method, size):
    surface = PatchSurface.of(patch.points, patch.elements)
    anew = remesh_patch(patch, surface, surface, size, method.remesh)
    assert anew is not None
    return Mesh.build(*anew)


def singular_nodes(mesh, border_nodes):
    """Inner nodes that have not just four quads."""
    quads = np.bincount(mesh.elements[~mesh.is_tria].ravel(), minlength=len(mesh.points))
    trias = np.bincount(mesh.elements[mesh.is_tria, :3].ravel(), minlength=len(mesh.points))
    return int(np.count_nonzero(((quads != 4) | (trias > 0))[border_nodes:]))


@each_in_a_plane
@bounded
@given(mesh=meshes((*FLAT_KINDS, *CURVED_KINDS)), size=st.floats(0.4, 2.0))
def test_the_border_stays_and_the_area_is_covered(method, mesh, size):
    for patch in patches(mesh):
        trias = trias_of(patch)
        try:
            points, anew = method.remesh(patch.points, trias, patch.border, size)
        except RemeshError:
            continue
        old, new = mesh_of(patch.points, trias), mesh_of(points, anew)
        kept = patch.border_nodes
        assert np.array_equal(points[:kept], patch.points[:kept])
        assert loose_sides(new) == loose_sides(old)
        np.testing.assert_allclose(
            area_vectors(new).sum(axis=0), area_vectors(old).sum(axis=0), atol=1e-9
        )
        # seen from the way that the patch faces, no tria is turned over
        assert (area_vectors(new) @ area_vectors(old).sum(axis=0) > 0).all()
        assert np.array_equal(np.unique(anew), np.arange(len(points)))


@each_in_a_plane
@bounded
@given(mesh=meshes(("plain", "holes", "annulus", "regions", "cylinder", "paraboloid")))
def test_plane_and_gently_curved_patches_can_be_meshed(method, mesh):
    done = 0
    for patch in patches(mesh):
        points, _ = method.remesh(patch.points, trias_of(patch), patch.border, 1.0)
        done += len(points) >= patch.border_nodes
    assert done == len(patches(mesh))


@each_method
def test_the_size_is_met(method):
    (patch,) = patches(sheet(12, 12, trias=0.3))
    counts = [len(quads_of(patch, method, size).elements) for size in (0.8, 1.0, 1.4)]
    assert counts[0] > counts[1] > counts[2]
    assert counts[1] == pytest.approx(144, rel=0.25)


@each_method
def test_the_same_patch_gives_the_same_mesh(method):
    (patch,) = patches(annulus())
    first, second = (method.remesh(patch.points, trias_of(patch), patch.border, 1) for _ in "ab")
    assert np.array_equal(first[0], second[0])
    assert np.array_equal(first[1], second[1])


@each_in_a_plane
@pytest.mark.parametrize("factor", [1e-6, 1e6])
def test_the_unit_of_length_does_not_matter(method, factor):
    (patch,) = patches(annulus())
    points, trias = method.remesh(patch.points, trias_of(patch), patch.border, 1.0)
    scaled, same = method.remesh(patch.points * factor, trias_of(patch), patch.border, factor)
    assert len(points) == len(scaled)
    assert len(trias) == len(same)


@each_in_a_plane
def test_new_nodes_lie_on_the_curved_surface_between_the_old_ones(method):
    (patch,) = patches(cylinder(sheet(10, 6), radius=8.0))
    points, _ = method.remesh(patch.points, trias_of(patch), patch.border, 1.0)
    radius = np.hypot(points[:, 0], points[:, 2])
    # a chord of length 1 is 1 / 64 below an arc of radius 8
    assert (radius <= 8.0 + 1e-9).all()
    assert (radius >= 8.0 - 0.02).all()


@each_in_a_plane
@pytest.mark.parametrize("size", [0.0, -1.0, float("nan"), float("inf"), 1e-9])
def test_sizes_that_make_no_mesh_are_refused(method, size):
    (patch,) = patches(sheet(3, 3))
    with pytest.raises(RemeshError):
        method.remesh(patch.points, trias_of(patch), patch.border, size)


@each_in_a_plane
def test_what_has_no_border_or_turns_too_far_is_refused(method):
    for mesh in (torus(24, 40), cylinder(sheet(40, 3), radius=8.0)):
        (patch,) = patches(mesh)
        with pytest.raises(RemeshError):
            method.remesh(patch.points, trias_of(patch), patch.border, 1.0)


# --- the front ----------------------------------------------------------------------------------


FRONT = next(method for method in METHODS if method.name == "front")
ISOTROPIC = next(method for method in METHODS if method.name == "isotropic")


@pytest.mark.parametrize("turn", [0.0, 0.3, 1.0])
def test_a_rectangle_becomes_rows_of_squares(turn):
    flat = sheet(12, 7, jitter=0.3, trias=0.5, seed=4)
    c, s = np.cos(turn), np.sin(turn)
    turned = flat.points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    (patch,) = patches(Mesh.build(turned, flat.elements))
    mesh = quads_of(patch, FRONT, 1.0)
    assert len(mesh.elements) == 84
    assert not mesh.is_tria.any()
    assert singular_nodes(mesh, patch.border_nodes) == 0
    np.testing.assert_allclose(np.linalg.norm(area_vectors(mesh), axis=1), 1.0, atol=0.01)


@pytest.mark.parametrize("rings", [4, 8])
def test_the_front_has_fewer_singular_nodes_than_isotropic_remeshing(rings):
    (patch,) = patches(annulus(around=24, rings=rings))
    front, isotropic = (
        singular_nodes(quads_of(patch, method, 1.0), patch.border_nodes)
        for method in (FRONT, ISOTROPIC)
    )
    assert front < isotropic


# --- trias that are left alone ------------------------------------------------------------------


@bounded
@given(mesh=meshes(("plain", "holes", "annulus", "cylinder")), size=st.floats(0.6, 1.6))
def test_trias_meet_in_pairs_and_nothing_else_changes(mesh, size):
    for patch in patches(mesh):
        points, trias = FRONT.remesh(
            patch.points, trias_of(patch), patch.border, TRIA_OF_QUAD * size
        )
        before = Mesh.build(points, recombine(points, trias))
        after = Mesh.build(points, unite_trias(points, before.elements))
        gone = np.count_nonzero(before.is_tria) - np.count_nonzero(after.is_tria)
        assert gone >= 0
        assert gone % 2 == 0
        assert len(before.elements) - len(after.elements) == gone // 2
        assert loose_sides(after) == loose_sides(before)
        assert doubles(after) == []
        if not unsound(before):
            assert unsound(after) == []


def test_two_trias_in_a_row_of_quads_meet():
    (patch,) = patches(sheet(9, 3))
    elements = patch.elements.tolist()
    ends = [elements.pop(13), elements.pop(9)]
    # the middle row: a diagonal in two of its quads, each pair with one tria taken by no one
    for a, b, c, d in ends:
        elements += [[a, b, c, -1], [a, c, d, -1]]
    before = np.array(elements, np.int32)
    after = unite_trias(patch.points, before)
    assert np.count_nonzero(before[:, 3] < 0) == 4
    assert (after[:, 3] >= 0).all()
    assert unsound(Mesh.build(patch.points, after)) == []
