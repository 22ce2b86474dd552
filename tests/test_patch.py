"""Cutting patches out and stitching them back in."""

from collections import Counter

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.edit import Edit, apply
from meshops.mesh import NO_NODE, ShellMesh
from meshops.patch import components, extract, extract_each, join, stitch, without_doubles
from meshops.topology import topology
from tests.meshes import (
    CURVED_KINDS,
    FLAT_KINDS,
    corners,
    crossable_edges,
    folded,
    joined,
    make,
    meshes,
    place,
    rib,
    sheet,
    sides,
    torus,
    users,
)

ALL_KINDS = FLAT_KINDS + CURVED_KINDS
bounded = settings(max_examples=60, deadline=None)


@st.composite
def selections(draw):
    """A mesh, and some of its elements: mostly most of them, so that patches have inner nodes."""
    mesh = draw(meshes(ALL_KINDS))
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    share = draw(st.sampled_from([0.3, 0.8, 0.95, 1.0]))
    return mesh, rng.random(len(mesh.elements)) < share


def patches_of(mesh, selected):
    found = topology(mesh)
    return [extract(found, rows) for rows in components(found, selected)]


def contents(mesh):
    """Elements by the places of their nodes, from whichever node; regions; nothing of numbers."""
    found = Counter()
    for element, region in zip(mesh.elements, mesh.region, strict=True):
        places = [place(mesh, node) for node in corners(element)]
        turned = min(tuple(places[k:] + places[:k]) for k in range(len(places)))
        found[turned, int(region)] += 1
    return found


def test_an_edit_that_doubles_an_element_is_left_out():
    points = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0), (2, 1, 0)], float)
    mesh = ShellMesh.build(points, [[0, 1, 2, 3], [1, 4, 5, 2], [0, 1, 2, NO_NODE]])

    def instead_of(row, *elements):
        added = np.array(elements, np.int32)
        return Edit(np.array([row]), added_elements=added, added_region=np.zeros(len(added)))

    doubling = instead_of(0, (0, 1, 2, NO_NODE), (0, 2, 3, NO_NODE))
    other = instead_of(0, (0, 1, 3, NO_NODE), (1, 2, 3, NO_NODE))
    beside = instead_of(1, (1, 4, 5, NO_NODE), (1, 5, 2, NO_NODE))
    assert without_doubles(mesh, [doubling, beside]) == [beside]
    assert without_doubles(mesh, [other, beside]) == [other, beside]
    # what takes the place of the other one may be on its nodes
    again = instead_of(2, (1, 2, 0, NO_NODE))
    assert without_doubles(mesh, [again]) == [again]
    assert without_doubles(mesh, [beside, instead_of(0, (4, 5, 1, NO_NODE))]) == [beside]


def in_the_skin(mesh):
    return (mesh.points[mesh.elements, 2] == 0).all(axis=1)


def put_back(mesh, patch):
    return stitch(mesh, patch, patch.points[patch.border_nodes :], patch.elements)


@bounded
@given(selections())
def test_a_patch_put_back_as_it_was_makes_the_same_mesh(case):
    mesh, selected = case
    edit = join(mesh, [put_back(mesh, patch) for patch in patches_of(mesh, selected)])
    after = apply(mesh, edit)
    assert contents(after) == contents(mesh)
    assert len(after.points) == len(mesh.points)
    assert Counter(map(tuple, after.points)) == Counter(map(tuple, mesh.points))


@bounded
@given(selections())
def test_a_patch_is_a_view_of_the_mesh(case):
    mesh, selected = case
    found = topology(mesh)
    patches = patches_of(mesh, selected)
    chosen = np.concatenate([patch.rows for patch in patches] or [np.zeros(0, int)])
    assert sorted(chosen) == np.nonzero(selected & found.editable)[0].tolist()
    for patch in patches:
        assert (np.diff(patch.rows) > 0).all()
        assert np.array_equal(patch.points, mesh.points[patch.nodes])
        is_corner = patch.elements >= 0
        of_mesh = np.where(is_corner, patch.nodes[patch.elements], -1)
        assert np.array_equal(of_mesh, mesh.elements[patch.rows])
        assert set(mesh.region[patch.rows]) == {patch.region}
        assert set(patch.elements[is_corner]) == set(range(len(patch.nodes)))


@bounded
@given(selections())
def test_patches_that_are_cut_out_together_are_those_cut_out_alone(case):
    mesh, selected = case
    found = topology(mesh)
    parts = components(found, selected)
    together = list(extract_each(found, parts))
    assert len(together) == len(parts)
    for one, rows in zip(together, parts, strict=True):
        alone = extract(found, rows)
        for name in ("points", "elements", "border", "rows", "nodes"):
            assert np.array_equal(getattr(one, name), getattr(alone, name)), name
        assert (one.border_nodes, one.region) == (alone.border_nodes, alone.region)


@bounded
@given(selections())
def test_a_border_is_odd_where_the_trias_are(case):
    """So two trias in a patch are always one too many, and one never is."""
    mesh, selected = case
    for patch in patches_of(mesh, selected):
        assert len(patch.border) % 2 == np.count_nonzero(mesh.is_tria[patch.rows]) % 2


@bounded
@given(selections())
def test_the_border_of_a_patch_is_its_sides_on_barriers_and_to_elements_outside(case):
    mesh, selected = case
    crossable, edge_users = crossable_edges(mesh), users(mesh)
    for patch in patches_of(mesh, selected):
        inside = set(patch.rows.tolist())
        expected = Counter()
        for row in inside:
            for a, b in sides(mesh.elements[row]):
                edge = min(a, b), max(a, b)
                elements = {element for element, _ in edge_users[edge]}
                if edge not in crossable or not elements <= inside:
                    expected[a, b] += 1
        assert Counter(map(tuple, patch.nodes[patch.border].tolist())) == expected
        assert set(patch.border.ravel()) == set(range(patch.border_nodes))


@bounded
@given(selections())
def test_a_patch_is_manifold(case):
    """A side has one other or is on the border; a border node has one way in and one out."""
    mesh, selected = case
    for patch in patches_of(mesh, selected):
        directed = Counter(side for element in patch.elements for side in sides(element))
        border = {tuple(side) for side in patch.border.tolist()}
        assert set(directed.values()) == {1}
        assert {side for side in directed if side[::-1] not in directed} == border
        if len(border):
            starts, ends = patch.border.T
            assert sorted(starts) == sorted(ends) == list(range(patch.border_nodes))


@bounded
@given(selections())
def test_elements_that_must_stay_are_in_no_patch(case):
    mesh, selected = case
    found = topology(mesh)
    inner = set()
    for patch in patches_of(mesh, selected):
        assert not mesh.locked_elements[patch.rows].any()
        assert not found.anchors[patch.rows].any()
        inner |= set(patch.nodes[patch.border_nodes :].tolist())
    # what is inside a patch vanishes: it must not be locked, nor may another part hang on it
    assert not mesh.locked_nodes[list(inner)].any()
    for row, element in enumerate(mesh.elements):
        if not selected[row]:
            assert not inner & set(corners(element))


def test_nodes_on_a_slit_are_in_the_patch_once_on_either_side():
    skin = sheet(6, 4)
    mesh = joined(skin, rib(3, 1, at=2.0, start=1.0))
    (patch,) = patches_of(mesh, in_the_skin(mesh))
    places = Counter(map(tuple, patch.points))
    twice = {at for at, times in places.items() if times == 2}
    assert twice == {(2.0, 2.0, 0.0), (3.0, 2.0, 0.0)}  # its ends at 1 and 4 are there once
    assert set(places.values()) == {1, 2}
    assert len(patch.border) == 2 * (6 + 4) + 2 * 3


def test_a_rib_that_starts_at_the_border_opens_the_patch_there():
    mesh = joined(sheet(4, 2), rib(2, 1, at=1.0, start=0.0))
    (patch,) = patches_of(mesh, in_the_skin(mesh))
    twice = {at for at, times in Counter(map(tuple, patch.points)).items() if times == 2}
    assert twice == {(0.0, 1.0, 0.0), (1.0, 1.0, 0.0)}


def test_a_fold_splits_a_selection_in_two():
    mesh = folded(sheet(4, 3), 2.0)
    assert [len(patch.rows) for patch in patches_of(mesh, np.ones(12, bool))] == [6, 6]


def test_nothing_selected_is_no_patch_and_an_empty_edit():
    mesh = make("plain", 0)
    assert patches_of(mesh, np.zeros(len(mesh.elements), bool)) == []
    assert join(mesh, []).is_empty


def test_a_mesh_without_border_is_a_patch_without_border():
    mesh = torus()
    (patch,) = patches_of(mesh, np.ones(len(mesh.elements), bool))
    assert patch.border_nodes == len(patch.border) == 0
    assert contents(apply(mesh, put_back(mesh, patch))) == contents(mesh)
