"""The small clean-up operations: what each does on a mesh made by hand, and that none does harm."""

import subprocess
import sys
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import STANDARD
from meshops.edit import apply
from meshops.fitness import Fitness
from meshops.mesh import ShellMesh
from meshops.operations.collapse_diagonal import CollapseDiagonal
from meshops.operations.join_trias import JoinTrias
from meshops.operations.open_diagonal import OpenDiagonal
from meshops.operations.remove_doublet import RemoveDoublet
from meshops.operations.split_quad import SplitQuad
from meshops.operations.swap_edge import SwapEdge
from meshops.workpiece import Setting, Workpiece
from tests.meshes import (
    CURVED_KINDS,
    FLAT_KINDS,
    barriers,
    corners,
    doubles,
    make,
    meshes,
    sheet,
    unsound,
    users,
    with_,
)
from tests.wholeness import (
    assert_ids_are_kept,
    assert_nothing_locked_has_changed,
    assert_on_the_surface,
    assert_sound,
    assert_zones_are_whole,
    tried,
)

OPERATIONS = (
    SwapEdge(pool=60),
    JoinTrias(),
    SplitQuad(pool=60, picks=3),
    CollapseDiagonal(pool=60),
    OpenDiagonal(pool=40, picks=6),
    RemoveDoublet(),
)
seeds = st.integers(0, 10**6)
bounded = settings(max_examples=40, deadline=None)


def workpiece(mesh, kind="quality"):
    return Workpiece(mesh, Setting(STANDARD.at(1.0), Fitness(kind, len(mesh.elements))))


def done(operation, mesh, rank=1, variant=0):
    """The mesh after one site; the mesh itself where that is forbidden."""
    edit = operation.apply(workpiece(mesh), np.array([(rank, variant)], np.int32))
    return apply(mesh, edit)


def counts(mesh):
    """(nodes, quads, trias)."""
    trias = int(np.count_nonzero(mesh.is_tria))
    return len(mesh.points), len(mesh.elements) - trias, trias


def shapes(mesh):
    """The elements as sets of nodes."""
    return Counter(frozenset(corners(element)) for element in mesh.elements)


def ring(size, radius=1.0, *, centre=False):
    """Nodes of a regular polygon, the first to the right, and perhaps one in the middle."""
    angle = 2 * np.pi * np.arange(size) / size
    points = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle]) * radius
    return np.concatenate([points, np.zeros((int(centre), 3))])


# --- swap an edge -------------------------------------------------------------------------------


def test_the_edge_of_two_quads_turns_to_the_two_other_diagonals():
    mesh = ShellMesh.build(ring(6), [(0, 1, 2, 3), (3, 4, 5, 0)])
    turned = [set(users(done(SwapEdge(), mesh, variant=v))) - set(users(mesh)) for v in (0, 1)]
    assert sorted(turned, key=min) == [{(1, 4)}, {(2, 5)}]


def test_a_tria_beside_a_quad_changes_its_place_in_two_ways():
    mesh = ShellMesh.build(ring(5), [(0, 1, 2, 3), (3, 4, 0, -1)])
    trias = [done(SwapEdge(), mesh, variant=v) for v in (0, 1)]
    assert all(counts(after) == (5, 1, 1) for after in trias)
    places = {frozenset(corners(after.elements[after.is_tria][0])) for after in trias}
    assert places == {frozenset((4, 0, 1)), frozenset((2, 3, 4))}


def test_the_edge_of_two_trias_becomes_the_other_diagonal():
    mesh = ShellMesh.build(ring(4), [(0, 1, 2, -1), (2, 3, 0, -1)])
    assert shapes(done(SwapEdge(), mesh)) == Counter([frozenset((1, 2, 3)), frozenset((3, 0, 1))])
    assert shapes(done(SwapEdge(), mesh, variant=1)) == shapes(mesh)


def test_swapping_twice_the_same_way_round_comes_back():
    mesh = ShellMesh.build(ring(6), [(0, 1, 2, 3), (3, 4, 5, 0)])
    forth = done(SwapEdge(), mesh, variant=0)
    back = [shapes(done(SwapEdge(), forth, variant=v)) for v in (0, 1)]
    assert shapes(mesh) in back


# --- join and split -----------------------------------------------------------------------------


def test_two_trias_become_a_quad():
    mesh = ShellMesh.build(ring(4), [(0, 1, 2, -1), (2, 3, 0, -1)])
    assert shapes(done(JoinTrias(), mesh)) == Counter([frozenset(range(4))])
    assert JoinTrias().search_space(workpiece(sheet(3, 3)), np.random.default_rng(0)) is None


def test_trias_whose_quad_would_be_concave_stay():
    points = [(0, 0, 0), (2, 0, 0), (0.5, 0.5, 0), (0, 2, 0)]
    mesh = ShellMesh.build(points, [(0, 1, 2, -1), (0, 2, 3, -1)])
    assert done(JoinTrias(), mesh).digest == mesh.digest


def test_a_quad_becomes_two_trias_by_either_diagonal():
    mesh = ShellMesh.build(ring(4), [(0, 1, 2, 3)])
    cuts = [set(users(done(SplitQuad(), mesh, variant=v))) - set(users(mesh)) for v in (0, 1)]
    assert sorted(cuts, key=min) == [{(0, 2)}, {(1, 3)}]


# --- collapse and open --------------------------------------------------------------------------


def test_a_collapsed_quad_takes_one_node_with_it():
    mesh = sheet(5, 5)
    after = [
        done(CollapseDiagonal(), mesh, rank, variant) for rank in (7, 13) for variant in (0, 1)
    ]
    assert {counts(mesh) for mesh in after} == {(35, 24, 0)}


def quad_in_the_middle():
    """A rhombus in a square: (0, 2) is its short diagonal, both ends inside."""
    inner = np.array([(0, -0.3, 0), (0.8, 0, 0), (0, 0.3, 0), (-0.8, 0, 0)])
    outer = np.array([(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)])
    elements = [(0, 1, 2, 3), (4, 5, 1, 0), (5, 6, 2, 1), (6, 7, 3, 2), (7, 4, 0, 3)]
    return ShellMesh.build(np.concatenate([inner, outer]), elements)


def collapsed(mesh):
    """The meshes that collapsing the element in row 0 leads to."""
    found = CollapseDiagonal().candidates(workpiece(mesh))
    first = np.nonzero(found.removed == 0)[0]
    owner = np.searchsorted(found.removed_start, first, side="right") - 1
    variants = {(int(k) // 2 + 1, int(k) % 2) for k in owner if k // 2 == owner[0] // 2}
    return [done(CollapseDiagonal(), mesh, *site) for site in sorted(variants)]


def test_locked_nodes_stay_where_a_diagonal_collapses():
    mesh = quad_in_the_middle()
    locked = with_(mesh, locked_nodes=np.arange(8) == 2)
    for after in collapsed(locked):
        assert tuple(mesh.points[2]) in set(map(tuple, after.points))
    both = with_(mesh, locked_nodes=np.isin(np.arange(8), (0, 1, 2)))
    assert all(mesh.points[[0, 1, 2]].tolist() <= m.points.tolist() for m in collapsed(both))


@pytest.mark.parametrize(("valence", "after"), [(4, (3, 3)), (5, (3, 4)), (6, (4, 4))])
def test_an_opened_node_is_two_with_about_half_of_its_elements_each(valence, after):
    outer = ring(2 * valence, 2.0, centre=True)
    middle = 2 * valence
    quads = [(middle, 2 * i, 2 * i + 1, (2 * i + 2) % (2 * valence)) for i in range(valence)]
    mesh = ShellMesh.build(outer, quads)
    opened = done(OpenDiagonal(), mesh)
    assert counts(opened) == (2 * valence + 2, valence + 1, 0)
    uses = Counter(opened.elements.ravel().tolist())
    inner = [k for k in uses if np.linalg.norm(opened.points[k]) < 1.5]
    assert tuple(sorted(uses[k] for k in inner)) == after


def test_collapsing_what_was_opened_gives_the_mesh_back():
    outer = ring(12, 2.0, centre=True)
    mesh = ShellMesh.build(outer, [(12, 2 * i, 2 * i + 1, (2 * i + 2) % 12) for i in range(6)])
    opened = done(OpenDiagonal(), mesh)
    found = CollapseDiagonal().candidates(workpiece(opened))
    back = [
        done(CollapseDiagonal(), opened, rank, variant)
        for rank in range(1, len(found) // 2 + 1)
        for variant in (0, 1)
    ]
    assert shapes(mesh) in [shapes(after) for after in back]


# --- doublets -----------------------------------------------------------------------------------


def test_a_doublet_of_quads_becomes_one_quad():
    mesh = ShellMesh.build(ring(4, centre=True), [(0, 1, 2, 4), (4, 2, 3, 0)])
    after = done(RemoveDoublet(), mesh)
    assert counts(after) == (4, 1, 0)
    assert shapes(after) == Counter([frozenset(range(4))])


def test_a_doublet_of_a_quad_and_a_tria_becomes_a_tria():
    mesh = ShellMesh.build(ring(3, centre=True), [(0, 1, 2, 3), (3, 2, 0, -1)])
    assert counts(done(RemoveDoublet(), mesh)) == (3, 0, 1)


def test_a_locked_doublet_stays():
    mesh = ShellMesh.build(
        ring(4, centre=True), [(0, 1, 2, 4), (4, 2, 3, 0)], locked_nodes=np.arange(5) == 4
    )
    assert done(RemoveDoublet(), mesh).digest == mesh.digest


# --- relaxing -----------------------------------------------------------------------------------


def test_nodes_around_relax():
    """The node between three squashed quads and a wide one moves to the middle."""
    mesh = sheet(2, 2)
    points = mesh.points.copy()
    points[4, :2] = 0.6
    after = done(SplitQuad(), with_(mesh, points=points))
    assert np.linalg.norm(after.points[4] - (1, 1, 0)) < 0.4 * np.sqrt(2) / 2


def test_the_search_turns_an_edge_that_is_the_wrong_way():
    """In a regular sheet one edge was turned: the greedy genome turns it back."""
    mesh = sheet(4, 3)
    row = {tuple(sorted(corners(e))): i for i, e in enumerate(mesh.elements)}
    one, two = row[6, 7, 11, 12], row[7, 8, 12, 13]
    elements = mesh.elements.copy()
    elements[one], elements[two] = (6, 7, 8, 13), (13, 12, 11, 6)
    points = mesh.points.copy()
    points[[7, 12], 1] += (-0.2, 0.2)
    piece = workpiece(with_(mesh, points=points, elements=elements))
    space = SwapEdge().search_space(piece, np.random.default_rng(0))
    genome = space.draw(np.random.default_rng(0), 1)[0]
    before, after = piece.fitness(np.stack([piece.tally, space.tally(genome)]))
    assert after > before
    mended = apply(piece.mesh, SwapEdge().apply(piece, space.parameters(genome)))
    assert {(7, 12)} <= set(users(mended))


# --- what every operation must leave whole ------------------------------------------------------


@bounded
@given(meshes(FLAT_KINDS), st.sampled_from(OPERATIONS), seeds)
def test_flat_parts_keep_all_that_they_must(mesh, operation, seed):
    for after, _ in tried(operation, workpiece(mesh), seed):
        assert_sound(after)
        assert_nothing_locked_has_changed(mesh, after)
        assert_ids_are_kept(mesh, after)
        assert barriers(after) == barriers(mesh)
        assert_zones_are_whole(mesh, after, area=1e-9)
        assert_on_the_surface(mesh, after, tolerance=1e-9)


@bounded
@given(meshes(CURVED_KINDS), st.sampled_from(OPERATIONS), seeds)
def test_curved_parts_keep_all_that_they_must(mesh, operation, seed):
    for after, _ in tried(operation, workpiece(mesh), seed):
        assert_sound(after)
        assert_ids_are_kept(mesh, after)
        assert barriers(after) == barriers(mesh)
        assert_zones_are_whole(mesh, after, area=0.1)
        assert_on_the_surface(mesh, after, tolerance=1e-9)


@bounded
@given(meshes(FLAT_KINDS + CURVED_KINDS), st.sampled_from(OPERATIONS), seeds)
def test_the_predicted_tally_is_that_of_the_mesh(mesh, operation, seed):
    for after, tally in tried(operation, workpiece(mesh), seed):
        np.testing.assert_allclose(workpiece(after).tally, tally, rtol=1e-9, atol=1e-8)


@bounded
@given(meshes(FLAT_KINDS), seeds)
def test_doublets_are_removed_and_all_else_is_kept(mesh, seed):
    mesh = with_a_doublet(mesh, seed)
    for after, tally in tried(RemoveDoublet(), workpiece(mesh), seed):
        assert len(unsound(after)) <= len(unsound(mesh))
        assert doubles(after) == []
        assert_nothing_locked_has_changed(mesh, after)
        assert barriers(after) == barriers(mesh)
        assert_zones_are_whole(mesh, after, area=None)
        np.testing.assert_allclose(workpiece(after).tally, tally, rtol=1e-9, atol=1e-8)


@bounded
@given(meshes(FLAT_KINDS + CURVED_KINDS), st.sampled_from(OPERATIONS), st.integers(1, 20), seeds)
def test_a_smaller_pool_has_the_first_places_of_a_larger_one(mesh, operation, pool, seed):
    piece = workpiece(with_a_doublet(mesh, seed))
    every = operation.candidates(piece)
    few = replace(operation, pool=pool).candidates(piece)
    assert len(few) == min(len(every), pool * operation.variants)
    first = every.take(np.arange(len(few), dtype=np.int32))
    for one, other in zip(few.arrays, first.arrays, strict=True):
        np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("operation", OPERATIONS, ids=lambda operation: operation.name)
def test_every_operation_finds_something_to_do(operation):
    """So that the properties above speak of edits and not of nothing."""
    edits = 0
    for seed in range(20):
        mesh = with_a_doublet(make("holes", seed), seed)
        found = tried(operation, workpiece(mesh), 0)
        edits += sum(after.digest != mesh.digest for after, _ in found)
    assert edits >= 10


def with_a_doublet(mesh, seed):
    """A quad, where there is one, becomes two with a new node in it."""
    quads = np.nonzero(~mesh.is_tria & ~mesh.locked_elements)[0]
    if not len(quads):
        return mesh
    rng = np.random.default_rng(seed)
    row = rng.choice(quads)
    a, b, c, d = mesh.elements[row]
    n = len(mesh.points)
    elements = np.concatenate([mesh.elements, [(a, n, c, d)]])
    elements[row] = (a, b, c, n)
    inside = rng.dirichlet(np.full(4, 9.0)) @ mesh.points[[a, b, c, d]]
    return ShellMesh.build(
        np.concatenate([mesh.points, inside[None]]),
        elements,
        region=np.append(mesh.region, mesh.region[row]),
        locked_nodes=np.append(mesh.locked_nodes, False),
        locked_elements=np.append(mesh.locked_elements, False),
    )


def digests():
    """What the operations make of some meshes."""
    return [
        after.digest
        for kind in ("plain", "slit", "cylinder")
        for operation in OPERATIONS
        for after, _ in tried(operation, workpiece(make(kind, 11)), 5)
    ]


def test_a_fresh_process_gives_the_same_meshes():
    code = "from tests.test_local_operations import digests; print(*digests())"
    fresh = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=120
    )
    assert fresh.stdout.split() == digests()
    assert len(set(digests())) > 10
