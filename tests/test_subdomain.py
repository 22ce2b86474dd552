"""Subdomains: where they lie, what they may reach, and the way back into the mesh."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import STANDARD
from meshops.edit import apply
from meshops.fitness import Fitness
from meshops.operations import OPERATIONS
from meshops.patch import components, extract, join
from meshops.quality import element_index
from meshops.quality_sums import IRREGULAR
from meshops.subdomain import Extent, Subdomain, places, subdomains
from meshops.workpiece import Setting, Workpiece
from tests.measures import barriers, corners, crossable_edges, place, sides, users, within
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
    assert_zones_are_whole,
    tried,
)

EXTENTS = (Extent(0, 1), Extent(1, 50), Extent(2, 10), Extent(3, 60), Extent(99, 10_000))
ALL_KINDS = FLAT_KINDS + CURVED_KINDS
bounded = settings(max_examples=40, deadline=None)
seeds = st.integers(0, 10**6)


def workpiece(mesh, outside=None):
    fitness = Fitness("quality", len(mesh.elements))
    return Workpiece(mesh, Setting(STANDARD.at(1.0), fitness, outside=outside))


def rows_of(found):
    return [set(subdomain.patch.rows.tolist()) for subdomain in found]


def two_trias(columns, rows):
    """A sheet with one quad in the middle cut in two."""
    mesh = sheet(columns, rows)
    middle = len(mesh.elements) // 2
    a, b, c, d = mesh.elements[middle]
    elements = [*np.delete(mesh.elements, middle, axis=0), (a, b, c, -1), (a, c, d, -1)]
    return with_(
        mesh,
        elements=elements,
        region=np.zeros(len(elements)),
        locked_elements=np.zeros(len(elements)),
        element_ids=np.arange(1, len(elements) + 1),
    )


# --- where they lie -----------------------------------------------------------------------------


@bounded
@given(meshes(ALL_KINDS), st.sampled_from(EXTENTS), st.integers(0, 7))
def test_subdomains_are_disjoint_connected_small_and_within_barriers(mesh, extent, turn):
    piece = workpiece(mesh)
    found = rows_of(subdomains(piece, extent, turn))
    assert sum(map(len, found)) == len(set().union(*found))
    crossable, of_edge = crossable_edges(mesh), users(mesh)
    for rows in found:
        assert len(rows) <= extent.elements
        assert piece.topology.editable[list(rows)].all()
        reached, todo = set(), [min(rows)]
        while todo:
            row = todo.pop()
            if row in reached:
                continue
            reached.add(row)
            for a, b in sides(mesh.elements[row]):
                if (min(a, b), max(a, b)) in crossable:
                    todo += [r for r, _ in of_edge[min(a, b), max(a, b)] if r in rows]
        assert reached == rows


@bounded
@given(meshes(ALL_KINDS), st.sampled_from(EXTENTS), st.integers(0, 7))
def test_all_failing_places_are_covered_and_no_subdomain_is_in_vain(mesh, extent, turn):
    piece = workpiece(mesh)
    found = subdomains(piece, extent, turn)
    covered = set().union(*rows_of(found))
    bad = places(piece)
    assert set(bad[piece.failing[bad]].tolist()) <= covered
    for subdomain in found:
        rows = subdomain.patch.rows
        trias = np.count_nonzero(mesh.is_tria[rows])
        assert piece.failing[rows].any() or trias > subdomain.least_trias
        assert set(rows.tolist()) & set(bad.tolist())


@bounded
@given(meshes(ALL_KINDS), st.integers(0, 7))
def test_without_limits_each_zone_that_can_gain_is_one_subdomain(mesh, turn):
    piece = workpiece(mesh)
    found = rows_of(subdomains(piece, Extent(10_000, 10_000), turn))
    assert set(places(piece).tolist()) <= set().union(*found)
    zones = piece.topology.zones
    for rows in found:
        (zone,) = set(zones[list(rows)].tolist())
        assert rows == set(np.nonzero(zones == zone)[0].tolist())


@pytest.mark.parametrize("rings", [1, 2, 3])
def test_a_subdomain_reaches_so_many_rings_from_the_worst_element(rings):
    mesh = two_trias(9, 9)
    piece = workpiece(mesh)
    first = subdomains(piece, Extent(rings, 1000), 0)[0]
    assert set(first.patch.rows.tolist()) == within(mesh, int(places(piece)[0]), rings)


def test_another_turn_begins_elsewhere():
    piece = workpiece(sheet(9, 9, seed=1, jitter=0.3, trias=0.4))
    assert len(places(piece)) > 5
    cuts = {
        tuple(sorted(map(tuple, map(sorted, rows_of(subdomains(piece, Extent(1, 9), turn))))))
        for turn in range(3)
    }
    assert len(cuts) > 1


def test_only_zones_that_can_gain_have_places():
    """Two trias, one in each half: each half has an odd border, so neither can lose its tria."""
    left = with_(two_trias(3, 1), elements=two_trias(3, 1).elements)
    assert len(places(workpiece(left))) == 2
    assert len(subdomains(workpiece(left), Extent(9, 99), 0)) == 1
    points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 1.8, 0)]
    house = with_(sheet(1, 1), points=sheet(1, 1).points)
    house = type(house).build(points, [(0, 1, 2, 3), (3, 2, 4, -1)])
    assert len(places(workpiece(house))) == 0
    assert subdomains(workpiece(house), Extent(9, 99), 0) == []


@pytest.mark.parametrize(
    "mesh",
    [sheet(4, 4), with_(two_trias(4, 4), locked_elements=np.ones(17, bool))],
    ids=["without fault", "locked whole"],
)
def test_where_nothing_is_left_to_gain_there_are_none(mesh):
    for extent in EXTENTS:
        assert subdomains(workpiece(mesh), extent, 0) == []


def test_regions_and_folds_end_a_subdomain():
    mesh = in_two_regions(two_trias(8, 4), 3.0)
    for subdomain in subdomains(workpiece(mesh), Extent(99, 999), 0):
        assert len(set(mesh.region[subdomain.patch.rows])) == 1
        assert (subdomain.mesh.region == subdomain.patch.region).all()
    plate = joined(two_trias(4, 4), shaped(sheet(4, 4), lambda x, y: (x + 4, y, 0 * x)))
    (found,) = subdomains(workpiece(folded(plate, 4.0)), Extent(99, 999), 0)
    assert not found.mesh.points[:, 2].any()


@bounded
@given(meshes(ALL_KINDS))
def test_the_worst_elements_come_first_and_sound_quads_only_where_there_is_nothing_else(mesh):
    piece = workpiece(mesh)
    index = np.round(element_index(mesh, piece.setting.scoring), 9)
    editable = np.nonzero(piece.topology.editable)[0].tolist()
    bad = [row for row in editable if piece.mendable[row] or mesh.is_tria[row]]
    bad = bad or [row for row in editable if piece.irregular_elements[row]] or editable
    by_shape = piece.failing_by_shape
    worst_first = sorted(bad, key=lambda row: (not by_shape[row], -index[row], row))
    assert piece.bad_elements.tolist() == worst_first


# --- the mesh of a subdomain --------------------------------------------------------------------


@bounded
@given(meshes(ALL_KINDS), st.sampled_from(EXTENTS))
def test_its_border_is_locked_and_its_elements_are_those_of_the_mesh(mesh, extent):
    for subdomain in subdomains(workpiece(mesh), extent, 0):
        own, patch = subdomain.mesh, subdomain.patch
        border = {end for edge, uses in users(own).items() if len(uses) == 1 for end in edge}
        assert set(np.nonzero(own.locked_nodes)[0].tolist()) == border
        assert not mesh.locked_nodes[patch.nodes[patch.border_nodes :]].any()
        assert not own.locked_elements.any()
        assert (own.region == mesh.region[patch.rows]).all()
        for element, row in zip(own.elements, patch.rows, strict=True):
            theirs = [place(mesh, node) for node in corners(mesh.elements[row])]
            assert [place(own, node) for node in corners(element)] == theirs


@bounded
@given(meshes(ALL_KINDS), st.sampled_from(EXTENTS))
def test_no_fewer_trias_than_the_parity_of_the_border(mesh, extent):
    for subdomain in subdomains(workpiece(mesh), extent, 0):
        borders = [uses for uses in users(subdomain.mesh).values() if len(uses) == 1]
        assert subdomain.least_trias == len(borders) % 2
        assert np.count_nonzero(subdomain.mesh.is_tria) % 2 == subdomain.least_trias


# --- and back -----------------------------------------------------------------------------------


@bounded
@given(meshes(ALL_KINDS), st.sampled_from(EXTENTS))
def test_an_unchanged_subdomain_is_an_empty_edit(mesh, extent):
    for subdomain in subdomains(workpiece(mesh), extent, 0):
        assert subdomain.edit(mesh, subdomain.mesh).is_empty


@settings(max_examples=60, deadline=None)
@given(meshes(ALL_KINDS), st.sampled_from(EXTENTS[1:]), st.sampled_from(OPERATIONS), seeds)
def test_what_is_done_inside_leaves_all_outside_as_it_was(mesh, extent, operation, seed):
    piece = workpiece(mesh)
    merged, edits = piece.tally, []
    for subdomain in subdomains(piece, extent, seed % 3):
        own = workpiece(subdomain.mesh, subdomain.outside)
        for after, _ in tried(operation, own, seed, count=1):
            edit = subdomain.edit(mesh, after)
            edits.append(edit)
            alone = apply(mesh, edit)
            change = workpiece(after, subdomain.outside).tally - own.tally
            merged = merged + change
            np.testing.assert_allclose(
                workpiece(alone).tally, piece.tally + change, rtol=1e-9, atol=1e-8
            )
            assert_outside_is_untouched(mesh, alone, subdomain)
            assert_untouched_elements_keep_their_id(mesh, alone, subdomain, after)
    together = apply(mesh, join(mesh, edits))
    # two subdomains may both change how many elements meet at a node between them
    found = np.delete(workpiece(together).tally, IRREGULAR)
    np.testing.assert_allclose(found, np.delete(merged, IRREGULAR), rtol=1e-9, atol=1e-7)
    assert barriers(together) == barriers(mesh)
    assert_ids_are_kept(mesh, together)
    assert_nothing_locked_has_changed(mesh, together)
    assert_zones_are_whole(mesh, together, area=0.1)


def named(mesh):
    """Places of the corners of each element, by its id; new ones have none."""
    return {
        int(number): [place(mesh, node) for node in corners(element)]
        for number, element in zip(mesh.element_ids, mesh.elements, strict=True)
        if number
    }


def assert_outside_is_untouched(before, after, subdomain):
    inside = set(before.element_ids[subdomain.patch.rows].tolist())
    now = named(after)
    for number, theirs in named(before).items():
        if number not in inside:
            assert now[number] == theirs


def assert_untouched_elements_keep_their_id(before, after, subdomain, part):
    """An element that the subdomain's mesh still has is the same one in the mesh around it."""
    now = named(after)
    for row, theirs in named(part).items():
        assert now[int(before.element_ids[subdomain.patch.rows[row - 1]])] == theirs


def test_moved_nodes_keep_their_id_and_locked_ones_their_place():
    mesh = with_(two_trias(5, 5), node_ids=np.arange(36) + 900)
    piece = workpiece(mesh)
    (rows,) = components(piece.topology, np.ones(len(mesh.elements), bool))
    subdomain = Subdomain.of(piece.topology, extract(piece.topology, rows), slides=False)
    points = subdomain.mesh.points.copy()
    inner = np.nonzero(~subdomain.mesh.locked_nodes)[0]
    points[inner[0], :2] += 0.1
    edit = subdomain.edit(mesh, with_(subdomain.mesh, points=points))
    after = apply(mesh, edit)
    assert len(edit.removed) == len(edit.rewired) == len(edit.added_elements) == 0
    assert np.array_equal(after.node_ids, mesh.node_ids)
    moved = np.nonzero((after.points != mesh.points).any(axis=1))[0]
    assert moved.tolist() == [subdomain.patch.nodes[inner[0]]]
