"""What a file says at its nodes and elements, on the mesh that edits have made of it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.edit import Edit, apply
from meshops.formats.carrying import Carried, is_numbering
from meshops.formats.grid import Grid, Others, shells_of
from meshops.formats.ids import IdSet
from meshops.mesh import NO_NODE, ShellMesh
from tests.decks import bad_plate
from tests.meshes import cylinder, sheet


def carried(before, after):
    return Carried.of(before, after, IdSet(), IdSet())


def refined(mesh, seed, share=0.3):
    """Some elements become fans around a new node, and some inner nodes move a little."""
    rng = np.random.default_rng(seed)
    removed = np.flatnonzero(rng.random(len(mesh.elements)) < share)
    places, fans, regions = [], [], []
    for element in removed:
        nodes = mesh.elements[element][mesh.elements[element] != NO_NODE]
        weights = rng.dirichlet(np.ones(len(nodes)))
        new = len(mesh.points) + len(places)
        places.append(weights @ mesh.points[nodes])
        fans += [[a, b, new, NO_NODE] for a, b in zip(nodes, np.roll(nodes, -1), strict=True)]
        regions += [mesh.region[element]] * len(nodes)
    moved = np.flatnonzero(rng.random(len(mesh.points)) < share)
    return apply(
        mesh,
        Edit(
            removed=removed,
            added_points=np.array(places).reshape(-1, 3),
            added_elements=np.array(fans).reshape(-1, 4),
            added_region=np.array(regions),
            moved=moved,
            moved_to=mesh.points[moved] + rng.uniform(-0.05, 0.05, (len(moved), 3)) * [1, 1, 0],
        ),
    )


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 999), slope=st.tuples(*[st.floats(-5, 5)] * 3))
def test_a_linear_field_stays_one_on_a_plate(seed, slope):
    """Quads of no distortion but in their plane are split, so that it is exact."""
    before = bad_plate(seed=seed)
    after = refined(before, seed)
    # nodes that have left the plate have the value of its border
    low, high = before.points.min(axis=0), before.points.max(axis=0)
    within = ((after.points >= low) & (after.points <= high)).all(axis=1)
    field = before.points @ np.array(slope) + 3.0
    found = carried(before, after).node_values(field)
    expected = after.points @ np.array(slope) + 3.0
    np.testing.assert_allclose(found[within], expected[within], atol=1e-9)
    assert found.min() >= field.min() - 1e-9
    assert found.max() <= field.max() + 1e-9


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 999), value=st.floats(-1e30, 1e30))
def test_what_is_the_same_everywhere_stays_so_bit_for_bit(seed, value):
    before = cylinder(sheet(5, 4, seed=seed, jitter=0.2, trias=0.4))
    after = refined(before, seed)
    found = carried(before, after)
    assert (found.node_values(np.full(len(before.points), value)) == value).all()
    single = np.full((len(before.points), 2), value, np.float32)
    assert (found.node_values(single) == single[0]).all()
    assert (found.element_values(np.full(len(before.elements), value)) == value).all()


def test_what_has_no_value_hides_no_other_one():
    before = sheet(3, 3)
    values = before.points[:, 0].copy()
    values[0] = np.nan
    after = refined(before, 3, share=1.0)
    found = carried(before, after).node_values(values)
    assert np.isfinite(found).sum() > 0.6 * len(found)
    values[:] = np.nan
    assert np.isnan(carried(before, after).node_values(values)).all()


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 999))
def test_a_new_element_has_the_values_of_its_own_region(seed):
    plate = bad_plate(seed=seed)
    side = np.array([plate.points[e[e != NO_NODE], 0].mean() > 25 for e in plate.elements])
    before = ShellMesh.build(plate.points, plate.elements, region=np.where(side, 7, 3))
    after = refined(before, seed)
    found = carried(before, after)
    assert (found.element_values(before.region) == after.region).all()


def test_numberings_go_on():
    before = sheet(2, 2)
    after = refined(before, 1, share=1.0)
    found = carried(before, after)
    numbers = np.arange(50, 50 + len(before.points))
    new = int((after.node_ids == 0).sum())
    values = found.node_values(numbers)
    assert sorted(values.tolist()) == list(range(50, 50 + len(before.points) + new))
    assert not is_numbering(np.array([1, 2, 2]))
    assert not is_numbering(np.array([1.0, 2.0]))
    assert not is_numbering(np.arange(200, 256, dtype=np.uint8))


# --- the mesh within a grid ---------------------------------------------------------------------


def grid(corners, **more):
    x, y = (a.ravel() for a in np.meshgrid(np.arange(4.0), np.arange(3.0)))
    points = np.stack([x, y, 0 * x], axis=1)
    rows = np.array(corners, np.int64)
    given = {"parts": np.ones(len(rows), np.int64)} | more
    return Grid("m.x", points, np.arange(1, 13), rows, np.arange(1, len(rows) + 1), **given)


def made(found):
    return shells_of(found, lambda row: f"point {row}", lambda row: f"cell {row}")


ROW = [[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6]]


def test_cells_on_the_same_nodes_are_one_element():
    shells = made(grid([*ROW, [5, 4, 0, 1]], parts=np.array([1, 1, 1, 9])))
    assert shells.element_of.tolist() == [0, 1, 2, 0]
    assert not shells.mesh.locked_elements.any()
    assert shells.mesh.region.tolist() == [10, 1, 1]
    assert shells.notes == ("1 cells lie on the nodes of others: they are edited together.",)


def test_cells_on_the_same_nodes_that_look_the_other_way_are_locked():
    shells = made(grid([*ROW, [4, 5, 1, 0]]))
    assert shells.mesh.locked_elements.tolist() == [True, False, False]
    assert [lock.count for lock in shells.locks] == [1]


@pytest.mark.parametrize(
    ("others", "nodes", "elements"),
    [
        ([Others(np.array([[0, 4]]), 1)], {1, 5}, []),
        ([Others(np.array([[1, 5]]), 1)], {2, 6}, [1]),
        ([Others(np.array([[1, 6]]), 1)], {2, 7}, []),
        ([Others(np.array([[0, 1, 5, 4, 8, 9, 10, 11]]), 3)], {1, 2, 5, 6}, [1]),
        ([Others(np.array([[3]]), 0)], {4}, []),
    ],
)
def test_what_other_cells_name_is_locked(others, nodes, elements):
    mesh = made(grid(ROW, others=others)).mesh
    assert set(mesh.node_ids[mesh.locked_nodes].tolist()) == nodes
    assert mesh.element_ids[mesh.locked_elements].tolist() == elements


def test_a_line_between_two_regions_locks_no_element():
    lines = [Others(np.array([[1, 5]]), 1)]
    assert not made(grid(ROW, others=lines, parts=np.array([1, 2, 2]))).mesh.locked_elements.any()


def test_parts_beyond_what_a_region_can_be_are_counted():
    parts = np.array([2**40, 5, 2**40])
    assert made(grid(ROW, parts=parts)).mesh.region.tolist() == [2, 1, 2]
