"""What is measured of two meshes, on edits whose harm is known."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import PAPER
from meshops.harm import compare, local_sizes, median_size, verify
from meshops.harm.changes import Changes, duplicates
from meshops.harm.edges import BORDER, FEATURE, JUNCTION, REGION, Edges, kinds_of
from meshops.harm.gradation import Gradation
from meshops.harm.nearest import to_segments, to_trias
from meshops.harm.rows import walk_across
from meshops.mesh import NEW, ShellMesh
from tests.measures import distances_to_trias
from tests.meshes import (
    CURVED_KINDS,
    FLAT_KINDS,
    annulus,
    folded,
    in_two_regions,
    joined,
    make,
    meshes,
    rib,
    shaped,
    sheet,
    shuffled,
    with_,
)

UNIT = PAPER.at(1.0)


def moved(mesh, node, by):
    points = mesh.points.copy()
    points[node] += by
    return with_(mesh, points=points)


def node_at(mesh, *place):
    (found,) = np.flatnonzero(np.all(np.isclose(mesh.points, place), axis=1))
    return int(found)


def split(mesh, row):
    """A quad in two trias, with new ids."""
    a, b, c, d = mesh.elements[row].tolist()
    elements = np.concatenate([np.delete(mesh.elements, row, 0), [(a, b, c, -1), (a, c, d, -1)]])
    region = np.append(np.delete(mesh.region, row), [mesh.region[row]] * 2)
    ids = np.append(np.delete(mesh.element_ids, row), [NEW, NEW])
    locked = np.append(np.delete(mesh.locked_elements, row), [False] * 2)
    return with_(mesh, elements=elements, region=region, element_ids=ids, locked_elements=locked)


def says(sentences, word):
    return [sentence for sentence in sentences if word in sentence]


@settings(max_examples=40, deadline=None)
@given(meshes((*FLAT_KINDS, *CURVED_KINDS)))
def test_what_is_as_it_was_has_no_harm(mesh):
    harm = compare(mesh, mesh, UNIT)
    assert harm.worse() == ()
    assert (harm.changed_elements, harm.changed_nodes, harm.other_ids) == (0, 0, 0)
    assert harm.before == harm.after


@settings(max_examples=40, deadline=None)
@given(meshes((*FLAT_KINDS, *CURVED_KINDS)), st.integers(0, 10**6))
def test_order_of_elements_is_no_change(mesh, seed):
    rng = np.random.default_rng(seed)
    order = rng.permutation(len(mesh.elements))
    names = ("elements", "region", "locked_elements", "element_ids")
    other = with_(mesh, **{name: getattr(mesh, name)[order] for name in names})
    harm = compare(mesh, other, UNIT)
    assert harm.worse() == ()
    assert harm.changed_elements == 0


@settings(max_examples=40, deadline=None)
@given(meshes((*FLAT_KINDS, *CURVED_KINDS)))
def test_other_numbers_of_regions_are_no_change(mesh):
    other = with_(mesh, region=100 - 3 * mesh.region)
    assert compare(mesh, other, UNIT).worse() == ()


@settings(max_examples=40, deadline=None)
@given(meshes(FLAT_KINDS), st.integers(0, 10**6))
def test_each_measure_of_a_move_is_undone_by_the_way_back(mesh, seed):
    """What is better one way is worse the other, in every column that has an order."""
    rng = np.random.default_rng(seed)
    node = int(rng.integers(len(mesh.points)))
    there = moved(mesh, node, rng.uniform(-0.4, 0.4, 3))
    one, back = compare(mesh, there, UNIT), compare(there, mesh, UNIT)
    for name in ("failed_by_shape", "failed_by_size", "least_angle", "least_scaled_jacobian"):
        assert getattr(one.before, name) == pytest.approx(getattr(back.after, name))
        assert getattr(one.after, name) == pytest.approx(getattr(back.before, name))


def test_kinds_of_edges():
    skin = joined(
        shaped(sheet(4, 2), lambda x, y: (x, y - 2, 0 * x)), in_two_regions(sheet(4, 2), 2.0)
    )
    mesh = joined(skin, rib(4, 2, at=0.0))
    edges = Edges.of(mesh)
    counts = np.bincount(kinds_of(mesh, edges), minlength=5).tolist()
    # skin 4 x 4 and rib 4 x 2 share 4 edges; the regions meet on 2 edges beside these
    assert counts[JUNCTION] == 4
    assert counts[BORDER] == 16 + 8
    assert counts[REGION] == 2
    assert counts[FEATURE] == 0
    bent = folded(sheet(4, 2), 2.0)
    assert np.bincount(kinds_of(bent, Edges.of(bent))).tolist()[FEATURE] == 2


def test_edges_of_a_grid():
    mesh = sheet(3, 2)
    edges = Edges.of(mesh)
    assert len(edges.nodes) == 3 * 3 + 4 * 2
    assert np.count_nonzero(edges.uses == 2) == 7
    for (a, b), pair, sides in zip(edges.nodes, edges.pair, edges.pair_sides, strict=True):
        for element, side in zip(pair[pair >= 0], sides[pair >= 0], strict=True):
            ends = mesh.elements[element, [side, (side + 1) % 4]]
            assert sorted(ends.tolist()) == [a, b]


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6))
def test_distances_to_trias_are_exact(seed):
    rng = np.random.default_rng(seed)
    trias = rng.normal(size=(40, 1, 3)) * 3 + rng.normal(size=(40, 3, 3)) * rng.choice(
        [0.01, 0.3, 5.0], (40, 1, 1)
    )
    points = rng.normal(size=(25, 3)) * 4
    found, row = to_trias(points, trias)
    for k, point in enumerate(points):
        distances = distances_to_trias(point, trias)
        assert found[k] == pytest.approx(distances.min(), abs=1e-9)
        assert distances[row[k]] == pytest.approx(found[k], abs=1e-9)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6))
def test_distances_to_segments_are_exact(seed):
    rng = np.random.default_rng(seed)
    ends = rng.normal(size=(30, 1, 3)) * 3 + rng.normal(size=(30, 2, 3)) * rng.choice(
        [0.01, 0.3, 5.0], (30, 1, 1)
    )
    points = rng.normal(size=(20, 3)) * 4
    found, _ = to_segments(points, ends)
    share = np.linspace(0, 1, 2001)[:, None]
    for k, point in enumerate(points):
        dense = ends[:, :1] + share * (ends[:, 1:] - ends[:, :1])
        nearest = np.linalg.norm(dense - point, axis=2).min()
        assert nearest - 2e-2 <= found[k] <= nearest + 1e-12


def test_nothing_is_infinitely_far_from_nothing():
    distance, row = to_segments(np.zeros((2, 3)), np.zeros((0, 2, 3)))
    assert (distance.tolist(), row.tolist()) == ([np.inf] * 2, [-1] * 2)


# --- changes ---------------------------------------------------------------------------------


def test_a_moved_node_changes_the_elements_around_it_and_no_other():
    mesh = sheet(5, 5)
    changes = Changes.of(mesh, moved(mesh, node_at(mesh, 2, 2, 0), (0.1, 0, 0)))
    assert (changes.changed_elements, changes.changed_nodes) == (4, 1)
    assert not changes.other_ids.any()
    assert changes.place_after.max() == 0


def test_two_moves_far_apart_are_two_places():
    mesh = sheet(8, 8)
    other = moved(moved(mesh, node_at(mesh, 2, 2, 0), 0.1), node_at(mesh, 6, 6, 0), 0.1)
    changes = Changes.of(mesh, other)
    assert np.unique(changes.place_before).tolist() == [-1, 0, 1]
    assert np.bincount(changes.place_after + 1).tolist() == [64 - 8, 4, 4]


def test_the_same_quad_from_another_corner_is_the_same_element():
    mesh = sheet(3, 3)
    changes = Changes.of(mesh, with_(mesh, elements=np.roll(mesh.elements, 1, axis=1)))
    assert changes.changed_elements == 0


def test_a_quad_turned_over_is_another_element():
    mesh = sheet(3, 3)
    elements = mesh.elements.copy()
    elements[4] = elements[4][::-1]
    harm = compare(mesh, with_(mesh, elements=elements), UNIT)
    assert harm.changed_elements == 1
    assert says(harm.broken(), "normal turned round")


def test_an_id_that_is_not_kept_is_told():
    mesh = sheet(3, 3)
    ids = mesh.element_ids.copy()
    ids[[2, 5]] = [77, NEW]
    harm = compare(mesh, with_(mesh, element_ids=ids), UNIT)
    assert harm.other_ids == 2
    assert says(harm.broken(), "another id")


def test_a_split_quad_counts_as_two_changes_and_no_fault_removed():
    mesh = sheet(4, 4)
    harm = compare(mesh, split(mesh, 5), UNIT)
    assert harm.changed_elements == 2
    assert harm.after.adjacent_trias == 1
    assert says(harm.broken(), "0 trias become 2")
    back = compare(split(mesh, 5), mesh, UNIT)
    assert back.faults_removed == 2
    assert back.changed_per_fault == 1.0
    assert back.worse() == ()


def test_a_tria_may_come_where_a_fault_of_shape_goes():
    """A quad with a corner of 200 degrees becomes two trias: one fault less, two trias more."""
    mesh = sheet(4, 4)
    row = next(
        r for r in range(16) if mesh.points[mesh.elements[r]].mean(0)[:2].tolist() == [1.5] * 2
    )
    corner = node_at(mesh, 1, 1, 0)
    bad = moved(mesh, corner, (0.6, 0.6, 0))
    assert compare(bad, bad, UNIT).before.failed_by_shape > 1
    harm = compare(bad, split(bad, row), UNIT)
    assert harm.places.unpaid_trias == 1


def test_elements_on_the_same_nodes_are_found():
    mesh = sheet(3, 3)
    doubled = with_(
        mesh,
        elements=np.concatenate([mesh.elements, np.roll(mesh.elements[:1], 2, axis=1)]),
        region=np.append(mesh.region, 0),
        locked_elements=np.append(mesh.locked_elements, False),
        element_ids=np.append(mesh.element_ids, 99),
    )
    assert duplicates(doubled).tolist() == [9]
    assert says(compare(mesh, doubled, UNIT).broken(), "on the nodes of another one")
    assert compare(doubled, doubled, UNIT).worse() == ()


def test_what_is_locked_stays():
    mesh = sheet(4, 4)
    node = node_at(mesh, 2, 2, 0)
    locked = with_(mesh, locked_nodes=np.arange(len(mesh.points)) == node)
    assert says(verify(locked, moved(locked, node, 0.05), UNIT), "locked")
    assert not says(verify(mesh, moved(mesh, node, 0.05), UNIT), "locked")


# --- lines -----------------------------------------------------------------------------------


def lines_of(harm):
    return {line.kind: line for line in harm.lines}


def test_a_border_node_that_slides_on_a_straight_border_does_no_harm_to_it():
    mesh = sheet(6, 4)
    harm = compare(mesh, moved(mesh, node_at(mesh, 2, 0, 0), (0.2, 0, 0)), UNIT)
    border = lines_of(harm)["free border"]
    assert (border.worst, border.corners_lost) == (0.0, 0)
    assert harm.area_change == pytest.approx(0.0, abs=1e-12)


def test_a_border_node_that_leaves_its_border_is_measured_both_ways():
    mesh = sheet(6, 4)
    harm = compare(mesh, moved(mesh, node_at(mesh, 2, 0, 0), (0.0, 0.2, 0)), UNIT)
    border = lines_of(harm)["free border"]
    assert border.after_off_before == pytest.approx(0.2)
    # the old node is nearest to a new edge: 0.2 across over an edge of sqrt(1.04)
    assert border.before_off_after == pytest.approx(0.2 / np.sqrt(1.04))
    assert says(harm.broken(), "the free border moves by 20 %")


def test_the_width_of_a_strip_counts_where_it_is_less_than_the_edge():
    narrow = shaped(sheet(6, 1), lambda x, y: (x, 0.1 * y, 0 * x))
    harm = compare(narrow, moved(narrow, node_at(narrow, 2, 0, 0), (0, 0.005, 0)), UNIT)
    assert lines_of(harm)["free border"].after_off_before == pytest.approx(0.05)


def test_a_node_that_slides_along_a_chord_makes_a_ragged_ring():
    ring = annulus(24, 3)
    node = node_at(ring, 5.0, 0.0, 0.0)
    ahead = ring.points[node + 1]
    harm = compare(ring, moved(ring, node, 0.5 * (ahead - ring.points[node])), UNIT)
    border = lines_of(harm)["free border"]
    # all its nodes are on the old border, but the old corner is cut off by an edge and a half
    assert border.after_off_before > 0.02
    assert border.before_off_after > 0.02
    assert says(harm.broken(), "free border")
    assert says(harm.broken(), "area")


def test_a_corner_that_is_cut_off_is_told():
    mesh = sheet(4, 4)
    corner = node_at(mesh, 0, 0, 0)
    harm = compare(mesh, moved(mesh, corner, (0.3, 0.0, 0)), UNIT)
    assert lines_of(harm)["free border"].corners_lost == 1
    assert says(harm.broken(), "corners of the free border")


@pytest.mark.parametrize(
    ("kind", "mesh", "place"),
    [
        (
            "T-junction",
            joined(
                shaped(sheet(4, 3), lambda x, y: (x, y - 3, 0 * x)),
                sheet(4, 3),
                rib(4, 2, at=0.0),
            ),
            (2, 0, 0),
        ),
        ("region edge", in_two_regions(sheet(4, 4), 2.0), (2, 2, 0)),
        ("crease", folded(sheet(4, 4), 2.0), (2, 2, 0)),
    ],
)
def test_lines_inside_a_part_are_kept_too(kind, mesh, place):
    node = node_at(mesh, *place)
    along = (0.2, 0, 0) if kind == "T-junction" else (0, 0.2, 0)
    across = (0, 0.2, 0) if kind == "T-junction" else (-0.2, 0, 0)
    slid = compare(mesh, moved(mesh, node, along), UNIT)
    assert lines_of(slid)[kind].worst == 0.0
    left = compare(mesh, moved(mesh, node, across), UNIT)
    assert lines_of(left)[kind].worst == pytest.approx(0.2, abs=0.01)
    assert says(left.broken(), kind)


def test_a_hole_that_closes_is_told():
    mesh = sheet(6, 6)
    row = 14
    keep = np.arange(36) != row
    names = ("elements", "region", "locked_elements", "element_ids")
    holed = with_(mesh, **{name: getattr(mesh, name)[keep] for name in names})
    assert lines_of(compare(holed, mesh, UNIT))["free border"].before_off_after > 0.3
    assert says(verify(holed, mesh, UNIT), "free border")
    assert says(verify(mesh, holed, UNIT), "free border")


# --- surface ---------------------------------------------------------------------------------


def test_a_node_off_the_surface_is_measured_in_local_edges():
    mesh = shaped(sheet(4, 4), lambda x, y: (3 * x, 3 * y, 0 * x))
    harm = compare(mesh, moved(mesh, node_at(mesh, 6, 6, 0), (0, 0, 0.3)), PAPER.at(3.0))
    assert harm.surface.nodes == pytest.approx(0.1)
    assert says(harm.broken(), "the surface moves by 10 %")


def test_nodes_that_move_within_the_surface_do_no_harm_to_it():
    mesh = folded(sheet(6, 4), 3.0)
    harm = compare(mesh, moved(mesh, node_at(mesh, 3, 2, 1), (0, 0.2, 0.1)), UNIT)
    assert harm.surface.nodes == pytest.approx(0.0, abs=1e-9)
    assert not says(harm.broken(), "surface")


def test_facets_explain_what_middles_of_a_curved_mesh_differ_by():
    turn = np.radians(10.0)
    curved = shaped(sheet(9, 4), lambda x, y: (np.sin(turn * x) / turn, y, np.cos(turn * x) / turn))
    node = node_at(curved, np.sin(4 * turn) / turn, 2, np.cos(4 * turn) / turn)
    ahead = curved.points[node_at(curved, np.sin(5 * turn) / turn, 2, np.cos(5 * turn) / turn)]
    harm = compare(curved, moved(curved, node, 0.3 * (ahead - curved.points[node])), UNIT)
    assert harm.surface.nodes == pytest.approx(0.0, abs=1e-9)
    assert 0.0 < harm.surface.back <= harm.surface.facets + 0.01
    assert not says(harm.broken(), "surface")


def test_a_narrow_strip_between_two_creases_is_not_folded_back():
    """A step that is much lower than the plates beside it are wide, sharper than a right angle."""
    step = [(0.0, 0.0), (5.0, 0.0), (4.99, 0.02), (9.99, 0.02)]
    mesh = shaped(sheet(3, 6), lambda x, y: (step_at(step, x, 0), y, step_at(step, x, 1)))
    found = compare(mesh, mesh, UNIT).before
    assert found.inverted == 0
    assert found.areas == pytest.approx({0: 6 * (10 + np.hypot(0.01, 0.02))})


def step_at(section, x, axis):
    return np.array([place[axis] for place in section])[x.astype(int)]


def test_walks_where_there_are_no_rows_are_no_measure():
    """In an irregular mesh one walk goes through more quads than the next: none is to be kept."""
    mesh = sheet(8, 8, trias=0.5, seed=2)
    edges = Edges.of(mesh)
    assert walk_across(mesh, edges, kinds_of(mesh, edges)).steady.sum() <= 4
    even = sheet(8, 8)
    edges = Edges.of(even)
    assert walk_across(even, edges, kinds_of(even, edges)).steady.all()


def test_areas_of_regions():
    mesh = in_two_regions(sheet(4, 4), 2.0)
    harm = compare(mesh, moved(mesh, node_at(mesh, 2, 0, 0), (0.1, 0, 0)), UNIT)
    assert harm.before.areas == pytest.approx({3: 8.0, 7: 8.0})
    assert harm.after.areas == pytest.approx({3: 8.05, 7: 7.95})
    assert harm.area_change == pytest.approx(0.05 / 8)
    assert says(harm.broken(), "area of region")


# --- sizes and rows --------------------------------------------------------------------------


def graded(columns=12, rows=4, ratio=1.2):
    """A plate whose columns grow by a ratio."""
    places = np.concatenate([[0.0], np.cumsum(ratio ** np.arange(columns))])
    return shaped(sheet(columns, rows), lambda x, y: (places[x.astype(int)], y, 0 * x))


def test_the_gradation_of_an_even_mesh_is_even():
    mesh = sheet(6, 6)
    assert Gradation.of(mesh, Edges.of(mesh)).at(mesh.points) == pytest.approx(np.ones(49))


def test_the_gradation_follows_the_mesh():
    mesh = shaped(sheet(12, 12), lambda x, y: (1.1**x, 1.1**y, 0 * x))
    found = Gradation.of(mesh, Edges.of(mesh)).at(mesh.points)
    expected = 0.1 * np.sqrt(mesh.points[:, 0] * mesh.points[:, 1])
    inner = (mesh.points[:, :2] > 1.3).all(axis=1) & (mesh.points[:, :2] < 2.6).all(axis=1)
    assert found[inner] == pytest.approx(expected[inner], rel=0.15)


def test_sizes_of_elements_follow_the_first_mesh_alone():
    mesh = graded()
    other = moved(mesh, 30, (0.3, 0, 0))
    then, now = local_sizes(mesh, other)
    assert then == pytest.approx(local_sizes(mesh, mesh)[1])
    assert now == pytest.approx(then, rel=0.1)


def coarse(mesh, columns, rows, step):
    """The grid of `sheet` with each `step` rows as one."""
    node = np.arange(len(mesh.points)).reshape(rows + 1, columns + 1)
    quads = [
        (node[j, i], node[j, i + 1], node[k, i + 1], node[k, i])
        for j, k in pairwise(range(0, rows + 1, step))
        for i in range(columns)
    ]
    return ShellMesh.build(
        mesh.points, quads, node_ids=mesh.node_ids, element_ids=np.zeros(len(quads))
    )


def test_five_rows_that_become_one_are_told():
    mesh = sheet(10, 5)
    harm = compare(mesh, coarse(mesh, 10, 5, 5), UNIT)
    assert (harm.rows.before, harm.rows.after) == (5, 1)
    assert harm.rows.least == pytest.approx(0.2)
    assert says(harm.worse(), "5 rows across become 1")
    assert harm.sizes.grown == pytest.approx(5.0)


def test_rows_of_a_web_between_flanges_are_counted_between_its_junctions():
    web = rib(6, 4, at=0.0)
    flanges = [shaped(sheet(6, 4), lambda x, y, z=z: (x, y - 2, 0 * x + z)) for z in (0.0, 4.0)]
    mesh = joined(web, *flanges)
    edges = Edges.of(mesh)
    kinds = kinds_of(mesh, edges)
    walks = walk_across(mesh, edges, kinds)
    at_junction = kinds[walks.edge] == JUNCTION
    upright = np.abs(walks.across[:, 2]) > 3.9
    assert np.unique(walks.rows[at_junction & upright]).tolist() == [4]
    assert np.unique(walks.rows[at_junction & ~upright]).tolist() == [2]
    assert walks.arrived.all()
    assert walks.width[at_junction & upright] == pytest.approx(4.0)


def test_a_walk_goes_straight_on_through_trias():
    mesh = split(sheet(5, 4), 7)
    edges = Edges.of(mesh)
    walks = walk_across(mesh, edges, kinds_of(mesh, edges))
    assert not walks.steady.all()
    assert walks.arrived.sum() >= len(walks.rows) - 4


def test_a_row_that_is_taken_out_lengthwise_keeps_the_rows_across():
    """Of 10 columns in a strip of 3 rows one goes: the others take its place."""
    mesh, other = sheet(10, 3), shaped(sheet(9, 3), lambda x, y: (x * 10 / 9, y, 0 * x))
    assert compare(mesh, other, UNIT).rows.fewer == 0


def test_an_edge_that_is_far_too_long_is_told_where_none_near_it_was():
    mesh = graded()
    assert compare(mesh, mesh, UNIT).sizes.grown == 1.0
    long = coarse(mesh, 12, 4, 4)
    assert compare(mesh, long, UNIT).sizes.grown > 1.5
    assert says(compare(mesh, long, UNIT).worse(), "times as long")


# --- faults and places -----------------------------------------------------------------------


def test_a_misplaced_node_that_goes_back_is_a_repair_without_harm():
    mesh = sheet(6, 6)
    bad = moved(mesh, node_at(mesh, 3, 3, 0), (0.7, 0.6, 0))
    harm = compare(bad, mesh, UNIT)
    assert harm.before.failed_by_shape >= 1
    assert harm.after.failed_by_shape == 0
    assert harm.worse() == ()
    assert harm.changed_elements == 4
    assert 0 < harm.changed_per_fault <= 4


def test_a_fault_of_shape_that_takes_the_place_of_one_of_size_is_told():
    """Long rectangles that fail by aspect alone are no reason for needles."""
    long = shaped(sheet(4, 6), lambda x, y: (4.0 * x, y, 0 * x))
    sheared = moved(long, node_at(long, 8, 3, 0), (3.0, 0, 0))
    assert compare(long, long, UNIT).before.failed_by_shape == 0
    harm = compare(long, sheared, UNIT)
    assert says(harm.broken(), "fail by shape")
    assert harm.places.new_faults == 1


def test_a_node_that_folds_elements_over_each_other_may_go_back():
    """The area of a folded mesh is that of what it covers."""
    mesh = sheet(6, 6)
    bad = moved(mesh, node_at(mesh, 3, 3, 0), (1.6, 0.2, 0))
    harm = compare(bad, mesh, UNIT)
    assert harm.before.areas == pytest.approx({0: 36.0})
    assert harm.before.inverted > 0
    assert harm.worse() == ()


def test_quality_that_falls_for_nothing_is_told():
    mesh = sheet(6, 6)
    harm = compare(mesh, moved(mesh, node_at(mesh, 3, 3, 0), (0.1, 0.05, 0)), UNIT)
    assert harm.places.spoiled == 1
    assert harm.broken() == ()
    assert says(harm.worse(), "lose quality")
    assert says(harm.worse(), "no fault went")


def test_sizes_given_by_element_are_what_lengths_are_judged_by():
    mesh = graded(ratio=1.3)
    even = compare(mesh, mesh, UNIT)
    local = compare(mesh, mesh, UNIT, local_sizes(mesh, mesh))
    assert local.before.failed_by_size <= even.before.failed_by_size
    assert median_size(sheet(3, 3)) == 1.0


@pytest.mark.parametrize("kind", [*FLAT_KINDS, *CURVED_KINDS])
def test_report_is_what_json_can_write(kind):
    import json

    mesh = make(kind, 4)
    other = shuffled(mesh, np.random.default_rng(1))
    text = json.dumps(compare(mesh, other, UNIT).to_json())
    assert json.loads(text)["changed_elements"] == 0


def test_an_empty_mesh_is_measured_too():
    empty = ShellMesh.build(np.zeros((0, 3)), np.zeros((0, 4)))
    assert compare(empty, empty, UNIT).worse() == ()
    with pytest.raises(ValueError, match="no size"):
        median_size(empty)


def test_all_that_goes_is_told():
    mesh = sheet(3, 3)
    empty = ShellMesh.build(np.zeros((0, 3)), np.zeros((0, 4)))
    assert says(verify(mesh, empty, UNIT), "free border")
    assert says(verify(mesh, empty, UNIT), "area")


def test_inactive_criteria_are_no_harm():
    off = [replace(c, active=False) for c in PAPER.criteria]
    nothing = PAPER.having(*off, name="none").at(1.0)
    mesh = sheet(6, 6)
    other = moved(mesh, node_at(mesh, 3, 3, 0), (0.7, 0.6, 0))
    assert not says(compare(mesh, other, nothing).worse(), "fail by")
