"""Slide: what it mends that Smooth cannot, and what must not change."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from islands.procedure import Procedure, perform
from islands.transfer import transfer
from meshops.criteria import PAPER, STANDARD
from meshops.edit import apply
from meshops.fitness import Fitness
from meshops.operations import ALL_OPERATIONS
from meshops.operations.slide import Slide
from meshops.operations.smooth import RINGS
from meshops.patch import components, extract
from meshops.quality import failed_elements
from meshops.reference import Reference
from meshops.subdomain import Extent, Subdomain, subdomains
from meshops.topology import CORNER_ANGLE, topology
from meshops.workpiece import Setting, Workpiece
from tests.decks import bad_plate
from tests.jobs import faults, finish, job
from tests.measures import fans, sides, users
from tests.meshes import (
    CURVED_KINDS,
    FLAT_KINDS,
    annulus,
    barriers,
    joined,
    meshes,
    rib,
    shaped,
    sheet,
    unsound,
    with_,
)
from tests.wholeness import assert_nothing_locked_has_changed
from tracking.events import RoundReport

ALL_KINDS = FLAT_KINDS + CURVED_KINDS
TOLERANCE = 0.01
SLIDE = Slide()
PLACES = st.lists(
    st.tuples(st.integers(1, 12), st.sampled_from(RINGS), st.integers(0, 2)), min_size=1, max_size=2
).map(lambda rows: np.array(rows, np.int32))
bounded = settings(max_examples=60, deadline=None)


def setting(mesh, criteria=STANDARD, size=1.0):
    fitness = Fitness("quality", len(mesh.elements))
    return Setting(criteria.at(size), fitness, slides=True)


def with_rails(mesh, first, criteria=STANDARD, size=1.0):
    """The mesh as a workpiece whose borders are those of the first mesh."""
    rows = components(topology(first), np.ones(len(first.elements), bool))[0]
    near = Reference(first, 30.0)
    own = Workpiece(mesh, setting(mesh, criteria, size))
    rails = near.around(extract(topology(first), rows)).rails
    return replace(own, reference=replace(own.surface, rails=rails))


def borders(mesh):
    """Border edges as pairs of nodes."""
    return [edge for edge, uses in users(mesh).items() if len(uses) == 1]


def turn(mesh, one, node, two):
    u, v = mesh.points[node] - mesh.points[one], mesh.points[two] - mesh.points[node]
    cosine = u @ v / (np.linalg.norm(u) * np.linalg.norm(v))
    return np.degrees(np.arccos(np.clip(cosine, -1, 1)))


def distance_to_border(query, mesh):
    """To the nearest border edge."""
    best = np.inf
    for a, b in borders(mesh):
        p, way = mesh.points[a], mesh.points[b] - mesh.points[a]
        t = np.clip((query - p) @ way / max(way @ way, 1e-300), 0, 1)
        best = min(best, np.linalg.norm(query - (p + t * way)))
    return best


def narrow(columns=12, height=0.089 / 0.2 * 5):
    """Quads of 5 by 2.2, whose upper nodes are locked: each edge across is too short."""
    mesh = shaped(sheet(columns, 1), lambda x, y: (5.0 * x, height * y, 0 * x))
    return with_(mesh, locked_nodes=mesh.points[:, 1] > 0)


# --- what gets better ---------------------------------------------------------------------------


def test_a_narrow_strip_passes_once_its_edges_across_are_askew():
    mesh = narrow()
    work = with_rails(mesh, mesh, PAPER, 5.0)
    assert work.failing.all()
    after = apply(mesh, SLIDE.apply(work, np.array([(6, 40, 1)], np.int32)))
    scoring = work.setting.scoring
    # the two at the ends have an edge between a corner and a locked node
    assert np.count_nonzero(failed_elements(after, scoring)) == 2
    assert np.abs(after.points[:, 1:] - mesh.points[:, 1:]).max() <= TOLERANCE * 5


def test_a_run_leaves_a_strip_of_rectangles_that_fail_by_size_alone():
    mesh = narrow()
    done = finish(job(mesh, rounds=8))
    assert done.before.failed_by_size == len(mesh.elements)
    assert done.mesh.digest == mesh.digest


def test_a_run_that_slides_is_replayed_bit_for_bit():
    mesh = bad_plate()
    done = finish(job(mesh, rounds=8))
    assert any(s.code == SLIDE.code for r in done.procedure.rounds for p in r.places
               for s in p.steps)  # fmt: skip
    text = done.procedure.to_json(ALL_OPERATIONS)
    procedure = Procedure.from_json(text, ALL_OPERATIONS, "procedure.json")
    again = perform(mesh, procedure.rounds, ALL_OPERATIONS, procedure.setting(mesh))
    assert again.digest == done.mesh.digest


def test_without_sliding_all_borders_stay_as_they_are():
    mesh = narrow()
    done = finish(job(mesh, rounds=8, slide=False))
    assert barriers(done.mesh) == barriers(mesh)


# --- which nodes may slide ----------------------------------------------------------------------


@bounded
@given(meshes(ALL_KINDS))
def test_nodes_slide_that_lie_on_nothing_but_a_border_that_hardly_turns(mesh):
    found = topology(mesh)
    around = {}
    for a, b in borders(mesh):
        around.setdefault(a, []).append(b)
        around.setdefault(b, []).append(a)
    of_node = {}
    for node, elements, closed in fans(mesh):
        of_node.setdefault(node, []).append((elements, closed))
    for node in range(len(mesh.points)):
        ends = around.get(node, [])
        lone = len(ends) == 2 and len(of_node[node]) == 1 and not of_node[node][0][1]
        free = lone and not mesh.locked_nodes[node]
        free = free and not mesh.locked_elements[list(of_node[node][0][0])].any()
        assert (found.border_neighbours[node] >= 0).all() == free
        if free:
            before, after = found.border_neighbours[node].tolist()
            assert {before, after} == set(ends)
            around_it = [sides(mesh.elements[row]) for row in of_node[node][0][0]]
            assert any((before, node) in directed for directed in around_it)
            assert any((node, after) in directed for directed in around_it)
            bend = turn(mesh, ends[0], node, ends[1])
            if abs(bend - CORNER_ANGLE) > 1e-6:
                assert found.sliding_nodes[node] == (bend < CORNER_ANGLE)
        else:
            assert not found.sliding_nodes[node]


@bounded
@given(meshes(ALL_KINDS), st.sampled_from([Extent(1, 50), Extent(3, 60), Extent(99, 10_000)]))
def test_of_a_subdomain_slide_those_with_all_their_elements_in_it(mesh, extent):
    piece = Workpiece(mesh, setting(mesh))
    for subdomain in subdomains(piece, extent, 0):
        inside = set(subdomain.patch.rows.tolist())
        for row, node in enumerate(subdomain.patch.nodes[: subdomain.patch.border_nodes]):
            users_of = np.nonzero((mesh.elements == node).any(axis=1))[0].tolist()
            slides = bool(piece.topology.sliding_nodes[node]) and set(users_of) <= inside
            assert subdomain.mesh.locked_nodes[row] == (not slides)
            assert (
                not slides or Workpiece(subdomain.mesh, piece.setting).topology.sliding_nodes[row]
            )


# --- what must not change -----------------------------------------------------------------------


@bounded
@given(meshes(ALL_KINDS), st.lists(PLACES, min_size=1, max_size=4))
def test_borders_stay_in_their_line_and_all_else_stays(mesh, turns):
    after = mesh
    longest = max(np.linalg.norm(mesh.points[a] - mesh.points[b]) for a, b in borders(mesh))
    held = ~(topology(mesh).free_nodes | topology(mesh).sliding_nodes)
    for places in turns:
        work = with_rails(after, mesh)
        after = apply(after, SLIDE.apply(work, places))
    assert np.array_equal(after.elements, mesh.elements)
    assert np.array_equal(after.points[held], mesh.points[held])
    assert_nothing_locked_has_changed(mesh, after)
    uses = {edge: count for edge, count in barriers(mesh).items() if count > 1}
    assert uses == {edge: count for edge, count in barriers(after).items() if count > 1}
    assert set(unsound(after, 0.05)) <= set(unsound(mesh, 0.05))
    scoring = setting(mesh).scoring
    if not any(places[:, 2].any() for places in turns):
        failing = [np.count_nonzero(failed_elements(m, scoring)) for m in (mesh, after)]
        assert failing[1] <= failing[0]
    # an edge may grow as its nodes slide: of twice the longest one the tolerance is ample
    for a, b in borders(after):
        for part in (0.0, 0.25, 0.5, 0.75):
            query = after.points[a] + part * (after.points[b] - after.points[a])
            assert distance_to_border(query, mesh) <= TOLERANCE * 2 * longest


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 10**6), st.lists(PLACES, min_size=1, max_size=5))
def test_a_round_border_does_not_creep(seed, turns):
    mesh = annulus(24, 2, seed=seed, jitter=0.3)
    after = mesh
    for places in turns:
        after = apply(after, SLIDE.apply(with_rails(after, mesh), places))
    rings = np.linalg.norm(after.points, axis=1)
    was = np.linalg.norm(mesh.points, axis=1)
    for radius in (2.0, 4.0):
        edge = 2 * np.pi * radius / 24
        on = np.isclose(was, radius)
        assert np.abs(rings[on] - radius).max() <= TOLERANCE * 2 * edge


def test_a_seam_of_three_plates_does_not_move():
    skin = joined(shaped(sheet(6, 2, seed=1), lambda x, y: (x, 0.4 * (y - 2), 0 * x)),
                  shaped(sheet(6, 2, seed=2), lambda x, y: (x, 0.4 * y, 0 * x)))  # fmt: skip
    wall = rib(6, 1, at=0.0)
    mesh = joined(skin, with_(wall, points=wall.points * (1.0, 1.0, 0.4)))
    mesh = with_(mesh, points=5.0 * mesh.points)
    done = finish(job(mesh, rounds=6))
    assert faults(done.mesh) <= faults(mesh)
    seam = {edge: count for edge, count in barriers(mesh).items() if count > 2}
    assert seam
    assert {edge: count for edge, count in barriers(done.mesh).items() if count > 2} == seam


def test_nothing_slides_without_the_borders_of_a_first_mesh():
    mesh = narrow()
    work = Workpiece(mesh, setting(mesh, PAPER, 5.0))
    assert SLIDE.search_space(work, np.random.default_rng(0)) is None
    assert SLIDE.apply(work, np.array([(1, 4, 0)], np.int32)).is_empty


@pytest.mark.parametrize("slides", [True, False])
def test_whether_it_slides_is_known_to_a_subdomain(slides):
    mesh = shaped(narrow(), lambda x, y: (x + 3.5 * (abs(x - 30) < 1) * (y < 1), y, 0 * x))
    mesh = with_(mesh, locked_nodes=narrow().locked_nodes)
    piece = Workpiece(mesh, replace(setting(mesh, PAPER, 5.0), slides=slides))
    (whole,) = subdomains(piece, Extent(99, 999), 0)
    assert isinstance(whole, Subdomain)
    assert np.count_nonzero(~whole.mesh.locked_nodes) == (11 if slides else 0)


# --- in a run -----------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def told():
    """A run on a bad plate, and the rounds that it tells of."""
    events = []
    done = finish(job(bad_plate()), events)
    return done, [event for event in events if isinstance(event, RoundReport)]


def test_it_slides_before_it_searches(told):
    done, rounds = told
    steps = [step for place in done.procedure.rounds[0].places for step in place.steps]
    assert steps
    assert {step.code for step in steps} == {SLIDE.code}
    assert rounds[0].evaluations == 0
    assert rounds[0].failed < faults(bad_plate())[0]
    assert (done.after.failed, done.after.trias) <= (rounds[0].failed, rounds[0].trias)


def test_a_run_that_slides_gives_the_same_mesh_in_any_batches(told, monkeypatch):
    monkeypatch.setattr("islands.rounds.BATCH", 2)
    assert finish(job(bad_plate())).mesh.digest == told[0].mesh.digest


def test_what_slid_is_replayed_and_transferred(told):
    mesh, procedure = bad_plate(), told[0].procedure
    again = perform(mesh, procedure.rounds, ALL_OPERATIONS, procedure.setting(mesh))
    assert again.digest == told[0].mesh.digest
    other = bad_plate(seed=3)
    better, _ = transfer(procedure, other, ALL_OPERATIONS, procedure.setting(other))
    assert faults(better) < faults(other)


def test_a_corner_of_a_part_stays(told):
    """The four corners of the plate, and so its outline, but for nodes in one line."""
    before, after = bad_plate(), told[0].mesh
    low, high = before.points.min(axis=0), before.points.max(axis=0)
    for x in (low[0], high[0]):
        for y in (low[1], high[1]):
            assert (np.abs(after.points[:, :2] - (x, y)).max(axis=1) == 0).any()
