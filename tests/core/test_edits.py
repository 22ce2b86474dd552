"""Local edits in the core: bit for bit what the compiled Python gave.

Where criteria look at angles, these differ in the last bit, and so do sums of their penalties.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops import _core
from meshops.criteria import STANDARD
from meshops.fitness import Fitness
from meshops.kernels import merging
from meshops.operations.replace_node import mergeable_pairs
from meshops.topology import element_normals
from meshops.workpiece import Setting, Workpiece
from tests.meshes import CURVED_KINDS, FLAT_KINDS, meshes, sheet

ANGLES = ("warpage", "max angle quad", "min angle quad", "max angle tria", "min angle tria", "skew")
WITHOUT_ANGLES = STANDARD.having(
    *(replace(STANDARD[name], active=False) for name in ANGLES), name="without angles"
)
ALL_KINDS = FLAT_KINDS + CURVED_KINDS


def workpiece(mesh, criteria=STANDARD):
    return Workpiece(mesh, Setting(criteria.at(1.0), Fitness("quality", len(mesh.elements))))


def assert_same_sums(found, expected, criteria):
    """Equal bit for bit, but for the last bits of what follows from angles."""
    if criteria is WITHOUT_ANGLES:
        np.testing.assert_array_equal(found, expected)
    else:
        np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-9)


# --- merging nodes ------------------------------------------------------------------------------


def merges(piece, rng):
    """A pool of pairs, and genomes of some that are near to each other and of some that are not."""
    pairs, on_border = mergeable_pairs(piece.topology)
    if not len(pairs):
        return None
    rows = rng.permutation(len(pairs))
    pairs, on_border = pairs[rows], on_border[rows]
    first = rng.integers(0, len(pairs), 40)
    middles = piece.mesh.points[pairs[:, :2]].mean(axis=1)
    away = np.linalg.norm(middles[first][:, None] - middles, axis=2)
    near = np.argsort(away, axis=1, kind="stable")[:, rng.integers(0, min(24, len(pairs)), 3)]
    drawn = rng.integers(0, 2 * len(pairs), (40, near.shape[1]))
    return np.concatenate([near, drawn]).astype(np.int64), pairs, on_border


@pytest.mark.parametrize("criteria", [WITHOUT_ANGLES, STANDARD], ids=lambda one: one.name)
@settings(max_examples=40, deadline=None)
@given(mesh=meshes(ALL_KINDS), seed=st.integers(0, 10**6), measured=st.booleans())
def test_merges_are_evaluated_as_before(criteria, mesh, seed, measured):
    piece = workpiece(mesh, criteria)
    drawn = merges(piece, np.random.default_rng(seed))
    if drawn is None:
        return
    normals, scoring = element_normals(mesh), piece.setting.scoring
    levels, weights, active, penalties, sizing = scoring.arrays
    expected = merging.evaluate_merges(
        *drawn, mesh.points, mesh.elements, *piece.around, piece.outside, normals, piece.values,
        piece.tally, levels, weights, active & measured, penalties, sizing,
    )  # fmt: skip
    found = _core.evaluate_merges(*drawn, normals, piece, scoring.core if measured else None)
    assert_same_sums(found, expected, criteria)


@settings(max_examples=40, deadline=None)
@given(meshes(ALL_KINDS), st.integers(0, 10**6))
def test_elements_are_rewired_as_before(mesh, seed):
    rng = np.random.default_rng(seed)
    nodes = len(mesh.points)
    target = np.arange(nodes, dtype=np.int32)
    some = rng.integers(0, nodes, nodes // 3)
    target[some] = rng.integers(0, nodes, len(some))
    expected = merging.rewire(mesh.elements, target)
    for one, other in zip(_core.rewire(mesh.elements, target), expected, strict=True):
        np.testing.assert_array_equal(one, other)
        assert one.dtype == other.dtype


def test_what_does_not_fit_is_refused():
    piece = workpiece(sheet(3, 3))
    normals = element_normals(piece.mesh)
    genome, pair = np.zeros((1, 1), np.int64), np.array([[5, 6, 0]], np.int32)
    inside = np.zeros(1, bool)
    assert np.isfinite(_core.evaluate_merges(genome, pair, inside, normals, piece, None)).all()
    for bad in (
        (genome - 1, pair, inside, normals),
        (genome, pair + np.array([0, 99, 0], np.int32), inside, normals),
        (genome, pair + np.array([0, 0, 2], np.int32), inside, normals),
        (genome, pair, inside[:0], normals),
        (genome, pair, inside, normals[1:]),
    ):
        with pytest.raises(ValueError, match=r"pair|gene|normal"):
            _core.evaluate_merges(*bad, piece, None)
    with pytest.raises(ValueError, match="node that is not there"):
        _core.rewire(piece.mesh.elements, np.zeros(3, np.int32))
