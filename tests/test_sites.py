"""Sites: which of them are drawn, which give way, and what they do at once."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import STANDARD
from meshops.fitness import Fitness
from meshops.operations.judge import judge
from meshops.operations.sites import SiteSpace, apply_sites, format_sites
from meshops.operations.split_quad import SplitQuad
from meshops.operations.swap_edge import SwapEdge
from meshops.quality_sums import QUADS, TRIAS
from meshops.workpiece import Setting, Workpiece
from tests.meshes import FLAT_KINDS, centre, meshes, sheet, with_
from tests.wholeness import assert_sound, assert_zones_are_whole, tried


def workpiece(mesh):
    return Workpiece(mesh, Setting(STANDARD.at(1.0), Fitness("quality", len(mesh.elements))))


def row_of(mesh, x, y):
    """Row of the element with its centre at (x, y)."""
    (row,) = [r for r in range(len(mesh.elements)) if tuple(centre(mesh, r)[:2]) == (x, y)]
    return row


def space_of(mesh, operation=SplitQuad(), picks=4):  # noqa: B008 - a frozen value
    piece = workpiece(mesh)
    found = operation.candidates(piece)
    return SiteSpace(piece, found, judge(piece, found), picks=picks, variants=2), found


def test_a_later_site_gives_way_to_an_earlier_one():
    mesh = with_(sheet(6, 1), locked_nodes=np.ones(14, bool))
    space, found = space_of(mesh)
    quads = [row_of(mesh, x + 0.5, 0.5) for x in (0, 1, 5)]
    near, beside, far = (int(np.nonzero(found.removed == row)[0][0]) for row in quads)
    nothing = len(space.sites)
    genome = np.array([near, beside, far, nothing])
    assert [tuple(row) for row in space.parameters(genome)] == [
        (near // 2 + 1, near % 2),
        (far // 2 + 1, far % 2),
    ]
    tally = space.tally(genome)
    assert (tally[TRIAS], tally[QUADS]) == (4, 4)
    assert len(space.parameters(np.full(4, nothing))) == 0
    np.testing.assert_array_equal(space.tally(np.full(4, nothing)), workpiece(mesh).tally)


def test_genes_are_valid_sites_or_nothing():
    mesh = with_(sheet(4, 4), locked_elements=np.arange(16) < 8)
    space, _ = space_of(mesh)
    assert len(space.sites) == 16
    genomes = space.draw(np.random.default_rng(0), 50)
    assert genomes.shape == (50, 4)
    assert (genomes >= 0).all()
    assert (genomes < space.bounds).all()
    assert (genomes >= len(space.sites)).any()
    assert np.isfinite(space.evaluate(genomes)).all()


def test_genomes_favour_the_worst_places():
    space, _ = space_of(sheet(12, 12))
    genomes = space.draw(np.random.default_rng(0), 500)[1:]
    drawn = genomes[genomes < len(space.sites)]
    assert np.mean(drawn < len(space.sites) // 4) > 0.5
    assert len(np.unique(drawn)) > len(space.sites) // 2


@settings(max_examples=20, deadline=None)
@given(meshes(FLAT_KINDS), st.integers(0, 10**6))
def test_the_first_genome_is_greedy(mesh, seed):
    space, _ = space_of(mesh, SwapEdge())
    if not len(space.sites):
        return
    first = space.draw(np.random.default_rng(seed), 1)[0]
    alone = space.workpiece.fitness(space.evaluate(np.arange(len(space.sites))[:, None]))
    before = space.workpiece.fitness(space.workpiece.tally[None])[0]
    chosen = first[first < len(space.sites)]
    assert (alone[chosen] > before).all()
    assert len(chosen) == len(space.parameters(first))
    if alone.max() > before:
        assert alone[first[0]] == alone.max()
    else:
        assert not len(chosen)


@settings(max_examples=30, deadline=None)
@given(meshes(FLAT_KINDS), st.integers(0, 10**6))
def test_sites_at_once_are_what_each_is_alone(mesh, seed):
    """Whatever genome: the mesh is whole and its tally that which was predicted."""
    for after, tally in tried(SwapEdge(pool=12, picks=6), workpiece(mesh), seed):
        assert_sound(after)
        assert_zones_are_whole(mesh, after, area=1e-9)
        np.testing.assert_allclose(workpiece(after).tally, tally, rtol=1e-9, atol=1e-8)


def test_sites_that_the_mesh_does_not_have_are_left_out():
    mesh = sheet(3, 3)
    piece = workpiece(mesh)
    found = SplitQuad().candidates(piece)
    for missing in ([(10, 0)], [(0, 0)], [(1, 2)], [(1, -1)], [(-3, 0)]):
        assert apply_sites(piece, found, np.array(missing, np.int32), variants=2).is_empty
    both = apply_sites(piece, found, np.array([(50, 0), (1, 1)], np.int32), variants=2)
    assert len(both.removed) == 1
    assert apply_sites(piece, found, np.zeros((0, 2), np.int32), variants=2).is_empty


def test_sites_are_written_by_rank_and_variant():
    rows = np.array([(3, 0), (1, 1)], np.int32)
    assert format_sites(rows, variants=2) == "3a 1b"
    assert format_sites(rows) == "3 1"
    assert format_sites(rows[:0]) == ""


def test_places_are_ranked_from_the_worst_element_on():
    mesh = sheet(8, 8)
    points = mesh.points.copy()
    points[56, :2] += (0.45, 0.4)
    piece = workpiece(with_(mesh, points=points))
    worst = int(piece.bad_elements[0])
    found = SplitQuad().candidates(piece)
    assert found.removed[0] == worst
    rings = piece.rings[found.removed]
    assert (np.diff(rings) >= 0).all()
    few = SplitQuad(pool=5).candidates(piece)
    assert np.array_equal(few.removed, found.removed[:10])
