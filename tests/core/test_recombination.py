"""Recombination in the core, against the kernels that it was ported from."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops import _core
from meshops.examples import plate
from meshops.kernels import pairing, uniting
from tests.meshes import CURVED_KINDS, PLANE_KINDS, meshes
from tests.test_pairing import random_graph, random_trias

seeds = st.integers(0, 10**6)
bounded = settings(max_examples=100, deadline=None)
same = np.testing.assert_array_equal


@bounded
@given(seeds)
def test_neighbours_shapes_and_matchings_are_those_of_the_kernel(seed):
    points, trias = random_trias(seed)
    neighbours = pairing.tria_neighbours(trias, len(points))
    same(_core.tria_neighbours(trias, len(points)), neighbours)
    shapes = pairing.pair_shapes(points, trias, neighbours)
    same(_core.pair_shapes(points, trias, neighbours), shapes)
    for least in (-1.0, 0.3, 0.7):
        mate = pairing.match_greedily(neighbours, shapes, least)
        same(_core.greedy_matching(neighbours, shapes, least), mate)
        same(
            _core.merge_pairs(trias, neighbours, mate),
            pairing.merge_pairs(trias, neighbours, mate),
        )
        same(_core.recombine(points, trias, least, 0.5), pairing.pair_up(points, trias, least, 0.5))


@bounded
@given(seeds, st.sampled_from([-2.0, 0.5, 2.0]))
def test_matchings_of_graphs_are_those_of_the_kernel(seed, least):
    neighbours, shapes = random_graph(seed)
    mate = pairing.match_greedily(neighbours, shapes, least)
    same(_core.greedy_matching(neighbours, shapes, least), mate)
    found = _core.maximum_matching(neighbours, shapes, mate)
    same(found, pairing.match_completely(neighbours, shapes, mate))


@bounded
@given(meshes(PLANE_KINDS + CURVED_KINDS), seeds)
def test_splits_are_those_of_the_kernel(mesh, seed):
    chosen = np.random.default_rng(seed).random(len(mesh.elements)) < 0.5
    same(
        _core.split_quads(mesh.points, mesh.elements, chosen),
        pairing.split_quads(mesh.points, mesh.elements, chosen),
    )
    trias = pairing.as_trias(mesh.points, mesh.elements)
    same(_core.as_trias(mesh.points, mesh.elements), trias)
    quads = pairing.pair_up(mesh.points, trias, 0.05, 0.5)
    same(_core.recombine(mesh.points, trias, 0.05, 0.5), quads)
    same(_core.unite_trias(mesh.points, quads), uniting.unite_trias(mesh.points, quads))


@bounded
@given(meshes(PLANE_KINDS + CURVED_KINDS))
def test_transport_of_trias_is_that_of_the_kernel(mesh):
    same(
        _core.unite_trias(mesh.points, mesh.elements),
        uniting.unite_trias(mesh.points, mesh.elements),
    )


def test_the_plate_is_recombined_as_by_the_kernel():
    mesh = plate()
    trias = pairing.as_trias(mesh.points, mesh.elements)
    quads = pairing.pair_up(mesh.points, trias, 0.05, 0.5)
    same(_core.recombine(mesh.points, trias, 0.05, 0.5), quads)
    same(_core.unite_trias(mesh.points, quads), uniting.unite_trias(mesh.points, quads))


def test_what_makes_no_sense_is_refused():
    points = np.zeros((3, 3))
    tria = np.array([[0, 1, 3]], np.int32)
    with pytest.raises(ValueError, match="not there"):
        _core.recombine(points, tria, 0.05, 0.5)
    with pytest.raises(ValueError, match="not there"):
        _core.as_trias(points, np.array([[0, 1, 3, -1]], np.int32))
    neighbours = np.array([[1, -1, -1], [-1, -1, -1]], np.int32)
    with pytest.raises(ValueError, match="not mutual"):
        _core.maximum_matching(neighbours, np.zeros((2, 3)), np.full(2, -1, np.int32))
    with pytest.raises(ValueError, match="above -2"):
        _core.recombine(points, np.zeros((0, 3), np.int32), -3.0, 0.5)
