"""Cavities in the core, around elements and nodes: bit for bit what the compiled Python gave."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops import _core
from meshops.criteria import STANDARD
from meshops.fitness import Fitness
from meshops.kernels import outlines, pillows
from meshops.operations.places import crossable_pairs
from meshops.operations.ragged import alternatives, starts
from meshops.operations.templates import triples
from meshops.workpiece import Setting, Workpiece
from tests.meshes import CURVED_KINDS, FLAT_KINDS, make, meshes

ALL_KINDS = FLAT_KINDS + CURVED_KINDS
seeds = st.integers(0, 10**6)


def workpiece(mesh):
    return Workpiece(mesh, Setting(STANDARD.at(1.0), Fitness("quality", len(mesh.elements))))


def groups(piece, rng):
    """One element, two and three that are adjacent, and three that are anywhere."""
    rows = np.arange(len(piece.mesh.elements), dtype=np.int32)
    two = crossable_pairs(piece)
    three = triples(piece.topology, rows)
    anywhere = rng.integers(-1, len(rows), (60, 3)).astype(np.int32)
    found = np.full((len(rows) + len(two), 3), -1, np.int32)
    found[: len(rows), 0], found[len(rows) :, :2] = rows, two
    return np.concatenate([found, three, anywhere])


def sets(piece, rng):
    """Single elements, those around each node, and some that are anywhere."""
    rows = np.arange(len(piece.mesh.elements), dtype=np.int32)
    start, around = piece.around
    anywhere = rng.permutation(rows)
    lengths = np.concatenate([np.ones(len(rows)), np.diff(start), [len(rows) // 3]])
    return (
        starts(lengths.astype(np.int32)),
        np.concatenate([rows, around, anywhere[: len(rows) // 3]]),
    )


def assert_same(found, expected):
    for one, other in zip(found, expected, strict=True):
        assert one.dtype == other.dtype
        np.testing.assert_array_equal(one, other, strict=True)


@settings(max_examples=60, deadline=None)
@given(meshes(ALL_KINDS), seeds)
def test_cavity_polygons(mesh, seed):
    chosen = groups(workpiece(mesh), np.random.default_rng(seed))
    polygons, sizes = _core.cavity_polygons(mesh.elements, chosen)
    old_polygons, old_sizes = outlines.outlines(mesh.elements, chosen)
    # what the compiled Python had of a polygon that is none is left out
    old_polygons[old_sizes == 0] = -1
    assert_same((polygons, sizes), (old_polygons, old_sizes))


@settings(max_examples=60, deadline=None)
@given(meshes(ALL_KINDS), seeds)
def test_pillow(mesh, seed):
    piece = workpiece(mesh)
    topology = piece.topology
    chosen = sets(piece, np.random.default_rng(seed))
    found = _core.pillow(chosen, mesh.points, mesh.elements, topology.graph)
    elements, points = pillows.pillow(
        *chosen, mesh.points, mesh.elements, topology.element_edges, topology.edge_elements
    )
    assert_same((*chosen, *found), (*elements, *points))


@settings(max_examples=60, deadline=None)
@given(meshes(ALL_KINDS))
def test_node_removal(mesh):
    piece = workpiece(mesh)
    nodes = np.nonzero(piece.topology.inner_nodes)[0].astype(np.int32)
    rows, ways = alternatives(len(nodes), _core.FILLINGS)
    assert_same(
        _core.remove_nodes(nodes[rows], ways, mesh.elements, piece.around),
        pillows.take_out(nodes[rows], ways, mesh.elements, *piece.around),
    )


@settings(max_examples=30, deadline=None)
@given(meshes(ALL_KINDS))
def test_any_node_may_be_asked_for(mesh):
    piece = workpiece(mesh)
    nodes = np.arange(len(mesh.points), dtype=np.int32)
    _core.remove_nodes(nodes, np.zeros_like(nodes), mesh.elements, piece.around)


def test_arguments_that_do_not_fit():
    mesh = make("plain", 1)
    piece = workpiece(mesh)
    nobody = np.array([10**6], np.int32)
    zero = np.zeros(1, np.int32)
    with pytest.raises(ValueError, match="element"):
        _core.cavity_polygons(mesh.elements, np.array([[0, 10**6, -1]], np.int32))
    with pytest.raises(ValueError, match="rows of 3"):
        _core.cavity_polygons(mesh.elements, np.zeros((1, 2), np.int32))
    one = np.array([0, 1], np.int32)
    with pytest.raises(ValueError, match="row"):
        _core.pillow((one, nobody), mesh.points, mesh.elements, piece.topology.graph)
    with pytest.raises(ValueError, match="lists"):
        _core.pillow((zero, zero), mesh.points, mesh.elements, piece.topology.graph)
    with pytest.raises(ValueError, match="elements"):
        _core.pillow((one, zero), mesh.points, mesh.elements[1:], piece.topology.graph)
    with pytest.raises(ValueError, match="node"):
        _core.remove_nodes(nobody, zero, mesh.elements, piece.around)
    with pytest.raises(ValueError, match="way"):
        _core.remove_nodes(zero, zero + _core.FILLINGS, mesh.elements, piece.around)
    with pytest.raises(ValueError, match="way"):
        _core.remove_nodes(zero, zero - 1, mesh.elements, piece.around)
