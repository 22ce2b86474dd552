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
from meshops.kernels import combining, local_edits, merging, selection
from meshops.kernels.judging import judge_candidates
from meshops.operations.candidates import Candidates
from meshops.operations.collapse_chord import CollapseChord
from meshops.operations.collapse_diagonal import CollapseDiagonal
from meshops.operations.insert_chord import InsertChord
from meshops.operations.judge import SURFACE_TOLERANCE, judge
from meshops.operations.open_diagonal import OpenDiagonal
from meshops.operations.places import crossable_pairs
from meshops.operations.replace_node import mergeable_pairs
from meshops.operations.split_quad import SplitQuad
from meshops.operations.swap_edge import SwapEdge
from meshops.quality_sums import ELEMENTS
from meshops.surface import PLANE_TOLERANCE
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


# --- candidates ---------------------------------------------------------------------------------

OPERATIONS = (
    SplitQuad(), SwapEdge(), CollapseDiagonal(), OpenDiagonal(), CollapseChord(), InsertChord()
)  # fmt: skip


def judged_before(piece, candidates):
    """Quality sums after each candidate, as the compiled Python found them."""
    mesh, topology = piece.mesh, piece.topology
    sums, edges, centres = judge_candidates(
        *candidates.arrays, mesh.points, mesh.elements, topology.element_edges,
        topology.edge_elements, topology.crossable, topology.zones, topology.free_nodes,
        *piece.around, piece.outside, piece.values, piece.tally, *piece.setting.scoring.arrays,
    )  # fmt: skip
    queries = np.concatenate([candidates.points, candidates.moved_to, centres])
    owners = np.concatenate(
        [
            np.repeat(np.arange(len(candidates)), np.diff(start))
            for start in (candidates.point_start, candidates.moved_start, candidates.added_start)
        ]
    )
    wanted = np.isfinite(sums[:, ELEMENTS])[owners]
    queries, owners = queries[wanted], owners[wanted]
    surface = piece.surface
    if surface.plane is not None:
        distance = np.abs((queries - surface.points[0]) @ surface.plane)
        limit = PLANE_TOLERANCE * float(np.ptp(surface.points, axis=0).max())
    else:
        distance = _core.nearest(queries, surface.points, surface.trias, surface.spheres)[1]
        limit = SURFACE_TOLERANCE * edges[owners]
    sums[owners[~(distance <= limit)]] = np.nan
    return sums


def spoilt(candidates, mesh, rng):
    """The candidates with some rows, nodes and places drawn anew, so that most make no mesh."""

    def redrawn(values, share, high):
        drawn = rng.integers(0, high, values.shape).astype(np.int32)
        return np.where(rng.random(values.shape) < share, drawn, values)

    share = rng.choice([0.02, 0.2])
    nodes = len(mesh.points)
    return replace(
        candidates,
        removed=redrawn(candidates.removed, share, len(mesh.elements)),
        added=redrawn(candidates.added, share, nodes + 2),
        moved=redrawn(candidates.moved, share, nodes),
        moved_to=candidates.moved_to + rng.choice([0.0, 0.1, 0.5]) * rng.normal(
            size=candidates.moved_to.shape
        ),
    )  # fmt: skip


@pytest.mark.parametrize("criteria", [WITHOUT_ANGLES, STANDARD], ids=lambda one: one.name)
@settings(max_examples=80, deadline=None)
@given(mesh=meshes(ALL_KINDS), operation=st.sampled_from(OPERATIONS), seed=st.integers(0, 10**6))
def test_candidates_are_judged_as_before(criteria, mesh, operation, seed):
    piece = workpiece(mesh, criteria)
    candidates = operation.candidates(piece)
    assert_same_sums(judge(piece, candidates), judged_before(piece, candidates), criteria)
    amiss = spoilt(candidates, mesh, np.random.default_rng(seed))
    assert_same_sums(judge(piece, amiss), judged_before(piece, amiss), criteria)


@settings(max_examples=60, deadline=None)
@given(meshes(ALL_KINDS), st.sampled_from(OPERATIONS), st.integers(0, 10**6))
def test_candidates_are_combined_as_before(mesh, operation, seed):
    rng = np.random.default_rng(seed)
    piece = workpiece(mesh)
    candidates = operation.candidates(piece)
    count = len(candidates)
    changes = rng.normal(size=(count, len(piece.tally)))
    genomes = rng.integers(0, max(1, 2 * count), (20, rng.integers(0, 9)))
    start, claimed = combining.claims(*candidates.arrays, mesh.elements, *piece.around)
    most = len(mesh.points) + len(mesh.elements)
    expected = combining.combine(genomes, start, claimed, most, changes)
    found = _core.Claims(candidates, mesh.elements, piece.around).combine(genomes, changes)
    for one, other in zip(found, expected, strict=True):
        np.testing.assert_array_equal(one, other)
        assert one.dtype == other.dtype


def assert_same_candidates(found, expected):
    for one, other in zip(found, expected.arrays, strict=True):
        np.testing.assert_array_equal(one, other)
        assert one.dtype == other.dtype


@settings(max_examples=60, deadline=None)
@given(meshes(ALL_KINDS))
def test_local_edits_are_listed_as_before(mesh):
    piece = workpiece(mesh)
    points, elements, around = mesh.points, mesh.elements, piece.around
    rows = np.arange(len(elements), dtype=np.int32)

    collapsed = local_edits.collapse_diagonals(
        rows[~mesh.is_tria], points, elements, *around, piece.topology.free_nodes
    )
    assert_same_candidates(
        _core.collapse_diagonals(
            rows[~mesh.is_tria], points, elements, around, piece.topology.free_nodes
        ),
        Candidates.padded(*collapsed[:2], moved=collapsed[2], moved_to=collapsed[3]),
    )
    nodes = np.arange(len(points), dtype=np.int32)
    assert_same_candidates(
        _core.open_diagonals(nodes, 6, points, elements, around),
        Candidates.padded(*local_edits.open_nodes(nodes, 6, points, elements, *around)),
    )
    pairs = crossable_pairs(piece)
    trias = pairs[mesh.is_tria[pairs].all(axis=1)]
    polygons = local_edits.pair_polygons(elements, trias)[0]
    assert_same_candidates(
        _core.join_trias(elements, trias), Candidates.padded(trias, polygons[:, None, :4])
    )
    polygons, sizes = local_edits.pair_polygons(elements, pairs)
    assert_same_candidates(
        _core.swap_edges(elements, pairs), swapped_before(pairs, polygons, sizes)
    )


def swapped_before(pairs, polygons, sizes):
    turns_of = {
        6: (((1, 2, 3, 4), (4, 5, 0, 1)), ((2, 3, 4, 5), (5, 0, 1, 2))),
        5: (((4, 0, 1, -1), (1, 2, 3, 4)), ((2, 3, 4, -1), (4, 0, 1, 2))),
        4: (((1, 2, 3, -1), (3, 0, 1, -1)),),
    }
    removed = np.full((len(pairs), 2, 2), -1, np.int32)
    added = np.full((len(pairs), 2, 2, 4), -1, np.int32)
    for size, turns in turns_of.items():
        rows = np.nonzero(sizes == size)[0]
        for variant, turn in enumerate(turns):
            removed[rows, variant] = pairs[rows]
            places = np.array(turn)
            added[rows, variant] = np.where(places >= 0, polygons[rows][:, places], -1)
    return Candidates.padded(removed.reshape(-1, 2), added.reshape(-1, 2, 4))


@given(st.integers(1, 40), st.data())
def test_ranges_are_selected_as_before(count, data):
    numbers = st.lists(st.integers(1, count), min_size=0, max_size=12)
    drawn = data.draw(numbers)
    ranges = np.array(drawn[: len(drawn) // 2 * 2], np.int32).reshape(-1, 2)
    expected = selection.select_ranges(ranges, count)
    np.testing.assert_array_equal(_core.select_ranges(ranges, count), expected)


# --- what is refused ----------------------------------------------------------------------------


@pytest.mark.parametrize(
    "changes",
    [
        {"removed": np.array([99], np.int32)},
        {"removed_start": np.array([0, 3], np.int32)},
        {"removed_start": np.array([1, 1], np.int32)},
        {"added_start": np.array([0, 1, 2], np.int32)},
        {"moved": np.array([-1], np.int32)},
        {"moved_to": np.zeros((2, 3))},
        {"added": np.zeros((2, 3), np.int32)},
    ],
    ids=str,
)
def test_candidates_that_do_not_fit_are_refused(changes):
    piece = workpiece(sheet(3, 3))
    candidates = OpenDiagonal(pool=1).candidates(piece).take(np.zeros(1, np.int32))
    candidates = replace(
        candidates, moved_start=np.array([0, 1], np.int32),
        moved=candidates.moved[:1], moved_to=candidates.moved_to[:1],
    )  # fmt: skip
    assert judge(piece, candidates).shape == (1, 56)
    with pytest.raises(ValueError, match=r"list|not there|place|shape"):
        judge(piece, replace(candidates, **changes))
    with pytest.raises(ValueError, match=r"list|not there|place|shape"):
        _core.Claims(replace(candidates, **changes), piece.mesh.elements, piece.around)


def test_merges_that_do_not_fit_are_refused():
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
