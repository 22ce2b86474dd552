"""Local edits in the core: what was recorded of them, what always holds, and what is refused.

What is recorded is of criteria that look at no angle: these may differ in the last bit.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops import _core
from meshops.criteria import STANDARD
from meshops.edit import apply
from meshops.fitness import Fitness
from meshops.operations.candidates import Candidates
from meshops.operations.judge import judge
from meshops.operations.open_diagonal import OpenDiagonal
from meshops.operations.places import crossable_pairs
from meshops.operations.replace_node import ReplaceNodeSpace, merge, mergeable_pairs
from meshops.quality_sums import ELEMENTS, IRREGULAR
from meshops.topology import element_normals
from meshops.workpiece import Setting, Workpiece
from tests.core.recorded import digest, outline
from tests.meshes import CURVED_KINDS, FLAT_KINDS, meshes, paraboloid, sheet

ANGLES = ("warpage", "max angle quad", "min angle quad", "max angle tria", "min angle tria", "skew")
WITHOUT_ANGLES = STANDARD.having(
    *(replace(STANDARD[name], active=False) for name in ANGLES), name="without angles"
)
ALL_KINDS = FLAT_KINDS + CURVED_KINDS
LISTS = {
    "join trias": (lambda piece: _core.join_trias(piece.mesh.elements, trias_of(piece))),
    "swap edges": (lambda piece: _core.swap_edges(piece.mesh.elements, crossable_pairs(piece))),
    "collapse diagonals": (lambda piece: collapsed(piece)),
    "open diagonals": (lambda piece: opened(piece)),
}
RECORDED = {
    "plane": sheet(14, 11, seed=5, jitter=0.2, trias=0.15, holes=0.04),
    "curved": paraboloid(sheet(9, 10, seed=6, jitter=0.15, trias=0.2)),
}
recorded = pytest.mark.parametrize("shape", RECORDED)
seeds = st.integers(0, 10**6)


def workpiece(mesh, criteria=STANDARD):
    return Workpiece(mesh, Setting(criteria.at(1.0), Fitness("quality", len(mesh.elements))))


def trias_of(piece):
    pairs = crossable_pairs(piece)
    return pairs[piece.mesh.is_tria[pairs].all(axis=1)]


def collapsed(piece):
    mesh, free = piece.mesh, piece.topology.free_nodes
    rows = np.nonzero(~mesh.is_tria)[0].astype(np.int32)
    return _core.collapse_diagonals(rows, mesh.points, mesh.elements, piece.around, free)


def opened(piece):
    mesh = piece.mesh
    nodes = np.arange(len(mesh.points), dtype=np.int32)
    return _core.open_diagonals(nodes, 6, mesh.points, mesh.elements, piece.around)


def parts(candidates):
    """Elements that go, elements that come, and nodes that move, of each candidate."""
    starts = (candidates.removed_start, candidates.added_start, candidates.moved_start)
    for k in range(len(candidates)):
        removed, added, moved = (slice(start[k], start[k + 1]) for start in starts)
        yield candidates.removed[removed], candidates.added[added], candidates.moved[moved]


def assert_sums_of(mesh, sums):
    """Irregular nodes are left out: which are inner nodes changes where features come or go."""
    expected, counted = workpiece(mesh).tally, np.arange(len(sums)) != IRREGULAR
    np.testing.assert_allclose(sums[counted], expected[counted], rtol=1e-9, atol=1e-8)


# --- merging nodes ------------------------------------------------------------------------------


def genomes_of(piece, rng, count=40):
    """A pool of pairs, and genomes of pairs that are near to each other or not there."""
    pairs, on_border = mergeable_pairs(piece.topology)
    if not len(pairs):
        return None
    rows = rng.permutation(len(pairs))
    pairs, on_border = pairs[rows], on_border[rows]
    first = rng.integers(0, len(pairs), count)
    middles = piece.mesh.points[pairs[:, :2]].mean(axis=1)
    away = ((middles[first][:, None] - middles) ** 2).sum(axis=2)
    near = np.argsort(away, axis=1, kind="stable")[:, rng.integers(0, min(24, len(pairs)), 3)]
    drawn = rng.integers(0, 2 * len(pairs), (count, near.shape[1]))
    return np.concatenate([near, drawn]).astype(np.int64), pairs, on_border


@recorded
def test_merges_are_those_recorded(shape):
    piece = workpiece(RECORDED[shape], WITHOUT_ANGLES)
    drawn = genomes_of(piece, np.random.default_rng(1), count=100)
    normals, scoring = element_normals(piece.mesh), piece.setting.scoring.core
    measured = _core.evaluate_merges(*drawn, normals, piece, scoring)
    counted = _core.evaluate_merges(*drawn, normals, piece, None)
    assert 20 < np.isfinite(measured[:, ELEMENTS]).sum() < 180
    expected = {"plane": "4d894b6bffae2d32", "curved": "13e4f1360aafd708"}
    assert digest(measured, counted) == expected[shape]


@settings(max_examples=40, deadline=None)
@given(meshes(ALL_KINDS), seeds)
def test_a_merge_has_the_sums_of_the_mesh_that_it_makes(mesh, seed):
    piece = workpiece(mesh)
    drawn = genomes_of(piece, np.random.default_rng(seed), count=6)
    if drawn is None:
        return
    genomes, pairs, on_border = drawn
    space = ReplaceNodeSpace(piece, 3, pairs, on_border)
    for genome, sums in zip(genomes, space.tallies(genomes), strict=True):
        if np.isfinite(sums[ELEMENTS]):
            assert_sums_of(apply(mesh, merge(piece, pairs[genome[genome < len(pairs)]])), sums)


def test_elements_are_rewired_as_recorded():
    mesh, rng = RECORDED["plane"], np.random.default_rng(2)
    target = np.arange(len(mesh.points), dtype=np.int32)
    some = rng.integers(0, len(target), len(target) // 3)
    target[some] = rng.integers(0, len(target), len(some))
    assert digest(*_core.rewire(mesh.elements, target)) == "8576fb602b154701"


# --- candidates ---------------------------------------------------------------------------------


def spoilt(candidates, mesh, rng):
    """The candidates with some rows, nodes and places drawn anew, so that most make no mesh."""

    def redrawn(values, share, high):
        drawn = rng.integers(0, high, values.shape).astype(np.int32)
        return np.where(rng.random(values.shape) < share, drawn, values)

    share, nodes, to = rng.choice([0.02, 0.2]), len(mesh.points), candidates.moved_to
    return replace(
        candidates,
        removed=redrawn(candidates.removed, share, len(mesh.elements)),
        added=redrawn(candidates.added, share, nodes + 2),
        moved=redrawn(candidates.moved, share, nodes),
        moved_to=to + rng.choice([0.0, 0.1, 0.5]) * rng.uniform(-1.0, 1.0, to.shape),
    )


@pytest.mark.parametrize(
    ("shape", "name", "listed", "judged"),
    [
        ("plane", "join trias", "02f1d9197e579be4", "4c60a17c86a9e31d"),
        ("plane", "swap edges", "ae541b3fce8dfbfc", "365d0c44355acae3"),
        ("plane", "collapse diagonals", "7c414ca87b752956", "1482bdd0b16e059a"),
        ("plane", "open diagonals", "c09acea23b916121", "ea61adbe927ab272"),
        ("curved", "join trias", "44b390cdc633abcc", "99eba32754951408"),
        ("curved", "swap edges", "cb423bc4b19a20ab", "addd196c1ac6dfc0"),
        ("curved", "collapse diagonals", "ee551a3051499300", "7b54a22530bf3174"),
        ("curved", "open diagonals", "b8bdbd3a22d3fa10", "114f0a51193ad987"),
    ],
)
def test_candidates_are_those_recorded(shape, name, listed, judged):
    piece, rng = workpiece(RECORDED[shape], WITHOUT_ANGLES), np.random.default_rng(3)
    candidates = Candidates(*LISTS[name](piece))
    amiss = spoilt(candidates, piece.mesh, rng)
    found = judge(piece, candidates)
    assert np.isfinite(found[:, ELEMENTS]).any()
    assert digest(candidates.arrays) == listed
    assert digest(found, judge(piece, amiss)) == judged


@settings(max_examples=40, deadline=None)
@given(meshes(ALL_KINDS), st.sampled_from(sorted(LISTS)))
def test_what_comes_has_the_outline_of_what_goes(mesh, name):
    candidates = Candidates(*LISTS[name](workpiece(mesh)))
    for removed, added, _ in parts(candidates):
        assert outline(added) == outline(mesh.elements[removed])


@settings(max_examples=40, deadline=None)
@given(meshes(ALL_KINDS), st.sampled_from(sorted(LISTS)), seeds)
def test_a_candidate_has_the_sums_of_the_mesh_that_it_makes(mesh, name, seed):
    piece, rng = workpiece(mesh), np.random.default_rng(seed)
    candidates = spoilt(Candidates(*LISTS[name](piece)), mesh, rng)
    sums = judge(piece, candidates)
    for k in np.nonzero(np.isfinite(sums[:, ELEMENTS]))[0][:8]:
        assert_sums_of(apply(mesh, candidates.edit(int(k), mesh.region)), sums[k])


def needs_of(candidates, piece):
    """What each candidate needs: nodes as they are, elements as pairs."""
    elements, (start, around) = piece.mesh.elements, piece.around
    for removed, added, moved in parts(candidates):
        nodes = set(elements[removed].ravel().tolist()) | set(added.ravel().tolist())
        deformed = [around[start[node] : start[node + 1]] for node in moved]
        rows = np.concatenate([removed, *deformed])
        yield {n for n in nodes if 0 <= n < len(start) - 1} | {("e", int(row)) for row in rows}


@settings(max_examples=40, deadline=None)
@given(meshes(ALL_KINDS), st.sampled_from(sorted(LISTS)), seeds)
def test_of_candidates_that_need_the_same_the_first_is_done(mesh, name, seed):
    piece, rng = workpiece(mesh), np.random.default_rng(seed)
    candidates = spoilt(Candidates(*LISTS[name](piece)), mesh, rng)
    changes = rng.normal(size=(len(candidates), len(piece.tally)))
    genomes = rng.integers(0, max(1, 2 * len(candidates)), (10, rng.integers(0, 9)))
    sums, taken = _core.Claims(candidates, mesh.elements, piece.around).combine(genomes, changes)
    needs = list(needs_of(candidates, piece))
    for genome, total, done in zip(genomes, sums, taken, strict=True):
        claimed, expected = set(), np.zeros(len(total))
        for gene, is_done in zip(genome, done, strict=True):
            clear = gene < len(candidates) and not claimed & needs[gene]
            assert is_done == clear
            if clear:
                claimed |= needs[gene]
                expected += changes[gene]
        np.testing.assert_array_equal(total, expected)


@given(st.integers(0, 40), st.lists(st.tuples(st.integers(-9, 60), st.integers(-9, 60))))
def test_ranges_select_the_numbers_in_them(count, ranges):
    selected = _core.select_ranges(np.array(ranges, np.int32).reshape(-1, 2), count)
    numbers = {n for ends in ranges for n in range(min(ends), max(ends) + 1)}
    assert selected.tolist() == [n in numbers for n in range(1, count + 1)]


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
    moved, to = candidates.moved[:1], candidates.moved_to[:1]
    candidates = replace(
        candidates, moved_start=np.array([0, 1], np.int32), moved=moved, moved_to=to
    )
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
    with pytest.raises(ValueError, match="no such"):
        _core.swap_edges(piece.mesh.elements, np.array([[0, 99]], np.int32))
