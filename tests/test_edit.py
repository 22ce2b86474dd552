"""Edit and apply, against a model that keeps nodes and elements in dictionaries."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import STANDARD
from meshops.edit import Edit, apply
from meshops.fitness import Fitness
from meshops.mesh import NEW, ShellMesh
from meshops.quality_sums import IRREGULAR
from meshops.workpiece import Setting, Workpiece
from tests.meshes import meshes, sheet, with_

bounded = settings(max_examples=80, deadline=None)


@st.composite
def edits(draw):
    """A mesh with deck ids of its own, and a random edit of it."""
    mesh = draw(meshes(("plain", "regions", "locks")))
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    n, m = len(mesh.points), len(mesh.elements)
    mesh = with_(
        mesh,
        node_ids=rng.permutation(10 * n)[:n] + 1,
        element_ids=rng.permutation(10 * m)[:m] + 1,
    )
    chosen = rng.permutation(m)
    removed, rewired = np.split(chosen[: rng.integers(0, m + 1)], [rng.integers(0, m + 1)])
    new_nodes, new_elements = rng.integers(0, 5, 2)

    def elements(count):
        nodes = [rng.permutation(n + new_nodes)[:4] for _ in range(count)]
        result = np.reshape(nodes, (count, 4)).astype(np.int32)
        result[rng.random(count) < 0.4, 3] = -1
        return result

    moved = rng.permutation(n)[: rng.integers(0, 4)].astype(np.int32)
    return mesh, Edit(
        removed=removed.astype(np.int32),
        rewired=rewired.astype(np.int32),
        rewired_to=elements(len(rewired)),
        added_points=rng.normal(size=(new_nodes, 3)),
        added_elements=elements(new_elements),
        added_region=rng.integers(0, 9, new_elements).astype(np.int32),
        moved=moved,
        moved_to=rng.normal(size=(len(moved), 3)),
    )


def model(mesh, edit):
    """What the edit makes of the mesh: nodes and elements as dictionaries and plain lists."""
    n = len(mesh.points)
    nodes = {
        i: {"at": tuple(mesh.points[i]), "id": int(mesh.node_ids[i]), "lock": mesh.locked_nodes[i]}
        for i in range(n)
    }
    for i, point in enumerate(edit.added_points):
        nodes[n + i] = {"at": tuple(point), "id": NEW, "lock": False}
    for i, point in zip(edit.moved.tolist(), edit.moved_to, strict=True):
        nodes[i]["at"] = tuple(point)
    elements = {
        i: {
            "nodes": mesh.elements[i].tolist(),
            "region": int(mesh.region[i]),
            "id": int(mesh.element_ids[i]),
            "lock": bool(mesh.locked_elements[i]),
        }
        for i in range(len(mesh.elements))
    }
    for i, to in zip(edit.rewired.tolist(), edit.rewired_to.tolist(), strict=True):
        elements[i]["nodes"] = to
    for i in edit.removed.tolist():
        del elements[i]
    added = zip(edit.added_elements.tolist(), edit.added_region.tolist(), strict=True)
    for to, region in added:
        elements[len(mesh.elements) + len(elements)] = {
            "nodes": to, "region": region, "id": NEW, "lock": False
        }  # fmt: skip
    used = {node for element in elements.values() for node in element["nodes"]}
    staying = [node for node in nodes if node in used or nodes[node]["lock"]]
    number = {node: i for i, node in enumerate(staying)} | {-1: -1}
    for element in elements.values():
        element["nodes"] = [number[node] for node in element["nodes"]]
    return [nodes[node] for node in staying], list(elements.values())


@bounded
@given(edits())
def test_apply_does_what_the_model_does(case):
    mesh, edit = case
    nodes, elements = model(mesh, edit)
    after = apply(mesh, edit)
    assert list(map(tuple, after.points)) == [node["at"] for node in nodes]
    assert after.node_ids.tolist() == [node["id"] for node in nodes]
    assert after.locked_nodes.tolist() == [node["lock"] for node in nodes]
    assert after.elements.tolist() == [element["nodes"] for element in elements]
    assert after.region.tolist() == [element["region"] for element in elements]
    assert after.element_ids.tolist() == [element["id"] for element in elements]
    assert after.locked_elements.tolist() == [element["lock"] for element in elements]


@bounded
@given(edits())
def test_numbering_is_compact_and_deck_ids_last(case):
    mesh, edit = case
    after = apply(mesh, edit)
    used = set(after.elements[after.elements >= 0].tolist())
    assert used | set(np.nonzero(after.locked_nodes)[0]) == set(range(len(after.points)))
    old_nodes = after.node_ids[after.node_ids != NEW]
    old_elements = after.element_ids[after.element_ids != NEW]
    assert np.array_equal(old_nodes, mesh.node_ids[np.isin(mesh.node_ids, old_nodes)])
    assert np.array_equal(old_elements, np.delete(mesh.element_ids, edit.removed))
    assert np.isin(mesh.node_ids[mesh.locked_nodes], after.node_ids).all()


@bounded
@given(edits())
def test_an_edit_changes_no_array_of_its_mesh(case):
    mesh, edit = case
    before = {name: array.copy() for name, array in mesh.__getstate__().items()}
    apply(mesh, edit)
    assert all(np.array_equal(before[name], getattr(mesh, name)) for name in before)


@bounded
@given(edits())
def test_the_change_of_the_tally_is_that_of_the_meshes(case):
    mesh, edit = case
    setting = Setting(STANDARD.at(1.0), Fitness("quality", len(mesh.elements)))
    before, after = Workpiece(mesh, setting), Workpiece(apply(mesh, edit), setting)
    foretold = before.tally + before.tally_change(edit)
    # any edit may make barriers or take some away, which operations never do: see test_properties
    foretold[IRREGULAR] = after.tally[IRREGULAR]
    np.testing.assert_allclose(foretold, after.tally, atol=1e-9)


def test_an_empty_edit_gives_an_equal_mesh():
    mesh = sheet(3, 2)
    assert Edit().is_empty
    assert apply(mesh, Edit()).digest == mesh.digest


def test_equal_meshes_have_equal_digests_and_others_do_not():
    mesh = sheet(3, 2, seed=1, jitter=0.1)
    assert mesh.digest == sheet(3, 2, seed=1, jitter=0.1).digest
    points = mesh.points.copy()
    points[5, 0] = np.nextafter(points[5, 0], 9)
    others = [
        with_(mesh, points=points),
        with_(mesh, elements=np.roll(mesh.elements, 1, axis=1)),
        with_(mesh, region=np.ones(6)),
        with_(mesh, locked_nodes=np.arange(12) == 3),
        with_(mesh, locked_elements=np.arange(6) == 3),
        with_(mesh, node_ids=np.arange(12)),
        with_(mesh, element_ids=np.arange(6)),
    ]
    assert len({mesh.digest, *(other.digest for other in others)}) == len(others) + 1


def test_a_mesh_cannot_be_written_to():
    mesh = sheet(2, 2)
    with pytest.raises(ValueError, match="read-only"):
        mesh.points[0] = 1.0


@pytest.mark.parametrize(
    "arrays",
    [
        {"points": np.zeros((3, 2))},
        {"elements": [(0, 1, 2)]},
        {"elements": [(0, 1, 4, -1)]},
        {"elements": [(0, -1, 2, 3)]},
        {"elements": [(0, 1, 2, -2)]},
        {"region": [1, 2]},
        {"locked_nodes": [True]},
        {"locked_elements": [True, False]},
        {"node_ids": [1]},
        {"element_ids": []},
    ],
    ids=str,
)
def test_arrays_that_do_not_fit_are_refused(arrays):
    fitting = {"points": np.zeros((4, 3)), "elements": [(0, 1, 2, 3)]}
    ShellMesh.build(**fitting)
    with pytest.raises(ValueError, match=r"must be|names a node|need one value"):
        ShellMesh.build(**{**fitting, **arrays})
