"""Swap an edge: the edge between two elements is turned within the polygon around them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from meshops.kernels.local_edits import pair_polygons
from meshops.mesh import Ints
from meshops.operations.candidates import Candidates
from meshops.operations.places import crossable_pairs, nearest_first
from meshops.operations.relax import relax
from meshops.operations.sites import SiteOperation
from meshops.workpiece import Workpiece

_TURNS = {
    6: (((1, 2, 3, 4), (4, 5, 0, 1)), ((2, 3, 4, 5), (5, 0, 1, 2))),
    5: (((4, 0, 1, -1), (1, 2, 3, 4)), ((2, 3, 4, -1), (4, 0, 1, 2))),
    4: (((1, 2, 3, -1), (3, 0, 1, -1)),),
}
"""For each size of the polygon: the two elements of each turn, as places of the polygon."""


@dataclass(frozen=True)
class SwapEdge(SiteOperation):
    """Turn the edge between two elements, then relax the nodes around.

    Between two quads it turns to one of the two other long diagonals of their hexagon; between a
    quad and a tria the tria changes its place in their pentagon; between two trias it becomes the
    other diagonal.
    """

    variants: ClassVar[int] = 2
    nested: ClassVar[bool] = True
    name: str = "swap-edge"
    code: int = 3

    def candidates(self, workpiece: Workpiece) -> Candidates:
        """Two turns of each edge; the second of two trias is empty."""
        pairs = crossable_pairs(workpiece)
        pairs = pairs[nearest_first(workpiece, pairs)[: self.pool]]
        polygons, sizes = pair_polygons(workpiece.mesh.elements, pairs)
        removed = np.full((len(pairs), 2, 2), -1, np.int32)
        added = np.full((len(pairs), 2, 2, 4), -1, np.int32)
        for size, turns in _TURNS.items():
            rows = np.nonzero(sizes == size)[0]
            for variant, turn in enumerate(turns):
                removed[rows, variant] = pairs[rows]
                added[rows, variant] = _at_places(polygons[rows], turn)
        return relax(workpiece, Candidates.padded(removed.reshape(-1, 2), added.reshape(-1, 2, 4)))


def _at_places(polygons: Ints, elements: tuple[tuple[int, ...], ...]) -> Ints:
    """(S, E, 4) nodes of elements that are given as places of a polygon, -1 for none."""
    places = np.array(elements)
    return np.where(places >= 0, polygons[:, places], np.int32(-1))
