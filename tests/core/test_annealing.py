"""Annealing in the core: what was recorded of it, what always holds, and that nothing panics."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops._core import AnnealingPrices, AnnealingSite, Cooling, Ground, WantedSizes, anneal
from meshops.criteria import STANDARD
from meshops.fitness import Fitness
from meshops.operations.anneal import _outside
from meshops.patch import components, extract
from meshops.workpiece import Setting, Workpiece
from tests.core.recorded import digest, outline, sides
from tests.meshes import CURVED_KINDS, FLAT_KINDS, meshes, paraboloid, sheet

PRICES = {"shape": 10.0, "tria": 6.0, "irregular": 0.3, "invalid": 10.0, "size": 6.0}
SCORING = STANDARD.at(1.0)


class Place:
    """A whole mesh, or a disc of it, as annealing takes it."""

    def __init__(self, mesh, rings=None, cells=(3, 2, 1), wanted=None):
        work = Workpiece(mesh, Setting(SCORING, Fitness("quality", 1)))
        topology, surface = work.topology, work.surface
        rows = np.arange(len(mesh.elements), dtype=np.int32)
        if rings is not None:
            disc = topology.graph.disc(np.ones(len(rows), bool), len(rows) // 2, rings)
            rows = next(iter(components(topology, disc)), rows)
        self.patch = patch = extract(topology, rows)
        if wanted is None:
            sizes = 1.0 + 0.1 * np.arange(np.prod(cells), dtype=float).reshape(cells)
        else:
            sizes = np.full(cells, wanted)
        low, high = patch.points.min(axis=0), patch.points.max(axis=0)
        self.site = AnnealingSite(
            outside=_outside(work, patch),
            fixed=patch.border_nodes,
            plane=surface.plane,
            ground=Ground(surface.points, *surface.near(patch.points, 1.0), 0.1, 0.05),
            wanted=WantedSizes(sizes, low, float(max((high - low) / cells)) + 1e-3),
        )

    def annealed(self, hot, trials, seed):
        """Points, elements, and the energy before and after."""
        prices, cooling = AnnealingPrices(**PRICES), Cooling(hot=hot, cold=0.02, trials=trials)
        patch = self.patch
        return anneal(patch.points, patch.elements, self.site, prices, SCORING.core, cooling, seed)


FLAT = sheet(12, 9, seed=5, jitter=0.2, trias=0.3, holes=0.04)
CURVED = paraboloid(sheet(8, 8, seed=3, jitter=0.2, trias=0.3))


@pytest.mark.parametrize(
    ("place", "hot", "trials", "seed", "expected"),
    [
        (Place(FLAT), 0.4, 20_000, 1, "b525d15d8e5517b8"),
        (Place(FLAT), 0.4, 20_000, 2, "0c484e3f32315e76"),
        (Place(FLAT, rings=3), 0.4, 10_000, 1, "5906d46cac256a16"),
        (Place(FLAT, cells=(1, 1, 1), wanted=0.6), 0.4, 20_000, 1, "d7a4e08af2609a16"),
        (Place(CURVED), 0.3, 10_000, 7, "22ab28fee53913d4"),
    ],
    ids=["sheet", "another-seed", "disc", "small-elements", "paraboloid"],
)
def test_the_recorded_patch_comes_of_it(place, hot, trials, seed, expected):
    """Each trial hangs on all before it, so that nothing has changed where this is the same."""
    points, elements, _, _ = place.annealed(hot, trials, seed)
    assert digest(points, elements) == expected


def test_the_recorded_energies_come_of_it():
    """They hold angles and logarithms."""
    _, _, before, after = Place(FLAT).annealed(0.4, 20_000, 1)
    assert (before, after) == pytest.approx((576.2083280998, 19.6944421978), rel=1e-9)


@settings(max_examples=60, deadline=None)
@given(
    mesh=meshes(FLAT_KINDS + CURVED_KINDS),
    rings=st.sampled_from([None, 1, 2, 4]),
    hot=st.sampled_from([0.05, 0.4, 5.0]),
    trials=st.integers(0, 1500),
    seed=st.integers(0, 2**31 - 1),
)
def test_the_border_stays_and_each_side_is_there_once(mesh, rings, hot, trials, seed):
    place = Place(mesh, rings=rings)
    patch = place.patch
    points, elements, before, after = place.annealed(hot, trials, seed)
    np.testing.assert_array_equal(points[: patch.border_nodes], patch.points[: patch.border_nodes])
    assert outline(elements) == outline(patch.elements)
    assert len(set(sides(elements))) == len(sides(elements))
    np.testing.assert_array_equal(
        np.unique(elements[elements >= 0])[patch.border_nodes :],
        np.arange(patch.border_nodes, len(points)),
    )
    if not trials:
        assert after == before
        np.testing.assert_array_equal(elements, patch.elements)
        np.testing.assert_array_equal(points, patch.points)


def test_it_gets_better_the_longer_it_takes():
    energies = [Place(FLAT).annealed(0.4, trials, 1)[3] for trials in (0, 300, 3_000, 30_000)]
    assert energies == sorted(energies, reverse=True)


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
