"""Candidates: many small edits of one mesh, each to be judged on its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self, TypeVar

import numpy as np

from meshops.edit import Edit
from meshops.mesh import Bools, Floats, Ints

Values = TypeVar("Values", Ints, Floats)

CandidateArrays = tuple[Ints, Ints, Ints, Ints, Ints, Floats, Ints, Ints, Floats]


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

    @classmethod
    def padded(
        cls,
        removed: Ints,
        added: Ints,
        points: Floats | None = None,
        moved: Ints | None = None,
        moved_to: Floats | None = None,
    ) -> Self:
        """Make candidates of arrays with the same number of places for each of them.

        Parameters
        ----------
        removed : (K, R) int32
            -1 where a place is empty.
        added : (K, B, 4) int32
            The first node is -1 where a place is empty.
        points : (K, A, 3) float64
            NaN where a place is empty; only the last ones of a candidate may be.
        moved, moved_to : (K, D) int32, (K, D, 3) float64
            -1 where a place is empty.
        """
        count = len(removed)
        points = np.zeros((count, 0, 3)) if points is None else points
        moved = np.zeros((count, 0), np.int32) if moved is None else moved
        moved_to = np.zeros((*moved.shape, 3)) if moved_to is None else moved_to
        has_point = ~np.isnan(points[:, :, 0])
        return cls(
            *_packed(removed, removed >= 0),
            *_packed(added, added[:, :, 0] >= 0),
            *_packed(points, has_point),
            *_packed(moved, moved >= 0),
            _packed(moved_to, moved >= 0)[1],
        )

    def __len__(self) -> int:
        return len(self.removed_start) - 1

    @property
    def arrays(self) -> CandidateArrays:
        """All arrays, in the order of the attributes."""
        return (
            self.removed_start,
            self.removed,
            self.added_start,
            self.added,
            self.point_start,
            self.points,
            self.moved_start,
            self.moved,
            self.moved_to,
        )

    def take(self, rows: Ints) -> Candidates:
        """Only some of the candidates, in the order of `rows`."""
        removed_start, removed = _rows_of(self.removed_start, rows)
        added_start, added = _rows_of(self.added_start, rows)
        point_start, points = _rows_of(self.point_start, rows)
        moved_start, moved = _rows_of(self.moved_start, rows)
        return Candidates(
            removed_start,
            self.removed[removed],
            added_start,
            self.added[added],
            point_start,
            self.points[points],
            moved_start,
            self.moved[moved],
            self.moved_to[moved],
        )

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


def _starts(counts: Ints) -> Ints:
    start = np.zeros(len(counts) + 1, np.int32)
    np.cumsum(counts, out=start[1:])
    return start


def _packed(values: Values, used: Bools) -> tuple[Ints, Values]:
    """Leave out the places that are not used."""
    return _starts(np.count_nonzero(used, axis=1)), values[used]


def _rows_of(start: Ints, rows: Ints) -> tuple[Ints, Ints]:
    """Where candidates `rows` will start, and the entries that they have now."""
    counts = start[rows + 1] - start[rows]
    starts = _starts(counts)
    shift = np.repeat(start[rows] - starts[:-1], counts)
    return starts, np.arange(starts[-1], dtype=np.int32) + shift
