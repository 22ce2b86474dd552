"""Strips in the core: bit for bit what the compiled Python gave."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops import _core
from meshops.criteria import STANDARD
from meshops.fitness import Fitness
from meshops.kernels import chords, strips, walks
from meshops.operations.ragged import alternatives
from meshops.operations.strips import Strips
from meshops.workpiece import Setting, Workpiece
from tests.meshes import CURVED_KINDS, FLAT_KINDS, annulus, make, meshes

ALL_KINDS = FLAT_KINDS + CURVED_KINDS
limits = st.integers(0, 9)


def workpiece(mesh):
    return Workpiece(mesh, Setting(STANDARD.at(1.0), Fitness("quality", len(mesh.elements))))


def ground(piece):
    """What the compiled Python took first."""
    topology = piece.topology
    return (
        piece.mesh.elements,
        topology.element_edges,
        topology.edge_elements,
        topology.crossable,
        topology.editable,
    )


def editable_trias(piece):
    return np.nonzero(piece.mesh.is_tria & piece.topology.editable)[0].astype(np.int32)


def some_strips(piece):
    """Of every kind."""
    trias = editable_trias(piece)
    found = Strips.straight(piece, trias, reach=8, steps=3)
    found += Strips.closed(piece)
    return found + Strips.walks(piece, trias, reach=5, steps=2, partners=4)


def open_strips(piece):
    found = some_strips(piece)
    return found.take(np.nonzero(found.rungs[found.start[1:] - 1, 0] < 0)[0].astype(np.int32))


def assert_same(found, expected):
    for one, other in zip(found, expected, strict=True):
        assert one.dtype == other.dtype
        np.testing.assert_array_equal(one, other, strict=True)


@settings(max_examples=60, deadline=None)
@given(meshes(ALL_KINDS), limits, st.integers(0, 4))
def test_straight_strips(mesh, reach, steps):
    piece = workpiece(mesh)
    trias = editable_trias(piece)
    assert_same(
        _core.straight_strips(mesh.elements, piece.topology, trias, reach, steps),
        strips.straight_strips(*ground(piece), trias, reach, steps),
    )


@settings(max_examples=60, deadline=None)
@given(meshes(ALL_KINDS))
def test_closed_strips(mesh):
    piece = workpiece(mesh)
    assert_same(
        _core.closed_strips(mesh.elements, piece.topology), strips.closed_strips(*ground(piece))
    )


def test_closed_strips_of_a_ring():
    piece = workpiece(annulus(around=16, rings=4))
    found = _core.closed_strips(piece.mesh.elements, piece.topology)
    assert_same(found, strips.closed_strips(*ground(piece)))
    assert len(found[0]) == 5


@settings(max_examples=60, deadline=None)
@given(meshes(ALL_KINDS), limits, st.integers(0, 4), st.integers(0, 6))
def test_shortest_strips(mesh, reach, steps, partners):
    piece = workpiece(mesh)
    trias = editable_trias(piece)
    assert_same(
        _core.shortest_strips(mesh.elements, piece.topology, trias, reach, steps, partners),
        strips.walks(*ground(piece), trias, reach, steps, partners),
    )


@settings(max_examples=60, deadline=None)
@given(meshes(ALL_KINDS))
def test_transport(mesh):
    found = open_strips(workpiece(mesh))
    rows, ways = alternatives(len(found), 3)
    walked = found.take(rows)
    assert_same(
        _core.transport_trias(walked, ways, mesh.points, mesh.elements),
        walks.transport(walked.start, walked.cells, walked.rungs, ways, mesh.points, mesh.elements),
    )


@settings(max_examples=60, deadline=None)
@given(meshes(ALL_KINDS))
def test_chord_insertion(mesh):
    found = some_strips(workpiece(mesh))
    rows, ends = alternatives(len(found), 2)
    doubled = found.take(rows)
    elements, places = _core.insert_chords(doubled, ends, mesh.points, mesh.elements)
    old_elements, old_places = chords.split_strips(
        doubled.start, doubled.cells, doubled.rungs, ends, mesh.points, mesh.elements
    )
    assert_same(elements, old_elements)
    assert_same(places, old_places)


@settings(max_examples=60, deadline=None)
@given(meshes(ALL_KINDS))
def test_chord_collapse(mesh):
    piece = workpiece(mesh)
    found = some_strips(piece)
    free = piece.topology.free_nodes
    elements, moves = _core.collapse_chords(found, mesh.points, mesh.elements, piece.around, free)
    old_elements, old_moves = chords.collapse_strips(
        found.start, found.rungs, mesh.points, mesh.elements, *piece.around, free
    )
    assert_same(elements, old_elements)
    assert_same(moves, old_moves)


# --- what does not fit together -----------------------------------------------------------------


@settings(max_examples=60, deadline=None)
@given(meshes(FLAT_KINDS), st.integers(0, 10**6))
def test_strips_that_lead_nowhere_do_no_harm(mesh, seed):
    """Rows that are there, in no order that makes sense."""
    piece, rng = workpiece(mesh), np.random.default_rng(seed)
    cells = rng.integers(0, len(mesh.elements), 12).astype(np.int32)
    rungs = rng.integers(0, len(mesh.points), (12, 2)).astype(np.int32)
    rungs[rng.random(12) < 0.3] = -1
    drawn = Strips(np.array([0, 0, 1, 5, 12], np.int32), cells, rungs)
    ways = np.array([0, 1, 1, 0], np.int32)
    _core.transport_trias(drawn, ways, mesh.points, mesh.elements)
    _core.insert_chords(drawn, ways, mesh.points, mesh.elements)
    free = piece.topology.free_nodes
    _core.collapse_chords(drawn, mesh.points, mesh.elements, piece.around, free)


@pytest.mark.parametrize(
    "wrong",
    [
        {"start": np.array([0, 3], np.int32)},
        {"start": np.array([2, 0], np.int32)},
        {"start": np.array([], np.int32)},
        {"cells": np.array([0, 10**6], np.int32)},
        {"cells": np.array([0, -1], np.int32)},
        {"rungs": np.array([[0, 10**6], [-1, -1]], np.int32)},
        {"rungs": np.array([[0, 1], [0, -1]], np.int32)},
        {"rungs": np.array([[0, 1]], np.int32)},
    ],
)
def test_strips_of_rows_that_are_not_there(wrong):
    mesh = make("plain", 1)
    right = {
        "start": np.array([0, 2], np.int32),
        "cells": np.array([0, 1], np.int32),
        "rungs": np.array([[0, 1], [-1, -1]], np.int32),
    }
    way = np.zeros(1, np.int32)
    piece = workpiece(mesh)
    wrong = Strips(**(right | wrong))
    with pytest.raises(ValueError, match=r"there|rung|lists"):
        _core.transport_trias(wrong, way, mesh.points, mesh.elements)
    with pytest.raises(ValueError, match=r"there|rung|lists"):
        _core.insert_chords(wrong, way, mesh.points, mesh.elements)
    with pytest.raises(ValueError, match=r"there|rung|lists"):
        _core.collapse_chords(
            wrong, mesh.points, mesh.elements, piece.around, piece.topology.free_nodes
        )


def test_arguments_that_do_not_fit():
    mesh = make("plain", 1)
    piece = workpiece(mesh)
    right = Strips(
        np.array([0, 2], np.int32),
        np.array([0, 1], np.int32),
        np.array([[0, 1], [-1, -1]], np.int32),
    )
    nobody = np.array([len(mesh.elements)], np.int32)
    for way in ([], [3], [-1]):
        ways = np.array(way, np.int32)
        with pytest.raises(ValueError, match="way"):
            _core.transport_trias(right, ways, mesh.points, mesh.elements)
        with pytest.raises(ValueError, match=r"way|end"):
            _core.insert_chords(right, ways, mesh.points, mesh.elements)
    with pytest.raises(ValueError, match="element"):
        _core.straight_strips(mesh.elements, piece.topology, nobody, 1, 1)
    with pytest.raises(ValueError, match="element"):
        _core.shortest_strips(mesh.elements, piece.topology, nobody, 1, 1, 1)
    with pytest.raises(ValueError, match="elements"):
        _core.closed_strips(mesh.elements[1:], piece.topology)
    start, around = piece.around
    for lists in ((start[1:], around), (start + 1, around[:1]), (start, around + 10**6)):
        with pytest.raises(ValueError, match=r"list|element"):
            _core.collapse_chords(
                right, mesh.points, mesh.elements, lists, piece.topology.free_nodes
            )
    with pytest.raises(ValueError, match="free"):
        _core.collapse_chords(
            right, mesh.points, mesh.elements, piece.around, piece.topology.free_nodes[1:]
        )
