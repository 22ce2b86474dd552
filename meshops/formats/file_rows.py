"""The rows of a file whose points and cells have no ids but their order, after its edits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshops.formats.carrying import Carried, is_numbering
from meshops.formats.grid import Shells
from meshops.formats.ids import IdSet
from meshops.mesh import NEW, NO_NODE, Bools, Floats, Ids, ShellMesh


@dataclass(frozen=True, eq=False)
class FileRows:
    """Points and cells of an edited file: those that stay in their order, then the new ones.

    Attributes
    ----------
    carried : Carried
    points : (P, 3) float64
    point_from : (P,) int64
        Row of each point in the file that was read, -1 where it is new.
    point_of : (n,) int64
        Row of each point that was read in the new file, -1 where it is gone.
    cell_from : (C,) int64
        Row of each cell in the file that was read; of a new one that of the nearest.
    is_new : (C,) bool
    corners : (C, 4) int64
        Rows of the points of the shells that are edited, ``NO_NODE`` last in a tria; of all other
        cells ``NO_NODE`` throughout.
    node_point : (N,) int64
        Row of the point of each node of the edited mesh.
    """

    carried: Carried
    points: Floats
    point_from: Ids
    point_of: Ids
    cell_from: Ids
    is_new: Bools
    corners: Ids
    node_point: Ids

    @classmethod
    def of(
        cls, shells: Shells, after: ShellMesh, points: Floats, point_of: Ids, element_of: Ids
    ) -> FileRows:
        """Compare an edited mesh with that of a file.

        Parameters
        ----------
        shells : Shells
            Its node ids are rows of points, counted from 1.
        after : ShellMesh
        points : (n, 3) float64
            Of the file.
        point_of : (n,) int64
            The point that each of these has been welded to; itself where it has not been.
        element_of : (c,) int64
            Mesh row of each cell of the file, -1 where it is none of the mesh.
        """
        taken = IdSet(ranges={(1, len(points), 1)})
        cells = IdSet(ranges={(1, max(len(element_of), 1), 1)})
        carried = Carried.of(shells.mesh, after, taken, cells)
        after, d = carried.after, carried.difference
        gone = np.zeros(len(points), bool)
        gone[d.gone_nodes - 1] = True
        gone |= point_of != np.arange(len(points))
        kept = np.flatnonzero(~gone)
        number = np.full(len(points), -1, np.int64)
        number[kept] = np.arange(len(kept))
        old = carried.node_rows >= 0
        node_point = np.empty(len(after.points), np.int64)
        node_point[old] = number[after.node_ids[old] - 1]
        node_point[~old] = len(kept) + np.arange(np.count_nonzero(~old))
        all_points = np.concatenate([points[kept], after.points[~old]])
        all_points[node_point[d.moved]] = after.points[d.moved]
        cell_from, element = _cells(carried, element_of)
        corners = np.full((len(cell_from), 4), NO_NODE, np.int64)
        of_mesh = element >= 0
        nodes = after.elements[element[of_mesh]]
        corners[of_mesh] = np.where(nodes == NO_NODE, NO_NODE, node_point[nodes])
        is_new = np.zeros(len(cell_from), bool)
        is_new[of_mesh] = after.element_ids[element[of_mesh]] == NEW
        return cls(
            carried=carried,
            points=all_points,
            point_from=np.concatenate([kept, np.full(np.count_nonzero(~old), -1)]),
            point_of=number[point_of],
            cell_from=cell_from,
            is_new=is_new,
            corners=corners,
            node_point=node_point,
        )

    def is_rewired(self, was: Ids) -> Bools:
        """(C,) bool: which cells have other corners than (c, 4) rows of points that they had."""
        before = np.where(was == NO_NODE, NO_NODE, self.point_of[was])[self.cell_from]
        found: Bools = (self.corners != NO_NODE).any(axis=1) & (self.corners != before).any(axis=1)
        return found

    def point_values(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values at the points of the file (n, ...) as those of the new one (P, ...)."""
        found = values[np.maximum(self.point_from, 0)]
        new = self.point_from < 0
        if is_numbering(values):
            found[new] = values.max() + 1 + np.arange(np.count_nonzero(new))
            return found
        rows = self.carried.before.node_ids - 1
        found[self.node_point] = self.carried.node_values(values[rows])
        return found

    def cell_values(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values of the cells of the file (c, ...) as those of the new one (C, ...)."""
        found = values[self.cell_from]
        if is_numbering(values):
            found[self.is_new] = values.max() + 1 + np.arange(np.count_nonzero(self.is_new))
        return found


def _cells(carried: Carried, element_of: Ids) -> tuple[Ids, Ids]:
    """(C,) cells of the file that is written, as rows of that which was read, and mesh rows."""
    kept = np.flatnonzero(carried.after.element_ids != NEW)
    after = np.full(len(carried.before.elements), -1, np.int64)
    after[carried.element_rows[kept]] = kept
    inside = element_of >= 0
    element = np.where(inside, after[np.maximum(element_of, 0)], -1)
    stays = ~inside | (element >= 0)
    rows = np.flatnonzero(stays)
    # shells on the same nodes are edited together
    copies: dict[int, list[int]] = {}
    for row in np.flatnonzero(inside).tolist():
        copies.setdefault(int(element_of[row]), []).append(row)
    new = [
        (row, added)
        for added in np.flatnonzero(carried.after.element_ids == NEW).tolist()
        for row in copies[int(carried.element_rows[added])]
    ]
    added_rows = np.array(new, np.int64).reshape(-1, 2)
    cells = np.concatenate([rows, added_rows[:, 0]])
    elements = np.concatenate([element[rows], added_rows[:, 1]])
    return cells, elements
