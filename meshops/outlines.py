"""Outlines of the zones of a raw surface, divided into edges of a size."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from meshops.curves import Curve, curves_of, even_divisions
from meshops.mesh import Floats, Ints
from meshops.topology import Topology
from meshops.zones import Zone


@dataclass(frozen=True, eq=False)
class Outlines:
    """The divided curves of a surface.

    Attributes
    ----------
    points : (n, 3) float64
        Nodes on all curves.
    nodes : list of list of int
        Rows of each curve's nodes in ``points``, in its direction.
    places : dict
        The curve of each directed raw edge, whether it is the first of the curve in that
        direction, and whether that is the curve's own.
    """

    points: Floats
    nodes: list[list[int]]
    places: dict[tuple[int, int], tuple[int, bool, bool]]

    @classmethod
    def of(cls, raw: Topology, zones: list[Zone], size: float, finer: Ints) -> Outlines:
        """Chain the edges between zones and divide them, an even number of edges for each zone.

        `finer` (Z,): how many times as finely as at the size the border of each zone is divided.
        """
        label = np.empty(len(raw.mesh.elements), np.int32)
        for number, zone in enumerate(zones):
            label[zone.rows] = number
        lines = ~zones[0].topology.crossable
        curves = curves_of(raw.mesh.points, raw.edges[lines], ~raw.crossable[lines])
        sides_of: dict[tuple[int, int], list[int]] = {}
        for zone_number, edges in zip(label.tolist(), raw.element_edges.tolist(), strict=True):
            for edge in edges[:3]:
                if lines[edge]:
                    a, b = raw.edges[edge].tolist()
                    sides_of.setdefault((a, b), []).append(zone_number)
        sides = [tuple(sides_of[_undirected(*curve.nodes[:2])]) for curve in curves]
        counts = [
            curve.divisions(size) * int(finer[list(zones_beside)].max())
            for curve, zones_beside in zip(curves, sides, strict=True)
        ]
        counts = even_divisions(counts, sides)
        return cls._divided(curves, counts)

    @classmethod
    def _divided(cls, curves: list[Curve], counts: list[int]) -> Outlines:
        points: list[Floats] = []
        rows: list[list[int]] = []
        corner_rows: dict[int, int] = {}
        places = {}

        def row_of(corner: int, place: Floats) -> int:
            if corner not in corner_rows:
                corner_rows[corner] = len(points)
                points.append(place)
            return corner_rows[corner]

        for number, (curve, count) in enumerate(zip(curves, counts, strict=True)):
            divided = curve.divided(count)
            first = row_of(curve.nodes[0], divided[0])
            last = row_of(curve.nodes[-1], divided[-1])
            inner = list(range(len(points), len(points) + count - 1))
            points.extend(divided[1:-1])
            rows.append([first, *inner, last])
            steps = len(curve.nodes) - 1
            for i, (a, b) in enumerate(pairwise(curve.nodes)):
                places[a, b] = (number, i == 0, True)
                places[b, a] = (number, i == steps - 1, False)
        return cls(np.array(points).reshape(-1, 3), rows, places)

    def loop(self, nodes: list[int]) -> list[int]:
        """Rows of the divided border that runs along a closed raw one."""
        rows: list[int] = []
        for a, b in zip(nodes, nodes[1:] + nodes[:1], strict=True):
            number, is_first, forward = self.places[a, b]
            if is_first:
                rows += (self.nodes[number] if forward else self.nodes[number][::-1])[:-1]
        return rows


def _undirected(a: int, b: int) -> tuple[int, int]:
    return (a, b) if a < b else (b, a)


def loops_of(border: Ints) -> list[list[int]]:
    """Chain border edges (b, 2) to closed loops: their nodes in order."""
    ahead = dict(border.tolist())
    loops = []
    while ahead:
        node = next(iter(ahead))
        loop = []
        while node in ahead:
            loop.append(node)
            node = ahead.pop(node)
        loops.append(loop)
    return loops
