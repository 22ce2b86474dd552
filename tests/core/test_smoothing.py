"""Smoothing in the core: what was recorded of it, and what always holds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops import _core
from meshops.criteria import STANDARD
from meshops.fitness import Fitness
from meshops.operations import relax as relaxation
from meshops.operations.candidates import Candidates
from meshops.operations.open_diagonal import OpenDiagonal
from meshops.operations.slide import SHIFTS, Curves, SlideSpace
from meshops.operations.smooth import METHODS, SmoothSpace
from meshops.operations.swap_edge import SwapEdge
from meshops.surface import PatchSurface
from meshops.workpiece import Setting, Workpiece
from tests.core.recorded import digest
from tests.meshes import CURVED_KINDS, FLAT_KINDS, make, meshes, shaped, sheet
from tests.test_slide import with_rails

ALL_KINDS = FLAT_KINDS + CURVED_KINDS
bounded = settings(max_examples=40, deadline=None)


def workpiece(mesh):
    return Workpiece(mesh, Setting(STANDARD.at(1.0), Fitness("quality", len(mesh.elements))))


def rows_of(chosen):
    return np.nonzero(chosen)[0].astype(np.int32)


def optimised(mesh, method):
    space = SmoothSpace(workpiece(mesh))
    search = space.search(mesh.points, mesh.elements, method)
    return search.optimise(mesh.points, mesh.elements, rows_of(space.movable))


def slid(mesh, shift):
    space = SlideSpace(with_rails(mesh, mesh))
    beside = space.workpiece.topology.border_neighbours
    neighbours = np.where(space.slides[:, None], beside, -1).astype(np.int32)
    search = space.search(mesh.points, mesh.elements, "even")
    curves = Curves(neighbours, space.rails.reshape(-1, 6), 0.007)
    return search.slide(mesh.points, mesh.elements, rows_of(space.movable), curves, shift)


def free_last(mesh):
    """Points and elements of a mesh whose free nodes come last, and the first of them."""
    free = workpiece(mesh).topology.free_nodes
    order = np.argsort(free, kind="stable")
    rank = np.append(np.argsort(order), -1).astype(np.int32)
    return mesh.points[order], rank[mesh.elements], int(np.count_nonzero(~free))


def candidates_of(operation, piece, monkeypatch):
    """The candidates of an operation on a mesh, as they are before they are relaxed."""
    seen = []

    def keep(_, candidates, **__):
        seen.append(candidates)
        return candidates

    with monkeypatch.context() as patched:
        patched.setattr(f"{operation.__module__}.relax", keep)
        operation().search_space(piece, np.random.default_rng(0))
    return seen[0]


FLAT = sheet(9, 8, seed=6, jitter=0.35, trias=0.15)
BENT = shaped(FLAT, lambda x, y: (x, y, 0.04 * (x - 4) * (x - 4) + 0.02 * x * y))
MESHES = pytest.mark.parametrize("mesh", [FLAT, BENT], ids=["flat", "bent"])


# --- what was recorded --------------------------------------------------------------------------

RECORDED = {
    "flat": {
        "laplace": "e70ed616bb306f2f",
        "worst": "7d675eb5e6fe3a64",
        "even": "5918e44591a528c3",
        "slide 0.0": "6f8854f8d74f7c68",
        "slide 0.25": "f90d4fa7fcc98baa",
        "slide -0.25": "5ede223d45d47c4a",
        "smooth": "d9c53bc2a7ca50e4",
        "relax": "d763ae01bc1cb34e",
    },
    "bent": {
        "laplace": "d5c9ff003375ceb1",
        "worst": "98a73e2c0aea2ef9",
        "even": "6148d9d80fc87963",
        "slide 0.0": "fb8e9acdc1bea407",
        "slide 0.25": "a82c7eeef62d807d",
        "slide -0.25": "51360c0cffb2e4fc",
        "smooth": "c56acab3a5282d7a",
        "relax": "ab28ed5da880b28a",
    },
}


@MESHES
def test_places_are_those_recorded(mesh, monkeypatch, request):
    points, elements, first = free_last(mesh)
    piece = workpiece(mesh)
    opened = candidates_of(OpenDiagonal, piece, monkeypatch)
    found = {
        **{method: optimised(mesh, method) for method in METHODS},
        **{f"slide {shift}": slid(mesh, shift) for shift in SHIFTS},
        "smooth": _core.smooth_laplace(points, elements, first, 5),
        "relax": _core.relax_candidates(opened, piece, 400, 3),
    }
    recorded = {name: digest(places) for name, places in found.items()}
    assert recorded == RECORDED[request.node.callspec.id]


# --- what always holds --------------------------------------------------------------------------


@bounded
@given(meshes(ALL_KINDS), st.integers(0, 4))
def test_smoothing_makes_no_corner_worse_and_moves_free_nodes_only(mesh, sweeps):
    points, elements, first = free_last(mesh)
    before = points.copy()
    after = _core.smooth_laplace(points, elements, first, sweeps)
    np.testing.assert_array_equal(points, before)
    np.testing.assert_array_equal(after[:first], points[:first])
    for least in (-0.5, 0.0, 0.2, 0.5, 0.8):
        valid = _core.valid_elements(points, elements, least).all()
        assert not valid or _core.valid_elements(after, elements, least).all()


@bounded
@given(meshes(ALL_KINDS), st.sampled_from(METHODS))
def test_what_is_given_is_not_written_to(mesh, method):
    before = mesh.points.copy()
    moved = (optimised(mesh, method) != before).any(axis=1)
    assert not (moved & ~workpiece(mesh).topology.free_nodes).any()
    np.testing.assert_array_equal(mesh.points, before)


@bounded
@given(meshes(ALL_KINDS), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_points_come_to_the_surface_and_stay_there(mesh, x, y):
    surface = workpiece(mesh).surface
    once = _core.project(surface.points + np.array([x, y, 0.3]), surface)
    np.testing.assert_allclose(_core.project(once, surface), once, atol=1e-12)
    np.testing.assert_allclose(_core.project(surface.points, surface), surface.points, atol=1e-12)


@MESHES
@pytest.mark.parametrize("operation", [OpenDiagonal, SwapEdge])
def test_candidates_are_relaxed_each_on_its_own(mesh, operation, monkeypatch):
    piece = workpiece(mesh)
    candidates = candidates_of(operation, piece, monkeypatch)
    together = relaxation.relax(piece, candidates)
    assert (together.points != candidates.points).any() or not len(candidates.points)
    assert len(together.moved) > len(candidates.moved)
    for k in range(0, len(candidates), 7):
        rows = np.array([k], np.int32)
        alone, same = relaxation.relax(piece, candidates.take(rows)), together.take(rows)
        for one, other in zip(alone.arrays, same.arrays, strict=True):
            np.testing.assert_array_equal(one, other)


def test_a_candidate_among_too_many_elements_stays_as_it_is(monkeypatch):
    piece = workpiece(FLAT)
    candidates = candidates_of(OpenDiagonal, piece, monkeypatch)
    points, _, moved, moved_to = _core.relax_candidates(candidates, piece, 3, 3)
    np.testing.assert_array_equal(points, candidates.points)
    stays = ~np.isin(moved, candidates.moved)
    np.testing.assert_array_equal(moved_to[stays], FLAT.points[moved[stays]])


def test_no_candidates_are_none_when_relaxed():
    none = Candidates.padded(np.zeros((0, 2), np.int32), np.zeros((0, 1, 4), np.int32))
    assert len(relaxation.relax(workpiece(FLAT), none)) == 0


# --- what does not fit --------------------------------------------------------------------------


def test_what_does_not_fit_is_refused(monkeypatch):
    points, elements = FLAT.points, FLAT.elements
    space = SmoothSpace(workpiece(FLAT))
    search = space.search(points, elements, "worst")
    nodes = rows_of(space.movable)
    nothing = np.full((len(points), 2), -1, np.int32)
    half = nothing.copy()
    half[nodes[0], 0] = 1
    rails = np.zeros((0, 6))
    with pytest.raises(ValueError, match="a node is to move that is not there"):
        search.optimise(points, elements, nodes + 1000)
    with pytest.raises(ValueError, match="names a node that is not there"):
        search.optimise(points[:5], elements, nodes[:1])
    with pytest.raises(ValueError, match="two neighbours"):
        search.slide(points, elements, nodes, Curves(half, rails, 0.1), 0.0)
    with pytest.raises(ValueError, match="row of neighbours"):
        search.slide(points, elements, nodes, Curves(nothing[1:], rails, 0.1), 0.0)
    with pytest.raises(ValueError, match="no goal best"):
        space.search(points, elements, "best")
    with pytest.raises(ValueError, match="names a node that is not there"):
        _core.smooth_laplace(points[:5], elements, 0, 1)
    candidates = candidates_of(SwapEdge, space.workpiece, monkeypatch)
    candidates.added[0, 0] = len(points)
    with pytest.raises(ValueError, match="names a node that is not there"):
        relaxation.relax(space.workpiece, candidates)


def test_nothing_breaks_where_there_is_little():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5]])
    elements = np.array([[0, 1, 2, -1]], np.int32)
    lone = np.array([3], np.int32)
    for goal in METHODS:
        surface = PatchSurface.of(points, elements)
        search = _core.NodeSearch(goal, surface, 0.1, 0.05, STANDARD.at(1.0).core)
        np.testing.assert_array_equal(search.optimise(points, elements, lone), points)
    np.testing.assert_array_equal(_core.smooth_laplace(points, elements, 3, 2), points)
    np.testing.assert_array_equal(_core.smooth_laplace(points, elements, 9, 2), points)


@pytest.mark.parametrize("kind", ALL_KINDS)
def test_every_kind_of_mesh_can_be_smoothed(kind):
    mesh = make(kind, 3)
    for method in METHODS:
        assert np.isfinite(optimised(mesh, method)).all()
