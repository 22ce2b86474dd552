"""Edges, barriers, fans and zones, against a plain computation element by element."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings

from meshops.mesh import ShellMesh
from meshops.topology import topology
from tests.meshes import (
    CURVED_KINDS,
    FLAT_KINDS,
    crossable_edges,
    cylinder,
    fans,
    joined,
    meshes,
    needle,
    partly_flipped,
    sheet,
    sides,
    users,
    with_,
)

ALL_KINDS = FLAT_KINDS + CURVED_KINDS
bounded = settings(max_examples=40, deadline=None)


@bounded
@given(meshes(ALL_KINDS))
def test_edges_are_those_of_the_elements(mesh):
    found = topology(mesh)
    expected = users(mesh)
    assert list(map(tuple, found.edges.tolist())) == sorted(expected)
    for edge, uses, pair in zip(found.edges, found.uses, found.edge_elements, strict=True):
        elements = [element for element, _ in expected[tuple(edge)]]
        assert uses == len(elements)
        assert pair.tolist() == (sorted(elements) if len(elements) == 2 else [-1, -1])
    assert np.array_equal(found.is_border, found.uses == 1)
    assert np.array_equal(found.is_t_junction, found.uses >= 3)


@bounded
@given(meshes(ALL_KINDS))
def test_every_side_knows_its_edge(mesh):
    found = topology(mesh)
    for element, edges in zip(mesh.elements, found.element_edges, strict=True):
        of_sides = [tuple(found.edges[e]) for e in edges if e >= 0]
        assert of_sides == [(min(side), max(side)) for side in sides(element)]


@bounded
@given(meshes(ALL_KINDS))
def test_barriers_are_those_of_the_definition(mesh):
    found = topology(mesh)
    assert set(map(tuple, found.edges[found.crossable].tolist())) == crossable_edges(mesh)


@bounded
@given(meshes(ALL_KINDS))
def test_fans_are_the_elements_that_crossable_edges_connect_around_a_node(mesh):
    corners, nodes, first_inner = topology(mesh).fans
    found = Counter()
    for fan, node in enumerate(nodes):
        elements, places = np.nonzero(corners == fan)
        assert (mesh.elements[elements, places] == node).all()
        found[int(node), frozenset(elements.tolist()), fan >= first_inner] += 1
    assert found == Counter(fans(mesh))
    assert np.array_equal(corners >= 0, mesh.elements >= 0)


@bounded
@given(meshes(ALL_KINDS))
def test_free_nodes_have_one_closed_fan_and_no_lock(mesh):
    around = fans(mesh)
    fans_of_node = Counter(node for node, _, _ in around)
    expected = {
        node
        for node, _, closed in around
        if closed and fans_of_node[node] == 1 and not mesh.locked_nodes[node]
    }
    assert set(np.nonzero(topology(mesh).free_nodes)[0].tolist()) == expected


@bounded
@given(meshes(ALL_KINDS))
def test_every_node_that_must_stay_is_on_a_barrier_or_has_an_anchor_in_its_fan(mesh):
    anchors = topology(mesh).anchors
    around = fans(mesh)
    fans_of_node = Counter(node for node, _, _ in around)
    pinned = [
        elements
        for node, elements, closed in around
        if closed and (mesh.locked_nodes[node] or fans_of_node[node] > 1)
    ]
    assert all(anchors[list(elements)].any() for elements in pinned)
    assert np.count_nonzero(anchors) <= len(pinned)


@bounded
@given(meshes(ALL_KINDS))
def test_zones_are_connected_by_crossable_edges_and_hold_no_anchor_or_lock(mesh):
    found = topology(mesh)
    assert np.array_equal(found.zones < 0, mesh.locked_elements | found.anchors)
    zone = found.zones.tolist()
    reached = {}
    edge_users = users(mesh)
    for edge in crossable_edges(mesh):
        one, two = (element for element, _ in edge_users[edge])
        if zone[one] >= 0 and zone[two] >= 0:
            assert zone[one] == zone[two]
            reached.setdefault(one, []).append(two)
            reached.setdefault(two, []).append(one)
    left, components = {row for row in range(len(zone)) if zone[row] >= 0}, 0
    while left:
        todo = [left.pop()]
        components += 1
        while todo:
            new = set(reached.get(todo.pop(), ())) & left
            left -= new
            todo += new
    assert components == len({z for z in zone if z >= 0})


def test_a_feature_is_an_edge_from_the_feature_angle_on():
    at_25_degrees = cylinder(sheet(4, 1), radius=1 / np.radians(25))
    assert topology(at_25_degrees, feature_angle=30).crossable.sum() == 3
    assert topology(at_25_degrees, feature_angle=20).crossable.sum() == 0


def test_an_edge_of_three_plates_is_a_t_junction_and_no_border():
    wall = ShellMesh.build([(1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)], [(0, 1, 2, 3)])
    found = topology(joined(sheet(2, 1), wall))
    assert found.is_t_junction.sum() == 1
    assert not (found.is_t_junction & (found.is_border | found.crossable)).any()


def test_elements_that_disagree_about_up_are_apart():
    assert topology(partly_flipped(sheet(2, 1), 1.0)).zones.max() == 1


def test_elements_folded_back_on_each_other_are_apart_also_where_one_is_flipped():
    """Their normals agree, but one has its upper side where the other has its lower."""
    points = [(0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0), (1, 1, 0.1), (1, 0, 0.1)]
    mesh = ShellMesh.build(points, [(0, 3, 2, 1), (0, 5, 4, 1)])
    assert not topology(mesh).crossable.any()


def test_a_node_on_which_another_part_hangs_is_anchored_in_the_skin():
    mesh = joined(sheet(2, 2), needle(1.0, 1.0))
    found = topology(mesh)
    assert not found.free_nodes.any()
    assert np.count_nonzero(found.anchors) == 1
    assert not mesh.is_tria[found.anchors].any()


def test_a_locked_inner_node_holds_one_element_and_a_locked_border_node_none():
    mesh = sheet(2, 2)
    inner = with_(mesh, locked_nodes=np.arange(9) == 4)
    border = with_(mesh, locked_nodes=np.arange(9) == 0)
    assert np.count_nonzero(topology(inner).anchors) == 1
    assert np.count_nonzero(topology(border).anchors) == 0


@pytest.mark.parametrize("points", [[], [(0, 0, 0)]])
def test_a_mesh_without_elements_has_no_edges(points):
    mesh = ShellMesh.build(np.reshape(points, (-1, 3)), np.zeros((0, 4)))
    found = topology(mesh)
    assert len(found.edges) == 0
    assert not found.free_nodes.any()
    assert not found.editable.any()
