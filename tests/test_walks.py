"""Trias that walk through quads."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import STANDARD
from meshops.edit import apply
from meshops.fitness import Fitness
from meshops.mesh import ShellMesh
from meshops.operations.judge import judge
from meshops.operations.strips import Strips, worst_trias
from meshops.operations.transport_tria import TransportTria
from meshops.quality_sums import TRIAS
from meshops.workpiece import Setting, Workpiece
from tests.meshes import (
    FLAT_KINDS,
    barriers,
    crossable_edges,
    doubles,
    make,
    meshes,
    sheet,
    unsound,
    users,
    with_,
    zones,
)

RIGHT, BEST = 0, 2


def workpiece(mesh):
    return Workpiece(mesh, Setting(STANDARD.at(1.0), Fitness("quality", len(mesh.elements))))


def slanted_row(length):
    """A row of squares whose uprights are slanted: a tria at either end, quads between."""
    bottom = [(i, 0, 0) for i in range(length + 1)]
    top = [(i, 1, 0) for i in range(length + 1)]
    t = length + 1
    quads = [(i, i + 1, t + i, t + i - 1) for i in range(1, length)]
    ends = [(0, 1, t, -1), (length, t + length, t + length - 1, -1)]
    return ShellMesh.build(np.array(bottom + top, float), [*ends, *quads])


def outcome(mesh, rank, way):
    return apply(mesh, TransportTria().apply(workpiece(mesh), np.array([[rank, way]], np.int32)))


def centres(mesh):
    return sorted(tuple(mesh.points[e[e >= 0]].mean(axis=0)) for e in mesh.elements)


@pytest.mark.parametrize("length", [2, 3, 7])
@pytest.mark.parametrize("way", [RIGHT, BEST])
def test_two_trias_at_the_ends_of_a_row_meet_and_leave_squares(length, way):
    after = outcome(slanted_row(length), 1, way)
    assert not after.is_tria.any()
    assert centres(after) == [(i + 0.5, 0.5, 0.0) for i in range(length)]


def test_one_step_changes_the_sides_of_tria_and_quad():
    mesh = slanted_row(3)
    mesh = with_(mesh, locked_elements=[False, True, False, False])
    after = outcome(mesh, 1, RIGHT)
    assert np.count_nonzero(after.is_tria) == 2
    assert centres(after)[0] == (0.5, 0.5, 0.0)
    tria = after.points[after.elements[after.is_tria & ~after.locked_elements][0, :3]]
    np.testing.assert_allclose(
        tria.mean(axis=0), np.mean([(1, 0, 0), (2, 0, 0), (1, 1, 0)], axis=0)
    )


def test_a_tria_does_not_walk_farther_than_its_reach():
    mesh = slanted_row(7)
    piece = workpiece(mesh)
    candidates = TransportTria(reach=5, steps=2).candidates(piece)
    change = judge(piece, candidates)[:, TRIAS] - 2
    assert np.nanmax(np.abs(change)) == 0
    lengths = np.diff(candidates.removed_start)
    assert set(lengths) == {2, 3}


def test_a_tria_does_not_cross_a_barrier():
    mesh = slanted_row(4)
    mesh = with_(mesh, region=[0, 1, 0, 0, 1])
    piece = workpiece(mesh)
    walks = Strips.walks(piece, worst_trias(piece, 9), reach=9, steps=3, partners=9)
    assert len(walks)
    for first, last in zip(walks.start[:-1], walks.start[1:], strict=True):
        assert len(set(mesh.region[walks.cells[first:last]])) == 1


def test_there_is_nothing_to_do_without_a_tria():
    rng = np.random.default_rng(0)
    assert TransportTria().search_space(workpiece(sheet(4, 4)), rng) is None


@settings(max_examples=25, deadline=None)
@given(meshes(FLAT_KINDS))
def test_each_rung_is_a_crossable_edge_between_two_cells(mesh):
    piece = workpiece(mesh)
    trias = worst_trias(piece, 6)
    crossable, of_edge = crossable_edges(mesh), users(mesh)
    straight = Strips.straight(piece, trias, reach=8, steps=2)
    walks = Strips.walks(piece, trias, reach=5, steps=2, partners=3)
    for strips in (straight, walks, Strips.closed(piece)):
        for first, last in zip(strips.start[:-1], strips.start[1:], strict=True):
            cells = strips.cells[first:last].tolist()
            assert len(set(cells)) == len(cells)
            following = [*cells[1:], cells[0]]
            is_closed = strips.rungs[last - 1, 0] >= 0
            for i in range(len(cells) if is_closed else len(cells) - 1):
                a, b = strips.rungs[first + i].tolist()
                edge = min(a, b), max(a, b)
                assert edge in crossable
                assert {row for row, _ in of_edge[edge]} == {cells[i], following[i]}


@settings(max_examples=40, deadline=None)
@given(meshes(FLAT_KINDS), st.integers(0, 10**6))
def test_walks_keep_the_mesh_whole_and_take_trias_in_pairs(mesh, seed):
    piece = workpiece(mesh)
    candidates = TransportTria(pool=40).candidates(piece)
    tallies = judge(piece, candidates)
    valid = np.nonzero(np.isfinite(tallies).all(axis=1))[0]
    for k in np.random.default_rng(seed).permutation(valid)[:4]:
        after = apply(mesh, candidates.edit(int(k), mesh.region))
        assert set(after.element_ids[unsound(after)]) <= set(mesh.element_ids[unsound(mesh)])
        assert doubles(after) == []
        assert barriers(after) == barriers(mesh)
        old = {zone.outline: zone.trias for zone in zones(mesh)}
        for zone in zones(after):
            assert zone.trias in (old[zone.outline], old[zone.outline] - 2)
        np.testing.assert_allclose(workpiece(after).tally, tallies[k], atol=1e-8)


def test_the_same_mesh_has_the_same_walks():
    mesh = make("plain", 4)
    one, other = (TransportTria().candidates(workpiece(mesh)) for _ in range(2))
    assert all(np.array_equal(a, b) for a, b in zip(one.arrays, other.arrays, strict=True))
