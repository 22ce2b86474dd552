"""The guard: whatever is done to a mesh, what is kept of it does no harm.

Changes are random operations one after the other, good ones and bad ones; what is kept is judged by
`meshops.harm`, which shares nothing with the guard.
"""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from benchmarks.planting import doublet, misplaced_node, needle, tria_pair
from benchmarks.structured import graded, patch, structured
from meshops.assessment import Assessment
from meshops.criteria import PAPER, STANDARD
from meshops.edit import Edit, apply
from meshops.fitness import Fitness
from meshops.guard import count_changed, guarded, guarded_edits
from meshops.harm import compare, local_sizes, median_size
from meshops.mesh import NEW, ShellMesh
from meshops.operations import OPERATIONS
from meshops.quality import median_edge
from meshops.sizing import LOCAL, parse_size
from meshops.workpiece import Setting, Workpiece
from tests.meshes import CURVED_KINDS, FLAT_KINDS, annulus, cylinder, sheet, with_

NAMES = (
    "anneal", "remesh", "swap-edge", "join-trias", "split-quad", "transport-tria",
    "collapse-diagonal", "open-diagonal", "remove-doublet", "replace-node", "smooth", "slide",
    "edit-element", "collapse-chord", "replace-chain",
)  # fmt: skip


def setting_of(mesh: ShellMesh) -> Setting:
    sizes = parse_size(LOCAL, mesh)
    assessment = Assessment(PAPER.at(median_edge(mesh)), sizes, LOCAL)
    fitness = Fitness("quality", len(mesh.elements))
    return Setting.of(mesh, assessment, fitness, element_size=None, feature_angle=30.0, slides=True)


def t_section(seed: int) -> ShellMesh:
    flange, web = sheet(8, 6, seed=seed, jitter=0.25, trias=0.2), sheet(8, 4, seed=seed, trias=0.2)
    x, y, _ = web.points.T
    points = np.concatenate([flange.points, np.stack([x, np.full(len(x), 3.0), y], axis=1)])
    _, first, row = np.unique(np.round(points, 9), axis=0, return_index=True, return_inverse=True)
    added = np.where(web.elements < 0, -1, web.elements + len(flange.points))
    elements = np.concatenate([flange.elements, added])
    return ShellMesh.build(points[first], np.where(elements < 0, -1, row.ravel()[elements]))


KINDS = {
    "structured": lambda seed: structured(seed % 100).mesh,
    "jittered": lambda seed: sheet(9, 7, seed=seed, jitter=0.3, trias=0.3),
    "graded": lambda seed: patch(
        lambda u, v: (9 * u, 9 * v, 0 * u), (graded(10, 1.25), graded(8, 1.2))
    ),
    "curved": lambda seed: cylinder(sheet(10, 8, seed=seed, jitter=0.25, trias=0.3)),
    "round": lambda seed: annulus(16, 4, seed=seed, jitter=0.3),
    "T-junction": t_section,
}


def changed(before: Workpiece, rng: np.random.Generator, steps: int) -> ShellMesh:
    """Apply genomes of operations without asking whether they do any good."""
    mesh, setting = before.mesh, before.setting
    known = {operation.name: operation for operation in OPERATIONS}
    for name in rng.choice(NAMES, steps):
        workpiece = Workpiece(mesh, setting, before.surface)
        space = known[name].search_space(workpiece, rng)
        if space is None:
            continue
        genome = space.draw(rng, 1)[0]
        parameters = space.parameters(genome)
        if len(parameters):
            mesh = apply(mesh, known[name].apply(workpiece, parameters))
    return mesh


def judged(before: ShellMesh, after: ShellMesh):
    return compare(before, after, PAPER.at(median_size(before)), local_sizes(before, after))


def of_kind(kind: str, seed: int) -> Workpiece:
    mesh = KINDS[kind](seed)
    return Workpiece(mesh, setting_of(mesh))


changes = given(
    kind=st.sampled_from(sorted(KINDS)), seed=st.integers(0, 10**6), steps=st.integers(1, 6)
)
bounded = settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))


@bounded
@changes
def test_no_element_breaks_a_limit_of_shape_that_none_before_it_broke_by_more(kind, seed, steps):
    before = of_kind(kind, seed)
    kept = guarded(before, changed(before, np.random.default_rng(seed), steps))
    harm = judged(before.mesh, kept)
    assert harm.places.new_faults == 0
    assert harm.after.failed_by_shape <= harm.before.failed_by_shape
    assert harm.after.inverted <= harm.before.inverted


@bounded
@changes
def test_shape_does_not_fall_for_size(kind, seed, steps):
    before = of_kind(kind, seed)
    kept = guarded(before, changed(before, np.random.default_rng(seed), steps))
    assert judged(before.mesh, kept).places.spoiled == 0


@bounded
@changes
def test_trias_do_not_come_but_for_what_is_folded(kind, seed, steps):
    before = of_kind(kind, seed)
    kept = guarded(before, changed(before, np.random.default_rng(seed), steps))
    then, now = judged(before.mesh, kept).before, judged(before.mesh, kept).after
    assert now.trias - then.trias <= max(then.inverted - now.inverted, 0)
    assert now.adjacent_trias <= then.adjacent_trias


@bounded
@changes
def test_the_worst_angles_and_the_least_jacobian_stay(kind, seed, steps):
    before = of_kind(kind, seed)
    kept = guarded(before, changed(before, np.random.default_rng(seed), steps))
    then, now = judged(before.mesh, kept).before, judged(before.mesh, kept).after
    if then.failed_by_shape == now.failed_by_shape:
        assert now.least_angle >= then.least_angle - 1e-6
        assert now.greatest_angle <= then.greatest_angle + 1e-6


@bounded
@changes
def test_what_is_kept_is_whole_and_all_else_is_as_it_was(kind, seed, steps):
    """Areas, ids and doubles; and what did not change stays bit for bit."""
    before = of_kind(kind, seed)
    mesh = before.mesh
    kept = guarded(before, changed(before, np.random.default_rng(seed), steps))
    harm = judged(mesh, kept)
    assert harm.other_ids == harm.lost_locks == 0
    assert harm.after.same_nodes <= harm.before.same_nodes
    if mesh.points[:, 2].max() == mesh.points[:, 2].min():
        for region, area in harm.before.areas.items():
            assert harm.after.areas[region] == pytest.approx(area, rel=1e-3)
    rows = {int(i): row for row, i in enumerate(mesh.element_ids)}
    nodes = {int(i): row for row, i in enumerate(mesh.node_ids)}
    same = [row for row, i in enumerate(kept.element_ids) if i != NEW and int(i) in rows]
    assert len(kept.elements) - len(same) + len(mesh.elements) - len(same) <= (
        2 * harm.changed_elements
    )
    moved = sum(
        int(i) in nodes and (kept.points[row] != mesh.points[nodes[int(i)]]).any()
        for row, i in enumerate(kept.node_ids)
    )
    assert moved <= harm.changed_nodes


@bounded
@changes
def test_guarding_twice_changes_nothing(kind, seed, steps):
    before = of_kind(kind, seed)
    kept = guarded(before, changed(before, np.random.default_rng(seed), steps))
    assert guarded(before, kept).digest == kept.digest


@pytest.mark.parametrize("kind", FLAT_KINDS + CURVED_KINDS)
def test_what_is_not_changed_is_the_mesh_itself(kind):
    from tests.meshes import make

    mesh = make(kind, 3)
    before = Workpiece(mesh, setting_of(mesh))
    again = with_(mesh, points=mesh.points.copy())
    assert guarded(before, again) is mesh


# --- what is kept, so that the above is not said of nothing --------------------------------------


@pytest.mark.parametrize("plant", [tria_pair, doublet, needle, misplaced_node])
@pytest.mark.parametrize("bent", [False, True])
def test_what_mends_a_fault_is_kept(plant, bent):
    sound = sheet(9, 9)
    bad = plant(sound, 40, np.random.default_rng(1))
    if bent:
        sound, bad = cylinder(sound), cylinder(bad)
    before = Workpiece(bad, setting_of(bad))
    # the sound mesh as what has become of the bad one
    known = {tuple(p): i for p, i in zip(bad.points.tolist(), bad.node_ids.tolist(), strict=True)}
    ids = [known.get(tuple(p), NEW) for p in sound.points.tolist()]
    after = with_(sound, node_ids=ids, element_ids=np.zeros(len(sound.elements)))
    kept = guarded(before, after)
    harm = judged(bad, kept)
    assert harm.after.trias == 0
    assert harm.after.failed_by_shape == 0
    assert harm.changed_elements <= 12


def test_of_two_changes_the_good_one_is_kept_and_the_bad_one_taken_back():
    mesh = misplaced_node(sheet(20, 6), 30, np.random.default_rng(0))
    sound = sheet(20, 6)
    wrong = int(np.nonzero((mesh.points != sound.points).any(axis=1))[0][0])
    far = int(np.argmin(np.abs(mesh.points[:, :2] - (16.0, 3.0)).sum(axis=1)))
    points = mesh.points.copy()
    points[wrong] = sound.points[wrong]
    points[far] += (0.6, 0.5, 0.0)
    before = Workpiece(mesh, setting_of(mesh))
    kept = guarded(before, with_(mesh, points=points))
    assert (kept.points[far] == mesh.points[far]).all()
    assert (kept.points[wrong] == sound.points[wrong]).all()


def test_nodes_that_moved_for_nothing_go_home():
    mesh = misplaced_node(sheet(9, 9), 40, np.random.default_rng(0))
    sound = sheet(9, 9)
    wrong = int(np.nonzero((mesh.points != sound.points).any(axis=1))[0][0])
    before = Workpiece(mesh, setting_of(mesh))
    points = mesh.points.copy()
    free = before.topology.free_nodes
    points[free, :2] += np.random.default_rng(1).uniform(-0.05, 0.05, (int(free.sum()), 2))
    points[wrong] = sound.points[wrong]
    kept = guarded(before, with_(mesh, points=points))
    moved = (kept.points != mesh.points).any(axis=1)
    assert moved[wrong]
    assert moved.sum() <= 9


def test_new_nodes_in_the_place_of_old_ones_are_these():
    """A patch that comes back as it was, from an operation that makes all of it anew."""
    mesh = sheet(8, 8)
    rows = np.nonzero((np.abs(mesh.points[mesh.elements].mean(axis=1)[:, :2] - 4) < 2).all(axis=1))
    rows = rows[0].astype(np.int32)
    inner = np.setdiff1d(mesh.elements[rows], np.delete(mesh.elements, rows, axis=0))
    fresh = np.arange(len(mesh.points), dtype=np.int32)
    fresh[inner] = len(mesh.points) + np.arange(len(inner))
    edit = Edit(
        removed=rows,
        added_points=mesh.points[inner] + (0.01, 0.0, 0.0),
        added_elements=fresh[mesh.elements[rows]],
        added_region=mesh.region[rows],
    )
    after = apply(mesh, edit)
    assert (after.element_ids == NEW).sum() == len(rows)
    assert guarded(Workpiece(mesh, setting_of(mesh)), after) is mesh


@pytest.mark.parametrize("remembers", [True, False])
def test_many_small_changes_do_no_harm_together(remembers):
    """A node creeps off its cylinder, each time by less than what is seen."""
    mesh = cylinder(sheet(9, 9, seed=2, jitter=0.3))
    first = before = Workpiece(mesh, setting_of(mesh))
    node = int(np.argmin(np.abs(mesh.points - mesh.points.mean(axis=0)).sum(axis=1)))
    node = np.array([node], np.int32)
    for _ in range(20):
        away = before.mesh.points[node] * (1.001, 1.0, 1.001)
        edit = Edit(moved=node, moved_to=away)
        origin = first if remembers else before
        after = guarded_edits(before, [edit], "faults", origin=origin, neutral=True)
        before = Workpiece(after, before.setting)
    kept = guarded(first, before.mesh, neutral=True)
    assert (kept.digest == before.mesh.digest) == remembers
    assert (kept.digest != mesh.digest) == remembers


def test_an_irregular_node_less_is_a_gain_where_rows_are_the_aim():
    mesh = doublet_free_pair()
    setting = replace(setting_of(mesh), sizes=None, gradation=None, keeps_sizes=False)
    before = Workpiece(mesh, replace(setting, scoring=STANDARD.at(1.0)))
    after = with_(sheet(6, 6), node_ids=before_ids(mesh, sheet(6, 6)), element_ids=np.zeros(36))
    assert guarded(before, after, "faults").digest == mesh.digest
    assert len(guarded(before, after, "flow").elements) == 36


def doublet_free_pair() -> ShellMesh:
    """A grid in one quad of which lies another, so that four nodes are irregular."""
    mesh = sheet(6, 6)
    row = 14
    a, b, c, d = mesh.elements[row]
    middle = mesh.points[[a, b, c, d]].mean(axis=0)
    inner = middle + 0.6 * (mesh.points[[a, b, c, d]] - middle)
    n = len(mesh.points)
    e, f, g, h = range(n, n + 4)
    added = [(a, b, f, e), (b, c, g, f), (c, d, h, g), (d, a, e, h), (e, f, g, h)]
    elements = np.concatenate([np.delete(mesh.elements, row, axis=0), added])
    return ShellMesh.build(np.concatenate([mesh.points, inner]), elements)


def before_ids(mesh: ShellMesh, other: ShellMesh) -> list[int]:
    known = {tuple(p): i for p, i in zip(mesh.points.tolist(), mesh.node_ids.tolist(), strict=True)}
    return [known.get(tuple(p), NEW) for p in other.points.tolist()]


def test_what_has_changed_is_counted():
    mesh = sheet(6, 6)
    assert count_changed(mesh, mesh) == (0, 0)
    points = mesh.points.copy()
    points[24] += (0.1, 0.0, 0.0)
    assert count_changed(mesh, with_(mesh, points=points)) == (4, 1)
    split = Edit(
        removed=np.array([14], np.int32),
        added_elements=np.array(
            [(*mesh.elements[14][:3], -1), (*mesh.elements[14][[0, 2, 3]], -1)]
        ),
        added_region=np.zeros(2, np.int32),
    )
    assert count_changed(mesh, apply(mesh, split)) == (2, 0)
