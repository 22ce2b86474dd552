"""What every operation must leave whole, on random meshes of every kind."""

import subprocess
import sys
from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import STANDARD
from meshops.edit import apply
from meshops.fitness import Fitness
from meshops.mesh import NEW
from meshops.operations import Remesh, ReplaceNode
from meshops.workpiece import Setting, Workpiece
from tests.meshes import (
    CURVED_KINDS,
    FLAT_KINDS,
    barriers,
    corners,
    distances_to_trias,
    doubles,
    make,
    meshes,
    place,
    trias_of,
    unsound,
    zones,
)

REMESHES = (
    Remesh(ranges=5, reach=None),
    Remesh(ranges=2, reach=None),
    Remesh(ranges=3, reach=25),
)
REPLACES = (
    ReplaceNode(pairs=4, pool=60),
    ReplaceNode(pairs=2, pool=400, optional=False),
)
seeds = st.integers(0, 10**6)
bounded = settings(max_examples=40, deadline=None)


def workpiece(mesh, kind="quality"):
    return Workpiece(mesh, Setting(STANDARD.at(1.0), Fitness(kind, len(mesh.elements))))


def tried(operation, piece, seed, count=3):
    """(mesh after, predicted tally) of random genomes that lead to a valid mesh."""
    rng = np.random.default_rng(seed)
    space = operation.search_space(piece, rng)
    if space is None:
        return []
    genomes = space.draw(rng, 16)
    tallies = space.evaluate(genomes)
    valid = np.nonzero(np.isfinite(tallies).all(axis=1))[0][:count]
    return [
        (apply(piece.mesh, operation.apply(piece, space.parameters(genomes[row]))), tallies[row])
        for row in valid
    ]


def assert_sound(mesh):
    assert unsound(mesh) == []
    assert doubles(mesh) == []


def assert_nothing_locked_has_changed(before, after):
    def locked(mesh):
        nodes = Counter(map(tuple, mesh.points[mesh.locked_nodes]))
        elements = mesh.elements[mesh.locked_elements]
        return nodes, [[place(mesh, node) for node in corners(element)] for element in elements]

    assert locked(before) == locked(after)


def assert_ids_are_kept(before, after):
    """Old nodes and elements keep their id and their order; new ones have none."""
    for ids, old in ((after.node_ids, before.node_ids), (after.element_ids, before.element_ids)):
        kept = ids[ids != NEW]
        assert np.array_equal(kept, old[np.isin(old, kept)])


def assert_zones_are_whole(before, after, *, area, straight=False):
    """Each zone keeps outline, region, Euler number and area; its trias have its border's parity.

    The area vector of a surface follows from its border alone: a hole or a lap would change it.
    """
    old = {zone.outline: zone for zone in zones(before, straight=straight)}
    new = {zone.outline: zone for zone in zones(after, straight=straight)}
    assert old.keys() == new.keys()
    for name, zone in old.items():
        assert new[name].region == zone.region
        assert new[name].euler == zone.euler
        np.testing.assert_allclose(new[name].area_vector, zone.area_vector, atol=1e-9)
        assert new[name].area == pytest.approx(zone.area, rel=area)
        assert new[name].trias % 2 == new[name].sides % 2


def barriers_inside(mesh):
    return {edge: uses for edge, uses in barriers(mesh).items() if uses > 1}


def assert_on_the_surface(before, after, *, tolerance):
    old = set(map(tuple, before.points))
    surface = trias_of(before)
    for point in after.points:
        if tuple(point) not in old:
            assert distances_to_trias(point, surface).min() <= tolerance


@bounded
@given(meshes(FLAT_KINDS), st.sampled_from(REMESHES), seeds)
def test_remesh_of_flat_parts_keeps_all_that_it_must(mesh, operation, seed):
    for after, _ in tried(operation, workpiece(mesh), seed):
        assert_sound(after)
        assert_nothing_locked_has_changed(mesh, after)
        assert_ids_are_kept(mesh, after)
        assert barriers(after) == barriers(mesh)
        assert_zones_are_whole(mesh, after, area=1e-9)
        assert_on_the_surface(mesh, after, tolerance=1e-12)


@bounded
@given(meshes(CURVED_KINDS), st.sampled_from(REMESHES), seeds)
def test_remesh_of_curved_parts_keeps_all_that_it_must(mesh, operation, seed):
    for after, _ in tried(operation, workpiece(mesh), seed):
        assert_sound(after)
        assert_ids_are_kept(mesh, after)
        assert barriers(after) == barriers(mesh)
        assert_zones_are_whole(mesh, after, area=0.03)
        assert_on_the_surface(mesh, after, tolerance=1e-9)


@bounded
@given(meshes(FLAT_KINDS), st.sampled_from(REPLACES), seeds)
def test_merging_in_flat_parts_keeps_all_that_it_must(mesh, operation, seed):
    for after, _ in tried(operation, workpiece(mesh), seed):
        assert_sound(after)
        assert_nothing_locked_has_changed(mesh, after)
        assert_ids_are_kept(mesh, after)
        assert barriers_inside(after) == barriers_inside(mesh)
        # border edges in one line may become one: the line stays
        assert_zones_are_whole(mesh, after, area=1e-9, straight=True)


@bounded
@given(meshes(CURVED_KINDS), st.sampled_from(REPLACES), seeds)
def test_merging_in_curved_parts_keeps_all_that_it_must(mesh, operation, seed):
    for after, _ in tried(operation, workpiece(mesh), seed):
        assert_sound(after)
        assert_ids_are_kept(mesh, after)
        assert barriers_inside(after) == barriers_inside(mesh)
        assert_zones_are_whole(mesh, after, area=0.1, straight=True)


@bounded
@given(meshes(FLAT_KINDS + CURVED_KINDS), st.sampled_from(REMESHES + REPLACES), seeds)
def test_the_predicted_tally_is_that_of_the_mesh(mesh, operation, seed):
    for after, tally in tried(operation, workpiece(mesh), seed):
        np.testing.assert_allclose(workpiece(after).tally, tally, rtol=1e-9, atol=1e-8)


@settings(max_examples=20, deadline=None)
@given(meshes(FLAT_KINDS + CURVED_KINDS), st.sampled_from(REMESHES + REPLACES), seeds)
def test_the_same_input_gives_the_same_mesh(mesh, operation, seed):
    once, again = (tried(operation, workpiece(mesh), seed) for _ in range(2))
    assert [after.digest for after, _ in once] == [after.digest for after, _ in again]
    assert all(np.array_equal(a, b) for (_, a), (_, b) in zip(once, again, strict=True))


def digests():
    """What some operations make of some meshes."""
    return [
        after.digest
        for kind in ("plain", "slit", "cylinder")
        for operation in REMESHES + REPLACES
        for after, _ in tried(operation, workpiece(make(kind, 11)), 5)
    ]


def test_a_fresh_process_gives_the_same_meshes():
    code = "from tests.test_properties import digests; print(*digests())"
    fresh = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=120
    )
    assert fresh.stdout.split() == digests()
    assert len(set(digests())) > 10
