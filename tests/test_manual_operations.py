"""The operations that the paper's software offers by hand."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import STANDARD
from meshops.edit import apply
from meshops.fitness import Fitness
from meshops.holes import holes
from meshops.mesh import NEW, ShellMesh
from meshops.operations.create_nodes import CreateNodes
from meshops.operations.delete_entity import COLLAPSED, DOUBLED, ISLAND, DeleteEntity
from meshops.operations.edit_element import EditElement
from meshops.operations.quick_edit import THICKNESSES, QuickEdit
from meshops.operations.renumber import renumber
from meshops.operations.templates import CENTRE, dissections, stars
from meshops.quality_sums import ELEMENTS, TRIAS
from meshops.surface import PatchSurface
from meshops.workpiece import Setting, Workpiece
from tests.meshes import (
    CURVED_KINDS,
    FLAT_KINDS,
    barriers,
    centre,
    corners,
    crossable_edges,
    cylinder,
    distances_to_trias,
    doubles,
    joined,
    make,
    meshes,
    needle,
    place,
    shaped,
    sheet,
    shuffled,
    sides,
    tidy,
    trias_of,
    unsound,
    users,
    with_,
    zones,
)

bounded = settings(max_examples=30, deadline=None)
seeds = st.integers(0, 10**6)


def workpiece(mesh, **setting):
    return Workpiece(mesh, Setting(STANDARD.at(1.0), Fitness("quality", 100), **setting))


def done(operation, mesh, *parameters):
    edit = operation.apply(workpiece(mesh), np.array(parameters, np.int32))
    return mesh if edit.is_empty else apply(mesh, edit)


def tried(operation, piece, seed, count=3):
    """(mesh after, predicted tally) of random genomes that lead to a valid mesh."""
    rng = np.random.default_rng(seed)
    space = operation.search_space(piece, rng)
    if space is None:
        return []
    genomes = space.draw(rng, 12)
    tallies = space.evaluate(genomes)
    valid = np.nonzero(np.isfinite(tallies).all(axis=1))[0][:count]
    parameters = [space.parameters(genomes[row]) for row in valid]
    return [
        (apply(piece.mesh, operation.apply(piece, chosen)), tallies[row])
        for row, chosen in zip(valid, parameters, strict=True)
        if len(chosen)
    ]


def assert_whole(before, after, *, area):
    """Sound, no hole, no lap, every barrier, lock and id as before."""
    assert unsound(after) == []
    assert doubles(after) == []
    assert barriers(after) == barriers(before)
    old, new = ({zone.outline: zone for zone in zones(mesh)} for mesh in (before, after))
    assert old.keys() == new.keys()
    for name, zone in old.items():
        assert (new[name].region, new[name].euler) == (zone.region, zone.euler)
        np.testing.assert_allclose(new[name].area_vector, zone.area_vector, atol=1e-9)
        assert new[name].area == pytest.approx(zone.area, rel=area)
    for mesh in (before, after):
        assert len(set(mesh.node_ids[mesh.node_ids != NEW])) == np.sum(mesh.node_ids != NEW)
    locked = [Counter(map(tuple, mesh.points[mesh.locked_nodes])) for mesh in (before, after)]
    assert locked[0] == locked[1]


def without(mesh, x0, y0, x1, y1):
    """The mesh without the elements whose centres are in a box."""
    kept = [
        row
        for row in range(len(mesh.elements))
        if not (x0 < centre(mesh, row)[0] < x1 and y0 < centre(mesh, row)[1] < y1)
    ]
    return tidy(with_(mesh, **{name: getattr(mesh, name)[kept] for name in OF_ELEMENTS}))


OF_ELEMENTS = ("elements", "region", "locked_elements", "element_ids")

PIERCED = without(sheet(12, 12, seed=1, trias=0.3), 5, 5, 7, 7)

# --- QuickEdit ----------------------------------------------------------------------------------


def rings_around_hole(mesh, nodes):
    """Whole rings of quads around the hole with these places, from the hole on: their places."""
    edge_users = users(mesh)
    rows = {place(mesh, node): node for node in range(len(mesh.points))}
    ring = [rows[node] for node in nodes]
    seen, found = set(), []
    while True:
        ahead = ring[1:] + ring[:1]
        quads = []
        for a, b in zip(ring, ahead, strict=True):
            quads += [row for row, _ in edge_users[min(a, b), max(a, b)] if row not in seen]
        if len(quads) != len(ring) or mesh.is_tria[quads].any():
            return found
        following = []
        for row, a in zip(quads, ring, strict=True):
            nodes_of = corners(mesh.elements[row])
            following.append(nodes_of[nodes_of.index(a) - 1])
        if any(
            {a, b, c, d} != set(corners(mesh.elements[row]))
            for row, a, b, c, d in zip(
                quads, ring, ahead, following, following[1:] + following[:1], strict=True
            )
        ):
            return found
        seen |= set(quads)
        ring = following
        found.append([place(mesh, node) for node in ring])


def hole_places(mesh):
    (hole,) = holes(workpiece(mesh))
    return [place(mesh, node) for node in hole.nodes]


@pytest.mark.parametrize("rings", [1, 2, 3])
def test_quick_edit_puts_rings_of_quads_around_a_hole(rings):
    after = done(QuickEdit(), PIERCED, (1, rings, 75, 0))
    assert_whole(PIERCED, after, area=1e-9)
    around = rings_around_hole(after, hole_places(PIERCED))
    assert len(around) >= rings
    for number, ring in enumerate(around[:rings], start=1):
        # a square set off by so much on every side
        off = np.abs(np.array(ring)[:, :2] - 6.0).max(axis=1) - 1.0
        np.testing.assert_allclose(off, 0.75 * number, atol=1e-12)


def test_quick_edit_takes_its_thickness_from_the_element_size_of_the_run():
    piece = workpiece(PIERCED, element_size=1.5)
    after = apply(PIERCED, QuickEdit().apply(piece, np.array([(1, 1, 50, 0)], np.int32)))
    ring = np.array(rings_around_hole(after, hole_places(PIERCED))[0])
    np.testing.assert_allclose(np.abs(ring[:, :2] - 6.0).max(axis=1), 1.75)


def test_quick_edit_stays_on_a_curved_surface():
    bent = cylinder(PIERCED)
    after = done(QuickEdit(), bent, (1, 2, 75, 0))
    assert after is not bent
    assert_whole(bent, after, area=0.01)
    assert len(rings_around_hole(after, hole_places(bent))) >= 2
    surface = trias_of(bent)
    assert max(distances_to_trias(point, surface).min() for point in after.points) < 1e-9


def test_quick_edit_stays_on_the_reference_surface():
    fine = shaped(sheet(60, 60), lambda x, y: (x / 5, y / 5, 0 * x))
    piece = workpiece(cylinder(PIERCED))
    reference = PatchSurface.of(*(getattr(cylinder(fine), n) for n in ("points", "elements")))
    piece = Workpiece(piece.mesh, piece.setting, reference)
    after = apply(piece.mesh, QuickEdit().apply(piece, np.array([(1, 1, 100, 0)], np.int32)))
    added = after.points[after.node_ids == NEW]
    assert len(added)
    # the facets of the fine surface are this near to the cylinder
    np.testing.assert_allclose(np.hypot(added[:, 0], added[:, 2]), 8.0, atol=2e-3)


def test_the_outer_border_is_no_hole():
    assert holes(workpiece(sheet(4, 4))) == []
    assert QuickEdit().search_space(workpiece(sheet(4, 4)), np.random.default_rng(1)) is None


@pytest.mark.parametrize(("bad_at", "sizes"), [((6, 4), [8, 4]), ((11, 3), [4, 8])])
def test_holes_next_to_a_bad_element_come_first(bad_at, sizes):
    mesh = without(without(sheet(20, 8), 3, 3, 5, 5), 12, 3, 13, 4)
    points = mesh.points.copy()
    points[(points[:, :2] == bad_at).all(axis=1), :2] += 0.8
    assert [len(hole.nodes) for hole in holes(workpiece(with_(mesh, points=points)))] == sizes


def test_rings_that_do_not_fit_are_not_made():
    narrow = without(sheet(8, 5), 3, 2, 5, 3)
    piece = workpiece(narrow)
    parameters = np.array([(1, 3, 100, 0)], np.int32)
    assert QuickEdit().apply(piece, parameters).is_empty
    space = QuickEdit().search_space(piece, np.random.default_rng(1))
    genome = np.array([0, 2, THICKNESSES.index(100), 0])
    assert np.isnan(space.tally(genome)).all()
    assert len(space.parameters(genome)) == 0


def test_quick_edit_leaves_out_holes_that_are_not_there_and_refuses_nonsense():
    assert done(QuickEdit(), PIERCED, (2, 1, 100, 0)) is PIERCED
    assert done(QuickEdit(), PIERCED, (0, 1, 100, 0)) is PIERCED
    for wrong in ((1, 0, 100, 0), (1, 1, 0, 0), (1, 1, 100, 99)):
        with pytest.raises(ValueError, match="a hole has no"):
            done(QuickEdit(), PIERCED, wrong)


def test_two_holes_far_apart_are_surrounded_at_once():
    mesh = without(sheet(24, 12), 4, 5, 6, 7)
    mesh = joined(mesh, shaped(PIERCED, lambda x, y: (x + 24, y, 0 * x)))
    after = done(QuickEdit(), mesh, (1, 1, 75, 0), (2, 1, 75, 0))
    assert_whole(mesh, after, area=1e-9)
    for hole in holes(workpiece(mesh)):
        assert rings_around_hole(after, [place(mesh, node) for node in hole.nodes])


# --- CreateNodes and EditElement ----------------------------------------------------------------


@bounded
@given(meshes(FLAT_KINDS), st.sampled_from([CreateNodes(), EditElement(), QuickEdit()]), seeds)
def test_flat_parts_stay_whole(mesh, operation, seed):
    piece = workpiece(mesh)
    for after, tally in tried(operation, piece, seed):
        assert_whole(mesh, after, area=1e-9)
        np.testing.assert_allclose(workpiece(after).tally, tally, rtol=1e-9, atol=1e-8)


@bounded
@given(meshes(CURVED_KINDS), st.sampled_from([CreateNodes(), EditElement()]), seeds)
def test_curved_parts_stay_whole(mesh, operation, seed):
    surface = trias_of(mesh)
    for after, tally in tried(operation, workpiece(mesh), seed):
        assert_whole(mesh, after, area=0.05)
        np.testing.assert_allclose(workpiece(after).tally, tally, rtol=1e-9, atol=1e-8)
        for point in after.points[after.node_ids == NEW]:
            assert distances_to_trias(point, surface).min() < 1e-9


@settings(max_examples=8, deadline=None)
@given(meshes(FLAT_KINDS), st.sampled_from([CreateNodes(), EditElement(), QuickEdit()]), seeds)
def test_the_same_input_gives_the_same_mesh(mesh, operation, seed):
    once, again = (tried(operation, workpiece(mesh), seed) for _ in range(2))
    assert [after.digest for after, _ in once] == [after.digest for after, _ in again]


def test_create_nodes_adds_a_node_in_each_place_and_edit_element_none():
    mesh = make("plain", 4)
    created = tried(CreateNodes(picks=1), workpiece(mesh), 1)
    assert created
    assert all(len(after.points) == len(mesh.points) + 1 for after, _ in created)
    edited = tried(EditElement(picks=1), workpiece(mesh), 1)
    assert edited
    assert all(len(after.points) <= len(mesh.points) for after, _ in edited)


def test_a_node_on_the_edge_of_two_quads_makes_three():
    hexagon = shaped(sheet(2, 1), lambda x, y: (x, y + np.where(x == 1, y - 0.5, 0), 0 * x))
    results = [
        done(CreateNodes(), hexagon, (rank, variant))
        for rank in range(1, 4)
        for variant in range(CreateNodes.variants)
    ]
    (three, _) = [after for after in results if tuple(after.is_tria) == (False, False, False)]
    assert_whole(hexagon, three, area=1e-9)


def test_edit_element_makes_two_quads_of_a_quad_between_two_trias():
    # a row of two squares cut as tria, parallelogram, tria
    points = [(x, y, 0) for y in (0, 1) for x in (0, 1, 2)]
    mesh = ShellMesh.build(points, [(0, 1, 3, -1), (1, 2, 4, 3), (2, 5, 4, -1)])
    best = min(
        (
            done(EditElement(), mesh, (rank, variant))
            for rank in range(1, 4)
            for variant in range(EditElement.variants)
        ),
        key=lambda after: workpiece(after).tally[TRIAS] + 100 * (after is mesh),
    )
    assert len(best.elements) == 2
    assert not best.is_tria.any()


def test_edit_element_never_makes_what_is_there():
    mesh = make("plain", 7)
    before = {frozenset(corners(element)) for element in mesh.elements}
    for after, _ in tried(EditElement(picks=1), workpiece(mesh), 3, count=12):
        assert {frozenset(corners(element)) for element in after.elements} != before


def test_a_locked_element_and_what_lies_across_a_barrier_stay():
    mesh = make("locks", 3)
    for operation in (CreateNodes(picks=6), EditElement(picks=6)):
        for after, _ in tried(operation, workpiece(mesh), 2, count=12):
            assert_whole(mesh, after, area=1e-9)
            kept = [
                sorted(map(tuple, m.points[corners(e)]))
                for m in (mesh, after)
                for e in m.elements[m.locked_elements]
            ]
            half = len(kept) // 2
            assert kept[:half] == kept[half:]


def area_of(polygon):
    x, y = np.transpose(polygon)
    return 0.5 * np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))


@pytest.mark.parametrize(("size", "count"), [(3, 1), (4, 1), (5, 5), (6, 3), (7, 28), (8, 12)])
def test_all_ways_to_cut_a_polygon(size, count):
    """The numbers are those of Kirkman and Cayley: (n + k - 1)! / n! over the parts' factorials."""
    ways = dissections(size)
    assert len({frozenset(map(frozenset, way)) for way in ways}) == len(ways) == count
    angle = 2 * np.pi * np.arange(size) / size
    polygon = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    for way in ways:
        parts = [area_of(polygon[list(nodes)]) for nodes in way]
        assert min(parts) > 0
        assert sum(parts) == pytest.approx(area_of(polygon))
        assert sum(len(nodes) == 3 for nodes in way) == size % 2


@pytest.mark.parametrize(("size", "count"), [(3, 1), (4, 5), (5, 5), (6, 2)])
def test_all_ways_to_join_a_node_inside(size, count):
    ways = stars(size)
    assert len({frozenset(way) for way in ways}) == len(ways) == count
    for way in ways:
        directed = Counter(side for nodes in way for side in sides(nodes_of(nodes)))
        outer = {(a, b) for a, b in directed if (b, a) not in directed}
        assert outer == {(k, (k + 1) % size) for k in range(size)}
        assert set(directed.values()) == {1}


def nodes_of(nodes):
    return [100 if node == CENTRE else node for node in nodes]


# --- DeleteEntity -------------------------------------------------------------------------------


def more(mesh, *elements, **changes):
    """The mesh with more elements on its nodes."""
    added = np.array(elements, np.int32)
    return with_(
        mesh,
        elements=np.concatenate([mesh.elements, added]),
        region=np.concatenate([mesh.region, np.zeros(len(added))]),
        locked_elements=np.zeros(len(mesh.elements) + len(added)),
        element_ids=np.arange(len(mesh.elements) + len(added)) + 1,
        **changes,
    )


def test_doubled_elements_go_and_one_of_each_stays():
    mesh = sheet(3, 3)
    quad = mesh.elements[4]
    rich = more(mesh, quad[[2, 3, 0, 1]], (*quad[:3], -1), quad[::-1])
    found = DeleteEntity().entities(workpiece(rich))
    assert [rows.tolist() for rows in found[DOUBLED]] == [[9], [10], [11]]
    after = done(DeleteEntity(), rich, (DOUBLED, 1), (DOUBLED, 2), (DOUBLED, 3))
    assert np.array_equal(after.elements, mesh.elements)


def test_elements_of_two_regions_on_the_same_nodes_are_meant():
    mesh = sheet(3, 3)
    rich = more(mesh, mesh.elements[4])
    rich = with_(rich, region=[0] * 9 + [5])
    assert DeleteEntity().entities(workpiece(rich))[DOUBLED] == []


def test_a_locked_element_is_not_the_one_of_two_that_goes():
    mesh = sheet(3, 3)
    rich = with_(more(mesh, mesh.elements[4]), locked_elements=[0] * 9 + [1])
    found = DeleteEntity().entities(workpiece(rich))
    assert [rows.tolist() for rows in found[DOUBLED]] == [[4]]


def test_collapsed_elements_go_without_a_hole():
    mesh = sheet(3, 3)
    a, b, c = mesh.elements[4, :3]
    rich = more(mesh, (a, b, b, -1), (a, b, c, b))
    found = DeleteEntity().entities(workpiece(rich))
    assert [rows.tolist() for rows in found[COLLAPSED]] == [[9], [10]]
    after = done(DeleteEntity(), rich, (COLLAPSED, 1), (COLLAPSED, 2))
    assert np.array_equal(after.elements, mesh.elements)


def test_a_quad_with_two_nodes_in_one_is_a_tria_and_stays():
    quad = ShellMesh.build([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2, 2)])
    found = DeleteEntity().entities(workpiece(quad))
    assert found[COLLAPSED] == found[DOUBLED] == []


def test_islands_go_by_hand_only_and_only_small_free_ones():
    far = shaped(sheet(2, 1), lambda x, y: (x + 20, y, 0 * x))
    farther = shaped(sheet(1, 1), lambda x, y: (x + 30, y, 0 * x))
    mesh = joined(sheet(4, 4), far, farther, needle(2.0, 2.0))
    found = DeleteEntity().entities(workpiece(mesh))
    assert [len(rows) for rows in found[ISLAND]] == [1, 2]
    assert DeleteEntity().search_space(workpiece(mesh), np.random.default_rng(1)) is None
    after = done(DeleteEntity(), mesh, (ISLAND, 2), (ISLAND, 9))
    assert len(after.elements) == len(mesh.elements) - 2
    assert after.points[:, 0].max() > 29
    locked = with_(mesh, locked_nodes=mesh.points[:, 0] > 19)
    assert DeleteEntity().entities(workpiece(locked))[ISLAND] == []


def test_deleting_is_searched_and_predicted():
    mesh = sheet(3, 3)
    rich = more(mesh, mesh.elements[4], mesh.elements[5])
    piece = workpiece(rich)
    space = DeleteEntity().search_space(piece, np.random.default_rng(1))
    tally = space.tally(np.array([0, 1, 2, 2]))
    assert tally[ELEMENTS] == 9
    np.testing.assert_allclose(tally, workpiece(mesh).tally, atol=1e-9)
    assert np.isnan(space.tally(np.array([2, 2, 2, 2]))).all()


def test_an_unknown_kind_is_refused():
    with pytest.raises(ValueError, match="kind"):
        done(DeleteEntity(), sheet(2, 2), (4, 1))


# --- Renumber -----------------------------------------------------------------------------------


def by_id(mesh):
    """All that a mesh is, without the order of its rows."""
    nodes = {
        int(number): (place(mesh, row), bool(mesh.locked_nodes[row]))
        for row, number in enumerate(mesh.node_ids)
    }
    elements = {
        int(number): (
            [int(mesh.node_ids[node]) for node in corners(mesh.elements[row])],
            int(mesh.region[row]),
            bool(mesh.locked_elements[row]),
        )
        for row, number in enumerate(mesh.element_ids)
    }
    return nodes, elements


@bounded
@given(meshes(FLAT_KINDS + CURVED_KINDS))
def test_renumber_changes_nothing_but_the_order(mesh):
    assert by_id(renumber(mesh)) == by_id(mesh)


def test_renumber_puts_neighbours_near_each_other():
    rng = np.random.default_rng(3)
    columns, rows = 30, 6
    regular = sheet(columns, rows, jitter=0.2)
    order = rng.permutation(len(regular.points))
    mixed = with_(
        regular,
        points=regular.points[order],
        elements=np.argsort(order)[regular.elements],
        node_ids=order + 1,
    )
    mesh = renumber(shuffled(mixed, rng))
    span = np.ptp(mesh.elements, axis=1)
    assert span.max() <= 3 * (rows + 1)
    # neighbours have numbers near each other, so a range of numbers is one strip
    for (a, b), edge_users in users(mesh).items():
        if (a, b) in crossable_edges(mesh):
            (one, _), (two, _) = edge_users
            assert abs(one - two) <= 4 * rows
