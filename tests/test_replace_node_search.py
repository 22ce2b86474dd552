"""ReplaceNode: the pool that pairs are chosen of, genomes, ranks and parameters."""

from dataclasses import replace

import numpy as np
import pytest

from meshops._core import compound_indices
from meshops.criteria import STANDARD
from meshops.edit import apply
from meshops.fitness import Fitness
from meshops.operations import ReplaceNode, ReplaceNodePairs
from meshops.operations.replace_node import mergeable_pairs, ranked_pairs
from meshops.quality_sums import QUADS, TRIAS
from meshops.workpiece import Setting, Workpiece
from tests.meshes import sheet, with_

EVERYTHING = ReplaceNodePairs(pairs=3, pool=10_000)


def workpiece(mesh, kind="quality"):
    return Workpiece(mesh, Setting(STANDARD.at(1.0), Fitness(kind, len(mesh.elements))))


def node_at(mesh, *place):
    """Number, from 1, of the node at a place."""
    (row,) = np.nonzero((mesh.points[:, : len(place)] == place).all(axis=1))[0]
    return int(row) + 1


# --- the pool and the genomes -------------------------------------------------------------------


def test_pairs_that_overlap_make_no_mesh():
    mesh = sheet(5, 5)
    space = EVERYTHING.search_space(workpiece(mesh), np.random.default_rng(0))
    pool = [tuple(pair) for pair in space.pool.tolist()]
    a, b, c = (node_at(mesh, x, 2) - 1 for x in (1, 2, 3))
    one, two, back = pool.index((a, b, 0)), pool.index((c, b, 0)), pool.index((b, a, 0))
    for genome in ([one, two], [one, back], [one, one]):
        assert np.isnan(space.evaluate(np.array([genome]))).all()
        assert EVERYTHING.apply(workpiece(mesh), space.parameters(np.array(genome))).is_empty
    assert np.isfinite(space.evaluate(np.array([[one, len(pool)]]))).all()  # a gene beyond: no pair


def test_the_pool_is_the_pairs_that_harm_quality_least():
    mesh = sheet(6, 6, seed=2, jitter=0.3, trias=0.3)
    piece = workpiece(mesh)
    everything = EVERYTHING.search_space(piece, np.random.default_rng(0))
    # a pool of a quarter of the candidates is chosen out of all of them
    candidates, _ = mergeable_pairs(piece.topology)
    quarter = -(-len(candidates) // 4)
    chosen = replace(EVERYTHING, pool=quarter).search_space(piece, np.random.default_rng(1))

    def harm(space):
        alone = space.tallies(np.arange(len(space.pool))[:, None])
        return np.sort(compound_indices(alone, piece.setting.scoring.core))

    assert len(chosen.pool) == quarter < len(everything.pool)
    assert len({tuple(pair) for pair in chosen.pool.tolist()}) == quarter
    np.testing.assert_allclose(harm(chosen), harm(everything)[:quarter])


def test_in_the_paper_every_gene_is_another_pair_of_the_pool():
    operation = ReplaceNodePairs(pairs=6, pool=50)
    space = operation.search_space(workpiece(sheet(8, 8)), np.random.default_rng(0))
    genomes = space.draw(np.random.default_rng(1), 200)
    assert genomes.shape == (200, 6)
    assert (space.bounds == 50).all()
    assert all(len(set(genome)) == 6 for genome in genomes.tolist())
    assert len(space.parameters(genomes[0])) == 6


def test_an_optional_gene_is_nothing_half_of_the_time():
    operation = ReplaceNode(pairs=6, pool=50)
    space = operation.search_space(workpiece(sheet(8, 8)), np.random.default_rng(0))
    genomes = space.draw(np.random.default_rng(1), 2000)
    kept = [len(space.parameters(genome)) for genome in genomes]
    assert np.mean(kept) == pytest.approx(3, abs=0.1)
    nothing = np.full((1, 6), 99)
    assert np.array_equal(space.evaluate(nothing)[0], space.workpiece.tally)
    assert operation.apply(space.workpiece, space.parameters(nothing[0])).is_empty


def test_ranks_begin_at_the_worst_element():
    points = sheet(9, 3).points.copy()
    points[15, :2] = (5.3, 1.4)  # the elements around (5, 1) are the worst
    piece = workpiece(with_(sheet(9, 3), points=points))
    pairs, _ = ranked_pairs(piece)
    distance = np.linalg.norm(points[pairs[:, 0]] - points[15], axis=1)
    assert distance[:8].max() < 2.5 < 4 < distance[-8:].max()


def test_the_pair_of_a_rank_is_merged_and_ranks_beyond_are_skipped():
    piece = workpiece(sheet(5, 5, seed=1, jitter=0.2))
    pairs, _ = ranked_pairs(piece)
    operation = ReplaceNode()
    for rank in (1, 5):
        edit = operation.apply(piece, np.array([(rank, 0)], np.int32))
        by_number = pairs[rank - 1] + np.array([1, 1, 0], np.int32)
        same = EVERYTHING.apply(piece, by_number[None])
        assert apply(piece.mesh, edit).digest == apply(piece.mesh, same).digest
    for rank in (0, -3, len(pairs) + 1):
        assert operation.apply(piece, np.array([(rank, 0)], np.int32)).is_empty
    assert operation.format(np.array([(3, 0), (17, 0)], np.int32)) == "3 17"


def test_counting_alone_counts_as_measuring_does():
    mesh = sheet(8, 8, seed=1, trias=0.2)
    counted, measured = (
        EVERYTHING.search_space(workpiece(mesh, kind), np.random.default_rng(0))
        for kind in ("trias", "quality")
    )
    genomes = measured.draw(np.random.default_rng(2), 300)
    columns = [QUADS, TRIAS]
    np.testing.assert_array_equal(
        counted.evaluate(genomes)[:, columns], measured.evaluate(genomes)[:, columns]
    )
    assert np.array_equal(counted.tally(genomes[0]), measured.tally(genomes[0]), equal_nan=True)


def test_a_mesh_without_a_free_node_has_no_pairs():
    assert EVERYTHING.search_space(workpiece(sheet(1, 1)), np.random.default_rng(0)) is None


def test_fewer_pairs_than_genes_is_no_space_where_each_gene_is_a_pair():
    piece, rng = workpiece(sheet(2, 1)), np.random.default_rng(0)
    assert replace(EVERYTHING, pairs=50).search_space(piece, rng) is None
    assert ReplaceNode(pairs=50).search_space(piece, rng) is not None


# --- parameters ---------------------------------------------------------------------------------


def test_parameters_are_written_as_in_figure_10():
    parameters = np.array([(242, 243, 0), (63, 64, 1), (8, 9, 0)], np.int32)
    assert EVERYTHING.format(parameters) == "242,243 63~64 8,9"
    assert EVERYTHING.format(parameters[:0]) == ""


@pytest.mark.parametrize(
    ("pair", "message"),
    [
        ((0, 1, 0), "from 1 to 25"),
        ((13, 26, 0), "from 1 to 25"),
        ((13, 15, 0), "cannot be merged"),  # not adjacent
        ((1, 2, 0), "cannot be merged"),  # a corner would go
        ((13, 14, 2), "cannot be merged"),  # neither here nor half-way
        ((13, 13, 0), "cannot be merged"),
    ],
)
def test_pairs_that_the_mesh_does_not_have_are_refused(pair, message):
    with pytest.raises(ValueError, match=message):
        EVERYTHING.apply(workpiece(sheet(4, 4)), np.array([pair], np.int32))
