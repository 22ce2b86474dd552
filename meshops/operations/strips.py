"""Strips of a workpiece: where the operations that reach across many elements work."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from meshops import _core
from meshops.mesh import Bools, Ints
from meshops.operations.places import nearest_first
from meshops.operations.ragged import picked
from meshops.workpiece import Workpiece

SWEEPS = 2
"""Of relaxation, where new nodes begin in good places: on the plate a third one gains nothing."""


@dataclass(frozen=True, eq=False)
class Strips:
    """Strips as lists one behind the other: elements, each across a crossable edge from the last.

    A strip has *cells*, the elements, and *rungs*, the edges between one cell and the next.

    Attributes
    ----------
    start : (S + 1,) int32
        Strip s has the places from ``start[s]`` to ``start[s + 1]``.
    cells : (C,) int32
        Element rows.
    rungs : (C, 2) int32
        The edge between a cell and the next one, in the direction of the cell. The last rung of a
        strip leads back to its first cell, or is -1, -1 where the strip is open.
    """

    start: Ints
    cells: Ints
    rungs: Ints

    @classmethod
    def straight(cls, workpiece: Workpiece, trias: Ints, *, reach: int, steps: int) -> Self:
        """Go straight from `trias` to others behind `reach` quads or into `steps` quads."""
        return cls(
            *_core.straight_strips(workpiece.mesh.elements, workpiece.topology, trias, reach, steps)
        )

    @classmethod
    def closed(cls, workpiece: Workpiece) -> Self:
        """Find all rows of quads that close on themselves."""
        return cls(*_core.closed_strips(workpiece.mesh.elements, workpiece.topology))

    @classmethod
    def walks(
        cls, workpiece: Workpiece, trias: Ints, *, reach: int, steps: int, partners: int
    ) -> Self:
        """Find the shortest ways from `trias` to other trias and to the quads within `steps`."""
        return cls(
            *_core.shortest_strips(
                workpiece.mesh.elements, workpiece.topology, trias, reach, steps, partners
            )
        )

    def __len__(self) -> int:
        return len(self.start) - 1

    @property
    def lengths(self) -> Ints:
        """(S,) number of cells."""
        lengths: Ints = np.diff(self.start)
        return lengths

    def __add__(self, other: Strips) -> Strips:
        return Strips(
            np.concatenate([self.start, self.start[-1] + other.start[1:]]),
            np.concatenate([self.cells, other.cells]),
            np.concatenate([self.rungs, other.rungs]),
        )

    def take(self, rows: Ints) -> Strips:
        """Only some of the strips, in the order of `rows`; a row may come more than once."""
        start, places = picked(self.start, rows)
        return Strips(start, self.cells[places], self.rungs[places])

    def ranked(self, workpiece: Workpiece, most: int) -> Strips:
        """At most so many strips: those that join two trias first, the open ones last.

        Of these the shorter ones first, then those nearest to the worst element.
        """
        if not len(self):
            return self
        last = self.start[1:] - 1
        joins: Bools = workpiece.mesh.is_tria[self.cells[last]]
        is_open: Bools = self.rungs[last, 0] < 0
        nearest = np.minimum.reduceat(nearness(workpiece)[self.cells], self.start[:-1])
        order = np.lexsort((nearest, self.lengths, is_open & ~joins, ~joins))
        return self.take(order[:most].astype(np.int32))


def worst_trias(workpiece: Workpiece, most: int) -> Ints:
    """Rows of at most so many trias that may be taken out, worst first."""
    bad = workpiece.bad_elements
    trias: Ints = bad[workpiece.mesh.is_tria[bad]][:most]
    return trias


def nearness(workpiece: Workpiece) -> Ints:
    """(M,) int32: place of each element in the order of `nearest_first`, 0 for the worst."""
    rows = np.arange(len(workpiece.mesh.elements), dtype=np.int32)
    places = np.empty_like(rows)
    places[nearest_first(workpiece, rows[:, None])] = rows
    return places
