"""Slide: move the nodes of a place, those on a border of the mesh along that border."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops.edit import Edit
from meshops.mesh import Bools, Floats, Ints
from meshops.operations.smooth import SmoothSpace
from meshops.workpiece import Workpiece

LINE_TOLERANCE = 0.005
"""Of a border edge: how far the new border may be from the old one. A hundredth is promised; it is
seen at a few points of an edge, between which it may be a little more."""

SHIFTS = (0.0, 0.25, -0.25)
"""Of an edge: what all border nodes at failing elements do before each looks for its own place."""


@dataclass(frozen=True, eq=False)
class Curves:
    """What border nodes slide along.

    Attributes
    ----------
    neighbours : (n, 2) int32
        The node before and after each that slides, along its border; elsewhere -1.
    segments : (R, 6) float64
        Both ends of each piece of the borders.
    tolerance : float
        How far from them a node and its border edges may be, of its shortest edge.
    """

    neighbours: Ints
    segments: Floats
    tolerance: float


@dataclass(frozen=True)
class Slide:
    """Move the free nodes around one or two bad elements, and border nodes along their border.

    As `Smooth` by ``even``, which a border does not hold back here: where a strip is narrower than
    an edge may be short, its edges across pass once they are askew. A corner stays, and so does a
    node that something hangs on or at which three and more elements meet. The border stays where
    the run found it, within a hundredth of an edge. A place is a rank, the rings around it, and
    whether the border nodes are all shifted first, and which way.
    """

    name: str = "slide"
    code: int = 26

    def search_space(self, workpiece: Workpiece, rng: np.random.Generator) -> SlideSpace | None:
        """Genomes are places; the random generator is not needed."""
        space = SlideSpace(workpiece)
        return space if space.slides.any() and len(workpiece.bad_elements) else None

    def apply(self, workpiece: Workpiece, parameters: Ints) -> Edit:
        """Slide in places (K, 3) one after the other; ranks that are not there are skipped.

        Raises ValueError where there is no such shift.
        """
        for shift in parameters[:, 2:].ravel():
            if not 0 <= shift < len(SHIFTS):
                raise ValueError(f"there is no shift {shift} to slide by")
        return SlideSpace(workpiece).edit(parameters)

    def format(self, parameters: Ints) -> str:
        """Places as ``3 r4 +``: rank, rings, shift."""
        return " ".join(
            f"{rank} r{rings}{('', ' +', ' -')[way]}" for rank, rings, way in parameters
        )


class SlideSpace(SmoothSpace):
    """One or two places on one mesh, as in `SmoothSpace` but with a shift for a method."""

    def __init__(self, workpiece: Workpiece) -> None:
        super().__init__(workpiece)
        self.rails = workpiece.surface.rails
        self.slides: Bools = workpiece.topology.sliding_nodes & (len(self.rails) > 0)

    @property
    def movable(self) -> Bools:
        """(N,) bool: nodes that may move."""
        return super().movable | self.slides

    def move(self, points: Floats, elements: Ints, rows: Ints, moves: Bools, place: Ints) -> Floats:
        """(n, 3) places of the nodes of a place once they have moved; see `SmoothSpace.move`."""
        topology = self.workpiece.topology
        local = np.full(len(self.workpiece.mesh.points) + 1, -1, np.int32)
        local[rows] = np.arange(len(rows), dtype=np.int32)
        neighbours = np.where(
            (moves & self.slides[rows])[:, None], local[topology.border_neighbours[rows]], -1
        ).astype(np.int32)
        return self.search(points, elements, "even").slide(
            points,
            elements,
            np.nonzero(moves)[0].astype(np.int32),
            Curves(neighbours, self.rails.reshape(-1, 6), LINE_TOLERANCE),
            SHIFTS[place[2]],
        )
