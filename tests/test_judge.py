"""The judge of small edits: what it allows, and each thing that it forbids."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import STANDARD
from meshops.edit import apply
from meshops.fitness import Fitness
from meshops.mesh import ShellMesh
from meshops.operations.candidates import Candidates
from meshops.operations.judge import judge
from meshops.operations.split_quad import SplitQuad
from meshops.operations.swap_edge import SwapEdge
from meshops.quality_sums import ELEMENTS
from meshops.workpiece import Setting, Workpiece
from tests.meshes import (
    PLANE_KINDS,
    barriers,
    cylinder,
    folded,
    in_two_regions,
    joined,
    meshes,
    needle,
    sheet,
    with_,
)
from tests.wholeness import (
    assert_nothing_locked_has_changed,
    assert_sound,
    assert_zones_are_whole,
)


def workpiece(mesh, kind="quality"):
    return Workpiece(mesh, Setting(STANDARD.at(1.0), Fitness(kind, len(mesh.elements))))


def candidate(removed=(), added=(), points=(), moved=(), moved_to=()):
    """One candidate; a tria of `added` has three nodes."""
    added = [[*element, -1][:4] for element in added]
    return Candidates.padded(
        np.array([removed], np.int32).reshape(1, -1),
        np.array([added], np.int32).reshape(1, -1, 4),
        np.array([points], float).reshape(1, -1, 3),
        np.array([moved], np.int32).reshape(1, -1),
        np.array([moved_to], float).reshape(1, -1, 3),
    )


def is_allowed(mesh, **edit):
    return bool(np.isfinite(judge(workpiece(mesh), candidate(**edit))).all())


def node(mesh, *place):
    (row,) = np.nonzero((mesh.points[:, : len(place)] == place).all(axis=1))[0]
    return int(row)


def row_of(mesh, *middle):
    """Row of the element with a middle."""
    centres = [mesh.points[nodes[nodes >= 0]].mean(axis=0) for nodes in mesh.elements]
    return int(np.argmin(np.linalg.norm(np.array(centres)[:, : len(middle)] - middle, axis=1)))


def square(mesh, x, y):
    """Row of the unit quad whose lower left corner is (x, y), and its corners from there."""
    return row_of(mesh, x + 0.5, y + 0.5), [
        node(mesh, x + u, y + v) for u, v in ((0, 0), (1, 0), (1, 1), (0, 1))
    ]


# --- what is allowed ----------------------------------------------------------------------------


def split(mesh, x, y):
    row, (a, b, c, d) = square(mesh, x, y)
    return {"removed": [row], "added": [(a, b, c), (a, c, d)]}


def moved(mesh, where, to):
    return {"moved": [node(mesh, *where)], "moved_to": [to]}


def star(mesh):
    """The quad in the middle of a sheet(3, 3) as four trias around a new node."""
    row, (a, b, c, d) = square(mesh, 1, 1)
    n = len(mesh.points)
    added = [(a, b, n), (b, c, n), (c, d, n), (d, a, n)]
    return {"removed": [row], "added": added, "points": [(1.5, 1.5, 0.0)]}


def without(mesh, x, y):
    """The four quads around an inner node become two, upright, and the node vanishes."""
    corner = {(u, v): node(mesh, x + u, y + v) for u in (-1, 0, 1) for v in (-1, 0, 1) if u or v}
    rows = [row_of(mesh, x + u, y + v) for u in (-0.5, 0.5) for v in (-0.5, 0.5)]
    ring = [corner[k] for k in ((-1, -1), (0, -1), (1, -1), (1, 0), (1, 1), (0, 1), (-1, 1))]
    a, b, c, d, e, f, g = ring
    h = corner[-1, 0]
    return {"removed": rows, "added": [(a, b, h), (b, c, d), (d, e, f), (f, g, h), (b, d, f, h)]}


@pytest.mark.parametrize(
    "edit",
    [
        lambda mesh: split(mesh, 0, 0),
        lambda mesh: moved(mesh, (1, 1), (1.3, 1.2, 0)),
        star,
        lambda mesh: without(mesh, 1, 1),
    ],
)
def test_a_sound_edit_has_the_tally_of_the_mesh_that_it_makes(edit):
    mesh = sheet(3, 3)
    piece, one = workpiece(mesh), candidate(**edit(mesh))
    after = apply(mesh, one.edit(0, mesh.region))
    np.testing.assert_allclose(judge(piece, one)[0], workpiece(after).tally, atol=1e-9)
    assert_zones_are_whole(mesh, after, area=1e-9)


def test_candidates_are_judged_each_on_its_own():
    mesh = sheet(3, 3)
    every = SplitQuad().candidates(workpiece(mesh))
    together = judge(workpiece(mesh), every)
    for k in range(len(every)):
        alone = judge(workpiece(mesh), every.take(np.array([k], np.int32)))
        np.testing.assert_array_equal(together[k], alone[0])


def test_no_candidates_have_no_tallies():
    piece = workpiece(sheet(2, 2))
    none = SplitQuad().candidates(piece).take(np.zeros(0, np.int32))
    assert judge(piece, none).shape == (0, len(piece.tally))


# --- what is forbidden --------------------------------------------------------------------------


def test_nothing_is_no_edit():
    assert not is_allowed(sheet(3, 3))
    row, nodes = square(sheet(3, 3), 1, 1)
    assert not is_allowed(sheet(3, 3), added=[nodes])
    assert not is_allowed(sheet(3, 3), removed=[row])


def test_locked_elements_stay():
    mesh = sheet(3, 3)
    locked = with_(mesh, locked_elements=np.arange(9) == square(mesh, 0, 0)[0])
    assert is_allowed(mesh, **split(mesh, 0, 0))
    assert not is_allowed(locked, **split(mesh, 0, 0))
    assert is_allowed(locked, **split(mesh, 1, 1))


def test_nodes_that_are_locked_or_on_a_barrier_neither_move_nor_vanish():
    mesh = sheet(4, 4)
    move, gone = moved(mesh, (2, 2), (2.1, 2, 0)), without(mesh, 2, 2)
    middle = np.arange(25) == node(mesh, 2, 2)
    assert is_allowed(mesh, **move)
    assert is_allowed(mesh, **gone)
    for barred in (with_(mesh, locked_nodes=middle), in_two_regions(mesh, 2)):
        assert not is_allowed(barred, **move)
        assert not is_allowed(barred, **gone)
    hung = joined(mesh, needle(2.0, 2.0))
    assert not is_allowed(hung, **moved(hung, (2, 2, 0), (2.1, 2, 0)))
    assert not is_allowed(mesh, **moved(mesh, (0, 1), (0, 1.1, 0)))
    assert not is_allowed(mesh, **moved(mesh, (0, 0), (0.1, 0.1, 0)))


def two_by_one(mesh, x, y):
    """Two quads side by side become four trias, with both diagonals of the pair."""
    one, (a, b, c, d) = square(mesh, x, y)
    two, (_, e, f, _) = square(mesh, x + 1, y)
    return {"removed": [one, two], "added": [(a, b, d), (b, e, d), (e, c, d), (e, f, c)]}


def test_no_barrier_runs_inside():
    mesh = sheet(4, 4)
    edit = two_by_one(mesh, 1, 1)
    assert is_allowed(mesh, **edit)
    assert not is_allowed(in_two_regions(mesh, 2), **edit)
    assert not is_allowed(folded(mesh, 2), **edit)


def test_no_barrier_runs_inside_even_where_it_ends():
    """Four features meet at a low peak; the elements around it are one zone all the same."""
    mesh = sheet(4, 4)
    points = mesh.points.copy()
    points[node(mesh, 2, 2), 2] = 0.15
    peak = with_(mesh, points=points)
    edit = candidate(**two_by_one(mesh, 1, 1))
    for angle, allowed in ((8.0, False), (30.0, True)):
        setting = Setting(STANDARD.at(1.0), Fitness("quality", 16), feature_angle=angle)
        piece = Workpiece(peak, setting)
        assert np.unique(piece.topology.zones).tolist() == [0]
        assert np.isfinite(judge(piece, edit)).all() == allowed


def test_elements_of_two_zones_are_not_exchanged_at_once():
    mesh = in_two_regions(sheet(4, 1), 2)
    one, two = split(mesh, 0, 0), split(mesh, 3, 0)
    assert is_allowed(mesh, **one)
    both = {key: [*one[key], *two[key]] for key in one}
    assert is_allowed(sheet(4, 1), **both)
    assert not is_allowed(mesh, **both)


def test_what_comes_has_the_border_of_what_goes():
    mesh = sheet(3, 3)
    edit = split(mesh, 1, 1)
    first, second = edit["added"]
    assert not is_allowed(mesh, removed=edit["removed"], added=[first])
    assert not is_allowed(mesh, removed=edit["removed"], added=[first, second[::-1]])
    assert not is_allowed(mesh, removed=edit["removed"], added=[first, second, second])
    other, _ = square(mesh, 0, 0)
    assert not is_allowed(mesh, removed=[*edit["removed"], other], added=edit["added"])
    assert not is_allowed(mesh, removed=edit["removed"] * 2, added=edit["added"])


def test_nodes_are_those_of_what_goes_or_new():
    mesh = sheet(3, 3)
    edit = star(mesh)
    assert is_allowed(mesh, **edit)
    assert not is_allowed(mesh, **{**edit, "points": []})
    far, n = node(mesh, 3, 3), len(mesh.points)
    elsewhere = [tuple(far if k == n else k for k in element) for element in edit["added"]]
    assert not is_allowed(mesh, removed=edit["removed"], added=elsewhere)


def test_a_node_vanishes_only_with_all_its_elements():
    """Three of the four quads around a node are exchanged for elements that do not have it."""
    mesh = sheet(2, 2)
    a, b, c, d = (node(mesh, *at) for at in ((0, 0), (1, 0), (2, 0), (2, 1)))
    h, g, m = node(mesh, 0, 1), node(mesh, 0, 2), node(mesh, 1, 1)
    f = node(mesh, 1, 2)
    rows = [row_of(mesh, *at) for at in ((0.5, 0.5), (1.5, 0.5), (0.5, 1.5))]
    assert not is_allowed(mesh, removed=rows, added=[(a, b, h), (b, c, d), (f, g, h), (b, d, f, h)])
    kept = [(a, b, h), (b, c, d), (f, g, h), (b, d, m), (b, m, h), (h, m, f)]
    assert is_allowed(mesh, removed=rows, added=kept)


def test_an_edge_that_stays_elsewhere_is_not_made_again():
    """A tube of four quads, split along the edge that a fin outside already has."""
    flat = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    fin = [(0.2, 0.2, 1.0)]
    mesh = ShellMesh.build(flat + fin, [(0, 1, 2, 3)])
    finned = ShellMesh.build(flat + fin, [(0, 1, 2, 3), (0, 2, 4, -1)])
    edit = {"removed": [0], "added": [(0, 1, 2), (0, 2, 3)]}
    assert is_allowed(mesh, **edit)
    assert not is_allowed(finned, **edit)


def test_no_element_comes_twice():
    """Three sides of a flat tetrahedron may not become the fourth, seen from the other side."""
    points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.3, 0.3, 0.05)]
    sides = [(0, 1, 3, -1), (1, 2, 3, -1), (2, 0, 3, -1)]
    edit = {"removed": [0, 1, 2], "added": [(0, 1, 2)]}
    assert is_allowed(ShellMesh.build(points, sides), **edit)
    assert not is_allowed(ShellMesh.build(points, [*sides, (2, 1, 0, -1)]), **edit)


def test_the_surface_is_not_pinched():
    """On two turns of a ramp, one just above the other, two quads may not get the same middle."""
    angle = np.repeat(np.arange(25) * np.pi / 6, 2)
    radius = np.tile([2.0, 3.0], 25)
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), angle / 80])
    quads = np.array([(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(24)])
    ramp = ShellMesh.build(points, quads)
    low, high = points[quads[3]].mean(axis=0), points[quads[15]].mean(axis=0)

    def around(row, middle):
        return [(*pair, middle) for pair in zip(quads[row], np.roll(quads[row], -1), strict=True)]

    two = {"removed": [3, 15], "added": around(3, 50) + around(15, 51), "points": [low, high]}
    one = {"removed": [3, 15], "added": around(3, 50) + around(15, 50)}
    assert is_allowed(ramp, **two)
    assert not is_allowed(ramp, **one, points=[(low + high) / 2])


def test_elements_that_come_are_sound():
    mesh = sheet(3, 3)
    assert not is_allowed(mesh, **{**star(mesh), "points": [(1.5, 1.02, 0.0)]})  # flat
    assert not is_allowed(mesh, **{**star(mesh), "points": [(1.5, 0.8, 0.0)]})  # turned over
    assert is_allowed(mesh, **{**star(mesh), "points": [(1.5, 1.2, 0.0)]})
    assert not is_allowed(mesh, **{**star(mesh), "points": [(1.5, np.nan, 0.0)]})


def test_elements_whose_nodes_move_stay_sound():
    mesh = sheet(3, 3)
    assert is_allowed(mesh, **moved(mesh, (1, 1), (1.4, 1.4, 0)))
    assert not is_allowed(mesh, **moved(mesh, (1, 1), (2.2, 2.2, 0)))


def test_a_bad_element_may_stay_bad_but_not_get_worse():
    mesh = sheet(3, 3)
    points = mesh.points.copy()
    points[node(mesh, 1, 1), :2] = 1.52  # the quad up right is turned in there
    bent = with_(mesh, points=points)
    assert not is_allowed(bent, **moved(bent, (1.52, 1.52), (1.54, 1.54, 0)))
    assert is_allowed(bent, **moved(bent, (1.52, 1.52), (1.51, 1.51, 0)))
    assert is_allowed(bent, **moved(bent, (1.52, 1.52), (1.0, 1.0, 0)))


def test_a_node_moves_once_and_only_if_it_stays():
    mesh = sheet(3, 3)
    middle = node(mesh, 1, 1)
    here, there = (1.1, 1.0, 0.0), (1.0, 1.1, 0.0)
    assert is_allowed(mesh, moved=[middle], moved_to=[here])
    assert not is_allowed(mesh, moved=[middle, middle], moved_to=[here, there])
    assert is_allowed(mesh, **without(mesh, 1, 1))
    assert not is_allowed(mesh, **without(mesh, 1, 1), moved=[middle], moved_to=[here])


def test_places_stay_on_the_plane():
    mesh = sheet(3, 3)
    assert is_allowed(mesh, **moved(mesh, (1, 1), (1.1, 1, 1e-12)))
    assert not is_allowed(mesh, **moved(mesh, (1, 1), (1.1, 1, 1e-6)))
    assert not is_allowed(mesh, **{**star(mesh), "points": [(1.5, 1.5, 1e-6)]})


def test_places_stay_on_a_curved_surface():
    flat = sheet(4, 4)
    mesh = cylinder(flat)
    middle = node(flat, 2, 2)
    outward = mesh.points[middle] * (1, 0, 1) / np.linalg.norm(mesh.points[middle] * (1, 0, 1))
    for height, allowed in ((0.0, True), (0.05, True), (0.15, False)):
        place = mesh.points[middle] + height * outward
        assert is_allowed(mesh, moved=[middle], moved_to=[place]) == allowed


@pytest.mark.parametrize(("angle", "allowed"), [(0, True), (10, True), (28, False)])
def test_elements_do_not_cut_corners_of_a_curved_surface(angle, allowed):
    """An edge along a ridge that is no feature is turned across it: the middle leaves the roof."""
    half = np.radians(angle / 2)
    points = sheet(2, 3).points.copy()
    points[[4, 7], 1] += (-0.3, 0.3)  # the hexagon has no flat corner
    x, y = points[:, 0] - 1, 0.6 * points[:, 1]
    roof = np.column_stack([np.cos(half) * x, y, -np.sin(half) * np.abs(x)])
    mesh = with_(sheet(2, 3), points=roof)
    turned = [(3, 4, 5, 8), (8, 7, 6, 3)]
    assert is_allowed(mesh, removed=[2, 3], added=turned) == allowed


# --- many candidates, most of them nonsense -----------------------------------------------------


def mangled(piece, rng):
    """Swaps and splits with some of their numbers and places changed."""
    mesh = piece.mesh
    found = rng.choice([SwapEdge(pool=30), SplitQuad(pool=30)]).candidates(piece)
    added, to = found.added.copy(), found.moved_to.copy()
    removed, which = found.removed.copy(), found.moved.copy()
    if len(added):
        for row in rng.integers(0, len(added), len(added) // 3):
            match rng.integers(4):
                case 0:
                    added[row] = np.roll(added[row], 1)
                case 1:
                    added[row, rng.integers(3)] = rng.integers(len(mesh.points))
                case 2:
                    added[row, :3] = added[row, [2, 1, 0]]
                case 3:
                    added[row] = added[rng.integers(len(added))]
    if len(removed):
        for row in rng.integers(0, len(removed), len(removed) // 6):
            removed[row] = rng.integers(len(mesh.elements))
    if len(to):
        to[:, :2] += rng.normal(0, 0.3, (len(to), 2)) * (rng.random(len(to)) < 0.3)[:, None]
        which[rng.random(len(which)) < 0.1] = rng.integers(len(mesh.points))
    return replace(found, added=added, removed=removed, moved=which, moved_to=to)


@settings(max_examples=30, deadline=None)
@given(meshes(PLANE_KINDS), st.integers(0, 10**6))
def test_whatever_is_allowed_leaves_the_mesh_whole(mesh, seed):
    piece, rng = workpiece(mesh), np.random.default_rng(seed)
    found = mangled(piece, rng)
    tallies = judge(piece, found)
    for k in np.nonzero(np.isfinite(tallies[:, ELEMENTS]))[0][:12]:
        after = apply(mesh, found.edit(int(k), mesh.region))
        assert_sound(after)
        assert_nothing_locked_has_changed(mesh, after)
        assert barriers(after) == barriers(mesh)
        assert_zones_are_whole(mesh, after, area=1e-9)
        np.testing.assert_allclose(workpiece(after).tally, tallies[k], rtol=1e-9, atol=1e-8)
