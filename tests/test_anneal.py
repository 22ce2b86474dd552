"""Anneal: what gets better, what must not change, and that changes can be taken back."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import PAPER
from meshops.edit import apply
from meshops.examples import SIZE, plate
from meshops.fitness import Fitness
from meshops.kernels.annealing import anneal
from meshops.kernels.living import fan, living, settle, take_back
from meshops.kernels.retopology import (
    collapse_diagonal_of,
    collapse_side,
    is_whole,
    open_node,
    open_trias,
    split_row,
    swap_side,
)
from meshops.operations.anneal import HEATS, Anneal, _doubles_an_edge
from meshops.patch import Patch, extract
from meshops.quality_sums import FAILED, IRREGULAR, TRIAS
from meshops.workpiece import Setting, Workpiece
from tests.measures import unsound
from tests.meshes import FLAT_KINDS, cylinder, meshes, sheet

ANNEAL = Anneal()
EVERYWHERE = 40
MILD, LONG = 2, 3
NO_GROUND = (np.zeros((0, 3)), np.zeros((0, 3), np.int32), np.zeros((0, 4)), 0.0, 0.0)
PRICES = (10.0, 6.0, 0.3, 10.0, 6.0)


def workpiece(mesh, size=1.0, element_size=None):
    fitness = Fitness("quality", len(mesh.elements))
    return Workpiece(mesh, Setting(PAPER.at(size), fitness, element_size))


def annealed(work, rank=1, rings=EVERYWHERE, heat=LONG, seed=1):
    place = np.array([[rank, rings, heat, seed]], np.int32)
    return apply(work.mesh, ANNEAL.apply(work, place))


def whole_patch(work) -> Patch:
    return extract(work.topology, np.arange(len(work.mesh.elements), dtype=np.int32))


def centre_of(mesh, row):
    return mesh.points[mesh.elements[row]].mean(axis=0)[:2]


def live_patch(work):
    patch = whole_patch(work)
    fits, live = living(patch.points, patch.elements, 60)
    assert fits
    return patch, live


CHANGES = (
    lambda live, e, i, j, fixed: swap_side(live, e, i % (3 + (live[1][e, 3] >= 0)), j),
    lambda live, e, i, j, fixed: split_row(live, e, j),
    lambda live, e, i, j, fixed: collapse_diagonal_of(live, e, i, fixed),
    lambda live, e, i, j, fixed: collapse_side(live, e, i % 3, fixed),
    lambda live, e, i, j, fixed: open_node(live, live[1][e, i % 3], i, j, fixed),
    lambda live, e, i, j, fixed: open_trias(live, live[1][e, i % 3], i, j, fixed),
)
changes = st.lists(
    st.tuples(
        st.sampled_from(range(len(CHANGES))),
        st.integers(0, 10**6),
        st.integers(0, 1000),
        st.integers(0, 1000),
    ),
    min_size=1,
    max_size=30,
)


def sides_of(elements):
    """Every directed side of elements, -1 rows left out."""
    sides = []
    for row in elements[elements[:, 0] >= 0].tolist():
        nodes = [node for node in row if node >= 0]
        sides += list(zip(nodes, [*nodes[1:], nodes[0]], strict=True))
    return sides


@settings(max_examples=40, deadline=None)
@given(mesh=meshes(("plain",)), asked=changes)
def test_a_change_is_whole_or_taken_back(mesh, asked):
    work = workpiece(mesh)
    patch, live = live_patch(work)
    outside = np.zeros(len(live[0]), np.int32)
    outside[: patch.border_nodes] = -1
    border = {side for side in sides_of(live[1]) if side[::-1] not in set(sides_of(live[1]))}
    for kind, which, i, j in asked:
        rows = np.nonzero(live[1][:, 0] >= 0)[0]
        before = live[1].copy(), live[0].copy(), live[3].copy()
        done = CHANGES[kind](live, int(rows[which % len(rows)]), i, j, patch.border_nodes)
        if done and is_whole(live, outside, patch.border_nodes):
            settle(live)
        else:
            take_back(live)
            for now, then in zip((live[1], live[0], live[3]), before, strict=True):
                np.testing.assert_array_equal(now, then)
        sides = sides_of(live[1])
        assert len(sides) == len(set(sides))
        assert {side for side in sides if side[::-1] not in set(sides)} == border
        used = live[1][live[1] >= 0]
        np.testing.assert_array_equal(live[3], np.bincount(used, minlength=len(live[3])))


def test_a_fan_goes_around_its_node_in_order():
    work = workpiece(sheet(4, 4))
    patch, live = live_patch(work)
    rows = np.empty(10, np.int32)
    inner = patch.border_nodes
    count, closed = fan(live, inner, rows)
    assert (count, closed) == (4, True)
    centres = patch.points[patch.elements[rows[:4]]].mean(axis=1) - patch.points[inner]
    angles = np.unwrap(np.arctan2(centres[:, 1], centres[:, 0]))
    assert (np.diff(angles) > 0.0).all()
    corner = int(np.argmin(patch.points[:, :2].sum(axis=1)))
    assert fan(live, corner, rows) == (1, False)


def test_the_plate_gets_better_in_all_that_counts():
    work = workpiece(plate(), SIZE, SIZE)
    after = workpiece(annealed(work), SIZE, SIZE)
    assert after.tally[FAILED] == 0 < work.tally[FAILED]
    assert after.tally[TRIAS] < work.tally[TRIAS]
    assert after.tally[IRREGULAR] < 0.6 * work.tally[IRREGULAR]
    assert after.fitness(after.tally[None]) > work.fitness(work.tally[None])


def test_a_regular_sheet_stays_as_it_is():
    work = workpiece(sheet(6, 6))
    assert work.tally[IRREGULAR] == 0
    assert ANNEAL.apply(work, np.array([[1, EVERYWHERE, LONG, 1]], np.int32)).is_empty


def test_the_same_seed_gives_the_same_mesh_and_another_one_another():
    work = workpiece(plate(), SIZE)
    first, again, other = (annealed(work, heat=MILD, seed=seed) for seed in (5, 5, 6))
    assert first.digest == again.digest != other.digest


def test_density_stays_where_no_size_is_given():
    work = workpiece(plate(), SIZE)
    after = annealed(work)
    assert 0.7 < len(after.elements) / len(work.mesh.elements) < 1.3


def test_a_curved_patch_stays_on_its_surface():
    mesh = cylinder(sheet(12, 12, seed=3, jitter=0.2, trias=0.3))
    work = workpiece(mesh)
    after = annealed(work)
    assert after.digest != mesh.digest
    radius = np.hypot(after.points[:, 0], after.points[:, 2])
    was = np.hypot(mesh.points[:, 0], mesh.points[:, 2])
    assert was.min() - 0.1 < radius.min()
    assert radius.max() < was.max() + 0.1
    assert not unsound(after)


@settings(max_examples=10, deadline=None)
@given(mesh=meshes(FLAT_KINDS), seed=st.integers(0, 999), rings=st.integers(0, 6))
def test_border_parity_holds(mesh, seed, rings):
    """4 Q + 3 T follows from the edges: the number of trias keeps its parity."""
    work = workpiece(mesh)
    place = np.array([[1, rings, MILD, seed]], np.int32)
    after = apply(mesh, ANNEAL.apply(work, place))
    assert (after.is_tria.sum() - mesh.is_tria.sum()) % 2 == 0


def test_energy_only_counts_what_it_says():
    """Of a sheet of unit squares nothing is lacking; a node that others hang on may differ."""
    work = workpiece(sheet(5, 5))
    patch = whole_patch(work)
    wanted = (np.ones((1, 1, 1)), np.zeros(3), 1.0)
    outside = np.zeros(len(patch.points), np.int32)

    def energy(outside):
        return anneal(
            patch.points,
            patch.elements,
            outside,
            patch.border_nodes,
            np.array([0.0, 0.0, 1.0]),
            NO_GROUND,
            wanted,
            PRICES,
            (0.1, 0.01),
            0,
            1,
            work.setting.scoring.arrays,
        )[3]

    outside[: patch.border_nodes] = -1
    assert energy(outside) == pytest.approx(0.0)
    outside[0] = 7 - np.count_nonzero(patch.elements == 0)
    assert energy(outside) == pytest.approx(0.3 * (1.0 + 1.5 * 2))


def test_parameters_that_there_are_not_are_refused():
    work = workpiece(plate(), SIZE)
    with pytest.raises(ValueError, match="temperature"):
        ANNEAL.apply(work, np.array([[1, 2, len(HEATS), 1]], np.int32))
    with pytest.raises(ValueError, match="one place"):
        ANNEAL.apply(work, np.array([[1, 2, 0, 1]] * 2, np.int32))
    assert ANNEAL.apply(work, np.array([[10**6, 2, 0, 1]], np.int32)).is_empty


def test_an_edge_that_is_outside_already_is_seen():
    """Around a hole of two elements, whose common edge joins two nodes of its border."""
    mesh = sheet(4, 3)
    hole = [
        row for row in range(12) if (np.abs(centre_of(mesh, row) - [2.0, 1.5]) < [1, 0.4]).all()
    ]
    assert len(hole) == 2
    work = workpiece(mesh)
    rows = np.setdiff1d(np.arange(12), hole).astype(np.int32)
    patch = extract(work.topology, rows)
    assert not _doubles_an_edge(work, patch, patch.elements)
    shared = np.intersect1d(*mesh.elements[hole])
    twice = patch.elements.copy()
    twice[0, :2] = [int(np.nonzero(patch.nodes == node)[0][0]) for node in shared]
    assert _doubles_an_edge(work, patch, twice)


def test_notation():
    assert ANNEAL.format(np.array([[3, 4, 0, 17]], np.int32)) == "3 r4 T0.4x300 #17"
