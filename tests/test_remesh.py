"""Remesh of places: discs and strips around the worst elements, by several methods."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import STANDARD
from meshops.edit import apply
from meshops.fitness import Fitness
from meshops.methods import METHODS
from meshops.operations import Remesh
from meshops.operations.remesh import LOCAL, MOST_RINGS, SHIFTS, SIZES, remesh_place, select
from meshops.patch import extract
from meshops.quality_sums import TRIAS
from meshops.workpiece import Setting, Workpiece
from tests.measures import barriers, within, zones
from tests.meshes import CURVED_KINDS, FLAT_KINDS, in_two_regions, meshes, sheet, with_

FRONT = [method.name for method in METHODS].index("front")
bounded = settings(max_examples=25, deadline=None)


def workpiece(mesh):
    return Workpiece(mesh, Setting(STANDARD.at(1.0), Fitness("quality", len(mesh.elements))))


def place(rank, *, shift=0, rings=1, other=0, size=0, method=FRONT):
    return np.array([(rank, shift, rings, other, size, method)], np.int32)


def with_trias(mesh, *cut):
    """The mesh with some of its quads, by row, cut in two: the trias come last."""
    quads = mesh.elements[list(cut)]
    halves = [half for a, b, c, d in quads for half in ((a, b, c, -1), (a, c, d, -1))]
    elements = np.concatenate([np.delete(mesh.elements, cut, axis=0), halves])
    return with_(
        mesh,
        elements=elements,
        region=np.zeros(len(elements)),
        locked_elements=np.zeros(len(elements)),
        element_ids=np.arange(1, len(elements) + 1),
    )


# --- what is selected ---------------------------------------------------------------------------


@bounded
@given(meshes(FLAT_KINDS), st.integers(0, 4), st.integers(0, 10**6))
def test_a_disc_is_all_that_can_be_reached_in_so_many_steps(mesh, rings, seed):
    mesh = with_(mesh, locked_elements=np.zeros(len(mesh.elements)))
    piece = workpiece(mesh)
    rank = 1 + seed % len(piece.bad_elements)
    chosen = select(piece, place(rank, rings=rings)[0])
    if piece.topology.editable.all():
        assert set(np.nonzero(chosen)[0]) == within(mesh, int(piece.bad_elements[rank - 1]), rings)


def test_a_strip_leads_from_one_bad_element_to_another():
    mesh = with_trias(sheet(9, 9), 9 * 4 + 1, 9 * 4 + 7)
    piece = workpiece(mesh)
    bad = piece.bad_elements
    centres = np.array([mesh.points[e[e >= 0]].mean(axis=0) for e in mesh.elements[bad]])
    other = 1 + int(np.argmax(np.abs(centres[:, 0] - centres[0, 0])))
    chosen = select(piece, place(1, rings=0, other=other)[0])
    assert chosen[bad[0]]
    assert chosen[bad[other - 1]]
    rows = np.nonzero(chosen)[0]
    assert len(extract(piece.topology, rows.astype(np.int32)).rows) == len(rows)
    middles = np.array([mesh.points[e[e >= 0]].mean(axis=0) for e in mesh.elements[rows]])
    assert np.abs(middles[:, 1] - 4.5).max() < 1
    wide = select(piece, place(1, rings=1, other=other)[0])
    assert chosen.sum() < wide.sum() < len(mesh.elements) / 2


def test_a_shift_moves_the_centre_to_another_element_near_it():
    mesh = with_trias(sheet(7, 7), 24)
    piece = workpiece(mesh)
    middles = []
    for shift in range(SHIFTS):
        (row,) = np.nonzero(select(piece, place(1, shift=shift, rings=0)[0]))[0]
        middles.append(int(row))
    assert middles[0] == piece.bad_elements[0]
    assert len(set(middles)) == SHIFTS
    assert set(middles) <= within(mesh, middles[0], 3)


def test_a_place_ends_at_a_barrier():
    mesh = in_two_regions(with_trias(sheet(8, 4), 3), 4.0)
    chosen = select(workpiece(mesh), place(1, rings=7)[0])
    assert set(mesh.region[chosen]) == {3}


# --- what comes out -----------------------------------------------------------------------------


def test_some_strip_between_four_trias_takes_all_of_them():
    mesh = with_trias(sheet(8, 4), 9, 14)
    piece = workpiece(mesh)
    after = [
        apply(mesh, Remesh().apply(piece, place(1, rings=1, other=other)))
        for other in range(1, len(piece.bad_elements) + 1)
    ]
    assert np.count_nonzero(mesh.is_tria) == 4
    assert min(np.count_nonzero(m.is_tria) for m in after) == 0


@settings(max_examples=40, deadline=None)
@given(meshes(FLAT_KINDS + CURVED_KINDS), st.integers(0, 10**6))
def test_the_trias_of_a_patch_keep_the_parity_of_its_border(mesh, seed):
    """4 quads + 3 trias = 2 inner edges + border edges, whatever the method."""
    piece = workpiece(mesh)
    rng = np.random.default_rng(seed)
    space = Remesh().search_space(piece, rng)
    if space is None:
        return
    for genome in space.draw(rng, 3):
        for parameters in space.parameters(genome):
            for edit, change in remesh_place(piece, parameters):
                border = len(extract(piece.topology, edit.removed).border)
                trias = np.count_nonzero(edit.added_elements[:, 3] < 0)
                assert trias % 2 == border % 2
                assert change[TRIAS] == trias - np.count_nonzero(mesh.is_tria[edit.removed])
                after = apply(mesh, edit)
                assert barriers(after) == barriers(mesh)
                assert all(zone.trias % 2 == zone.sides % 2 for zone in zones(after))


@pytest.mark.parametrize("method", range(len(METHODS)), ids=[m.name for m in METHODS])
def test_every_method_mends_a_rough_disc(method):
    mesh = sheet(10, 10, seed=3, jitter=0.3, trias=0.4)
    piece = workpiece(mesh)
    after = apply(mesh, Remesh().apply(piece, place(1, rings=6, method=method)))
    assert np.count_nonzero(after.is_tria) < np.count_nonzero(mesh.is_tria) - 5


def test_a_larger_size_makes_fewer_elements():
    mesh = with_trias(sheet(16, 16), 100)
    counts = [
        len(apply(mesh, Remesh().apply(workpiece(mesh), place(1, rings=7, size=size))).elements)
        for size in sorted(
            (k for k in range(len(SIZES)) if SIZES[k][0] is LOCAL), key=lambda k: SIZES[k][1]
        )
    ]
    assert counts == sorted(counts, reverse=True)
    assert counts[0] > counts[-1]


# --- genomes and parameters ---------------------------------------------------------------------


def test_the_genes_are_rank_shift_rings_other_size_and_method():
    piece = workpiece(with_trias(sheet(5, 4), 7, 12))
    space = Remesh().search_space(piece, np.random.default_rng(0))
    bad = len(piece.bad_elements)
    assert space.bounds.tolist() == [
        bad, SHIFTS, MOST_RINGS, bad + 1, len(SIZES), len(METHODS)
    ]  # fmt: skip
    genomes = space.draw(np.random.default_rng(1), 400)
    assert (genomes.max(axis=0) == space.bounds - 1).all()
    assert np.mean(genomes[:, 3] == 0) > 0.5
    ranks = np.bincount(genomes[:, 0])
    assert ranks[0] > ranks[-1]


def test_what_cannot_be_remeshed_has_no_parameters():
    piece = workpiece(sheet(1, 1))  # one element alone is not meshed anew
    space = Remesh().search_space(piece, np.random.default_rng(0))
    genome = np.zeros(6, np.int64)
    assert len(space.parameters(genome)) == 0
    assert np.isnan(space.tally(genome)).all()


@pytest.mark.parametrize("place", [place(0), place(-2), place(99), place(1, other=99)])
def test_ranks_that_the_mesh_does_not_have_are_left_out(place):
    assert Remesh().apply(workpiece(sheet(4, 4)), place).is_empty


@pytest.mark.parametrize("wrong", [{"size": len(SIZES)}, {"method": len(METHODS)}, {"size": -1}])
def test_sizes_and_methods_that_there_are_not_are_refused(wrong):
    with pytest.raises(ValueError, match="no size"):
        Remesh().apply(workpiece(sheet(4, 4)), place(1, **wrong))


def test_a_mesh_that_is_locked_whole_has_no_genomes():
    mesh = with_(sheet(3, 3), locked_elements=np.ones(9))
    assert Remesh().search_space(workpiece(mesh), np.random.default_rng(0)) is None


def test_parameters_tell_the_place_and_the_method():
    assert Remesh().format(place(3, shift=2, rings=4)) == "3+2 r4 100% front"
    assert Remesh().format(place(3, other=5, rings=2, size=2, method=0)) == "3-5 r2 90% isotropic"
    assert Remesh().format(place(1, rings=2, size=1)) == "1 r2 100%! front"
    assert Remesh().format(place(1)[:0]) == ""
