"""Reference: the surface of the first mesh around a patch, whatever became of the mesh since."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.edit import apply
from meshops.operations import Smooth
from meshops.patch import components, extract
from meshops.reference import Reference
from meshops.topology import topology
from meshops.workpiece import Workpiece
from tests.jobs import setting_of
from tests.measures import distances_to_trias, trias_of
from tests.meshes import (
    CURVED_KINDS,
    cylinder,
    folded,
    joined,
    meshes,
    paraboloid,
    partly_flipped,
    shaped,
    sheet,
    with_,
)


def patch_of(mesh, *, near=None, elements=9):
    """The elements nearest to a place as a patch; without one, the whole of the first part."""
    found = topology(mesh)
    chosen = np.ones(len(mesh.elements), bool)
    if near is not None:
        middles = np.array([mesh.points[e[e >= 0]].mean(axis=0) for e in mesh.elements])
        order = np.argsort(np.linalg.norm(middles - near, axis=1), kind="stable")
        chosen[order[elements:]] = False
    return extract(found, components(found, chosen)[0])


def places(points):
    return set(map(tuple, points))


def test_under_a_plane_patch_is_its_own_plane():
    mesh = sheet(8, 8, jitter=0.2, trias=0.3)
    patch = patch_of(mesh, near=(4, 4, 0))
    surface = Reference(mesh, 30.0).around(patch)
    assert abs(surface.plane[2]) == pytest.approx(1.0)
    assert places(surface.points) == places(patch.points)


def test_under_a_curved_patch_are_the_trias_of_the_first_mesh_around_it():
    mesh = paraboloid(sheet(12, 12, jitter=0.15, trias=0.3))
    middle = mesh.points[84]
    patch = patch_of(mesh, near=middle)
    surface = Reference(mesh, 30.0).around(patch)
    assert surface.plane is None
    assert places(patch.points) < places(surface.points) < places(mesh.points)
    # it reaches beyond the patch, but not over the whole mesh
    reach = np.linalg.norm(patch.points - middle, axis=1).max()
    beyond = np.linalg.norm(surface.points - middle, axis=1).max()
    assert reach < beyond < 4 * reach


@settings(max_examples=25, deadline=None)
@given(meshes(CURVED_KINDS), st.integers(0, 10**6))
def test_a_patch_lies_on_the_reference_of_its_own_mesh(mesh, seed):
    found = topology(mesh)
    chosen = np.random.default_rng(seed).random(len(mesh.elements)) < 0.7
    reference = Reference(mesh, 30.0)
    for rows in components(found, chosen):
        patch = extract(found, rows)
        surface = reference.around(patch)
        trias = surface.points[surface.trias]
        for point in patch.points:
            assert distances_to_trias(point, trias).min() < 1e-9


def test_nodes_stay_on_it_however_often_they_move():
    first = cylinder(sheet(8, 8, jitter=0.25), radius=4.0)
    reference = Reference(first, 30.0)
    original = trias_of(first)
    mesh = with_(first, points=first.points)
    drifted = with_(first, points=first.points)
    for seed in range(6):
        mesh = smoothed(mesh, seed, reference.around(patch_of(mesh)))
        drifted = smoothed(drifted, seed, None)
    assert (mesh.points != first.points).any()
    farthest = max(distances_to_trias(point, original).min() for point in mesh.points)
    assert farthest < 1e-9
    assert max(distances_to_trias(point, original).min() for point in drifted.points) > farthest


def smoothed(mesh, seed, surface):
    piece = Workpiece(mesh, setting_of(mesh), surface)
    rng = np.random.default_rng(seed)
    space = Smooth().search_space(piece, rng)
    genomes = space.draw(rng, 8)
    best = genomes[np.nanargmax(piece.fitness(space.evaluate(genomes)))]
    return apply(mesh, Smooth().apply(piece, space.parameters(best)))


def two_skins(gap):
    """A thin part: a curved skin, and below it another that faces the other way."""
    upper = paraboloid(sheet(8, 8, seed=1, jitter=0.15))
    lower = shaped(
        partly_flipped(sheet(8, 8, seed=2, jitter=0.15), -1.0),
        lambda x, y: (x, y, 0.04 * ((x - 2) ** 2 + (y - 2) ** 2) - gap),
    )
    return upper, lower


@pytest.mark.parametrize("gap", [0.02, 0.2, 1.0])
def test_of_two_skins_the_one_that_the_patch_is_of(gap):
    skins = two_skins(gap)
    reference = Reference(joined(*skins), 30.0)
    for skin in skins:
        surface = reference.around(patch_of(skin, near=skin.points[40]))
        assert places(np.round(surface.points, 9)) <= places(np.round(skin.points, 9))


def test_beyond_a_feature_edge_is_another_surface():
    """A bent wing that goes straight up: a patch at the fold knows the floor alone."""
    flat = sheet(12, 6)
    bent = folded(flat, 6.0)
    curved = with_(bent, points=bent.points + np.stack([
        0 * flat.points[:, 0], 0 * flat.points[:, 0], 0.02 * flat.points[:, 1] ** 2
    ], axis=1))  # fmt: skip
    patch = patch_of(curved, near=(5.5, 3.0, 0.2), elements=4)
    assert patch.points[:, 0].max() <= 6.0
    surface = Reference(curved, 30.0).around(patch)
    floor = curved.points[flat.points[:, 0] <= 6.0]
    assert places(surface.points) <= places(floor)


def test_regions_and_feature_angle_part_the_surface_and_locks_do_not():
    mesh = cylinder(sheet(10, 6), radius=3.0)  # 19 degrees from row to row
    patch = patch_of(mesh, near=mesh.points[38], elements=2)
    everywhere = Reference(mesh, 30.0).around(patch)
    locked = with_(mesh, locked_elements=np.ones(len(mesh.elements)))
    assert places(Reference(locked, 30.0).around(patch).points) == places(everywhere.points)
    narrow = Reference(mesh, 10.0).around(patch_of(mesh, near=mesh.points[38], elements=1))
    assert len(narrow.points) < len(everywhere.points)
