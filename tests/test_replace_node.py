"""ReplaceNode: what merging does on small meshes, and which merges are refused."""

from collections import Counter, defaultdict

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import STANDARD
from meshops.edit import apply
from meshops.fitness import Fitness
from meshops.mesh import ShellMesh
from meshops.operations import ReplaceNodePairs
from meshops.operations.replace_node import mergeable_pairs
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

FACING = 0.5
"""Cosine of the angle up to which an element may turn."""

LEAST_CORNER = 0.02
"""Of a merged element, as the core has it."""

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
