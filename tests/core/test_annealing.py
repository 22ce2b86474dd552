"""Annealing in the core: bit for bit what the compiled Python gave, and safe whatever it is given.

Energies hold angles and logarithms, which differ in their last bits; points and elements do not.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops._core import AnnealingPrices, AnnealingSite, Cooling, Ground, WantedSizes, anneal
from meshops.criteria import PAPER, STANDARD
from meshops.examples import SIZE, plate
from meshops.fitness import Fitness
from meshops.kernels.annealing import anneal as compiled_anneal
from meshops.operations.anneal import _outside
from meshops.patch import components, extract
from meshops.workpiece import Setting, Workpiece
from tests.meshes import CURVED_KINDS, FLAT_KINDS, cylinder, meshes, sheet

PRICES = {"shape": 10.0, "tria": 6.0, "irregular": 0.3, "invalid": 10.0, "size": 6.0}
SCORING = STANDARD.at(1.0)
TOO_SMALL = SIZE / 4


class Place:
    """A whole mesh, or a disc of it, as annealing takes it."""

    def __init__(self, mesh, criteria=STANDARD, size=1.0, rings=None, cells=(3, 2, 1)):
        self.work = Workpiece(mesh, Setting(criteria.at(size), Fitness("quality", 1)))
        topology, surface = self.work.topology, self.work.surface
        rows = np.arange(len(mesh.elements), dtype=np.int32)
        if rings is not None:
            disc = topology.graph.disc(np.ones(len(rows), bool), len(rows) // 2, rings)
            rows = next(iter(components(topology, disc)), rows)
        self.patch = patch = extract(topology, rows)
        self.outside = _outside(self.work, patch)
        self.plane = surface.plane
        near = surface.near(patch.points, size)
        self.ground = (surface.points, *near, 0.1 * size, 0.05)
        sizes = size * (1.0 + 0.1 * np.arange(np.prod(cells), dtype=float).reshape(cells))
        low, high = patch.points.min(axis=0), patch.points.max(axis=0)
        self.wanted = (sizes, low, float(max((high - low) / cells)) + 1e-3)

    def compiled(self, hot, cold, trials, seed):
        """What the compiled Python gives."""
        plane = np.zeros(3) if self.plane is None else self.plane
        return compiled_anneal(
            self.patch.points,
            self.patch.elements,
            self.outside,
            self.patch.border_nodes,
            plane,
            self.ground,
            self.wanted,
            tuple(PRICES.values()),
            (hot, cold),
            trials,
            seed,
            self.work.setting.scoring.arrays,
        )

    def core(self, hot, cold, trials, seed):
        """What the core gives."""
        site = AnnealingSite(
            outside=self.outside,
            fixed=self.patch.border_nodes,
            plane=self.plane,
            ground=Ground(*self.ground),
            wanted=WantedSizes(*self.wanted),
        )
        return anneal(
            self.patch.points,
            self.patch.elements,
            site,
            AnnealingPrices(**PRICES),
            self.work.setting.scoring.core,
            Cooling(hot=hot, cold=cold, trials=trials),
            seed,
        )

    def check(self, hot, cold, trials, seed):
        """The same patch comes of both; how many elements it has."""
        fits, points, elements, before, after = self.compiled(hot, cold, trials, seed)
        found = self.core(hot, cold, trials, seed)
        if not fits:
            assert found is None
            return 0
        np.testing.assert_array_equal(found[0], points, strict=True)
        np.testing.assert_array_equal(found[1], elements, strict=True)
        assert found[2:] == pytest.approx((before, after), rel=1e-9, abs=1e-9)
        return len(elements)


@settings(max_examples=60, deadline=None)
@given(
    mesh=meshes(FLAT_KINDS + CURVED_KINDS),
    rings=st.sampled_from([None, 1, 2, 4]),
    hot=st.sampled_from([0.05, 0.4, 5.0]),
    trials=st.integers(0, 1500),
    seed=st.integers(0, 2**31 - 1),
)
def test_the_same_trials_are_made(mesh, rings, hot, trials, seed):
    Place(mesh, rings=rings).check(hot, 0.02, trials, seed)


@pytest.mark.parametrize("seed", range(3))
def test_the_same_plate_comes_of_it(seed):
    place = Place(plate(), PAPER, SIZE)
    assert place.check(0.4, 0.02, 30_000, seed) != len(place.patch.elements)


@pytest.mark.parametrize("jitter", [0.0, 0.2])
def test_the_same_cylinder_comes_of_it(jitter):
    place = Place(cylinder(sheet(8, 8, seed=3, jitter=jitter, trias=0.3)))
    assert place.plane is None
    assert place.check(0.3, 0.02, 10_000, 7) != len(place.patch.elements)


def test_more_elements_come_where_they_are_to_be_small():
    place = Place(plate(), PAPER, SIZE, cells=(1, 1, 1))
    place.wanted = (np.full((1, 1, 1), TOO_SMALL), *place.wanted[1:])
    assert place.check(0.4, 0.02, 20_000, 1) > len(place.patch.elements)


def test_there_is_room_for_no_more_than_ten_elements_at_a_node():
    points = np.array([[np.cos(a), np.sin(a), 0.0] for a in np.arange(11) * 2 * np.pi / 11])
    points = np.concatenate([points, np.zeros((1, 3))])
    elements = np.array([[11, i, (i + 1) % 11, -1] for i in range(11)], np.int32)
    assert found_in(points, elements) is None
    assert found_in(points, elements[:10]) is not None


def found_in(points, elements, fixed=0, **changes):
    """Anneal anything for a while."""
    arguments = {
        "outside": np.zeros(len(points), np.int32),
        "fixed": fixed,
        "plane": np.array([0.0, 0.0, 1.0]),
        "ground": Ground(points, np.zeros((0, 3), np.int32), np.zeros((0, 4)), 0.1, 0.05),
        "wanted": WantedSizes(np.ones((1, 1, 1)), np.zeros(3), 1.0),
    }
    site = AnnealingSite(**(arguments | changes))
    cooling = Cooling(hot=50.0, cold=1.0, trials=300)
    return anneal(points, elements, site, AnnealingPrices(**PRICES), SCORING.core, cooling, 3)


numbers = st.one_of(st.floats(-3.0, 3.0), st.sampled_from([0.0, 1e300, np.inf, np.nan]))


@settings(max_examples=100, deadline=None)
@given(data=st.data(), nodes=st.integers(4, 9), fixed=st.integers(0, 4), curved=st.booleans())
def test_no_patch_is_so_wrong_that_it_panics(data, nodes, fixed, curved):
    row = st.tuples(*[st.integers(0, nodes - 1)] * 3, st.integers(-1, nodes - 1))
    elements = np.reshape(data.draw(st.lists(row, max_size=12)), (-1, 4)).astype(np.int32)
    points = np.reshape(data.draw(st.lists(numbers, min_size=27, max_size=27)), (9, 3))[:nodes]
    outside = data.draw(st.lists(st.integers(-(2**31), 2**31 - 1), min_size=nodes, max_size=nodes))
    changes = {"outside": np.array(outside, np.int32)}
    if curved:
        facets = np.array([[0, 1, 2], [1, 2, 3]], np.int32)
        ground = Ground(points, facets, np.ones((2, 4)), 0.1, 0.05)
        changes |= {"plane": None, "ground": ground}
    before = points.copy(), elements.copy()
    found = found_in(points, elements, fixed, **changes)
    np.testing.assert_array_equal(points, before[0])
    np.testing.assert_array_equal(elements, before[1])
    if found is not None:
        assert found[1].max(initial=-1) < len(found[0])
        np.testing.assert_array_equal(found[0][:fixed], points[:fixed])


def test_what_does_not_fit_is_refused():
    mesh = sheet(2, 2)
    with pytest.raises(ValueError, match="node that is not there"):
        found_in(mesh.points[:5], mesh.elements)
    with pytest.raises(ValueError, match="more nodes stay"):
        found_in(mesh.points, mesh.elements, fixed=10)
    with pytest.raises(ValueError, match="more nodes stay"):
        found_in(mesh.points, mesh.elements, fixed=-1)
    with pytest.raises(ValueError, match="one number of elements outside"):
        found_in(mesh.points, mesh.elements, outside=np.zeros(3, np.int32))
    with pytest.raises(ValueError, match="no facet"):
        found_in(mesh.points, mesh.elements, plane=None)
    with pytest.raises(ValueError, match="no size"):
        WantedSizes(np.zeros((0, 1, 1)), np.zeros(3), 1.0)
    with pytest.raises(ValueError, match="3 are needed"):
        WantedSizes(np.zeros((1, 1, 1)), np.zeros(2), 1.0)
    with pytest.raises(ValueError, match="point that is not there"):
        Ground(mesh.points, np.array([[0, 1, 9]], np.int32), np.zeros((1, 4)), 0.1, 0.05)
    with pytest.raises(ValueError, match="one sphere"):
        Ground(mesh.points, np.array([[0, 1, 2]], np.int32), np.zeros((0, 4)), 0.1, 0.05)
