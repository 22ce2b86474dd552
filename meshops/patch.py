"""Patch: the one way out of a mesh and back into it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from meshops.edit import Edit
from meshops.mesh import NO_NODE, Bools, Floats, Ints, ShellMesh
from meshops.topology import Topology


@dataclass(frozen=True, eq=False)
class Patch:
    """Connected elements of one region, cut out along every barrier.

    Attributes
    ----------
    points : (n, 3) float64
        Patch nodes; those of the border come first.
    elements : (m, 4) int32
        The elements on patch nodes.
    border : (b, 2) int32
        Border edges, each in the direction of its element.
    border_nodes : int
        How many of the patch nodes are on the border.
    rows : (m,) int32
        The mesh row of each element.
    nodes : (n,) int32
        The mesh row of each node. A node on a slit has two patch nodes.
    region : int
    """

    points: Floats
    elements: Ints
    border: Ints
    border_nodes: int
    rows: Ints
    nodes: Ints
    region: int


def components(topology: Topology, selected: Bools) -> list[Ints]:
    """Split a selection of elements, (M,) bool, into patches that can be cut out.

    Elements that must stay are left out. Each is a list of element rows, ascending.
    """
    label = topology.graph.label_components(selected & topology.editable)
    chosen = np.nonzero(label >= 0)[0].astype(np.int32)
    if not len(chosen):
        return []
    order = np.argsort(label[chosen], kind="stable")
    ends = np.cumsum(np.bincount(label[chosen]))[:-1]
    return np.split(chosen[order], ends)


def extract(topology: Topology, rows: Ints) -> Patch:
    """Cut out one component; `rows` ascending."""
    return next(extract_each(topology, [rows]))


def extract_each(topology: Topology, components: Iterable[Ints]) -> Iterator[Patch]:
    """Cut out components; the rows of each ascending."""
    mesh = topology.mesh
    for rows in components:
        elements, nodes, border = topology.graph.cut(rows, mesh.elements)
        yield Patch(
            points=mesh.points[nodes],
            elements=elements,
            border=border,
            border_nodes=int(border.max()) + 1 if len(border) else 0,
            rows=rows,
            nodes=nodes,
            region=int(mesh.region[rows[0]]),
        )


def stitch(mesh: ShellMesh, patch: Patch, points: Floats, elements: Ints) -> Edit:
    """Put other elements in the place of a patch.

    `points` are the new inner nodes; `elements` name border nodes by their patch row, and inner
    ones from ``patch.border_nodes`` on.
    """
    count = patch.border_nodes
    rows = np.full(count + len(points) + 1, NO_NODE, np.int32)  # no node, -1, is the last row
    rows[:count] = patch.nodes[:count]
    rows[count:-1] = np.arange(len(mesh.points), len(mesh.points) + len(points))
    return Edit(
        removed=patch.rows,
        added_points=points,
        added_elements=rows[elements],
        added_region=np.full(len(elements), patch.region, np.int32),
    )


def without_doubles(mesh: ShellMesh, edits: Iterable[Edit]) -> list[Edit]:
    """Leave out edits that put an element on the nodes of another one.

    That may be one that a patch cannot see, as across a T-junction, or of an edit before.
    """
    done = list(edits)
    count = len(mesh.points)
    brought = [_on_old_nodes(edit, count) for edit in done]
    wanted = {nodes for keys in brought for nodes in keys}
    if not wanted:
        return done
    is_near = np.zeros(count + 1, bool)
    is_near[list({node for nodes in wanted for node in nodes})] = True
    is_near[NO_NODE] = True
    near = np.flatnonzero(is_near[mesh.elements].all(axis=1))
    there: dict[tuple[int, ...], set[int]] = {}
    for row, nodes in zip(
        near.tolist(), np.sort(mesh.elements[near], axis=1).tolist(), strict=True
    ):
        there.setdefault(tuple(nodes), set()).add(row)
    kept: list[Edit] = []
    for edit, keys in zip(done, brought, strict=True):
        own = {*edit.removed.tolist(), *edit.rewired.tolist()}
        if len(set(keys)) == len(keys) and all(there.get(nodes, set()) <= own for nodes in keys):
            kept.append(edit)
            for nodes in keys:
                there.setdefault(nodes, set()).add(NO_NODE)
    return kept


def _on_old_nodes(edit: Edit, count: int) -> list[tuple[int, ...]]:
    """Nodes, ascending, of what an edit brings that has none of its new nodes."""
    elements = np.concatenate([edit.rewired_to, edit.added_elements])
    old = elements[(elements < count).all(axis=1)]
    return [tuple(nodes) for nodes in np.sort(old, axis=1).tolist()]


def join(mesh: ShellMesh, edits: list[Edit]) -> Edit:
    """One edit of several that touch different patches of the same mesh."""
    if len(edits) == 1:
        return edits[0]
    if not edits:
        return Edit()
    n = len(mesh.points)
    shifts = np.cumsum([0] + [len(e.added_points) for e in edits[:-1]], dtype=np.int32)

    def shifted(elements: list[Ints]) -> Ints:
        return np.concatenate(
            [np.where(e >= n, e + shift, e) for e, shift in zip(elements, shifts, strict=True)]
        )

    return Edit(
        removed=np.concatenate([e.removed for e in edits]),
        rewired=np.concatenate([e.rewired for e in edits]),
        rewired_to=shifted([e.rewired_to for e in edits]),
        added_points=np.concatenate([e.added_points for e in edits]),
        added_elements=shifted([e.added_elements for e in edits]),
        added_region=np.concatenate([e.added_region for e in edits]),
        moved=np.concatenate([e.moved for e in edits]),
        moved_to=np.concatenate([e.moved_to for e in edits]),
    )
