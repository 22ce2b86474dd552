"""New nodes get what all nodes around them share; regions see to it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from meshops.edit import Edit, apply
from meshops.formats.node_attributes import (
    Membership,
    memberships_of_new_nodes,
    rows_by_membership,
    share_memberships,
)
from meshops.mesh import NO_NODE, ShellMesh

HELD = Membership(("NSET", "HELD"))
COLD, WARM = Membership("TEMP", 20.0), Membership("TEMP", 30.0)
RIGID = Membership("RBE2", 7, can_grow=False, can_shrink=False)


def grid(columns, rows):
    """(M, 4) quads; node of column i, row j is i * (rows + 1) + j."""
    numbers = np.arange((columns + 1) * (rows + 1)).reshape(columns + 1, rows + 1)
    quads = [numbers[:-1, :-1], numbers[1:, :-1], numbers[1:, 1:], numbers[:-1, 1:]]
    return np.stack(quads, axis=-1).reshape(-1, 4).astype(np.int32)


def sets(count, members):
    found = [frozenset()] * count
    for item, nodes in members.items():
        for node in nodes:
            found[node] |= {item}
    return found


def share(elements, count, members, region=None):
    region = np.zeros(len(elements), np.int32) if region is None else region
    return share_memberships(elements, region, sets(count, members))


def test_a_set_of_all_nodes_parts_and_locks_nothing():
    found = share(grid(4, 2), 15, {HELD: range(15)})
    assert found.region.tolist() == [0] * 8
    assert found.shared == [{HELD}]
    assert not found.locked_nodes.any()
    assert not found.locked_elements.any()


def test_a_band_is_a_region_and_only_nodes_at_its_edge_stay():
    # four columns of two quads; the nodes of the first three columns of nodes are held
    found = share(grid(4, 2), 15, {HELD: range(9)})
    assert found.region.tolist() == [0, 0, 0, 0, 1, 1, 1, 1]
    assert found.shared == [{HELD}, set()]
    assert np.flatnonzero(found.locked_nodes).tolist() == [6, 7, 8]


def test_a_line_of_held_nodes_parts_nothing_and_keeps_its_nodes():
    found = share(grid(4, 2), 15, {HELD: range(3)})
    assert found.region.tolist() == [0] * 8
    assert found.shared == [frozenset()]
    assert np.flatnonzero(found.locked_nodes).tolist() == [0, 1, 2]


def test_regions_refine_those_that_were():
    region = np.array([0, 0, 1, 1, 1, 1, 1, 1], np.int32)
    found = share(grid(4, 2), 15, {HELD: range(9)}, region)
    assert found.region.tolist() == [0, 0, 1, 1, 2, 2, 2, 2]
    assert found.before.tolist() == [0, 1, 1]


def test_values_that_differ_lock_and_equal_ones_are_shared():
    found = share(grid(3, 1), 8, {COLD: range(4), WARM: range(4, 8)})
    assert found.locked_elements.tolist() == [False, True, False]
    assert [found.shared[r] for r in found.region] == [{COLD}, frozenset(), {WARM}]


def test_what_cannot_be_written_for_another_node_locks():
    found = share(grid(3, 1), 8, {RIGID: range(4)})
    assert found.locked_elements.tolist() == [True, False, False]
    assert np.flatnonzero(found.locked_nodes).tolist() == [0, 1, 2, 3]


# a corner quad split across: the tria at the corner 0 has two sides on the border
CORNER = np.array(
    [[0, 2, 1, NO_NODE], [2, 3, 1, NO_NODE], [2, 4, 5, 3], [1, 3, 7, 6], [3, 5, 8, 7]], np.int32
)


@pytest.mark.parametrize("item", [HELD, RIGID])
def test_a_lone_tria_in_a_corner_is_not_cut_off(item):
    found = share(CORNER, 9, {item: [0, 1, 2, 4, 6]})
    assert found.region.tolist() == [0] * 5
    assert not found.locked_elements.any()
    assert np.flatnonzero(found.locked_nodes).tolist() == [0, 1, 2, 4, 6]


def test_a_tria_with_an_inside_of_its_own_is_a_region():
    # the neighbour at the other side of the corner's diagonal, held at three nodes as a pad
    found = share(CORNER, 9, {HELD: [1, 2, 3]})
    assert found.region.tolist() == [0, 1, 0, 0, 0]


def test_a_corner_of_a_held_area_belongs_to_it():
    found = share(CORNER, 9, {HELD: range(9)})
    assert found.region.tolist() == [0] * 5
    assert found.shared == [{HELD}]


def test_new_nodes_get_what_their_region_shares():
    elements = grid(4, 2)
    found = share(elements, 15, {HELD: range(9), COLD: range(15)})
    points = np.array([(i, j, 0.0) for i in range(5) for j in range(3)])
    mesh = ShellMesh.build(points, elements, region=found.region)

    def fan(row, new):
        a, b, c, d = elements[row]
        return [(p, q, new, NO_NODE) for p, q in ((a, b), (b, c), (c, d), (d, a))]

    edit = Edit(
        removed=np.array([0, 7]),
        added_points=points[[0, 10]] + (0.5, 0.5, 0.0),
        added_elements=np.array([*fan(0, 15), *fan(7, 16)], np.int32),
        added_region=np.repeat(found.region[[0, 7]], 4),
    )
    got = memberships_of_new_nodes(apply(mesh, edit), found.shared)
    assert got == {15: {HELD, COLD}, 16: {COLD}}
    assert rows_by_membership(got) == {HELD: [15], COLD: [15, 16]}


items = st.sampled_from([HELD, COLD, WARM, RIGID, Membership("CD", 7), Membership("PS", "345")])


@given(
    st.lists(st.frozensets(items, max_size=4), min_size=12, max_size=12),
    st.lists(st.integers(0, 1), min_size=6, max_size=6),
    st.integers(0, 63),
)
def test_whatever_nodes_have_a_region_gives_no_more_than_its_elements_share(own, region, split):
    elements = []
    for row, (a, b, c, d) in enumerate(grid(3, 2).tolist()):
        halves = [[a, b, c, NO_NODE], [a, c, d, NO_NODE]]
        elements += halves if split >> row & 1 else [[a, b, c, d]]
    elements = np.array(elements, np.int32)
    regions = np.resize(np.array(region, np.int32), len(elements))
    found = share_memberships(elements, regions, own)
    for row, nodes in enumerate(elements.tolist()):
        mine = [own[node] for node in nodes if node != NO_NODE]
        shared = frozenset.intersection(*mine)
        given_ = found.shared[found.region[row]]
        assert found.before[found.region[row]] == regions[row]
        assert given_ <= shared
        # only a tria gives up what its nodes share
        assert given_ == shared or nodes[3] == NO_NODE
        if not found.locked_elements[row]:
            assert all(item.can_grow for item in given_)
        for node in nodes:
            if node != NO_NODE and not found.locked_nodes[node]:
                # what a free node has is had by every node that takes its place
                assert own[node] == given_
    names = [(regions[row], found.shared[number]) for row, number in enumerate(found.region)]
    numbers = dict(zip(names, found.region.tolist(), strict=True))
    assert [numbers[name] for name in names] == found.region.tolist()
    assert len(numbers) == len(found.shared)
