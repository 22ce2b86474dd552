"""Smooth: what gets better, and what must not change."""

from dataclasses import replace
from functools import lru_cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops._core import element_faults
from meshops.criteria import PAPER, STANDARD, Criterion
from meshops.criteria_files import OFF
from meshops.edit import apply
from meshops.examples import plate
from meshops.fitness import Fitness
from meshops.operations.smooth import METHODS, RINGS, Smooth
from meshops.quality import element_index, failed_elements
from meshops.quality_sums import FAILED
from meshops.topology import element_normals, topology
from meshops.workpiece import Setting, Workpiece
from tests.meshes import (
    CURVED_KINDS,
    FLAT_KINDS,
    PLANE_KINDS,
    barriers,
    centre,
    cylinder,
    distances_to_trias,
    meshes,
    shaped,
    sheet,
    trias_of,
    unsound,
    with_,
)

EVERYWHERE = 30
"""Rings that reach every node of these meshes."""

LAPLACE, WORST, EVEN = range(3)
ONLY_TRIAS = OFF.having(
    Criterion("min angle tria", (60.0, 59.0, 58.0, 57.0, 1.0)), name="only trias"
)
SMOOTH = Smooth()
PLACES = st.lists(
    st.tuples(st.integers(1, 12), st.sampled_from(RINGS), st.integers(0, 2)),
    min_size=1,
    max_size=2,
)


def workpiece(mesh, criteria=STANDARD, size=1.0):
    return Workpiece(mesh, Setting(criteria.at(size), Fitness("quality", len(mesh.elements))))


def smoothed(work, *places):
    return apply(work.mesh, SMOOTH.apply(work, np.array(places, np.int32).reshape(-1, 3)))


def worst_and_failing(mesh, scoring):
    return element_index(mesh, scoring).max(), np.count_nonzero(failed_elements(mesh, scoring))


def rough(seed, jitter=0.35, columns=8):
    return sheet(columns, columns, seed=seed, jitter=jitter, trias=0.1)


def dome(mesh, radius=12.0):
    """Laid on a sphere."""
    half = mesh.points[:, 0].max() / 2

    def shape(x, y):
        x, y = x - half, y - half
        return x, y, np.sqrt(radius**2 - x**2 - y**2)

    return shaped(mesh, shape)


@lru_cache
def jittered_plate():
    mesh = plate()
    free = topology(mesh).free_nodes
    points = mesh.points.copy()
    points[free, :2] += np.random.default_rng(5).uniform(-1.6, 1.6, (np.count_nonzero(free), 2))
    return with_(mesh, points=points)


# --- what gets better ---------------------------------------------------------------------------


@settings(deadline=None)
@given(meshes(FLAT_KINDS + CURVED_KINDS), PLACES)
def test_never_do_more_elements_fail_nor_does_the_worst_get_worse(mesh, places):
    work = workpiece(mesh)
    worst, failing = worst_and_failing(mesh, work.setting.scoring)
    after = smoothed(work, *places)
    worst_after, failing_after = worst_and_failing(after, work.setting.scoring)
    assert failing_after <= failing
    if all(method != EVEN for _, _, method in places):
        assert worst_after <= worst + 1e-9


@settings(deadline=None)
@given(meshes(PLANE_KINDS), st.integers(1, 12), st.sampled_from(RINGS))
def test_even_lowers_the_mean_where_no_fewer_fail(mesh, rank, rings):
    work = workpiece(mesh)
    scoring = work.setting.scoring
    after = smoothed(work, (rank, rings, EVEN))
    if np.count_nonzero(failed_elements(after, scoring)) == np.count_nonzero(work.failing):
        assert element_index(after, scoring).sum() <= element_index(mesh, scoring).sum() + 1e-9


@pytest.mark.parametrize("method", [WORST, EVEN])
@pytest.mark.parametrize("seed", range(3))
def test_the_jitter_of_a_lattice_no_longer_fails(seed, method):
    work = workpiece(rough(seed))
    assert work.failing.any()
    after = smoothed(work, (1, EVERYWHERE, method))
    assert not failed_elements(after, work.setting.scoring).any()


def test_laplace_makes_a_jittered_lattice_regular():
    lattice = sheet(6, 6)
    work = workpiece(sheet(6, 6, seed=2, jitter=0.3))
    after = smoothed(work, *[(1, EVERYWHERE, LAPLACE)] * 4)
    assert np.abs(after.points - lattice.points).max() < 0.1
    assert np.abs(work.mesh.points - lattice.points).max() > 0.25


def test_the_plate_with_jittered_nodes_has_no_failing_element_after_worst():
    mesh = jittered_plate()
    before = workpiece(mesh, PAPER, 5.0)
    after = smoothed(before, *[(1, EVERYWHERE, WORST)] * 2)
    assert np.count_nonzero(before.failing) > 50
    assert not failed_elements(after, before.setting.scoring).any()


def test_one_ring_moves_only_the_nodes_around_one_element():
    work = workpiece(rough(1))
    near, far = (SMOOTH.apply(work, np.array([(1, r, WORST)], np.int32)) for r in (1, 4))
    assert 0 < len(near.moved) < len(far.moved)
    worst = work.mesh.points[work.mesh.elements[work.bad_elements[0]][:3]].mean(axis=0)
    assert np.linalg.norm(near.moved_to - worst, axis=1).max() < 3


def test_places_are_smoothed_one_after_the_other():
    work = workpiece(rough(3))
    first, second = (1, 2, LAPLACE), (4, 3, WORST)
    both = SMOOTH.apply(work, np.array([first, second], np.int32))
    half = SMOOTH.apply(work, np.array([first], np.int32))
    assert set(half.moved) <= set(both.moved)
    assert len(both.moved) > len(half.moved)


@given(meshes(FLAT_KINDS + CURVED_KINDS))
@settings(deadline=None, max_examples=30)
def test_elements_are_judged_as_everywhere_else(mesh):
    scoring = STANDARD.at(1.1)
    shape, size, index = element_faults(mesh.points, mesh.elements, scoring.core).T
    np.testing.assert_allclose(index, element_index(mesh, scoring))
    np.testing.assert_array_equal(shape + size > 0, failed_elements(mesh, scoring))


# --- what must not change -----------------------------------------------------------------------


@settings(deadline=None)
@given(meshes(FLAT_KINDS + CURVED_KINDS), PLACES)
def test_only_free_nodes_move_and_no_barrier_does(mesh, places):
    work = workpiece(mesh)
    after = smoothed(work, *places)
    moved = (after.points != mesh.points).any(axis=1)
    assert not (moved & ~work.topology.free_nodes).any()
    assert not (moved & mesh.locked_nodes).any()
    assert (after.elements == mesh.elements).all()
    assert not barriers(mesh) - barriers(after)


@settings(deadline=None)
@given(meshes(FLAT_KINDS + CURVED_KINDS), PLACES)
def test_no_element_becomes_unsound(mesh, places):
    after = smoothed(workpiece(mesh), *places)
    assert set(unsound(after, 0.05)) <= set(unsound(mesh, 0.05))


@pytest.mark.parametrize("shape", [lambda mesh: mesh, dome], ids=["plane", "sphere"])
@pytest.mark.parametrize("seed", range(3))
def test_criteria_that_ask_for_nothing_of_quads_do_not_turn_them_over(shape, seed):
    mesh = shape(sheet(7, 7, seed=seed, jitter=0.1, trias=0.4))
    after = smoothed(workpiece(mesh, ONLY_TRIAS), (1, EVERYWHERE, EVEN))
    assert np.abs(after.points - mesh.points).max() > 0.1
    assert not unsound(after, 0.05)
    turned = (element_normals(after) * element_normals(mesh)).sum(axis=1)
    assert (turned > 0.5).all()


@pytest.mark.parametrize("seed", range(3))
def test_no_element_leaves_a_surface_that_is_bent_sharply(seed):
    mesh = cylinder(sheet(7, 7, seed=seed, jitter=0.1, trias=0.4), radius=2.2)
    work = workpiece(mesh, ONLY_TRIAS)
    work = Workpiece(mesh, replace(work.setting, feature_angle=60.0), work.surface)
    after = smoothed(work, *[(1, EVERYWHERE, EVEN)] * 2)
    trias = trias_of(mesh)
    gaps = [
        distances_to_trias(centre(after, row), trias).min() for row in range(len(mesh.elements))
    ]
    assert np.abs(after.points - mesh.points).max() > 0.1
    assert max(gaps) < 0.12


def test_an_element_that_is_turned_over_is_turned_back():
    mesh = sheet(5, 5)
    points = mesh.points.copy()
    node = np.nonzero((points[:, :2] == (2, 2)).all(axis=1))[0]
    points[node, 0] += 1.3
    turned = with_(mesh, points=points)
    # the reference has no fold that could lie about which way is up
    setting = replace(workpiece(mesh).setting, feature_angle=180.0)
    work = Workpiece(turned, setting, workpiece(mesh).surface)
    after = smoothed(work, (1, 3, WORST), (1, 3, EVEN))
    assert unsound(turned)
    assert not unsound(after)


@pytest.mark.parametrize("method", [LAPLACE, WORST, EVEN])
def test_nodes_stay_on_a_sphere_as_it_was_meshed(method):
    mesh = dome(rough(4, jitter=0.25))
    work = workpiece(mesh)
    after = smoothed(work, (1, EVERYWHERE, method))
    moved = np.nonzero((after.points != mesh.points).any(axis=1))[0]
    assert len(moved) > 5
    trias = trias_of(mesh)
    assert max(distances_to_trias(place, trias).min() for place in after.points[moved]) < 1e-6


def test_nodes_come_back_to_the_reference_of_a_run():
    fine = dome(sheet(32, 32), 48.0)
    fine = with_(fine, points=fine.points / 4)
    mesh = dome(rough(4, jitter=0.25))
    work = Workpiece(mesh, workpiece(mesh).setting, workpiece(fine).surface)
    after = smoothed(work, (1, EVERYWHERE, WORST))
    moved = np.nonzero((after.points != mesh.points).any(axis=1))[0]
    radius = np.linalg.norm(after.points[moved], axis=1)
    # the chord of a fine quad is 0.002 below the sphere
    assert len(moved) > 5
    assert (np.abs(radius - 12.0) < 0.005).all()


# --- search space and procedure -----------------------------------------------------------------


@settings(deadline=None, max_examples=30)
@given(meshes(FLAT_KINDS + CURVED_KINDS), st.integers(0, 10**6))
def test_the_search_predicts_what_the_procedure_does(mesh, seed):
    work = workpiece(mesh)
    rng = np.random.default_rng(seed)
    space = SMOOTH.search_space(work, rng)
    if space is None:
        assert not (work.topology.free_nodes.any() and work.topology.editable.any())
        return
    genomes = space.draw(rng, 4)
    assert ((genomes >= 0) & (genomes < space.bounds)).all()
    tallies = space.evaluate(genomes)
    for genome, tally in zip(genomes, tallies, strict=True):
        parameters = space.parameters(genome)
        after = apply(mesh, SMOOTH.apply(work, parameters))
        np.testing.assert_allclose(tally, workpiece(after).tally, rtol=1e-9, atol=1e-7)
        np.testing.assert_array_equal(tally, space.tally(genome))
        assert bool(len(parameters)) == (after.digest != mesh.digest)
        assert tally[FAILED] <= work.tally[FAILED]


def test_the_same_place_gives_the_same_nodes():
    mesh = dome(rough(7))
    parameters = np.array([(1, 4, WORST), (2, 8, EVEN)], np.int32)
    first, second = (SMOOTH.apply(workpiece(mesh), parameters) for _ in range(2))
    np.testing.assert_array_equal(first.moved, second.moved)
    np.testing.assert_array_equal(first.moved_to, second.moved_to)


def test_a_perfect_mesh_is_left_as_it_is():
    work = workpiece(sheet(4, 4))
    space = SMOOTH.search_space(work, np.random.default_rng(0))
    genome = np.array([0, len(RINGS) - 1, WORST, 0, 0, 0])
    assert space.parameters(genome).shape == (0, 3)
    np.testing.assert_array_equal(space.tally(genome), work.tally)


def test_there_is_nothing_to_smooth_without_free_nodes():
    mesh = sheet(1, 5)
    assert SMOOTH.search_space(workpiece(mesh), np.random.default_rng(0)) is None
    assert SMOOTH.apply(workpiece(mesh), np.array([(1, 8, WORST)], np.int32)).is_empty


@pytest.mark.parametrize("rank", [0, -1, 10_000])
def test_a_rank_that_the_mesh_does_not_have_is_skipped(rank):
    assert SMOOTH.apply(workpiece(rough(1)), np.array([(rank, 8, WORST)], np.int32)).is_empty


def test_no_places_do_nothing():
    assert SMOOTH.apply(workpiece(rough(1)), np.zeros((0, 3), np.int32)).is_empty


def test_an_unknown_method_is_refused():
    with pytest.raises(ValueError, match="no method 3"):
        SMOOTH.apply(workpiece(rough(1)), np.array([(1, 8, 3)], np.int32))


def test_places_are_printed_by_rank_rings_and_method():
    assert SMOOTH.format(np.array([(3, 4, WORST), (1, 30, EVEN)])) == "3 r4 worst 1 r30 even"
    assert METHODS == ("laplace", "worst", "even")
