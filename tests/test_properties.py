"""What every operation must leave whole, on random meshes of every kind."""

from collections import Counter

import numpy as np
import pytest
from hypothesis import settings
from hypothesis import strategies as st

from meshops.criteria import STANDARD
from meshops.fitness import Fitness
from meshops.mesh import NEW
from meshops.operations import Remesh, ReplaceNode
from meshops.workpiece import Setting, Workpiece
from tests.meshes import (
    doubles,
    place,
    unsound,
    zones,
)

REMESHES = (Remesh(ranges=5, reach=None), Remesh(ranges=2, reach=None), Remesh(ranges=3, reach=25))
REPLACES = (ReplaceNode(pairs=4, pool=60), ReplaceNode(pairs=2, pool=400, optional=False))
seeds = st.integers(0, 10**6)
bounded = settings(max_examples=40, deadline=None)


def workpiece(mesh, kind="quality"):
    return Workpiece(mesh, Setting(STANDARD.at(1.0), Fitness(kind, len(mesh.elements))))


def tried(operation, piece, seed, count=8):
    """(parameters, predicted tally) of random genomes that make a valid mesh."""
    rng = np.random.default_rng(seed)
    space = operation.search_space(piece, rng)
    if space is None:
        return []
    genomes = space.draw(rng, count)
    tallies = space.evaluate(genomes)
    valid = np.isfinite(tallies[:, 0])
    return [(space.parameters(g), t) for g, t in zip(genomes[valid], tallies[valid], strict=True)]


def assert_zones_are_whole(before, after, *, area):
    """Every zone has the outline, the region, the holes and the area vector that it had."""
    old = {zone.outline: zone for zone in zones(before)}
    new = {zone.outline: zone for zone in zones(after)}
    assert old.keys() == new.keys()
    for outline, zone in old.items():
        assert new[outline].region == zone.region
        assert new[outline].euler == zone.euler
        # the area vector of a surface follows from its border alone, so a hole would change it
        np.testing.assert_allclose(new[outline].area_vector, zone.area_vector, atol=1e-9)
        assert new[outline].area == pytest.approx(zone.area, rel=area)
        assert trias(after, new[outline]) % 2 == sum(n for _, n in outline) % 2


def trias(mesh, zone):
    return np.count_nonzero(mesh.is_tria[list(zone.elements)])


def assert_nothing_locked_has_changed(before, after):
    assert Counter(map(tuple, before.points[before.locked_nodes])) == Counter(
        map(tuple, after.points[after.locked_nodes])
    )
    locked = [
        [place(mesh, node) for node in element if node >= 0]
        for mesh in (before, after)
        for element in mesh.elements[mesh.locked_elements]
    ]
    assert locked[: len(locked) // 2] == locked[len(locked) // 2 :]


def assert_ids_are_kept(before, after):
    """Old nodes and elements keep id and order; new ones have none."""
    for ids, old in ((after.node_ids, before.node_ids), (after.element_ids, before.element_ids)):
        kept = ids[ids != NEW]
        assert np.array_equal(kept, old[np.isin(old, kept)])


def assert_sound(before, after):
    assert not unsound(after)
    assert not doubles(after)
    assert_nothing_locked_has_changed(before, after)
    assert_ids_are_kept(before, after)
