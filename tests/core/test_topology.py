"""Topology in the core: what was recorded of it, and what always holds."""

from itertools import pairwise

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from meshops import _core
from meshops.topology import FAR, REGULAR, topology
from tests.core.recorded import digest, sides
from tests.meshes import CURVED_KINDS, FLAT_KINDS, meshes, sheet

ALL_KINDS = FLAT_KINDS + CURVED_KINDS
RECORDED = sheet(14, 11, seed=5, jitter=0.2, trias=0.15, holes=0.04)
bounded = settings(deadline=None, max_examples=60)


class Graph:
    """A mesh's graph, some of whose edges may not be crossed; as the core and as networkx."""

    def __init__(self, mesh, rng):
        self.mesh = mesh
        found = topology(mesh)
        crossable = found.crossable & (rng.random(len(found.edges)) < rng.choice([0.7, 1.0]))
        self.arrays = (found.element_edges, found.edge_elements, crossable)
        self.core = _core.ElementGraph(*self.arrays)
        self.allowed = rng.random(len(mesh.elements)) < rng.choice([0.5, 0.9, 1.0])
        self.whole = nx.Graph()
        self.whole.add_nodes_from(range(len(mesh.elements)))
        self.whole.add_edges_from(found.edge_elements[crossable].tolist())

    def among(self, chosen):
        return self.whole.subgraph(np.nonzero(chosen)[0].tolist())

    def rings(self, centres, most=FAR):
        """Edges from each element to the nearest centre through allowed ones, up to some."""
        entered = self.allowed.copy()
        entered[centres] = True
        found = np.full(len(entered), FAR)
        for centre in centres:
            lengths = nx.single_source_shortest_path_length(self.among(entered), int(centre), most)
            for row, length in lengths.items():
                found[row] = min(found[row], length)
        return found


# --- what was recorded --------------------------------------------------------------------------


def test_topology_is_that_recorded():
    elements, nodes = RECORDED.elements, len(RECORDED.points)
    assert digest(*_core.find_edges(elements, nodes)) == "39b5ae176266be63"
    start, around = _core.elements_of_nodes(elements, nodes)
    assert digest(start, around) == "676480f4cd37c2d7"
    graph = Graph(RECORDED, np.random.default_rng(3))
    core, allowed = graph.core, graph.allowed
    assert digest(core.label_components(allowed)) == "135f679bc80e0004"
    assert digest(core.rings_around(allowed, np.array([3, 90], np.int32))) == "3451c73ad973f6a3"
    assert digest(core.disc(allowed, 70, 3)) == "fffd9a89960f9cbd"
    assert digest(core.strip(allowed, 3, 90, 1)) == "6a755e378fb23499"
    shifts = (0, 1, 7, 20, 999)
    assert [core.nearby(allowed, 70, shift) for shift in shifts] == [
        70,
        56,
        55,
        67,
        176,
    ]
    assert (
        digest(core.partition(allowed, np.arange(0, 150, 9, dtype=np.int32), 2, 11))
        == "f6c30ffdc3a487d0"
    )
    patch = core.cut(np.arange(20, 120, dtype=np.int32), elements)
    assert digest(*patch) == "7e61fd89a667e9d4"
    assert digest(*_core.trace_loops(patch[2])) == "df9e52d76514d002"
    assert digest(_core.unit_normals(RECORDED.points, elements)) == "3fc4580c19ce2cb0"
    assert digest(_core.valid_elements(RECORDED.points, elements, 0.5)) == "be95da1fd5b6be1b"
    assert digest(_core.irregular_nodes(start, np.zeros(nodes, np.int32))) == "d7c6c5215ac47b4f"


# --- what always holds --------------------------------------------------------------------------


@st.composite
def tangles(draw):
    """Elements that no mesh has: on few nodes, some twice, some with a node twice."""
    count = draw(st.integers(1, 8))
    nodes = st.integers(0, count - 1)
    elements = draw(arrays(np.int32, (draw(st.integers(0, 20)), 4), elements=nodes))
    elements[draw(arrays(np.bool_, len(elements))), 3] = -1
    return elements, count


@bounded
@given(tangles() | meshes(ALL_KINDS).map(lambda mesh: (mesh.elements, len(mesh.points))))
def test_each_side_has_one_edge(tangle):
    elements, nodes = tangle
    edges, element_edges, edge_elements, uses, opposed = _core.find_edges(elements, nodes)
    assert (np.diff(edges @ [nodes, 1]) > 0).all()
    at: dict[int, list[tuple[int, bool]]] = {edge: [] for edge in range(len(edges))}
    for row, element in enumerate(elements):
        ends = sides(element[None])
        assert (element_edges[row, len(ends) :] == -1).all()
        for edge, (a, b) in zip(element_edges[row], ends, strict=False):
            assert edges[edge].tolist() == sorted((a, b))
            at[int(edge)].append((row, a < b))
    for edge, found in at.items():
        assert uses[edge] == len(found) > 0
        two = len(found) == 2
        assert edge_elements[edge].tolist() == ([row for row, _ in found] if two else [-1, -1])
        assert opposed[edge] == (two and found[0][1] != found[1][1])


@bounded
@given(tangles())
def test_elements_are_listed_at_their_nodes(tangle):
    elements, nodes = tangle
    start, around = _core.elements_of_nodes(elements, nodes)
    for node in range(nodes):
        expected = [row for row, e in enumerate(elements) for same in e if same == node]
        assert around[start[node] : start[node + 1]].tolist() == expected


@bounded
@given(tangles())
def test_doubles_are_elements_on_the_nodes_of_another(tangle):
    elements, nodes = tangle
    kept = [e for e in elements if len({*e.tolist()}) == 4]  # none with a node twice
    elements = np.array(kept, np.int32).reshape(-1, 4)
    sets = [{node for node in e.tolist() if node >= 0} for e in elements]
    doubles = any(a <= b or b <= a for i, a in enumerate(sets) for b in sets[:i])
    assert _core.has_doubles(elements, nodes) == doubles


@bounded
@given(meshes(ALL_KINDS), st.integers(0, 2**31))
def test_walks_through_elements(mesh, seed):
    rng = np.random.default_rng(seed)
    graph = Graph(mesh, rng)
    core, allowed = graph.core, graph.allowed
    count, few = len(mesh.elements), int(rng.integers(0, 5))
    centres = rng.integers(0, count, 3).astype(np.int32)
    centre, other = (int(row) for row in centres[:2])
    label = core.label_components(allowed)
    parts = [set(np.nonzero(label == part)[0].tolist()) for part in range(label.max() + 1)]
    expected = sorted(nx.connected_components(graph.among(allowed)), key=min)
    assert parts == [set(part) for part in expected]
    np.testing.assert_array_equal(core.rings_around(allowed, centres), graph.rings(centres))
    near = graph.rings([centre])
    np.testing.assert_array_equal(core.disc(allowed, centre, few), near <= few)
    # visited ring by ring; a strip is what is around the way to the other end
    order = [near[core.nearby(allowed, centre, shift)] for shift in range((near < FAR).sum())]
    assert order == sorted(near[near < FAR])
    strip = core.strip(allowed, centre, other, few)
    to_other = graph.rings([other])
    assert strip[centre]
    if to_other[centre] < FAR:
        way = core.strip(allowed, centre, other, 0)
        assert np.count_nonzero(way) == to_other[centre] + 1
        assert nx.is_connected(graph.among(way))
        np.testing.assert_array_equal(strip, graph.rings(np.nonzero(way)[0]) <= few)
    else:
        np.testing.assert_array_equal(strip, core.disc(allowed, centre, few))


@bounded
@given(meshes(ALL_KINDS), st.integers(0, 2**31))
def test_subdomains_are_connected_and_around_bad_places(mesh, seed):
    rng = np.random.default_rng(seed)
    graph = Graph(mesh, rng)
    bad = rng.permutation(len(mesh.elements))[:4].astype(np.int32)
    rings, most = int(rng.integers(0, 4)), int(rng.integers(1, 20))
    label = graph.core.partition(graph.allowed, bad, rings, most)
    assert (label[~graph.allowed] == -1).all()
    centres = iter(bad[graph.allowed[bad]])
    for part in range(label.max() + 1):
        rows = label == part
        assert 1 <= np.count_nonzero(rows) <= most
        assert nx.is_connected(graph.among(rows))
        centre = next(row for row in centres if label[row] == part)
        assert (graph.rings([centre])[rows] <= rings).all()
    assert (label[bad[graph.allowed[bad]]] >= 0).all()


@bounded
@given(meshes(ALL_KINDS), st.integers(0, 2**31))
def test_patches_are_cut_along_barriers(mesh, seed):
    graph = Graph(mesh, np.random.default_rng(seed))
    element_edges, _, crossable = graph.arrays
    for rows in (np.nonzero(graph.allowed)[0], np.arange(len(mesh.elements))):
        rows = rows.astype(np.int32)
        elements, nodes, border = graph.core.cut(rows, mesh.elements)
        is_node = elements >= 0
        np.testing.assert_array_equal(np.where(is_node, nodes[elements], -1), mesh.elements[rows])
        found = sides(elements)
        inside = [crossable[edge] for row in rows for edge in element_edges[row] if edge >= 0]
        kept = graph.among(np.isin(np.arange(len(mesh.elements)), rows))
        across = 2 * kept.number_of_edges()
        assert len(border) == len(found) - across
        assert across <= sum(inside)
        assert {tuple(side) for side in border.tolist()} <= set(found)
        on_border = int(border.max()) + 1 if len(border) else 0
        assert set(border.ravel().tolist()) == set(range(on_border))
        order, start = _core.trace_loops(border)
        assert sorted(order.tolist()) == list(range(len(border)))
        for first, last in pairwise(start):
            loop = border[order[first:last]]
            assert order[first] == min(order[first:last])
            np.testing.assert_array_equal(loop[:, 1], np.roll(loop[:, 0], -1))


def test_a_patch_of_few_elements_of_many():
    mesh = sheet(60, 60)
    core = Graph(mesh, np.random.default_rng(0)).core
    far, near = np.array([3, 4, 63, 64, 3000]), np.array([3, 4, 63, 64, 70])
    one, other = (core.cut(rows.astype(np.int32), mesh.elements) for rows in (far, near))
    np.testing.assert_array_equal(one[0], other[0])
    np.testing.assert_array_equal(one[2], other[2])


@bounded
@given(meshes(ALL_KINDS), st.integers(0, 2**31))
def test_valence(mesh, seed):
    rng = np.random.default_rng(seed)
    nodes = len(mesh.points)
    start, _ = _core.elements_of_nodes(mesh.elements, nodes)
    outside = rng.integers(-1, 3, nodes).astype(np.int32)

    def irregular(elements):
        valence = np.bincount(elements[elements >= 0], minlength=nodes + 2)
        free = np.append(outside, [0, 0])
        return (free >= 0) & (valence > 0) & (valence + free != REGULAR)

    before = irregular(mesh.elements)
    np.testing.assert_array_equal(_core.irregular_nodes(start, outside), before[:-2])
    goes = rng.permutation(len(mesh.elements))[:4].astype(np.int32)
    comes = rng.integers(0, nodes + 2, (3, 4)).astype(np.int32)
    comes[0, 3] = -1
    after = irregular(np.concatenate([np.delete(mesh.elements, goes, axis=0), comes]))
    change = np.count_nonzero(after) - np.count_nonzero(before)
    assert _core.irregular_change(goes, comes, mesh.elements, start, outside) == change


@bounded
@given(meshes(ALL_KINDS), st.floats(-0.5, 1.0))
def test_validity(mesh, least):
    points, elements = mesh.points, mesh.elements
    normals = _core.unit_normals(points, elements)
    corners = []
    for element, normal in zip(elements, normals, strict=True):
        nodes = points[element[element >= 0]]
        along = np.roll(nodes, -1, axis=0) - nodes
        turned = np.cross(np.roll(along, 1, axis=0), along)
        np.testing.assert_allclose(np.linalg.norm(normal), 1.0)
        total = np.cross(nodes[2] - nodes[0], nodes[-1] - nodes[1])
        np.testing.assert_allclose(normal, total / np.linalg.norm(total), atol=1e-12)
        corners.append((turned @ normal).min() / (along**2).sum(axis=1).max())
    clear = np.abs(np.array(corners) - least) > 1e-9
    valid = _core.valid_elements(points, elements, least)
    np.testing.assert_array_equal(valid[clear], (np.array(corners) >= least)[clear])
    assert _core.all_facing(points, elements, normals)
    assert not _core.all_facing(points, elements, -normals)
    assert not _core.all_facing(points, elements, normals[:, [1, 2, 0]] * 0.0)


def test_what_does_not_fit_is_refused():
    mesh = sheet(3, 3)
    graph = Graph(mesh, np.random.default_rng(0))
    everywhere = np.ones(len(mesh.elements), bool)
    with pytest.raises(ValueError, match="not there"):
        _core.find_edges(mesh.elements, 3)
    element_edges, edge_elements, crossable = graph.arrays
    for broken in (
        (element_edges + 99, edge_elements, crossable),
        (element_edges[::-1], edge_elements, crossable),
        (element_edges[:2], edge_elements, crossable),
        (element_edges, edge_elements, np.ones(len(crossable), bool)),
    ):
        with pytest.raises(ValueError, match="an edge that is not"):
            _core.ElementGraph(*broken)
    with pytest.raises(ValueError, match="one value"):
        _core.ElementGraph(element_edges, edge_elements, crossable[:2])
    with pytest.raises(ValueError, match="one value"):
        graph.core.label_components(everywhere[:2])
    with pytest.raises(ValueError, match="no such element"):
        graph.core.disc(everywhere, 9, 1)
    with pytest.raises(ValueError, match="no such element"):
        graph.core.partition(everywhere, np.array([-1], np.int32), 1, 1)
    with pytest.raises(ValueError, match="ascend"):
        graph.core.cut(np.array([1, 1], np.int32), mesh.elements)
    with pytest.raises(OverflowError):
        graph.core.nearby(everywhere, 0, -1)
