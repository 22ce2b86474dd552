"""Quality in the core: what was recorded of it, and what always holds.

Measures are compared with VTK's in ``tests/test_quality_measures.py``, sums and indices with their
definitions in ``tests/test_quality_tally.py``.
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
    CRITERIA,
    JACOBIAN,
    MAX_LENGTH,
    MIN_SIZE,
    PAPER,
    STANDARD,
    TAPER,
)
from meshops.fitness import Fitness
from meshops.quality import element_index, failed_elements
from meshops.quality_sums import ELEMENTS, IRREGULAR, SHAPE, SIZE, TALLY_SIZE, TRIAS
from tests.core.recorded import digest
from tests.meshes import CURVED_KINDS, FLAT_KINDS, meshes, paraboloid, sheet

ALL_KINDS = FLAT_KINDS + CURVED_KINDS
WITHOUT_ANGLES = [MIN_SIZE, MAX_LENGTH, ASPECT_RATIO, JACOBIAN, TAPER]
NORMALISED = replace(STANDARD, name="normalised", normalised_size=True)
WEIGHTED = replace(
    STANDARD,
    criteria=tuple(replace(c, weight=0.5 + i) for i, c in enumerate(STANDARD.criteria)),
).having(replace(STANDARD["skew"], active=False), name="weighted", penalties=(0, 0.1, 0.5, 2, 7))

RECORDED = paraboloid(sheet(12, 9, seed=5, jitter=0.35, trias=0.3))
BOUNDED = replace(WEIGHTED.at(0.9), bounds=tuple(0.9 * WEIGHTED.at(0.9).levels[:, 3]))

bounded = settings(deadline=None, max_examples=50)


@st.composite
def scorings(draw):
    """Criteria at a size, some with bounds."""
    criteria = draw(st.sampled_from([STANDARD, PAPER, NORMALISED, WEIGHTED]))
    scoring = criteria.at(draw(st.sampled_from([0.7, 1.0, 3.0])))
    if draw(st.booleans()):
        fails = scoring.levels[:, 3]
        scoring = replace(scoring, bounds=tuple(fails * draw(st.floats(0.5, 1.5))))
    return scoring


def some_sums(mesh, scoring):
    """(P, TALLY_SIZE) sums of parts of a mesh, one of no mesh at all."""
    parts = [mesh.elements[: len(mesh.elements) * k // 4] for k in range(5)]
    sums = [_core.sum_elements(mesh.points, part, scoring.core) for part in parts]
    sums = np.stack([*sums, np.full(TALLY_SIZE, np.nan)])
    sums[:-1, IRREGULAR] = np.arange(5)
    return sums


# --- what was recorded --------------------------------------------------------------------------


def test_quality_without_angles_is_that_recorded():
    points, elements = RECORDED.points, RECORDED.elements
    values = _core.measure_elements(points, elements, BOUNDED.sizing)
    assert digest(values[:, WITHOUT_ANGLES]) == "6855c1e80949bc19"
    normalised = _core.measure_elements(points, elements, NORMALISED.at(1.0).sizing)
    assert digest(normalised[:, MIN_SIZE]) == "ec50b0857340f55f"
    rough = np.round(values, 3)
    assert digest(_core.penalise(rough, BOUNDED.core)) == "cd1c236b35ecb84a"
    sums = _core.sum_measures(rough, RECORDED.is_tria, BOUNDED.core)
    assert digest(sums) == "ead735937be9b33b"
    assert digest(_core.criterion_indices(sums)) == "d30debadf016cade"
    assert (_core.compound_index(sums, BOUNDED.core), _core.percent_trias(sums)) == (
        1450.880897949731,
        50.0,
    )
    sums[IRREGULAR] = 12
    several = sums + np.outer([0, 1, 2], np.arange(TALLY_SIZE) % 3 == 2)
    limits = (float(sums[SHAPE]), float(sums[TRIAS]) - 1, float(sums[SIZE]))
    for kind, expected in (("quality", "d614100bf2068947"), ("quads", "c05bd6c223b73382")):
        fitness = Fitness(kind, 150, limits=limits)
        assert digest(fitness.of(several, BOUNDED, np.arange(3))) == expected


def test_angles_are_the_same_on_every_machine():
    points, elements = RECORDED.points, RECORDED.elements
    assert digest(_core.measure_elements(points, elements, BOUNDED.sizing)) == "46f9647fa31f2a59"
    graded = replace(BOUNDED, growth=(0.1, -0.05, 0.02, 1.0, 2.0, 0.5))
    assert digest(_core.measure_elements(points, elements, graded.sizing)) == "69b35d4c7b3965cf"
    assert digest(_core.sum_elements(points, elements, graded.core)) == "ffe0588b27c57295"
    assert digest(_core.element_faults(points, elements, BOUNDED.core)) == "2706e826f708b1f2"


# --- what always holds --------------------------------------------------------------------------


@bounded
@given(meshes(ALL_KINDS), scorings())
def test_faults_and_index_of_elements(mesh, scoring):
    shape, size, index = _core.element_faults(mesh.points, mesh.elements, scoring.core).T
    np.testing.assert_allclose(index, element_index(mesh, scoring))
    failed = failed_elements(mesh, replace(scoring, bounds=None))
    assert (shape + size > 0.0)[failed].all()
    if scoring.bounds is None:
        np.testing.assert_array_equal(shape + size > 0.0, failed)
    sums = _core.sum_elements(mesh.points, mesh.elements, scoring.core)
    assert (sums[SHAPE], sums[SIZE]) == (shape.sum(), size.sum())


@bounded
@given(meshes(ALL_KINDS), scorings())
def test_sums_follow_from_measures_and_from_their_parts(mesh, scoring):
    core = scoring.core
    values = _core.measure_elements(mesh.points, mesh.elements, scoring.sizing)
    sums = _core.sum_elements(mesh.points, mesh.elements, core)
    np.testing.assert_array_equal(_core.sum_measures(values, mesh.is_tria, core), sums)
    half = len(mesh.elements) // 2
    parts = [mesh.elements[:half], mesh.elements[half:]]
    added = sum(_core.sum_elements(mesh.points, part, core) for part in parts)
    np.testing.assert_allclose(added, sums, rtol=1e-12, atol=1e-12)


@bounded
@given(meshes(ALL_KINDS), st.integers(0, 99))
def test_lengths_are_over_the_size_that_is_wanted_where_they_are(mesh, row):
    row %= len(mesh.elements)
    nodes = mesh.elements[row][mesh.elements[row] >= 0]
    growth = np.array([0.3, -0.2, 0.1])
    sizing = np.array([0.0, *growth, 1.0, 2.0, 0.5])
    plain = _core.measure_elements(mesh.points, mesh.elements, np.zeros(7))[row]
    graded = _core.measure_elements(mesh.points, mesh.elements, sizing)[row]
    factor = np.exp(-growth @ (mesh.points[nodes].mean(axis=0) - [1.0, 2.0, 0.5]))
    lengths = [MIN_SIZE, MAX_LENGTH]
    np.testing.assert_allclose(graded[lengths], plain[lengths] * factor)
    others = np.setdiff1d(np.arange(CRITERIA), lengths)
    np.testing.assert_array_equal(graded[others], plain[others])


@bounded
@given(meshes(ALL_KINDS), scorings(), st.integers(0, 4), st.booleans())
def test_fitness_is_that_of_its_definition(mesh, scoring, start, quads):
    sums = some_sums(mesh, scoring)
    limits = sums[start]
    fitness = Fitness(
        "quads" if quads else "quality", 7, limits=tuple(limits[[SHAPE, TRIAS, SIZE]])
    )
    found = fitness.of(sums, scoring, np.arange(len(sums)))
    assert found[-1] == -np.inf
    for row, value, operations in zip(sums[:-1], found, range(5), strict=False):
        shape, trias, size = row[[SHAPE, TRIAS, SIZE]]
        dire = (max(limits[SHAPE] - shape, 0.0)) // 30.0
        harm = max(trias - limits[TRIAS] - dire, 0.0)
        harm += max(size - limits[SIZE] - 31.0 * dire, 0.0)
        first, second = shape, trias
        if quads:
            harm += max(shape - limits[SHAPE], 0.0)
            first, second = trias, shape / 8
        passed, failed = row[: 4 * CRITERIA].reshape(-1, 4)[:, [0, 1]].T
        means = np.divide(passed, failed, out=np.zeros(CRITERIA), where=failed > 0)
        weights = np.where(scoring.active, scoring.weights, 0.0)[:CRITERIA]
        index = weights @ means / weights.sum() + fitness.irregularity * row[IRREGULAR] / 8
        finish = (index / (1.0 + index) + min(fitness.price * operations / 8, 1.0)) / 2.0
        finish += size / (31.0 * 8)
        assert value == pytest.approx(100.0 - first - 60.0 * harm - (second + finish) / 8)


@bounded
@given(meshes(ALL_KINDS), scorings())
def test_many_indices_at_once(mesh, scoring):
    sums = some_sums(mesh, scoring)
    found = _core.compound_indices(sums, scoring.core)
    assert found[:-1].tolist() == [_core.compound_index(row, scoring.core) for row in sums[:-1]]
    assert np.isnan(found[-1])


@bounded
@given(arrays(np.float64, (6, CRITERIA), elements=st.floats(allow_nan=True, width=64)), scorings())
def test_any_value_has_a_penalty(values, scoring):
    penalties = _core.penalise(values, scoring.core)
    counts = scoring.active[:CRITERIA] & ~np.isnan(values)
    np.testing.assert_array_equal(np.isnan(penalties), ~counts)
    low, high = scoring.penalties[[0, 4]]
    assert ((penalties >= low) & (penalties <= high * (1.0 + 1e-12)))[counts].all()
    sums = _core.sum_measures(values, np.zeros(6, bool), scoring.core)
    assert sums[ELEMENTS] == 6
    assert np.isfinite(sums).all()


# --- what is refused ----------------------------------------------------------------------------


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
