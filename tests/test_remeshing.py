"""Remeshing of one patch: what comes out of it, and what of a remesher is not put in."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.methods import METHODS
from meshops.patch import components, extract
from meshops.remesher import RemeshError, remesh_isotropic
from meshops.remeshing import remesh_patch
from meshops.surface import PatchSurface
from meshops.topology import topology
from tests.measures import distances_to_trias, sides
from tests.meshes import CURVED_KINDS, FLAT_KINDS, annulus, cylinder, meshes, paraboloid, sheet


def anew(patch, method=remesh_isotropic):
    """The patch remeshed by a method at the size that it has; None where that fails."""
    surface = PatchSurface.of(patch.points, patch.elements)
    return remesh_patch(patch, surface, surface, surface.mean_edge(patch), method)


@settings(max_examples=40, deadline=None)
@given(meshes(FLAT_KINDS + CURVED_KINDS), st.integers(0, 10**6))
def test_nearly_every_patch_can_be_remeshed(mesh, seed):
    """Ragged ones too, with slits, and parts that touch in a node."""
    found = topology(mesh)
    selected = np.random.default_rng(seed).random(len(mesh.elements)) < 0.85
    for rows in components(found, selected):
        if len(rows) > 1:
            patch = extract(found, rows)
            made = anew(patch)
            assert made is not None
            trias = np.count_nonzero(made[1][:, 3] < 0)
            assert trias % 2 == len(patch.border) % 2


def patch_of(mesh):
    found = topology(mesh)
    (rows,) = components(found, np.ones(len(mesh.elements), bool))
    return extract(found, rows)


@pytest.mark.parametrize(
    "mesh",
    [
        sheet(7, 6, seed=1, jitter=0.3),
        annulus(seed=1, jitter=0.1),
        cylinder(sheet(7, 6, seed=1, jitter=0.15)),
        paraboloid(sheet(7, 6, seed=1, jitter=0.15)),
    ],
    ids=["sheet", "annulus", "cylinder", "paraboloid"],
)
@pytest.mark.parametrize("method", METHODS, ids=[method.name for method in METHODS])
def test_the_law_of_parity_holds_in_a_patch(mesh, method):
    patch = patch_of(mesh)
    _, elements = anew(patch, method.remesh)
    directed = {side for element in elements for side in sides(element)}
    inner = sum(side[::-1] in directed for side in directed) // 2
    trias = np.count_nonzero(elements[:, 3] < 0)
    quads = len(elements) - trias
    assert 4 * quads + 3 * trias == 2 * inner + len(patch.border)
    assert {side for side in directed if side[::-1] not in directed} == set(
        map(tuple, patch.border.tolist())
    )


# --- what is refused ----------------------------------------------------------------------------


def without_middle(points, trias, border_nodes):
    middle = np.linalg.norm(points[trias].mean(axis=1) - points.mean(axis=0), axis=1).argmin()
    return points, np.delete(trias, middle, axis=0)


def with_one_twice(points, trias, border_nodes):
    return points, np.concatenate([trias, trias[:1]])


def upside_down(points, trias, border_nodes):
    return points, np.ascontiguousarray(trias[:, ::-1])


def with_a_node_astray(points, trias, border_nodes):
    points = points.copy()
    points[-1] += (9.0, 9.0, 0.0)
    return points, trias


def lifted_off(points, trias, border_nodes):
    points = points.copy()
    points[border_nodes:, 2] += 0.5
    return points, trias


def not_even_a_mesh(points, trias, border_nodes):
    raise RemeshError("no")


@pytest.mark.parametrize("bend", [lambda mesh: mesh, cylinder], ids=["plane", "cylinder"])
@pytest.mark.parametrize(
    "spoil", [without_middle, with_one_twice, upside_down, with_a_node_astray, not_even_a_mesh]
)
def test_what_the_remesher_spoils_is_not_put_in(spoil, bend, monkeypatch):
    patch = patch_of(bend(sheet(6, 6, seed=1, trias=0.3)))

    def spoiled(points, trias, border, size):
        return spoil(*remesh_isotropic(points, trias, border, size), patch.border_nodes)

    assert anew(patch) is not None
    monkeypatch.setattr("meshops.remeshing.SMOOTHING_SWEEPS", 0)
    assert anew(patch, spoiled) is None


def test_what_lies_off_the_surface_is_brought_back():
    patch = patch_of(cylinder(sheet(6, 6)))

    def spoiled(points, trias, border, size):
        return lifted_off(*remesh_isotropic(points, trias, border, size), patch.border_nodes)

    points, _ = anew(patch, spoiled)
    surface = patch.points[PatchSurface.of(patch.points, patch.elements).trias]
    for point in points:
        assert distances_to_trias(point, surface).min() < 1e-9


SQUARE = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float)
HALVES = np.array([(0, 1, 2), (0, 2, 3)], np.int32)
RIM = np.array([(0, 1), (1, 2), (2, 3), (3, 0)], np.int32)


@pytest.mark.parametrize("size", [0.0, -1.0, np.nan, np.inf, 1e-9])
def test_sizes_that_make_no_mesh_are_refused(size):
    with pytest.raises(RemeshError, match=r"finite|large"):
        remesh_isotropic(SQUARE, HALVES, RIM, size)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e30, 1e200])
def test_coordinates_that_make_no_mesh_are_refused(value):
    points = SQUARE.copy()
    points[2, 1] = value
    with pytest.raises(RemeshError, match=r"finite|large"):
        remesh_isotropic(points, HALVES, RIM, 0.5)
