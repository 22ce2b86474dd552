"""Cavities in the core, around elements and nodes: what was recorded, and what always holds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops import _core
from meshops.criteria import STANDARD
from meshops.fitness import Fitness
from meshops.operations.places import crossable_pairs
from meshops.operations.ragged import alternatives, starts
from meshops.operations.templates import triples
from meshops.workpiece import Setting, Workpiece
from tests.core.recorded import digest, outline, sides
from tests.meshes import CURVED_KINDS, FLAT_KINDS, make, meshes, sheet

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


RECORDED = sheet(14, 11, seed=5, jitter=0.2, trias=0.15, holes=0.04)


def test_cavities_are_those_recorded():
    mesh, piece = RECORDED, workpiece(RECORDED)
    polygons = _core.cavity_polygons(mesh.elements, groups(piece, np.random.default_rng(0)))
    assert digest(*polygons) == "1cc8bb48deb638af"
    chosen = sets(piece, np.random.default_rng(0))
    pillows = _core.pillow(chosen, mesh.points, mesh.elements, piece.topology.graph)
    assert digest(*pillows) == "43b134d81adca29e"
    nodes = np.nonzero(piece.topology.inner_nodes)[0].astype(np.int32)
    rows, ways = alternatives(len(nodes), _core.FILLINGS)
    filled = _core.remove_nodes(nodes[rows], ways, mesh.elements, piece.around)
    assert digest(*filled) == "6a7767a5c96ee97c"


@settings(max_examples=40, deadline=None)
@given(meshes(ALL_KINDS), seeds)
def test_a_cavity_polygon_is_the_outline_of_its_group(mesh, seed):
    chosen = groups(workpiece(mesh), np.random.default_rng(seed))
    polygons, sizes = _core.cavity_polygons(mesh.elements, chosen)
    for group, polygon, size in zip(chosen, polygons, sizes, strict=True):
        nodes = polygon[:size].tolist()
        assert set(polygon[size:]) <= {-1}
        around = outline(mesh.elements[group[group >= 0]])
        starts_once = len({start for start, _ in around}) == len(around)
        if size:
            assert sorted(zip(nodes, nodes[1:] + nodes[:1], strict=True)) == around
        elif len(set(group)) == 3 and starts_once and around:
            # several loops: elements that are not adjacent
            assert len(loop_of(around)) < len(around)


def not_against_each_other(elements):
    """Whether all agree about which side is up: none has a side of another in its direction."""
    found = sides(elements)
    return len(set(found)) == len(found)


def loop_of(sides):
    """The nodes along sides, each from node to node, from the first one on."""
    following = dict(sides)
    found = [sides[0][0]]
    while following[found[-1]] != found[0]:
        found.append(following[found[-1]])
    return found


@settings(max_examples=40, deadline=None)
@given(meshes(ALL_KINDS), seeds)
def test_a_pillow_keeps_the_outline(mesh, seed):
    piece = workpiece(mesh)
    start, rows = sets(piece, np.random.default_rng(seed))
    added_start, added, point_start, points = _core.pillow(
        (start, rows), mesh.points, mesh.elements, piece.topology.graph
    )
    for k in range(len(start) - 1):
        before = mesh.elements[rows[start[k] : start[k + 1]]]
        after = added[added_start[k] : added_start[k + 1]]
        new = points[point_start[k] : point_start[k + 1]]
        assert np.count_nonzero(after[:, 3] < 0) == np.count_nonzero(before[:, 3] < 0)
        if not_against_each_other(before):
            assert set(outline(before)) <= set(outline(after))
        numbers = after[after >= len(mesh.points)]
        assert set(numbers) == {*range(len(mesh.points), len(mesh.points) + len(new))}
        if len(new):
            corners = mesh.points[before[before >= 0]]
            assert (new >= corners.min(axis=0) - 1e-12).all()
            assert (new <= corners.max(axis=0) + 1e-12).all()


@settings(max_examples=40, deadline=None)
@given(meshes(ALL_KINDS))
def test_a_ring_is_filled_up_to_its_outline(mesh):
    piece = workpiece(mesh)
    nodes = np.nonzero(piece.topology.inner_nodes)[0].astype(np.int32)
    rows, ways = alternatives(len(nodes), _core.FILLINGS)
    removed_start, removed, added_start, added = _core.remove_nodes(
        nodes[rows], ways, mesh.elements, piece.around
    )
    start, around = piece.around
    for k, row in enumerate(rows):
        gone = removed[removed_start[k] : removed_start[k + 1]]
        after = added[added_start[k] : added_start[k + 1]]
        if len(after):
            node = nodes[row]
            np.testing.assert_array_equal(gone, around[start[node] : start[node + 1]])
            assert len(after) < len(gone)
            assert np.count_nonzero(after[:, 3] < 0) <= 1
            assert outline(after) == outline(mesh.elements[gone])
        else:
            assert not len(gone)


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
