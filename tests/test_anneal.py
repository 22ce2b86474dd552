"""Anneal: what gets better, and what must not change."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops._core import AnnealingPrices, AnnealingSite, Cooling, Ground, WantedSizes, anneal
from meshops.criteria import PAPER
from meshops.edit import apply
from meshops.examples import SIZE, plate
from meshops.fitness import Fitness
from meshops.operations.anneal import HEATS, Anneal, _doubles_an_edge
from meshops.patch import Patch, extract
from meshops.quality_sums import FAILED, IRREGULAR, TRIAS
from meshops.workpiece import Setting, Workpiece
from tests.measures import unsound
from tests.meshes import FLAT_KINDS, cylinder, meshes, sheet

ANNEAL = Anneal()
EVERYWHERE = 40
MILD, LONG = 2, 3
NO_GROUND = Ground(np.zeros((0, 3)), np.zeros((0, 3), np.int32), np.zeros((0, 4)), 0.0, 0.0)
PRICES = AnnealingPrices(shape=10.0, tria=6.0, irregular=0.3, invalid=10.0, size=6.0)


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
    wanted = WantedSizes(np.ones((1, 1, 1)), np.zeros(3), 1.0)
    outside = np.zeros(len(patch.points), np.int32)
    cooling = Cooling(hot=0.1, cold=0.01, trials=0)

    def energy(outside):
        site = AnnealingSite(
            outside=outside,
            fixed=patch.border_nodes,
            plane=np.array([0.0, 0.0, 1.0]),
            ground=NO_GROUND,
            wanted=wanted,
        )
        scoring = work.setting.scoring.core
        return anneal(patch.points, patch.elements, site, PRICES, scoring, cooling, 1)[2]

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
