"""Rows of quads taken out and put in, and what refines or coarsens one place."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import STANDARD
from meshops.edit import apply
from meshops.fitness import Fitness
from meshops.mesh import ShellMesh
from meshops.operations.coarsen import Coarsen
from meshops.operations.collapse_chord import CollapseChord
from meshops.operations.insert_chord import InsertChord
from meshops.operations.judge import judge
from meshops.operations.refine import Refine
from meshops.operations.replace_chain import ReplaceChain
from meshops.operations.transport_tria import TransportTria
from meshops.quality_sums import TRIAS
from meshops.workpiece import Setting, Workpiece
from tests.meshes import (
    CURVED_KINDS,
    FLAT_KINDS,
    annulus,
    barriers,
    corners,
    distances_to_trias,
    doubles,
    make,
    meshes,
    place,
    sheet,
    tidy,
    trias_of,
    unsound,
    with_,
    zones,
)

OPERATIONS = (
    TransportTria(pool=60),
    ReplaceChain(pool=60),
    CollapseChord(pool=60),
    InsertChord(pool=60),
    Refine(pool=60),
    Coarsen(pool=20),
)
operations = st.sampled_from(OPERATIONS)
seeds = st.integers(0, 10**6)


def workpiece(mesh):
    return Workpiece(mesh, Setting(STANDARD.at(1.0), Fitness("quality", len(mesh.elements))))


def lens(length):
    """Two rows of quads that a row between two trias, `length` quads long, has forced apart."""
    rungs = length + 1
    middle = [(0, 0), *((i, y) for i in range(1, rungs + 1) for y in (-0.4, 0.4)), (rungs + 1, 0)]
    outer = [(i, y) for i in range(rungs + 2) for y in (-1.5, 1.5)]
    last = 2 * rungs + 1
    low = [0, *range(1, last, 2), last]
    high = [0, *range(2, last, 2), last]
    bottom = [last + 1 + 2 * i for i in range(rungs + 2)]
    elements = [(0, 1, 2, -1), (last - 2, last, last - 1, -1)]
    elements += [(i, i + 2, i + 3, i + 1) for i in range(1, last - 2, 2)]
    below = [(bottom[i], bottom[i + 1], low[i + 1], low[i]) for i in range(rungs + 1)]
    above = [(high[i], high[i + 1], bottom[i + 1] + 1, bottom[i] + 1) for i in range(rungs + 1)]
    return ShellMesh.build([(x, y, 0.0) for x, y in middle + outer], below + elements + above)


def best(mesh, operation):
    """The mesh after the valid candidate with the fewest trias; of these the first."""
    piece = workpiece(mesh)
    candidates = operation.candidates(piece)
    tallies = judge(piece, candidates)
    return apply(mesh, candidates.edit(int(np.nanargmin(tallies[:, TRIAS])), mesh.region))


def valid_edits(mesh, operation):
    """[(mesh after, predicted tally)] of all candidates that no guard forbids."""
    piece = workpiece(mesh)
    candidates = operation.candidates(piece)
    tallies = judge(piece, candidates)
    return [
        (apply(mesh, candidates.edit(k, mesh.region)), tallies[k])
        for k in range(len(candidates))
        if np.isfinite(tallies[k]).all()
    ]


def assert_whole(before, after, *, area):
    """No guard is broken: what is locked stays, and each zone keeps its border, area and Euler
    number; its trias have the parity of its border."""
    assert set(after.element_ids[unsound(after)]) <= set(before.element_ids[unsound(before)])
    assert doubles(after) == []
    assert barriers(after) == barriers(before)
    assert locked(after) == locked(before)
    old = {zone.outline: zone for zone in zones(before)}
    new = {zone.outline: zone for zone in zones(after)}
    assert old.keys() == new.keys()
    for name, zone in old.items():
        assert (new[name].region, new[name].euler) == (zone.region, zone.euler)
        np.testing.assert_allclose(new[name].area_vector, zone.area_vector, atol=1e-9)
        assert new[name].area == pytest.approx(zone.area, rel=area)
        assert new[name].trias % 2 == zone.sides % 2


def locked(mesh):
    """Places of locked nodes, and of the nodes of locked elements."""
    nodes = Counter(map(tuple, mesh.points[mesh.locked_nodes]))
    elements = mesh.elements[mesh.locked_elements]
    return nodes, [[place(mesh, node) for node in corners(element)] for element in elements]


def valences(mesh):
    return Counter(node for element in mesh.elements for node in corners(element))


@pytest.mark.parametrize("length", [0, 1, 4])
@pytest.mark.parametrize("operation", [ReplaceChain(), CollapseChord()])
def test_a_row_between_two_trias_vanishes_with_them(length, operation):
    after = best(lens(length), operation)
    assert not after.is_tria.any()
    assert len(after.elements) == 2 * (length + 2)
    middle = after.points[np.abs(after.points[:, 1]) < 1]
    np.testing.assert_allclose(middle[:, 1], 0.0, atol=1e-12)
    assert sorted(middle[:, 0].round(9)) == list(range(length + 3))


@pytest.mark.parametrize("length", [1, 4])
def test_a_row_put_in_between_two_trias_makes_quads_of_them(length):
    after = best(lens(length), InsertChord())
    assert not after.is_tria.any()
    assert len(after.elements) == 2 * (length + 2) + 2 * length + 2


def test_a_chain_that_ends_in_a_quad_takes_the_tria_there():
    mesh = lens(4)
    outcomes = [after for after, tally in valid_edits(mesh, ReplaceChain()) if tally[TRIAS] == 2]
    assert outcomes
    for after in outcomes:
        assert np.count_nonzero(after.is_tria) == 2
        assert len(after.elements) < len(mesh.elements)


def test_a_chain_meets_at_the_node_that_cannot_move():
    mesh = lens(1)
    locked = np.zeros(len(mesh.points), bool)
    locked[[1, 3]] = True
    after = best(with_(mesh, locked_nodes=locked), ReplaceChain())
    assert not after.is_tria.any()
    inner = after.points[np.abs(after.points[:, 1]) < 1, :2]
    assert set(map(tuple, inner)) == {(0.0, 0.0), (1.0, -0.4), (2.0, -0.4), (3.0, 0.0)}


def test_a_chain_is_not_closed_where_neither_node_can_move():
    mesh = lens(1)
    locked = np.zeros(len(mesh.points), bool)
    locked[[1, 2]] = True
    after = [
        tally[TRIAS] for _, tally in valid_edits(with_(mesh, locked_nodes=locked), ReplaceChain())
    ]
    assert 0 not in after


def test_closed_rows_go_one_by_one():
    mesh = annulus(around=16, rings=4)
    outcomes = valid_edits(mesh, CollapseChord())
    assert [len(after.elements) for after, _ in outcomes] == [48] * 4
    for after, _ in outcomes:
        assert not after.is_tria.any()
        assert set(map(tuple, mesh.points[:16])) <= set(map(tuple, after.points))


def test_closed_rows_are_doubled_one_by_one():
    outcomes = valid_edits(annulus(around=16, rings=4), InsertChord())
    assert [len(after.elements) for after, _ in outcomes] == [80] * 4
    assert not any(after.is_tria.any() for after, _ in outcomes)


def test_a_row_that_ends_at_a_border_stays():
    rng = np.random.default_rng(0)
    assert CollapseChord().search_space(workpiece(sheet(5, 5)), rng) is None


def test_refining_a_quad_makes_five_and_refining_around_a_node_twelve():
    outcomes = valid_edits(sheet(4, 4), Refine())
    assert Counter(len(after.elements) - 16 for after, _ in outcomes) == {4: 16, 8: 9}
    assert not any(after.is_tria.any() for after, _ in outcomes)


def test_refining_a_tria_makes_three_quads_around_it():
    mesh = ShellMesh.build([(0, 0, 0), (1, 0, 0), (0.5, 0.8, 0)], [(0, 1, 2, -1)])
    ((after, _),) = valid_edits(mesh, Refine())
    assert np.count_nonzero(~after.is_tria) == 3
    assert np.count_nonzero(after.is_tria) == 1


def test_what_refining_makes_of_a_quad_collapsing_its_ring_takes_back():
    mesh = sheet(3, 3)
    fine = next(after for after, _ in valid_edits(mesh, Refine()) if len(after.elements) == 13)
    after = best(fine, CollapseChord())
    assert len(after.elements) == 9
    assert sorted(valences(after).values()) == sorted(valences(mesh).values())


def test_three_quads_around_a_node_become_two():
    hexagon = [(np.cos(a), np.sin(a), 0.0) for a in np.arange(6) * np.pi / 3]
    cube = ShellMesh.build([*hexagon, (0, 0, 0)], [(6, 0, 1, 2), (6, 2, 3, 4), (6, 4, 5, 0)])
    outcomes = valid_edits(cube, Coarsen())
    assert [len(after.elements) for after, _ in outcomes] == [2] * 3
    assert all(len(after.points) == 6 for after, _ in outcomes)


def test_four_trias_around_a_node_become_a_quad():
    points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 0)]
    fan = ShellMesh.build(points, [(i, (i + 1) % 4, 4, -1) for i in range(4)])
    ((after, _),) = valid_edits(fan, Coarsen())
    assert len(after.elements) == 1
    assert not after.is_tria.any()


def test_a_ring_is_filled_with_fewer_elements_in_all_ways_that_differ():
    octagon = [(np.cos(a), np.sin(a), 0.0) for a in np.arange(8) * np.pi / 4]
    quads = [(8, i, i + 1, (i + 2) % 8) for i in (0, 2, 4, 6)]
    outcomes = valid_edits(ShellMesh.build([*octagon, (0, 0, 0)], quads), Coarsen())
    fillings = {
        frozenset(frozenset(corners(element)) for element in after.elements)
        for after, _ in outcomes
    }
    assert len(outcomes) == len(fillings) == 12
    assert all(len(filling) == 3 for filling in fillings)


@pytest.mark.parametrize("operation", OPERATIONS, ids=lambda operation: operation.name)
def test_there_is_nothing_to_do_where_all_is_locked(operation):
    mesh = make("plain", 3)
    mesh = with_(mesh, locked_elements=np.ones(len(mesh.elements), bool))
    assert operation.search_space(workpiece(mesh), np.random.default_rng(0)) is None


@settings(max_examples=60, deadline=None)
@given(meshes(FLAT_KINDS), operations, seeds)
def test_no_guard_is_broken_on_flat_parts(mesh, operation, seed):
    outcomes = valid_edits(mesh, operation)
    for k in np.random.default_rng(seed).permutation(len(outcomes))[:3]:
        after, tally = outcomes[k]
        assert_whole(mesh, after, area=1e-9)
        np.testing.assert_allclose(workpiece(after).tally, tally, atol=1e-8)


@settings(max_examples=30, deadline=None)
@given(meshes(CURVED_KINDS), operations, seeds)
def test_no_guard_is_broken_on_curved_parts(mesh, operation, seed):
    outcomes = valid_edits(mesh, operation)
    surface = trias_of(mesh)
    for k in np.random.default_rng(seed).permutation(len(outcomes))[:2]:
        after, tally = outcomes[k]
        assert_whole(mesh, after, area=0.05)
        for point in after.points:
            assert distances_to_trias(point, surface).min() <= 1e-9
        np.testing.assert_allclose(workpiece(after).tally, tally, atol=1e-8)


@settings(max_examples=20, deadline=None)
@given(meshes(FLAT_KINDS), operations, seeds)
def test_parameters_make_the_mesh_that_was_evaluated(mesh, operation, seed):
    piece, rng = workpiece(mesh), np.random.default_rng(seed)
    space = operation.search_space(piece, rng)
    if space is None:
        return
    for genome in space.draw(rng, 4):
        parameters = space.parameters(genome)
        after = apply(mesh, operation.apply(workpiece(mesh), parameters))
        np.testing.assert_allclose(workpiece(after).tally, space.tally(genome), atol=1e-8)


@pytest.mark.parametrize("operation", OPERATIONS, ids=lambda operation: operation.name)
def test_the_same_mesh_has_the_same_candidates(operation):
    mesh = tidy(make("holes", 12))
    one, other = (operation.candidates(workpiece(mesh)) for _ in range(2))
    assert all(np.array_equal(a, b) for a, b in zip(one.arrays, other.arrays, strict=True))
