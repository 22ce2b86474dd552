"""Quality in the core: bit for bit what the compiled Python gave.

Where criteria look at angles, these differ in the last bit, and so do sums of their penalties.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from meshops import _core
from meshops.criteria import (
    ASPECT_RATIO,
    CHORDAL_DEV,
    CRITERIA,
    JACOBIAN,
    MAX_LENGTH,
    MIN_SIZE,
    PAPER,
    PERCENT_TRIAS,
    SLACK,
    STANDARD,
    TAPER,
)
from meshops.fitness import Fitness
from meshops.kernels import measures as old_measures
from meshops.kernels import node_scores as old_scores
from meshops.kernels import quality as old
from meshops.quality_sums import IRREGULAR, SHAPE, SIZE, TALLY_SIZE, TRIAS
from tests.core.test_edits import WITHOUT_ANGLES
from tests.meshes import CURVED_KINDS, FLAT_KINDS, meshes, sheet

ALL_KINDS = FLAT_KINDS + CURVED_KINDS
WITHOUT_ACOS = [MIN_SIZE, MAX_LENGTH, ASPECT_RATIO, JACOBIAN, CHORDAL_DEV, TAPER]
NORMALISED = replace(STANDARD, name="normalised", normalised_size=True)
WEIGHTED = replace(
    STANDARD,
    criteria=tuple(replace(c, weight=0.5 + i) for i, c in enumerate(STANDARD.criteria)),
).having(replace(STANDARD["skew"], active=False), name="weighted", penalties=(0, 0.1, 0.5, 2, 7))
SETS = st.sampled_from([STANDARD, PAPER, NORMALISED, WEIGHTED])

bounded = settings(deadline=None, max_examples=50)
numbers = st.floats(allow_nan=True, allow_infinity=True) | st.floats(-200, 200)


@st.composite
def scorings(draw):
    """Criteria at a size, some with bounds and at a size that grows."""
    scoring = draw(SETS).at(draw(st.sampled_from([0.7, 1.0, 3.0])))
    if draw(st.booleans()):
        fails = scoring.levels[:, 3]
        scoring = replace(scoring, bounds=tuple(fails * draw(st.floats(0.5, 1.5))))
    if draw(st.booleans()):
        scoring = replace(scoring, growth=(0.1, -0.05, 0.02, 1.0, 2.0, 0.5))
    return scoring


@st.composite
def pinched(draw):
    """Points and elements of which some have a node twice, lie on a line or are not a number."""
    count = draw(st.integers(4, 9))
    places = st.sampled_from([0.0, 1.0, 1.0 + 1e-13, 2.0, np.nan, np.inf, 1e-200])
    points = draw(arrays(np.float64, (count, 3), elements=places))
    nodes = st.integers(0, count - 1)
    elements = draw(arrays(np.int32, (draw(st.integers(1, 8)), 4), elements=nodes))
    elements[draw(arrays(np.bool_, len(elements))), 3] = -1
    return points, elements


def measured(points, elements, sizing):
    values = np.empty((len(elements), CRITERIA))
    old_measures.measure_elements(points, elements, sizing, values)
    return values


def assert_same_measures(points, elements, scoring):
    found = _core.measure_elements(points, elements, scoring.sizing)
    expected = measured(points, elements, scoring.sizing)
    np.testing.assert_allclose(found, expected, rtol=1e-15)
    if not any(scoring.growth):
        np.testing.assert_array_equal(found[:, WITHOUT_ACOS], expected[:, WITHOUT_ACOS])


@bounded
@given(meshes(ALL_KINDS), scorings())
def test_measures(mesh, scoring):
    assert_same_measures(mesh.points, mesh.elements, scoring)


@bounded
@given(pinched(), scorings())
def test_measures_of_degenerate_elements(pinched, scoring):
    with np.errstate(all="ignore"):
        assert_same_measures(*pinched, scoring)


@bounded
@given(arrays(np.float64, (6, CRITERIA), elements=numbers), scorings())
def test_penalties_and_sums_of_measures(values, scoring):
    is_tria = np.arange(6) % 2 == 0
    np.testing.assert_array_equal(
        _core.penalise(values, scoring.core), old.penalise(values, *scoring.arrays)
    )
    np.testing.assert_array_equal(
        _core.sum_measures(values, is_tria, scoring.core),
        old.tally_values(values, is_tria, *scoring.arrays),
    )


@bounded
@given(st.floats(-300, 300), st.integers(0, PERCENT_TRIAS), scorings())
def test_the_penalty_of_a_value(value, criterion, scoring):
    found = _core.penalty_of(value, criterion, scoring.core)
    assert found == old.penalty(value, scoring.levels[criterion], scoring.penalties)


@bounded
@given(meshes(ALL_KINDS), scorings())
def test_sums_of_elements(mesh, scoring):
    for criteria, rtol in ((replace(scoring, criteria=WITHOUT_ANGLES), 0.0), (scoring, 1e-12)):
        if any(criteria.growth):
            rtol = 1e-12
        np.testing.assert_allclose(
            _core.sum_elements(mesh.points, mesh.elements, criteria.core),
            old.tally_elements(mesh.points, mesh.elements, *criteria.arrays),
            rtol=rtol,
            atol=1e-9 if rtol else 0.0,
        )


@bounded
@given(meshes(ALL_KINDS), scorings())
def test_faults_of_elements(mesh, scoring):
    found = _core.element_faults(mesh.points, mesh.elements, scoring.core)
    values = np.empty(CRITERIA)
    expected = [
        old_scores.element_faults(mesh.points, element, values, scoring.arrays)
        for element in mesh.elements
    ]
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)


def some_sums(mesh, scoring):
    """(P, TALLY_SIZE) sums of parts of a mesh, one of no mesh at all."""
    parts = [mesh.elements[: len(mesh.elements) * k // 4] for k in range(5)]
    sums = [_core.sum_elements(mesh.points, part, scoring.core) for part in parts]
    sums = np.stack([*sums, np.full(TALLY_SIZE, np.nan)])
    sums[:-1, IRREGULAR] = np.arange(5)
    return sums


@bounded
@given(meshes(ALL_KINDS), scorings())
def test_indices(mesh, scoring):
    sums = some_sums(mesh, scoring)
    expected = old.compound_indices(sums, *scoring.arrays)
    np.testing.assert_array_equal(_core.compound_indices(sums, scoring.core), expected)
    assert [_core.compound_index(row, scoring.core) for row in sums[:-1]] == expected[:-1].tolist()
    for row in sums[:-1]:
        each = [old.criterion_index(row, c) for c in range(CRITERIA)]
        np.testing.assert_array_equal(_core.criterion_indices(row), each)
        assert _core.percent_trias(row) == old.percent_trias(row)


@bounded
@given(meshes(ALL_KINDS), scorings(), st.integers(0, 4), st.booleans(), st.booleans())
def test_fitness(mesh, scoring, start, limited, quads):
    sums = some_sums(mesh, scoring)
    limits = np.full(TALLY_SIZE, np.inf)
    if limited:
        limits = sums[start]
    three = tuple(limits[[SHAPE, TRIAS, SIZE]])
    fitness = Fitness("quads" if quads else "quality", 7, limits=three)
    operations = np.arange(len(sums))
    np.testing.assert_array_equal(
        fitness.of(sums, scoring, operations),
        old.order_meshes(
            sums, quads, limits, 8, fitness.irregularity, fitness.price * operations, -np.inf,
            *scoring.arrays,
        ),
    )  # fmt: skip


def test_constants_are_those_of_the_sums():
    assert (old.TALLY_SIZE, old.CRITERIA, old.SLACK) == (TALLY_SIZE, CRITERIA, SLACK)
    assert (old.IRREGULAR, old.SHAPE, old.SIZE, old.TRIAS) == (IRREGULAR, SHAPE, SIZE, TRIAS)


def test_what_does_not_fit_is_refused():
    mesh, scoring = sheet(2, 2), STANDARD.at(1.0)
    with pytest.raises(ValueError, match="rows of 3"):
        _core.measure_elements(mesh.points[:, :2], mesh.elements, scoring.sizing)
    with pytest.raises(ValueError, match="not there"):
        _core.measure_elements(mesh.points[:5], mesh.elements, scoring.sizing)
    with pytest.raises(ValueError, match="7 are needed"):
        _core.measure_elements(mesh.points, mesh.elements, np.zeros(6))
    with pytest.raises(ValueError, match="not there"):
        _core.sum_elements(mesh.points, mesh.elements - 2, scoring.core)
    with pytest.raises(ValueError, match="one value an element"):
        _core.sum_measures(np.zeros((3, CRITERIA)), np.zeros(2, bool), scoring.core)
    with pytest.raises(ValueError, match="no such criterion"):
        _core.penalty_of(1.0, 13, scoring.core)
    with pytest.raises(ValueError, match="13 are needed"):
        _core.Scoring(scoring.levels, scoring.weights[1:], *scoring.arrays[2:])
    with pytest.raises(TypeError):
        _core.measure_elements(mesh.points, mesh.elements.astype(np.int64), scoring.sizing)


def test_arrays_may_lie_in_memory_in_any_way():
    mesh, scoring = sheet(4, 3, seed=1, jitter=0.2), STANDARD.at(1.0)
    expected = _core.sum_elements(mesh.points, mesh.elements, scoring.core)
    points, elements = np.asfortranarray(mesh.points), np.repeat(mesh.elements, 2, axis=0)[::2]
    np.testing.assert_array_equal(_core.sum_elements(points, elements, scoring.core), expected)
