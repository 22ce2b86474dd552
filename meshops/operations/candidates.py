"""Candidates: many small edits of one mesh, each to be judged on its own."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops.edit import Edit
from meshops.mesh import Floats, Ints


@dataclass(frozen=True, eq=False)
class Candidates:
    """K local edits as ragged arrays: candidate k has the rows from ``start[k]`` to ``start[k+1]``.

    Node rows from the mesh's node count N on stand for the candidate's own new points, in order.

    Attributes
    ----------
    removed_start, removed : (K + 1,) int32, (R,) int32
        Rows of the elements that go.
    added_start, added : (K + 1,) int32, (B, 4) int32
        Elements that come in their place; a tria has ``NO_NODE`` last.
    point_start, points : (K + 1,) int32, (A, 3) float64
        New points.
    moved_start, moved, moved_to : (K + 1,) int32, (D,) int32, (D, 3) float64
        Nodes that get another place.
    """

    removed_start: Ints
    removed: Ints
    added_start: Ints
    added: Ints
    point_start: Ints
    points: Floats
    moved_start: Ints
    moved: Ints
    moved_to: Floats

    def __len__(self) -> int:
        return len(self.removed_start) - 1

    def edit(self, k: int, region: Ints) -> Edit:
        """Return candidate k as an Edit; `region` (M,) is that of the mesh's elements."""
        removed = self.removed[self.removed_start[k] : self.removed_start[k + 1]]
        added = self.added[self.added_start[k] : self.added_start[k + 1]]
        moved = slice(self.moved_start[k], self.moved_start[k + 1])
        return Edit(
            removed=removed,
            added_points=self.points[self.point_start[k] : self.point_start[k + 1]],
            added_elements=added,
            added_region=np.full(len(added), region[removed[0]] if len(removed) else 0, np.int32),
            moved=self.moved[moved],
            moved_to=self.moved_to[moved],
        )
