"""Topology in the core: bit for bit what the compiled Python gave."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from meshops import _core
from meshops.kernels import edges as old_edges
from meshops.kernels import partition as old_partition
from meshops.kernels import patches as old_patches
from meshops.kernels import regularity as old_valence
from meshops.kernels import rings as old_rings
from meshops.kernels import smoothing as old_smoothing
from meshops.kernels import soundness as old_validity
from meshops.topology import FAR, REGULAR, topology
from tests.meshes import CURVED_KINDS, FLAT_KINDS, meshes, sheet

ALL_KINDS = FLAT_KINDS + CURVED_KINDS
bounded = settings(deadline=None, max_examples=60)


def assert_equal(found, expected):
    assert len(found) == len(expected)
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_array_equal(one, other)
        assert one.dtype == other.dtype


@st.composite
def tangles(draw):
    """Elements that no mesh has: on few nodes, some twice, some with a node twice."""
    count = draw(st.integers(1, 8))
    nodes = st.integers(0, count - 1)
    elements = draw(arrays(np.int32, (draw(st.integers(0, 20)), 4), elements=nodes))
    elements[draw(arrays(np.bool_, len(elements))), 3] = -1
    return elements, count


@bounded
@given(tangles())
def test_edges_and_elements_of_nodes(tangle):
    assert_equal(_core.find_edges(*tangle), old_edges.find_edges(*tangle))
    assert_equal(_core.elements_of_nodes(*tangle), old_smoothing.elements_of_nodes(*tangle))
    assert _core.has_doubles(*tangle) == old_validity.has_doubles(*tangle)


@bounded
@given(meshes(ALL_KINDS))
def test_edges_of_meshes(mesh):
    nodes = len(mesh.points)
    assert_equal(_core.find_edges(mesh.elements, nodes), old_edges.find_edges(mesh.elements, nodes))
    assert not _core.has_doubles(mesh.elements, nodes)


class Graph:
    """A mesh's graph, some of whose edges may not be crossed, as the core and as arrays."""

    def __init__(self, mesh, rng):
        self.mesh = mesh
        found = topology(mesh)
        self.crossable = found.crossable & (rng.random(len(found.edges)) < rng.choice([0.7, 1.0]))
        self.arrays = (found.element_edges, found.edge_elements, self.crossable)
        self.core = _core.ElementGraph(*self.arrays)
        self.allowed = rng.random(len(mesh.elements)) < rng.choice([0.5, 0.9, 1.0])


@bounded
@given(meshes(ALL_KINDS), st.integers(0, 2**31))
def test_walks_through_elements(mesh, seed):
    rng = np.random.default_rng(seed)
    graph = Graph(mesh, rng)
    core, arrays, allowed = graph.core, graph.arrays, graph.allowed
    count = len(mesh.elements)
    centre, other = (int(row) for row in rng.integers(0, count, 2))
    few, most = int(rng.integers(0, 5)), int(rng.integers(1, 30))
    centres = rng.integers(0, count, 3).astype(np.int32)
    assert_equal(
        [
            core.label_components(allowed),
            core.rings_around(allowed, centres),
            core.disc(allowed, centre, few),
            core.strip(allowed, centre, other, few),
            core.partition(allowed, centres, few, most),
        ],
        [
            old_patches.label_components(*arrays, allowed),
            old_patches.rings_around(*arrays, allowed, centres),
            old_patches.disc(*arrays, allowed, centre, few),
            old_patches.strip(*arrays, allowed, centre, other, few),
            old_partition.partition(*arrays, allowed, centres, few, most),
        ],
    )
    shift = int(rng.integers(0, 2 * count))
    assert core.nearby(allowed, centre, shift) == old_patches.nearby(
        *arrays, allowed, centre, shift
    )


@bounded
@given(meshes(ALL_KINDS), st.integers(0, 2**31))
def test_patches_and_their_loops(mesh, seed):
    graph = Graph(mesh, np.random.default_rng(seed))
    label = graph.core.label_components(graph.allowed)
    parts = [np.nonzero(label == part)[0] for part in range(label.max() + 1)]
    for rows in [*parts, np.nonzero(graph.allowed)[0], np.arange(len(mesh.elements))]:
        rows = rows.astype(np.int32)
        scratch = np.full(len(mesh.elements), -1, np.int32)
        expected = old_patches.cut(rows, mesh.elements, *graph.arrays, scratch)
        found = graph.core.cut(rows, mesh.elements)
        assert_equal(found, expected)
        assert_equal(_core.trace_loops(found[2]), old_rings.trace_loops(expected[2]))


def test_a_patch_of_few_elements_of_many():
    mesh = sheet(60, 60)
    graph = Graph(mesh, np.random.default_rng(0))
    rows = np.array([3, 4, 63, 64, 3000], np.int32)
    scratch = np.full(len(mesh.elements), -1, np.int32)
    expected = old_patches.cut(rows, mesh.elements, *graph.arrays, scratch)
    assert_equal(graph.core.cut(rows, mesh.elements), expected)


@bounded
@given(meshes(ALL_KINDS), st.integers(0, 2**31))
def test_valence(mesh, seed):
    rng = np.random.default_rng(seed)
    nodes = len(mesh.points)
    start, _ = _core.elements_of_nodes(mesh.elements, nodes)
    outside = rng.integers(-1, 3, nodes).astype(np.int32)
    assert_equal(
        [_core.irregular_nodes(start, outside)], [old_valence.irregular_nodes(start, outside)]
    )
    goes = rng.permutation(len(mesh.elements))[:4].astype(np.int32)
    comes = rng.integers(0, nodes + 2, (3, 4)).astype(np.int32)
    comes[0, 3] = -1
    counts = np.zeros(nodes + 2, np.int32)
    expected = old_valence.irregular_change(goes, comes, mesh.elements, start, outside, counts)
    assert _core.irregular_change(goes, comes, mesh.elements, start, outside) == expected


@bounded
@given(meshes(ALL_KINDS), st.floats(-0.5, 1.0))
def test_validity(mesh, least):
    arrays = (mesh.points, mesh.elements)
    normals = _core.unit_normals(*arrays)
    assert_equal([normals], [old_validity.unit_normals(*arrays)])
    assert_equal(
        [_core.valid_elements(*arrays, least)], [old_validity.sound_elements(*arrays, least)]
    )
    leaning = normals[:, [1, 2, 0]] + normals
    for against in (normals, leaning, -normals):
        assert _core.all_facing(*arrays, against) == old_validity.all_facing(*arrays, against)


def test_constants():
    assert (FAR, REGULAR) == (old_patches.FAR, old_valence.REGULAR)


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
