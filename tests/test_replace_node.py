"""ReplaceNode: what merging does on small meshes, and which merges are refused."""

from collections import Counter, defaultdict
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import STANDARD
from meshops.edit import apply
from meshops.fitness import Fitness
from meshops.kernels.merging import LEAST_CORNER
from meshops.kernels.quality import QUADS, TRIAS, compound_indices
from meshops.kernels.soundness import FACING
from meshops.mesh import ShellMesh
from meshops.operations import ReplaceNode, ReplaceNodePairs
from meshops.operations.replace_node import mergeable_pairs, ranked_pairs
from meshops.topology import topology
from meshops.workpiece import Setting, Workpiece
from tests.meshes import (
    CURVED_KINDS,
    FLAT_KINDS,
    area_vectors,
    corners,
    doubles,
    in_two_regions,
    joined,
    meshes,
    needle,
    sheet,
    sides,
    users,
    with_,
)

EVERYTHING = ReplaceNodePairs(pairs=3, pool=10_000)


def workpiece(mesh, kind="quality"):
    return Workpiece(mesh, Setting(STANDARD.at(1.0), Fitness(kind, len(mesh.elements))))


def node_at(mesh, *place):
    """Number, from 1, of the node at a place."""
    (row,) = np.nonzero((mesh.points[:, : len(place)] == place).all(axis=1))[0]
    return int(row) + 1


def merged(mesh, *pairs):
    """The mesh after merging pairs of places; half-way where a third item says so."""
    parameters = [
        (node_at(mesh, *pair[0]), node_at(mesh, *pair[1]), int(len(pair) == 3)) for pair in pairs
    ]
    return apply(mesh, EVERYTHING.apply(workpiece(mesh), np.array(parameters, np.int32)))


def counts(mesh):
    return np.count_nonzero(~mesh.is_tria), np.count_nonzero(mesh.is_tria)


def pairs_of(mesh):
    """All pairs that may be merged, by places, without half-way ones."""
    pairs, _ = mergeable_pairs(topology(mesh))
    return {
        (tuple(mesh.points[a]), tuple(mesh.points[b])) for a, b, half_way in pairs if not half_way
    }


def movable(mesh):
    return {one for one, _ in pairs_of(mesh)}


# --- the paper's figures ------------------------------------------------------------------------


def test_one_merge_in_a_lattice_adds_two_trias():
    mesh = sheet(5, 4)
    assert counts(mesh) == (20, 0)
    assert counts(merged(mesh, ((2, 2), (3, 2)))) == (18, 2)


def test_two_merges_side_by_side_delete_the_quad_between_as_in_figure_9():
    mesh = sheet(5, 5)
    apart = merged(mesh, ((1, 1), (2, 1)), ((4, 4), (3, 4)))
    adjacent = merged(mesh, ((2, 2), (3, 2)), ((2, 3), (3, 3)))
    assert counts(apart) == (21, 4)
    assert counts(adjacent) == (22, 2)


def wedge():
    """A lattice with one more column in its lower two rows, which ends in a tria."""
    lower = [(x, y, 0) for y in (0, 1) for x in (0, 1, 2, 3)]
    upper = [(x, y, 0) for y in (2, 3) for x in (0, 1.5, 3)]
    elements = [(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6)]
    elements += [(4, 5, 9, 8), (5, 6, 9, -1), (6, 7, 10, 9), (8, 9, 12, 11), (9, 10, 13, 12)]
    return ShellMesh.build(lower + upper, elements)


@pytest.mark.parametrize("half_way", [(), (True,)], ids=["to the second", "half-way"])
def test_a_chain_of_merges_from_a_tria_to_the_border_removes_it_as_in_figure_11(half_way):
    mesh = wedge()
    after = merged(mesh, ((1, 1), (2, 1), *half_way), ((1, 0), (2, 0), *half_way))
    assert counts(mesh) == (7, 1)
    assert counts(after) == (6, 0)
    assert set(after.points[:, 0]) == ({0.0, 1.5, 3.0} if half_way else {0.0, 1.5, 2.0, 3.0})


def test_half_a_chain_leaves_a_tria():
    assert counts(merged(wedge(), ((1, 1), (2, 1)))) == (6, 1)


def test_nodes_meet_at_the_second_one_or_half_way():
    mesh = sheet(5, 4, seed=3, jitter=0.1)
    one, two = mesh.points[[14, 15]]
    at_second = merged(mesh, (one, two))
    half_way = merged(mesh, (one, two, True))
    assert {tuple(two)} == set(map(tuple, at_second.points)) & {tuple(one), tuple(two)}
    assert tuple((one + two) / 2) in set(map(tuple, half_way.points))
    assert not {tuple(one), tuple(two)} & set(map(tuple, half_way.points))


# --- what may be merged -------------------------------------------------------------------------


def test_inner_nodes_may_go_anywhere_and_border_nodes_along_a_straight_border():
    found = pairs_of(sheet(3, 2))
    inner = {(1, 1, 0), (2, 1, 0)}
    ends = {(0, 0, 0), (3, 0, 0), (0, 2, 0), (3, 2, 0)}
    assert not {one for one, _ in found} & ends
    assert all(x == u == 0 or x == u == 3 or y == v for (x, y, _), (u, v, _) in found - {
        pair for pair in found if pair[0] in inner
    })  # fmt: skip
    assert {two for one, two in found if one == (1, 1, 0)} == {
        (0, 1, 0), (2, 1, 0), (1, 0, 0), (1, 2, 0)
    }  # fmt: skip


def test_nodes_that_are_locked_or_between_regions_stay():
    mesh = sheet(4, 4)
    locked = with_(mesh, locked_nodes=np.arange(25) == 12)
    assert movable(mesh) - movable(locked) == {(2, 2, 0)}
    regions = in_two_regions(mesh, 2)
    assert movable(mesh) - movable(regions) == {(2.0, y, 0.0) for y in range(5)}


def test_nodes_of_locked_elements_stay():
    mesh = sheet(4, 4)
    locked = with_(mesh, locked_elements=np.arange(16) == 5)
    assert movable(mesh) - movable(locked) == {tuple(mesh.points[n]) for n in mesh.elements[5]}


def test_a_straight_corner_of_a_locked_element_stays():
    points = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (1, 1, 0)]
    mesh = ShellMesh.build(points, [(0, 1, 2, 3)])
    assert movable(mesh) == {(1, 0, 0)}
    assert not movable(with_(mesh, locked_elements=[True]))


def test_a_node_on_which_another_part_hangs_stays():
    mesh = joined(sheet(4, 4), needle(2.0, 2.0))
    assert movable(sheet(4, 4)) - movable(mesh) == {(2, 2, 0)}


def test_a_bent_border_stays():
    angle = np.radians(np.arange(0, 91, 15))
    arc = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1)
    ring = np.concatenate([2 * arc, 3 * arc])
    mesh = ShellMesh.build(ring, [(i, i + 7, i + 8, i + 1) for i in range(6)])
    assert not movable(mesh)


def thin_tube():
    """Three elements around, two sides of them nearly flat on each other; four rings."""
    section = [(0, 0.1), (0, -0.1), (1, 0)]
    points = [(x, y, z) for z in range(4) for x, y in section]
    quads = [
        (3 * z + i, 3 * z + j, 3 * z + 3 + j, 3 * z + 3 + i)
        for z in range(3)
        for i, j in ((0, 1), (1, 2), (2, 0))
    ]
    return ShellMesh.build(points, quads)


def test_a_merge_that_would_join_the_mesh_to_itself_is_an_empty_edit():
    """Both long sides of the tube would have the edge between b and c."""
    mesh = thin_tube()
    without_features = Setting(STANDARD.at(1.0), Fitness("quality", 9), feature_angle=180.0)
    piece = Workpiece(mesh, without_features)
    a, b = node_at(mesh, 0, 0.1, 1), node_at(mesh, 0, -0.1, 1)
    assert not model_is_valid(mesh, [(a - 1, b - 1, 0)])
    assert EVERYTHING.apply(piece, np.array([(a, b, 0)], np.int32)).is_empty


# --- valid or not, against a plain model --------------------------------------------------------


def model_is_valid(mesh, pairs):
    """Whether merging the pairs at once leaves a whole mesh of sound elements."""
    nodes = [node for a, b, _ in pairs for node in (a, b)]
    if len(set(nodes)) < len(nodes):
        return False
    target = {a: b for a, b, _ in pairs}
    points = mesh.points.copy()
    for a, b, half_way in pairs:
        if half_way:
            points[b] = (mesh.points[a] + mesh.points[b]) / 2
    elements, origin = [], []
    for row, element in enumerate(mesh.elements):
        loop = [target.get(node, node) for node in corners(element)]
        loop = [node for k, node in enumerate(loop) if node != loop[k - 1]]
        if len(loop) >= 3 and len(set(loop)) == len(loop):
            elements.append([*loop, -1][:4])
            origin.append(row)
    after = ShellMesh.build(points, np.reshape(elements, (-1, 4)))
    return (
        model_elements_are_sound(mesh, after, origin)
        and not doubles(after)
        and euler(mesh) == euler(after)
        and joints(mesh, target) == joints(after, {})
    )


def model_elements_are_sound(mesh, after, origin):
    old, new = area_vectors(mesh)[origin], area_vectors(after)
    for row, (u, v) in enumerate(zip(old, new, strict=True)):
        points = after.points[corners(after.elements[row])]
        before = mesh.points[corners(mesh.elements[origin[row]])]
        if len(before) == len(points) and (before == points).all():
            continue
        if u @ v < FACING * np.linalg.norm(u) * np.linalg.norm(v) or not v.any():
            return False
        ahead = np.roll(points, -1, axis=0) - points
        behind = np.roll(points, 1, axis=0) - points
        jacobians = np.cross(ahead, behind) @ v / np.linalg.norm(v)
        if jacobians.min() < LEAST_CORNER * (ahead**2).sum(axis=1).max():
            return False
    return True


def euler(mesh):
    return len(set(mesh.elements[mesh.elements >= 0])) - len(users(mesh)) + len(mesh.elements)


def joints(mesh, target):
    """Edges that have not just two elements, with how many, as they are after merging."""
    found = defaultdict(int)
    for (a, b), uses in users(mesh).items():
        a, b = target.get(a, a), target.get(b, b)
        if len(uses) != 2 and a != b:
            found[min(a, b), max(a, b)] = len(uses)
    return found


@settings(max_examples=100, deadline=None)
@given(meshes(FLAT_KINDS + CURVED_KINDS), st.integers(0, 10**6))
def test_valid_is_what_the_model_finds_valid(mesh, seed):
    rng = np.random.default_rng(seed)
    space = EVERYTHING.search_space(workpiece(mesh), rng)
    if space is None:
        return
    near = space.pool[:, :2]
    for _ in range(12):
        # pairs near to each other, which touch the same elements
        first = rng.integers(len(space.pool))
        distance = np.linalg.norm(
            mesh.points[near].mean(axis=1) - mesh.points[near[first]].mean(axis=0), axis=1
        )
        genome = rng.choice(np.argsort(distance, kind="stable")[:24], rng.integers(1, 4))
        valid = bool(np.isfinite(space.tallies(genome[None])).all())
        assert valid == model_is_valid(mesh, space.pool[genome].tolist())


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
        return np.sort(compound_indices(alone, *piece.setting.scoring.arrays))

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


def test_a_merge_that_would_invert_an_element_is_an_empty_edit():
    points = sheet(4, 4).points.copy()
    points[12, :2] = (2.9, 2.9)  # its neighbour to the left cannot follow it
    mesh = with_(sheet(4, 4), points=points)
    parameters = np.array([(12, 13, 0)], np.int32)
    assert EVERYTHING.apply(workpiece(mesh), parameters).is_empty


def test_rewired_elements_keep_their_id():
    mesh = with_(sheet(5, 4), element_ids=np.arange(20) + 500)
    after = merged(mesh, ((2, 2), (3, 2)))
    assert np.array_equal(after.element_ids, mesh.element_ids)
    assert set(after.node_ids) == set(mesh.node_ids) - {node_at(mesh, 2, 2)}
    assert Counter(len(sides(element)) for element in after.elements) == {4: 18, 3: 2}
