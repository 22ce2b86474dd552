"""What every edit must leave whole, asserted by the plain measures of tests.meshes."""

from collections import Counter

import numpy as np
import pytest

from meshops.edit import apply
from meshops.mesh import NEW
from tests.meshes import corners, distances_to_trias, doubles, place, trias_of, unsound, zones


def assert_sound(mesh):
    assert unsound(mesh) == []
    assert doubles(mesh) == []


def assert_nothing_locked_has_changed(before, after):
    def locked(mesh):
        nodes = Counter(map(tuple, mesh.points[mesh.locked_nodes]))
        elements = mesh.elements[mesh.locked_elements]
        return nodes, [[place(mesh, node) for node in corners(element)] for element in elements]

    assert locked(before) == locked(after)


def assert_ids_are_kept(before, after):
    """Old nodes and elements keep their id and their order; new ones have none."""
    for ids, old in ((after.node_ids, before.node_ids), (after.element_ids, before.element_ids)):
        kept = ids[ids != NEW]
        assert np.array_equal(kept, old[np.isin(old, kept)])


def assert_zones_are_whole(before, after, *, area, straight=False):
    """Each zone keeps outline, region, Euler number and area; its trias have its border's parity.

    The area vector of a surface follows from its border alone: a hole or a lap would change it.
    `area` is relative; None: not compared, where the mesh lapped over itself before. `straight`:
    border edges in one line may have become one.
    """
    old = {zone.outline: zone for zone in zones(before, straight=straight)}
    new = {zone.outline: zone for zone in zones(after, straight=straight)}
    assert old.keys() == new.keys()
    for name, zone in old.items():
        assert new[name].region == zone.region
        assert new[name].euler == zone.euler
        np.testing.assert_allclose(new[name].area_vector, zone.area_vector, atol=1e-9)
        if area is not None:
            assert new[name].area == pytest.approx(zone.area, rel=area)
        assert new[name].trias % 2 == new[name].sides % 2


def assert_on_the_surface(before, after, *, tolerance):
    old = set(map(tuple, before.points))
    surface = trias_of(before)
    for point in after.points:
        if tuple(point) not in old:
            assert distances_to_trias(point, surface).min() <= tolerance


def tried(operation, piece, seed, count=3):
    """(mesh after, predicted tally) of some genomes that lead to a valid mesh."""
    rng = np.random.default_rng(seed)
    space = operation.search_space(piece, rng)
    if space is None:
        return []
    genomes = space.draw(rng, 16)
    tallies = space.evaluate(genomes)
    valid = np.nonzero(np.isfinite(tallies).all(axis=1))[0][:count]
    return [
        (apply(piece.mesh, operation.apply(piece, space.parameters(genomes[row]))), tallies[row])
        for row in valid
    ]
