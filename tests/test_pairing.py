"""Pairing trias to quads, against rustworkx's maximum matching."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from meshops._core import (
    greedy_matching,
    maximum_matching,
    merge_pairs,
    pair_shapes,
    split_quads,
    tria_neighbours,
)
from meshops.mesh import ShellMesh
from meshops.remeshing import recombine
from tests.meshes import CURVED_KINDS, PLANE_KINDS, area_vectors, meshes, sides, unsound

seeds = st.integers(0, 10**6)
bounded = settings(max_examples=100, deadline=None)


def greatest(neighbours):
    """How many pairs the best matching has, found by another program."""
    rustworkx = pytest.importorskip("rustworkx")
    graph = rustworkx.PyGraph()
    graph.add_nodes_from(range(len(neighbours)))
    edges = {(t, int(o)) for t, row in enumerate(neighbours) for o in row if o > t}
    graph.add_edges_from([(a, b, 1) for a, b in edges])
    return len(rustworkx.max_weight_matching(graph, max_cardinality=True))


def assert_matching(neighbours, mate):
    """Each is the mate of its mate, which is its neighbour."""
    paired = np.nonzero(mate >= 0)[0]
    assert np.array_equal(mate[mate[paired]], paired)
    assert all(mate[t] in neighbours[t] for t in paired)


def random_graph(seed):
    """A table of neighbours, three at most: -1 where there is none, in any place."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(1, 60))
    neighbours = np.full((count, 3), -1, np.int32)
    places = rng.permutation(3 * count)
    # few long chains, many odd cycles: how many links are tried decides it
    links = int(rng.integers(0, 1 + 3 * count // 2))
    for one, two in places[: 2 * links].reshape(-1, 2):
        a, b = one // 3, two // 3
        if a != b and b not in neighbours[a]:
            neighbours.flat[one], neighbours.flat[two] = b, a
    shapes = np.full((count, 3), -2.0)
    for a, row in enumerate(neighbours):
        for k, b in enumerate(row):
            if b > a:
                shapes[a, k] = shapes[b, list(neighbours[b]).index(a)] = rng.uniform(-1, 1)
    return neighbours, shapes


def random_trias(seed):
    """A Delaunay mesh of random points, with some of its trias taken away."""
    rng = np.random.default_rng(seed)
    plane = rng.random((int(rng.integers(4, 80)), 2))
    points = np.column_stack([plane, np.zeros(len(plane))])
    trias = Delaunay(plane).simplices.astype(np.int32)
    return points, np.ascontiguousarray(trias[rng.random(len(trias)) < rng.choice([0.6, 0.9, 1.0])])


@bounded
@given(seeds, st.sampled_from([-2.0, 0.5, 2.0]))
def test_a_matching_of_a_graph_is_as_large_as_can_be(seed, least):
    neighbours, shapes = random_graph(seed)
    start = greedy_matching(neighbours, shapes, least)
    assert_matching(neighbours, start)
    mate = maximum_matching(neighbours, shapes, start)
    assert_matching(neighbours, mate)
    assert np.count_nonzero(mate >= 0) == 2 * greatest(neighbours)
    # whoever had a mate still has one
    assert (mate[start >= 0] >= 0).all()


@bounded
@given(seeds)
def test_a_matching_of_trias_is_as_large_as_can_be(seed):
    points, trias = random_trias(seed)
    neighbours = tria_neighbours(trias, len(points))
    shapes = pair_shapes(points, trias, neighbours)
    mate = maximum_matching(neighbours, shapes, greedy_matching(neighbours, shapes, 0.5))
    assert_matching(neighbours, mate)
    assert np.count_nonzero(mate >= 0) == 2 * greatest(neighbours)


def test_an_odd_cycle_is_matched_through_its_blossom():
    """A pentagon with a tail at two of its nodes: greedy pairs in the ring must be given up."""
    ring = [(0, 1), (1, 2), (2, 3), (3, 4), (4, 0), (0, 5), (2, 6), (5, 7)]
    neighbours = np.full((8, 3), -1, np.int32)
    for a, b in ring:
        neighbours[a, list(neighbours[a]).index(-1)] = b
        neighbours[b, list(neighbours[b]).index(-1)] = a
    mate = maximum_matching(neighbours, np.zeros((8, 3)), np.full(8, -1, np.int32))
    assert_matching(neighbours, mate)
    assert (mate >= 0).all()


@bounded
@given(seeds)
def test_neighbours_share_a_side(seed):
    points, trias = random_trias(seed)
    neighbours = tria_neighbours(trias, len(points))
    owner = {side: t for t, tria in enumerate(trias) for side in sides(tria)}
    expected = [[owner.get(side[::-1], -1) for side in sides(tria)] for tria in trias]
    assert neighbours.tolist() == expected


@bounded
@given(seeds)
def test_quads_have_the_sides_of_their_trias_and_cover_the_same(seed):
    points, trias = random_trias(seed)
    if not len(trias):
        return
    elements = recombine(points, trias)
    before = ShellMesh.build(points, np.insert(trias, 3, -1, axis=1))
    after = ShellMesh.build(points, elements)
    old, new = (
        Counter(side for element in mesh.elements for side in sides(element))
        for mesh in (before, after)
    )
    # only the side between two trias of a pair is gone, in both directions
    assert new <= old
    gone = old - new
    assert gone == Counter(side[::-1] for side in gone.elements())
    assert gone.total() == 2 * np.count_nonzero(~after.is_tria)
    assert area_vectors(after).sum(axis=0) == pytest.approx(area_vectors(before).sum(axis=0))
    # no pair makes a concave quad, and Delaunay trias are sound as far as the plane goes
    assert unsound(before) or not unsound(after)


def test_shape_is_the_sine_of_the_worst_corner():
    def shape(*corners):
        points = np.insert(np.array(corners, float), 2, 0.0, axis=1)
        trias = np.array([(0, 1, 2), (0, 2, 3)], np.int32)
        shapes = pair_shapes(points, trias, tria_neighbours(trias, 4))
        assert shapes[0, 2] == shapes[1, 0]
        assert np.count_nonzero(shapes == -2.0) == 4
        return shapes[0, 2]

    assert shape((0, 0), (3, 0), (3, 1), (0, 1)) == pytest.approx(1.0)
    assert shape((0, 0), (2, 0), (3, 1), (1, 1)) == pytest.approx(np.sqrt(0.5))
    assert shape((0, 0), (2, 0), (1, 1), (0, 2)) == pytest.approx(0.0)
    assert shape((0, 0), (2, 0), (0.5, 0.5), (0, 2)) < 0
    assert shape((0, 0), (1, 0), (0, 0), (0, 1)) == -1.0


@bounded
@given(meshes(PLANE_KINDS + CURVED_KINDS), seeds)
def test_split_quads_cover_the_same_and_leave_the_rest(mesh, seed):
    chosen = np.random.default_rng(seed).random(len(mesh.elements)) < 0.5
    elements = split_quads(mesh.points, mesh.elements, chosen)
    after = ShellMesh.build(mesh.points, elements)
    split = chosen & ~mesh.is_tria
    assert len(elements) == len(mesh.elements) + np.count_nonzero(split)
    kept = {tuple(element) for element in mesh.elements[~split].tolist()}
    assert kept <= {tuple(element) for element in elements.tolist()}
    np.testing.assert_allclose(
        area_vectors(after).sum(axis=0), area_vectors(mesh).sum(axis=0), atol=1e-12
    )


def test_a_quad_is_split_along_its_better_diagonal():
    points = np.array([(0, 0, 0), (3, 0, 0), (4, 1, 0), (1, 1, 0)], float)
    quad = np.array([(0, 1, 2, 3)], np.int32)
    halves = split_quads(points, quad, np.array([True]))
    assert {frozenset(half[:3]) for half in halves.tolist()} == {
        frozenset((0, 1, 3)), frozenset((1, 2, 3))
    }  # fmt: skip


def test_a_pair_becomes_one_quad_and_a_lone_tria_stays():
    trias = np.array([(0, 1, 2), (0, 2, 3), (3, 2, 4)], np.int32)
    mate = np.array([1, 0, -1], np.int32)
    elements = merge_pairs(trias, tria_neighbours(trias, 5), mate)
    assert sorted(map(len, (set(e) - {-1} for e in elements.tolist()))) == [3, 4]
    assert set(sides(elements[0])) == {(0, 1), (1, 2), (2, 3), (3, 0)}
