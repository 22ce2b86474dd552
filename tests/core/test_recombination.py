"""Recombination in the core: what was recorded of it, and that nothing panics.

What holds of a matching is in tests/test_pairing.py, of tria transport in tests/test_methods.py.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops import _core
from tests.core.recorded import digest, outline
from tests.meshes import CURVED_KINDS, FLAT_KINDS, meshes, paraboloid, sheet
from tests.test_pairing import random_graph

FLAT = sheet(30, 20, seed=5, jitter=0.3, trias=0.4, holes=0.03)
CURVED = paraboloid(sheet(12, 12, seed=3, jitter=0.25, trias=0.3))


@pytest.mark.parametrize(
    ("mesh", "expected"),
    [
        (
            FLAT,
            {
                "trias": "ec4c5d34d925068e",
                "split": "647fa26e81a8253c",
                "quads": "f72be7a4570b80f1",
                "poor": "390e4ec0674d0183",
                "united": "02e8b7fecd145dcf",
            },
        ),
        (
            CURVED,
            {
                "trias": "c913c91ea48db852",
                "split": "d1c8605e2ac3bcc9",
                "quads": "a1a3f92def4de3dc",
                "poor": "a1a3f92def4de3dc",
                "united": "df7f6ba5491f57f6",
            },
        ),
    ],
    ids=["sheet", "paraboloid"],
)
def test_the_recorded_elements_come_of_it(mesh, expected):
    chosen = np.arange(len(mesh.elements)) % 3 > 0
    trias = _core.as_trias(mesh.points, mesh.elements)
    found = {
        "trias": digest(trias),
        "split": digest(_core.split_quads(mesh.points, mesh.elements, chosen)),
        "quads": digest(_core.recombine(mesh.points, trias, 0.05, 0.5)),
        "poor": digest(_core.recombine(mesh.points, trias, -1.0, 0.9)),
        "united": digest(_core.unite_trias(mesh.points, mesh.elements)),
    }
    assert found == expected


def test_the_recorded_matchings_come_of_it():
    """Of many small graphs, with odd cycles."""
    mates = []
    for seed in range(200):
        neighbours, shapes = random_graph(seed)
        greedy = _core.greedy_matching(neighbours, shapes, 0.3)
        mates += [greedy, _core.maximum_matching(neighbours, shapes, greedy)]
    assert digest(*mates) == "1621c9a0a2252c04"


@settings(max_examples=60, deadline=None)
@given(mesh=meshes(FLAT_KINDS + CURVED_KINDS))
def test_the_outline_stays_whatever_is_merged_and_split(mesh):
    trias = _core.as_trias(mesh.points, mesh.elements)
    quads = _core.recombine(mesh.points, trias, 0.05, 0.5)
    united = _core.unite_trias(mesh.points, quads)
    halves = _core.split_quads(mesh.points, united, np.ones(len(united), bool))
    for elements in (np.insert(trias, 3, -1, axis=1), quads, united, halves):
        assert outline(elements) == outline(mesh.elements)
    assert len(halves) == len(trias)


numbers = st.one_of(st.floats(-3.0, 3.0), st.sampled_from([0.0, 1e300, np.inf, np.nan]))


@settings(max_examples=200, deadline=None)
@given(data=st.data(), nodes=st.integers(3, 9), least=st.sampled_from([-1.9, -0.5, 0.05, np.nan]))
def test_no_elements_are_so_wrong_that_it_panics(data, nodes, least):
    row = st.tuples(*[st.integers(0, nodes - 1)] * 3, st.integers(-1, nodes - 1))
    elements = np.reshape(data.draw(st.lists(row, max_size=20)), (-1, 4)).astype(np.int32)
    points = np.reshape(data.draw(st.lists(numbers, min_size=27, max_size=27)), (9, 3))[:nodes]
    trias = _core.as_trias(points, elements)
    neighbours = _core.tria_neighbours(trias, nodes)
    shapes = _core.pair_shapes(points, trias, neighbours)
    mate = _core.greedy_matching(neighbours, shapes, least)
    for found in (
        _core.merge_pairs(trias, neighbours, mate),
        _core.unite_trias(points, elements),
        _core.split_quads(points, elements, np.ones(len(elements), bool)),
    ):
        assert found.max(initial=-1) < nodes
    if np.isnan(least):
        with pytest.raises(ValueError, match="above -2"):
            _core.recombine(points, trias, least, 0.5)
    else:
        assert _core.recombine(points, trias, least, 0.5).max(initial=-1) < nodes


@settings(max_examples=200, deadline=None)
@given(data=st.data(), count=st.integers(0, 8))
def test_no_graph_is_so_wrong_that_it_panics(data, count):
    rows = st.integers(-1, max(count - 1, -1))
    drawn = data.draw(st.lists(rows, min_size=4 * count, max_size=4 * count))
    table = np.reshape(drawn, (count, 4)).astype(np.int32)
    neighbours, mate = np.ascontiguousarray(table[:, :3]), np.ascontiguousarray(table[:, 3])
    shapes = np.zeros((count, 3))
    for start in (mate, np.full(count, -1, np.int32)):
        try:
            found = _core.maximum_matching(neighbours, shapes, start)
        except ValueError:
            continue
        assert found.shape == (count,)
    _core.greedy_matching(neighbours, shapes, 0.0)
    _core.merge_pairs(np.zeros((count, 3), np.int32), neighbours, mate)


def test_what_does_not_fit_is_refused():
    points = np.zeros((3, 3))
    with pytest.raises(ValueError, match="not there"):
        _core.recombine(points, np.array([[0, 1, 3]], np.int32), 0.05, 0.5)
    with pytest.raises(ValueError, match="not there"):
        _core.as_trias(points, np.array([[0, 1, 3, -1]], np.int32))
    with pytest.raises(ValueError, match="chosen or not"):
        _core.split_quads(points, np.array([[0, 1, 2, -1]], np.int32), np.zeros(2, bool))
    neighbours = np.array([[1, -1, -1], [-1, -1, -1]], np.int32)
    with pytest.raises(ValueError, match="not mutual"):
        _core.maximum_matching(neighbours, np.zeros((2, 3)), np.full(2, -1, np.int32))
    with pytest.raises(ValueError, match="row of neighbours"):
        _core.greedy_matching(neighbours, np.zeros((3, 3)), 0.0)
    with pytest.raises(ValueError, match="above -2"):
        _core.recombine(points, np.zeros((0, 3), np.int32), -3.0, 0.5)
