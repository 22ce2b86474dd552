"""Automesh: whole zones anew, the worst one first, their outlines kept."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import STANDARD
from meshops.edit import apply
from meshops.fitness import Fitness
from meshops.methods import METHODS
from meshops.operations.automesh import Automesh, ranked_zones
from meshops.quality_sums import TRIAS
from meshops.workpiece import Setting, Workpiece
from tests.meshes import (
    CURVED_KINDS,
    FLAT_KINDS,
    folded,
    in_two_regions,
    joined,
    meshes,
    shaped,
    sheet,
    with_,
)
from tests.wholeness import (
    assert_ids_are_kept,
    assert_nothing_locked_has_changed,
    assert_on_the_surface,
    assert_sound,
    assert_zones_are_whole,
    tried,
)

bounded = settings(max_examples=12, deadline=None)
FRONT = [method.name for method in METHODS].index("front")


def workpiece(mesh, element_size=1.0):
    fitness = Fitness("quality", len(mesh.elements))
    return Workpiece(mesh, Setting(STANDARD.at(1.0), fitness, element_size=element_size))


def automeshed(mesh, *rows):
    return apply(mesh, Automesh().apply(workpiece(mesh), np.array(rows, np.int32).reshape(-1, 3)))


@bounded
@given(meshes((*FLAT_KINDS, *CURVED_KINDS)), st.integers(0, 10**6))
def test_a_zone_keeps_its_outline_and_the_tally_is_foretold(mesh, seed):
    piece = workpiece(mesh)
    flat = not mesh.points[:, 2].any()
    for after, tally in tried(Automesh(), piece, seed):
        assert_zones_are_whole(mesh, after, area=1e-9 if flat else 0.05)
        assert_nothing_locked_has_changed(mesh, after)
        assert_ids_are_kept(mesh, after)
        assert_on_the_surface(mesh, after, tolerance=0.11)
        np.testing.assert_allclose(workpiece(after).tally, tally, atol=1e-6)


def test_a_rough_sheet_becomes_rows_of_squares():
    after = automeshed(sheet(8, 6, jitter=0.3, trias=0.6), (1, FRONT, 100))
    assert_sound(after)
    assert len(after.elements) == 48
    assert not after.is_tria.any()


def test_the_worst_zone_comes_first():
    good = sheet(4, 4)
    bad = shaped(sheet(4, 4, trias=0.5), lambda x, y: (x + 4, y, 0 * x))
    mesh = in_two_regions(joined(good, bad), 4.0)
    zones = ranked_zones(workpiece(mesh))
    assert len(zones) == 2
    assert mesh.is_tria[zones[0]].any()
    assert not mesh.is_tria[zones[1]].any()
    assert automeshed(mesh, (1, FRONT, 100)).is_tria.sum() == 0
    assert automeshed(mesh, (2, FRONT, 100)).is_tria.sum() == mesh.is_tria.sum()


def test_both_zones_at_once_are_both_zones():
    mesh = folded(joined(sheet(4, 4, trias=0.5), shaped(sheet(4, 4, trias=0.5), _beside)), 4.0)
    after = automeshed(mesh, (1, FRONT, 100), (2, FRONT, 100), (2, FRONT, 90))
    assert_sound(after)
    assert after.is_tria.sum() == 0
    assert len(after.elements) == 32


def _beside(x, y):
    return x + 4, y, 0 * x


def test_a_rank_that_the_mesh_does_not_have_is_left_out():
    mesh = sheet(4, 4, trias=0.5)
    assert Automesh().apply(workpiece(mesh), np.array([[2, 0, 100]], np.int32)).is_empty
    assert Automesh().apply(workpiece(mesh), np.zeros((0, 3), np.int32)).is_empty


@pytest.mark.parametrize("row", [(1, len(METHODS), 100), (1, -1, 100), (1, 0, 0)])
def test_methods_and_sizes_that_there_are_not_are_refused(row):
    with pytest.raises(ValueError, match="automesh has no"):
        automeshed(sheet(3, 3), row)


def test_the_size_is_a_share_of_the_runs():
    mesh = sheet(14, 14)
    counts = [len(automeshed(mesh, (1, FRONT, percent)).elements) for percent in (70, 100, 140)]
    assert counts[0] > counts[1] > counts[2]


def test_a_mesh_that_is_locked_whole_has_no_genomes():
    mesh = with_(sheet(3, 3), locked_elements=np.ones(9, bool))
    assert Automesh().search_space(workpiece(mesh), np.random.default_rng(0)) is None


def test_a_genome_without_a_valid_mesh_has_no_parameters():
    # one element alone is not meshed anew
    piece = workpiece(sheet(1, 1))
    space = Automesh().search_space(piece, np.random.default_rng(0))
    genome = np.zeros(3, np.int64)
    assert len(space.parameters(genome)) == 0
    assert np.isnan(space.tally(genome)).all()


def test_the_best_genome_of_a_rough_sheet_has_no_tria():
    piece = workpiece(sheet(8, 6, jitter=0.3, trias=0.6))
    space = Automesh().search_space(piece, np.random.default_rng(0))
    genomes = space.draw(np.random.default_rng(1), 20)
    assert np.nanmin(space.evaluate(genomes)[:, TRIAS]) == 0


def test_parameters_are_written_as_in_figure_10():
    rows = np.array([[2, FRONT, 90], [1, 0, 100]], np.int32)
    assert Automesh().format(rows) == "2 front 90% 1 isotropic 100%"
