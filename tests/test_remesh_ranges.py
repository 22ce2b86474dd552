"""Remesh of element number ranges: what it selects, what comes out, and what it refuses."""

from collections import Counter

import numpy as np
import pymeshlab
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import STANDARD
from meshops.edit import apply
from meshops.fitness import Fitness
from meshops.operations import RemeshRanges
from meshops.operations.remesh_ranges import select
from meshops.quality_sums import FAILED, TRIAS
from meshops.remeshing import joint_change, replace_patch
from meshops.topology import topology
from meshops.workpiece import Setting, Workpiece
from tests.measures import barriers, unsound
from tests.meshes import (
    FLAT_KINDS,
    folded,
    in_two_regions,
    joined,
    make,
    meshes,
    rib,
    sheet,
    torus,
    with_,
)

PAPER = RemeshRanges()
bounded = settings(max_examples=40, deadline=None)


def workpiece(mesh, *, element_size=None):
    fitness = Fitness("quality", len(mesh.elements))
    return Workpiece(mesh, Setting(STANDARD.at(1.0), fitness, element_size=element_size))


def remeshed(mesh, *ranges, element_size=None):
    ranges = np.array(ranges or [(1, len(mesh.elements))], np.int32)
    return apply(mesh, PAPER.apply(workpiece(mesh, element_size=element_size), ranges))


# --- what comes out -----------------------------------------------------------------------------


def test_a_rough_sheet_comes_out_without_tria_and_with_few_failed_elements():
    mesh = sheet(8, 8, seed=4, jitter=0.35, trias=0.4)
    before, after = workpiece(mesh), workpiece(remeshed(mesh))
    assert before.tally[TRIAS] > 30
    assert before.tally[FAILED] > 10
    assert after.tally[TRIAS] == 0
    assert after.tally[FAILED] <= 3


def test_the_skin_around_a_rib_that_ends_inside_is_remeshed_on_both_sides():
    mesh = joined(sheet(6, 6, seed=2, trias=0.8), rib(3, 2, at=3.0, start=1.0))
    after = remeshed(mesh)
    assert np.count_nonzero(after.is_tria) < np.count_nonzero(mesh.is_tria) / 4
    assert barriers(after) == barriers(mesh)
    assert topology(after).is_t_junction.sum() == 3


def test_parts_of_a_patch_that_touch_in_a_node_stay_together_there():
    """A ring of eight quads of which one opens it: its ends touch in a node."""
    mesh = sheet(3, 3)
    ring = [1, 2, 3, 4, 6, 7, 8]  # without the middle and the upper left
    after = remeshed(mesh, *((n, n) for n in ring))
    assert barriers(after) == barriers(mesh)
    assert not unsound(after)


def test_a_closed_surface_is_remeshed():
    mesh = torus()
    after = remeshed(mesh)
    assert set(after.element_ids) == {0}
    assert not unsound(after)
    assert barriers(after) == Counter()
    nodes, edges = len(after.points), len(topology(after).edges)
    assert nodes - edges + len(after.elements) == 0


def test_the_size_of_the_elements_can_be_given():
    mesh = sheet(12, 12)
    coarse, fine = remeshed(mesh, element_size=2.0), remeshed(mesh, element_size=0.5)
    assert len(coarse.elements) < 100 < 250 < len(fine.elements)
    assert barriers(coarse) == barriers(fine) == barriers(mesh)


def test_size_is_kept_where_none_is_given():
    mesh = sheet(10, 10, seed=5, jitter=0.2)
    assert len(remeshed(mesh).elements) == pytest.approx(100, abs=10)
    tiny = with_(mesh, points=mesh.points * 1e-3)
    assert len(remeshed(tiny).elements) == pytest.approx(100, abs=10)


def test_a_sheet_far_from_the_origin_is_remeshed():
    mesh = sheet(6, 6, seed=5, jitter=0.2, trias=0.3)
    far = with_(mesh, points=mesh.points + np.array([1e6, -2e6, 3e6]))
    after = remeshed(far)
    assert set(after.element_ids) == {0}
    assert barriers(after) == barriers(far)


def test_what_pymeshlab_was_called_with_before_does_not_matter():
    mesh = make("paraboloid", 3)
    once = remeshed(mesh).digest
    other = pymeshlab.MeshSet(verbose=False)
    other.create_sphere()
    other.meshing_isotropic_explicit_remeshing(
        iterations=1, adaptive=True, splitflag=False, collapseflag=False, swapflag=False,
        smoothflag=False, reprojectflag=False, checksurfdist=True,
    )  # fmt: skip
    assert remeshed(mesh).digest == once


@bounded
@given(meshes(FLAT_KINDS), st.integers(0, 10**6))
def test_patches_at_once_are_patches_one_by_one(mesh, seed):
    """By what they add to the tally, as their numbers differ."""
    piece = workpiece(mesh)
    ranges = (
        np.random.default_rng(seed).integers(1, len(mesh.elements) + 1, (3, 2)).astype(np.int32)
    )
    edit = PAPER.apply(piece, ranges)
    alone = [replace_patch(piece, rows) for rows in select(piece, ranges)]
    total = joint_change(piece, alone) if alone else 0 * piece.tally
    np.testing.assert_allclose(piece.tally_change(edit), total, atol=1e-9)


# --- what is selected ---------------------------------------------------------------------------


def selected(mesh, *ranges):
    return [rows.tolist() for rows in select(workpiece(mesh), np.array(ranges, np.int32))]


def test_ranges_are_united_whichever_way_they_run():
    mesh = sheet(4, 3)
    assert selected(mesh, (2, 4), (6, 3)) == [[1, 2, 3, 4, 5]]
    assert selected(mesh, (5, 5)) == [[4]]
    assert selected(mesh, (1, 1), (3, 3), (9, 10)) == [[0], [2], [8, 9]]


def test_a_selection_is_split_by_regions_folds_and_locks():
    mesh = sheet(4, 1)
    assert selected(mesh, (1, 4)) == [[0, 1, 2, 3]]
    assert selected(in_two_regions(mesh, 2.0), (1, 4)) == [[0, 1], [2, 3]]
    assert selected(folded(mesh, 3.0), (1, 4)) == [[0, 1, 2], [3]]
    locked = with_(mesh, locked_elements=[False, True, False, False])
    assert selected(locked, (1, 4)) == [[0], [2, 3]]


def test_one_element_alone_is_not_remeshed():
    assert PAPER.apply(workpiece(sheet(3, 3)), np.array([(5, 5)], np.int32)).is_empty


def test_a_mesh_that_is_locked_whole_has_no_genomes():
    mesh = sheet(3, 3)
    locked = with_(mesh, locked_elements=np.ones(9))
    assert PAPER.search_space(workpiece(locked), np.random.default_rng(0)) is None


def test_genes_are_the_ends_of_ranges_anywhere():
    mesh = sheet(5, 4)
    space = PAPER.search_space(workpiece(mesh), np.random.default_rng(0))
    assert space.bounds.tolist() == [20] * 10
    genomes = space.draw(np.random.default_rng(1), 500)
    assert genomes.min() == 0
    assert genomes.max() == 19
    assert space.parameters(np.array([0, 4, 19, 7, 3, 3, 1, 2, 5, 6])).tolist() == [
        [1, 5], [20, 8], [4, 4], [2, 3], [6, 7]
    ]  # fmt: skip


# --- what is refused ----------------------------------------------------------------------------


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("value", [np.nan, np.inf, 1e30, 1e200])
def test_a_node_out_of_this_world_is_left_alone(value):
    mesh = sheet(6, 6, seed=5, jitter=0.2)
    points = mesh.points.copy()
    points[24] = value
    after = remeshed(with_(mesh, points=points))
    around = (mesh.elements == 24).any(axis=1)
    assert set(mesh.element_ids[around]) <= set(after.element_ids)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("factor", [1e160, 1e-160])
def test_numbers_at_the_ends_of_their_range_change_nothing(factor):
    mesh = sheet(4, 4, seed=5, jitter=0.2)
    extreme = with_(mesh, points=mesh.points * factor)
    assert remeshed(extreme).digest == extreme.digest


@pytest.mark.parametrize("ranges", [[(0, 3)], [(2, 13)], [(1, 2), (-4, 5)]])
def test_numbers_that_the_mesh_does_not_have_are_refused(ranges):
    with pytest.raises(ValueError, match="from 1 to 12"):
        PAPER.apply(workpiece(sheet(4, 3)), np.array(ranges, np.int32))


def test_no_ranges_are_an_empty_edit():
    assert PAPER.apply(workpiece(sheet(3, 3)), np.zeros((0, 2), np.int32)).is_empty


def test_parameters_are_written_as_in_figure_10():
    ranges = np.array([(33, 301), (317, 243), (9, 9)], np.int32)
    assert PAPER.format(ranges) == "33-301 317-243 9-9"
    assert PAPER.format(ranges[:0]) == ""
