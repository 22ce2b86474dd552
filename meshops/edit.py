"""Edit: what an operation does to a mesh, as a value."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from meshops.mesh import NEW, NO_NODE, Bools, Floats, Ints, ShellMesh


def _no_rows() -> Ints:
    return np.zeros(0, np.int32)


def _no_elements() -> Ints:
    return np.zeros((0, 4), np.int32)


def _no_points() -> Floats:
    return np.zeros((0, 3))


@dataclass(frozen=True, eq=False)
class Edit:
    """The difference between two meshes.

    Node rows at or beyond the mesh's node count stand for ``added_points``.

    Attributes
    ----------
    removed : (K,) int32
        Rows of the elements that go.
    rewired, rewired_to : (C,) int32, (C, 4) int32
        Elements that keep their identity but get other nodes (a quad may become a tria).
    added_points : (A, 3) float64
    added_elements, added_region : (B, 4) int32, (B,) int32
    moved, moved_to : (D,) int32, (D, 3) float64
        Nodes that get another place.
    """

    removed: Ints = field(default_factory=_no_rows)
    rewired: Ints = field(default_factory=_no_rows)
    rewired_to: Ints = field(default_factory=_no_elements)
    added_points: Floats = field(default_factory=_no_points)
    added_elements: Ints = field(default_factory=_no_elements)
    added_region: Ints = field(default_factory=_no_rows)
    moved: Ints = field(default_factory=_no_rows)
    moved_to: Floats = field(default_factory=_no_points)

    @property
    def is_empty(self) -> bool:
        """Whether the edit changes nothing."""
        return not (
            len(self.removed) or len(self.rewired) or len(self.added_elements) or len(self.moved)
        )

    def points_after(self, mesh: ShellMesh) -> Floats:
        """(N + A, 3) coordinates with moves and additions, before nodes are renumbered."""
        points = np.concatenate([mesh.points, self.added_points])
        points[self.moved] = self.moved_to
        return points


def apply(mesh: ShellMesh, edit: Edit) -> ShellMesh:
    """Apply the edit and renumber: rows stay compact, nodes that no element uses are dropped.

    Elements and nodes that stay keep their order and their deck ids; what is added comes last.
    Locked nodes stay even where no element uses them.
    """
    points = edit.points_after(mesh)
    kept = np.ones(len(mesh.elements), bool)
    kept[edit.removed] = False
    rewired = mesh.elements.copy()
    rewired[edit.rewired] = edit.rewired_to
    elements = np.concatenate([rewired[kept], edit.added_elements])
    new_nodes, new_elements = len(edit.added_points), len(edit.added_elements)
    locked_nodes = np.concatenate([mesh.locked_nodes, np.zeros(new_nodes, bool)])
    used = _used_nodes(elements, len(points)) | locked_nodes
    rows = np.cumsum(used, dtype=np.int32) - np.int32(1)
    renumbered = np.where(elements == NO_NODE, np.int32(NO_NODE), rows[elements])
    return ShellMesh.build(
        points=points[used],
        elements=renumbered,
        region=np.concatenate([mesh.region[kept], edit.added_region]),
        locked_nodes=locked_nodes[used],
        locked_elements=np.concatenate([mesh.locked_elements[kept], np.zeros(new_elements, bool)]),
        node_ids=np.concatenate([mesh.node_ids, np.full(new_nodes, NEW)])[used],
        element_ids=np.concatenate([mesh.element_ids[kept], np.full(new_elements, NEW)]),
    )


def _used_nodes(elements: Ints, nodes: int) -> Bools:
    used = np.zeros(nodes, bool)
    used[elements[elements != NO_NODE]] = True
    return used
