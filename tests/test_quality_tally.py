"""Penalties, and the tally that an edit changes, against a plain computation."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops._core import Scoring, compound_index, compound_indices, penalty_of, sum_elements
from meshops.criteria import CRITERIA, NAMES, PAPER, STANDARD, Criterion
from meshops.mesh import ShellMesh
from meshops.quality import (
    element_index,
    element_penalties,
    element_values,
    failed_elements,
)
from meshops.quality_sums import ELEMENTS, FAILED, QUADS, TALLY_SIZE, TRIAS

SCORING = STANDARD.at(1.0)
WEIGHTED = replace(
    STANDARD,
    criteria=tuple(replace(c, weight=0.5 + i) for i, c in enumerate(STANDARD.criteria)),
).having(replace(STANDARD["skew"], active=False), name="weighted", penalties=(0, 0.1, 0.5, 2, 7))


def random_mesh(seed, *, noise=0.3, side=6):
    """A noisy sheet of unit quads of which some are split into trias."""
    rng = np.random.default_rng(seed)
    grid = np.arange(side * side).reshape(side, side)
    points = np.stack([*np.divmod(grid.ravel(), side), 0 * grid.ravel()], axis=1)[:, [1, 0, 2]]
    points = points + rng.uniform(-noise, noise, points.shape)
    quads = np.stack([grid[:-1, :-1], grid[:-1, 1:], grid[1:, 1:], grid[1:, :-1]], -1)
    quads = quads.reshape(-1, 4)
    split = rng.random(len(quads)) < 0.2
    first, second = quads[split][:, [0, 1, 2, 2]], quads[split][:, [0, 2, 3, 3]]
    trias = np.concatenate([first, second])
    trias[:, 3] = -1
    return ShellMesh.build(points, np.concatenate([quads[~split], trias]))


def plain_penalty(value, levels, penalties):
    levels = np.asarray(levels)[:5]
    sign = 1 if levels[-1] > levels[0] else -1
    return np.interp(sign * value, sign * levels, penalties)


def plain_index(weights, penalties, failing):
    passing = [(w, p) for w, p, f in zip(weights, penalties, failing, strict=True) if not f]
    total = sum(w for w, _ in passing)
    mean = sum(w * p for w, p in passing) / total if total else 0.0
    return mean + sum(w * p for w, p, f in zip(weights, penalties, failing, strict=True) if f)


def plain_compound(mesh, scoring):
    """Compound Q.I. and failed elements straight from their definitions."""
    limit = scoring.penalties[3]
    values = element_values(mesh, scoring)
    weights, indices, failing, failed = [], [], [], set()
    for c, criterion in enumerate(scoring.criteria.criteria[:CRITERIA]):
        if not scoring.active[c]:
            continue
        found = {
            i: plain_penalty(v, scoring.levels[c], scoring.penalties)
            for i, v in enumerate(values[:, c])
            if not math.isnan(v)
        }
        bad = {i for i, p in found.items() if p > limit}
        good = [p for i, p in found.items() if i not in bad]
        indices.append((np.mean(good) if good else 0.0) + sum(found[i] for i in bad))
        failing.append(bool(bad))
        weights.append(criterion.weight)
        failed |= bad
    if scoring.active[12]:
        share = 100 * mesh.is_tria.mean()
        indices.append(plain_penalty(share, scoring.levels[12], scoring.penalties))
        failing.append(indices[-1] > limit)
        weights.append(scoring.weights[12])
    return plain_index(weights, indices, failing), failed


@pytest.mark.parametrize("criterion", STANDARD.criteria, ids=NAMES)
def test_published_penalties_at_the_levels(criterion):
    row = NAMES.index(criterion.name)
    found = [penalty_of(level, row, SCORING.core) for level in criterion.levels]
    assert found == pytest.approx([0, 0, 0.8, 1, 10])
    beyond = 2 * criterion.levels[4] - criterion.levels[0]
    before = 2 * criterion.levels[0] - criterion.levels[4]
    assert penalty_of(beyond, row, SCORING.core) == 10
    assert penalty_of(before, row, SCORING.core) == 0
    assert math.isnan(penalty_of(math.nan, row, SCORING.core))


def test_max_length_of_figure_5():
    # two elements of 8.00 where 7.50 fails: the figure's Q.I. is 8.08
    scoring = PAPER.at(5.0)
    assert 2 * penalty_of(8.0, 1, scoring.core) == pytest.approx(8.0)


@settings(max_examples=100, deadline=None)
@given(st.sampled_from(range(13)), st.floats(-500, 500), st.floats(-500, 500))
def test_penalties_are_monotone_and_linear_between_levels(row, x, y):
    levels = SCORING.levels[row]
    if levels[4] < levels[0]:
        x, y = max(x, y), min(x, y)
    else:
        x, y = min(x, y), max(x, y)
    better, worse = (penalty_of(v, row, SCORING.core) for v in (x, y))
    assert 0 <= better <= worse + 1e-12 <= 10 + 1e-11
    assert better == pytest.approx(plain_penalty(x, levels, SCORING.penalties), abs=1e-12)


def test_equal_levels_make_a_step():
    levels = SCORING.levels.copy()
    levels[0] = 0.0, 0.0, 5.0, 5.0, 5.0, math.inf
    steps = Scoring(levels, *SCORING.arrays[1:])
    found = [penalty_of(v, 0, steps) for v in (0.0, 2.5, 5.0, 5.1)]
    assert found == pytest.approx([0, 0.4, 0.8, 10])


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from([STANDARD, PAPER, WEIGHTED]))
def test_compound_index_is_that_of_its_definition(seed, criteria):
    mesh, scoring = random_mesh(seed), criteria.at(1.0)
    tally = sum_elements(mesh.points, mesh.elements, scoring.core)
    compound, failed = plain_compound(mesh, scoring)
    assert compound_index(tally, scoring.core) == pytest.approx(compound, rel=1e-10)
    assert set(np.flatnonzero(failed_elements(mesh, scoring))) == failed
    counts = [len(mesh.elements), (~mesh.is_tria).sum(), mesh.is_tria.sum(), len(failed)]
    assert tally[[ELEMENTS, QUADS, TRIAS, FAILED]].tolist() == counts


@settings(max_examples=100, deadline=None)
@given(st.integers(0, 10**6))
def test_element_index_is_that_of_its_definition(seed):
    mesh, scoring = random_mesh(seed, side=3), WEIGHTED.at(1.0)
    found = element_index(mesh, scoring)
    for row, index in zip(element_penalties(mesh, scoring), found, strict=True):
        applies = ~np.isnan(row)
        weights = scoring.weights[:CRITERIA][applies]
        assert index == pytest.approx(plain_index(weights, row[applies], row[applies] > 2))


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10**6), st.floats(1e-3, 1e3))
def test_quality_does_not_depend_on_the_unit_of_length(seed, scale):
    mesh = random_mesh(seed, noise=0.2)
    scaled = ShellMesh.build(mesh.points * scale, mesh.elements)
    here, there = PAPER.at(1.0), PAPER.at(scale)
    np.testing.assert_allclose(
        element_penalties(scaled, there), element_penalties(mesh, here), atol=1e-7
    )
    np.testing.assert_array_equal(failed_elements(scaled, there), failed_elements(mesh, here))


@pytest.mark.parametrize(
    "nodes", [(0, 1, 1, 2), (0, 0, 0, 0), (0, 1, 3, 1), (0, 1, 1, -1), (0, 1, 3, -1)]
)
def test_degenerate_elements_take_the_worst_penalty(nodes):
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0]])
    tally = sum_elements(points, np.array([nodes], np.int32), SCORING.core)
    assert np.isfinite(tally).all()
    assert tally[FAILED] == 1
    angles = (6, 7) if nodes[3] < 0 else (4, 5)
    assert [tally[4 * c + 2] for c in angles] == [10, 10]
    assert np.isfinite(compound_index(tally, SCORING.core))


def test_rounding_does_not_fail_an_element():
    # the edge of a length of exactly the fail level, in many directions
    scoring = PAPER.having(*(replace(c, active=False) for c in PAPER.criteria[2:]), name="lengths")
    for turn in np.linspace(0, 2 * np.pi, 50):
        along = np.array([np.cos(turn), np.sin(turn), 0.3]) / np.hypot(1, 0.3)
        across = np.array([-np.sin(turn), np.cos(turn), 0.0])
        points = np.array([0 * along, 7.5 * along, 7.5 * along + 2.5 * across, 2.5 * across])
        mesh = ShellMesh.build(points, [[0, 1, 2, 3]])
        assert not failed_elements(mesh, scoring.at(5.0)).any()


def test_criteria_of_trias_stay_in_the_mean_when_the_last_tria_has_gone():
    points = [[0, 0, 0], [1, 0, 0], [1, 1, 0.15], [0, 1, 0], [2, 0.5, 0]]
    quad = ShellMesh.build(points, [[0, 1, 2, 3]])
    tally = sum_elements(quad.points, quad.elements, SCORING.core)
    penalties = np.nansum(element_penalties(quad, SCORING))
    assert 0 < penalties < 1
    assert compound_index(tally, SCORING.core) == pytest.approx(penalties / 12)


def test_nothing_scores_nothing():
    mesh = ShellMesh.build(np.zeros((0, 3)), np.zeros((0, 4)))
    tally = sum_elements(mesh.points, mesh.elements, SCORING.core)
    assert not tally.any()
    assert compound_index(tally, SCORING.core) == 0
    assert len(element_index(mesh, SCORING)) == 0


def test_many_tallies_at_once():
    tallies = np.stack(
        [sum_elements(m.points, m.elements, SCORING.core) for m in map(random_mesh, range(3))]
        + [np.full(TALLY_SIZE, np.nan)]
    )
    found = compound_indices(tallies, SCORING.core)
    assert found[:3].tolist() == [compound_index(t, SCORING.core) for t in tallies[:3]]
    assert np.isnan(found[3])


def test_a_failed_element_counts_alone_and_a_passing_one_on_average():
    only = replace(STANDARD["max length"], levels=(1.0, 1.2, 1.5, 2.0, 3.0), scaled=False)
    off = (replace(c, active=False) for c in STANDARD.criteria if c.name != "max length")
    scoring = STANDARD.having(*off, only, name="length only").at(1.0)
    long, longer = 1.5, 2.5  # penalties 0.8 and 5.5
    points = [[0, 0, 0], [long, 0, 0], [long, 1, 0], [0, 1, 0]]
    points += [[9, 0, 0], [9 + longer, 0, 0], [9 + longer, 1, 0], [9, 1, 0]]
    mesh = ShellMesh.build(points, [[0, 1, 2, 3], [4, 5, 6, 7]])
    tally = sum_elements(mesh.points, mesh.elements, scoring.core)
    assert compound_index(tally, scoring.core) == pytest.approx(0.8 + 5.5)
    assert element_index(mesh, scoring) == pytest.approx([0.8, 5.5])


def test_an_inactive_criterion_counts_nowhere():
    mesh = random_mesh(1)
    worse = Criterion("skew", (0.0, 0.0, 0.0, 0.0, 1e-9), weight=5.0, active=False)
    off = STANDARD.having(replace(STANDARD["skew"], active=False), name="off").at(1.0)
    other = STANDARD.having(worse, name="other").at(1.0)
    np.testing.assert_array_equal(element_index(mesh, off), element_index(mesh, other))
    tallies = [sum_elements(mesh.points, mesh.elements, s.core) for s in (off, other)]
    np.testing.assert_array_equal(*tallies)
    assert compound_index(tallies[0], off.core) == compound_index(tallies[1], other.core)
