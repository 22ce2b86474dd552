"""Strips in the core: what was recorded of them, and what always holds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops import _core
from meshops.criteria import STANDARD
from meshops.fitness import Fitness
from meshops.operations.ragged import alternatives
from meshops.operations.strips import Strips
from meshops.workpiece import Setting, Workpiece
from tests.core.recorded import digest, outline
from tests.meshes import CURVED_KINDS, FLAT_KINDS, annulus, make, meshes, sheet

ALL_KINDS = FLAT_KINDS + CURVED_KINDS
limits = st.integers(0, 9)


def workpiece(mesh):
    return Workpiece(mesh, Setting(STANDARD.at(1.0), Fitness("quality", len(mesh.elements))))


def editable_trias(piece):
    return np.nonzero(piece.mesh.is_tria & piece.topology.editable)[0].astype(np.int32)


def straight_and_closed(piece):
    straight = Strips.straight(piece, editable_trias(piece), reach=8, steps=3)
    return straight + Strips.closed(piece)


def open_strips(piece):
    """Straight ones, and such as turn."""
    trias = editable_trias(piece)
    straight = Strips.straight(piece, trias, reach=8, steps=3)
    return straight + Strips.walks(piece, trias, reach=5, steps=2, partners=4)


def each(strips):
    """Cells and rungs of each strip."""
    for first, last in zip(strips.start[:-1], strips.start[1:], strict=True):
        yield strips.cells[first:last], strips.rungs[first:last]


RECORDED = sheet(14, 11, seed=5, jitter=0.2, trias=0.15, holes=0.04)


def test_strips_are_those_recorded():
    piece = workpiece(RECORDED)
    elements, topology, trias = RECORDED.elements, piece.topology, editable_trias(piece)
    straight = _core.straight_strips(elements, topology, trias, 8, 3)
    assert digest(*straight) == "7d703f6a1d3e91c5"
    shortest = _core.shortest_strips(elements, topology, trias, 6, 2, 4)
    assert digest(*shortest) == "5f4d368cfddedf49"
    ring = annulus(around=16, rings=4)
    closed = _core.closed_strips(ring.elements, workpiece(ring).topology)
    assert digest(*closed) == "b0b39a114be2b7d5"


def test_what_is_done_along_strips_is_what_is_recorded():
    mesh, piece = RECORDED, workpiece(RECORDED)
    strips = open_strips(piece)
    rows, ways = alternatives(len(strips), 3)
    walked = _core.transport_trias(strips.take(rows), ways, mesh.points, mesh.elements)
    assert digest(*walked) == "7e2bd091cf55208f"
    rows, ends = alternatives(len(strips), 2)
    doubled = _core.insert_chords(strips.take(rows), ends, mesh.points, mesh.elements)
    assert digest(*doubled) == "32c456ab5c220abb"
    free = piece.topology.free_nodes
    merged = _core.collapse_chords(strips, mesh.points, mesh.elements, piece.around, free)
    assert digest(*merged) == "8f91b45348f2a6b5"


@settings(max_examples=40, deadline=None)
@given(meshes(ALL_KINDS), limits, st.integers(0, 4))
def test_straight_strips_cross_quads_from_side_to_opposite_side(mesh, reach, steps):
    piece = workpiece(mesh)
    for cells, rungs in each(
        Strips.straight(piece, editable_trias(piece), reach=reach, steps=steps)
    ):
        joins = mesh.is_tria[cells[-1]]
        assert len(cells) - 2 <= max(reach, steps) if joins else len(cells) - 1 <= steps
        assert mesh.is_tria[cells].sum() == 1 + joins
        for row, before, after in zip(cells[1:-1], rungs, rungs[1:], strict=False):
            assert sorted((*before, *after)) == sorted(mesh.elements[row])


@settings(max_examples=40, deadline=None)
@given(meshes(ALL_KINDS), limits, st.integers(0, 4), st.integers(0, 6))
def test_shortest_strips_keep_to_their_limits(mesh, reach, steps, partners):
    piece = workpiece(mesh)
    trias = editable_trias(piece)
    found = Strips.walks(piece, trias, reach=reach, steps=steps, partners=partners)
    pairs = []
    for cells, _ in each(found):
        joins = mesh.is_tria[cells[-1]]
        assert 1 <= len(cells) - 2 <= max(reach, steps) if joins else len(cells) - 1 <= steps
        assert not mesh.is_tria[cells[1:-1]].any()
        if joins:
            pairs.append(frozenset((int(cells[0]), int(cells[-1]))))
    assert len(set(pairs)) == len(pairs)
    assert len(pairs) <= partners * len(trias)


@settings(max_examples=40, deadline=None)
@given(meshes(ALL_KINDS))
def test_what_a_tria_walks_through_keeps_its_outline_and_has_no_element_more(mesh):
    strips = open_strips(workpiece(mesh))
    for way in range(3):
        ways = np.full(len(strips), way, np.int32)
        start, added = _core.transport_trias(strips, ways, mesh.points, mesh.elements)
        for k, (cells, _) in enumerate(each(strips)):
            after = added[start[k] : start[k + 1]]
            joins = mesh.is_tria[cells[-1]]
            assert len(after) == len(cells) - joins
            assert np.count_nonzero(after[:, 3] < 0) == 1 - joins
            assert outline(after) == outline(mesh.elements[cells])


@settings(max_examples=40, deadline=None)
@given(meshes(ALL_KINDS))
def test_a_strip_that_is_split_keeps_its_outline(mesh):
    strips = straight_and_closed(workpiece(mesh))
    for end in range(2):
        ends = np.full(len(strips), end, np.int32)
        elements, places = _core.insert_chords(strips, ends, mesh.points, mesh.elements)
        _, removed, start, added = elements
        assert places[0][-1] == len(places[1])
        for k, (cells, rungs) in enumerate(each(strips)):
            after = added[start[k] : start[k + 1]]
            is_open = rungs[-1, 0] < 0
            in_quad = not mesh.is_tria[cells[-1]] and is_open
            if end == 1 and not in_quad:
                assert not len(after)
                continue
            assert outline(after) == outline(mesh.elements[cells])
            trias = mesh.is_tria[cells].sum()
            assert np.count_nonzero(after[:, 3] < 0) == (1 if in_quad else 0)
            assert len(after) == 2 * len(cells) - trias
        if end == 0:
            np.testing.assert_array_equal(removed, strips.cells)


@settings(max_examples=40, deadline=None)
@given(meshes(ALL_KINDS))
def test_a_row_that_is_taken_out_leaves_the_outline_around_it(mesh):
    piece = workpiece(mesh)
    strips = straight_and_closed(piece)
    free = piece.topology.free_nodes
    elements, moves = _core.collapse_chords(strips, mesh.points, mesh.elements, piece.around, free)
    removed_start, removed, start, added = elements
    moved_start, moved, _ = moves
    assert free[moved].all()
    for k, (cells, rungs) in enumerate(each(strips)):
        gone = removed[removed_start[k] : removed_start[k + 1]]
        after = added[start[k] : start[k + 1]]
        if not len(gone):
            assert not len(after)
            continue
        assert set(gone) >= set(cells)
        assert len(gone) - len(after) >= len(cells) - (rungs[-1, 0] < 0)
        nodes = rungs[rungs[:, 0] >= 0]
        assert moved_start[k + 1] - moved_start[k] == free[nodes].all(axis=1).sum()


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
