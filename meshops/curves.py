"""Curves: the lines along which the zones of a surface meet, and their division into edges."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from heapq import heappop, heappush
from itertools import pairwise

import numpy as np

from meshops.mesh import Bools, Floats, Ints

CORNER = 40.0
"""Degrees that a feature line turns by at a node from which that node is a corner and stays."""

TURN = 60.0
"""Degrees that a curve may turn by within one division."""

LEAST_CLOSED = 4
"""Divisions of a closed curve at the least."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A chain of edges between two corners, or a closed one.

    Attributes
    ----------
    nodes : tuple of int
        Node rows in order; first and last are the same for a closed curve.
    points : (n, 3) float64
        Their places.
    """

    nodes: tuple[int, ...]
    points: Floats

    @property
    def is_closed(self) -> bool:
        """Whether it ends where it begins."""
        return self.nodes[0] == self.nodes[-1]

    @property
    def length(self) -> float:
        """Sum of its edges."""
        return float(np.linalg.norm(np.diff(self.points, axis=0), axis=1).sum())

    def divisions(self, size: float) -> int:
        """How many edges of about a size it is divided into."""
        ways = np.diff(self.points, axis=0)
        ways = ways[np.linalg.norm(ways, axis=1) > 0]
        turns = sum(_turn(a, b) for a, b in pairwise(ways))
        least = LEAST_CLOSED if self.is_closed else 1
        # a zigzag turns too, but no division is shorter than an edge
        by_turn = min(round(turns / TURN), len(ways))
        return max(least, by_turn, round(self.length / size))

    def divided(self, count: int) -> Floats:
        """(count + 1, 3) points at even distances along the curve, its two ends included."""
        steps = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        along = np.concatenate([[0.0], np.cumsum(steps)])
        wanted = np.linspace(0.0, along[-1], count + 1)
        columns = [np.interp(wanted, along, self.points[:, axis]) for axis in range(3)]
        return np.stack(columns, axis=1)


def curves_of(points: Floats, edges: Ints, is_feature: Bools) -> list[Curve]:
    """Chain edges (E, 2) to curves.

    A curve ends at a node where not just two edges meet, or where a feature, (E,) bool, turns
    sharply. Elsewhere a line may zigzag from element to element, and has no corners.
    """
    around: dict[int, list[int]] = defaultdict(list)
    for row, (a, b) in enumerate(edges.tolist()):
        around[a].append(row)
        around[b].append(row)

    def beyond(row: int, node: int) -> int:
        return int(edges[row].sum()) - node

    def is_corner(node: int) -> bool:
        if len(around[node]) != 2:
            return True
        one, two = around[node]
        if not (is_feature[one] or is_feature[two]):
            return False
        here = points[node]
        return _turn(here - points[beyond(one, node)], points[beyond(two, node)] - here) > CORNER

    corners = {node for node in sorted(around) if is_corner(node)}
    used = np.zeros(len(edges), bool)
    found = []
    for start in [*sorted(corners), *sorted(around)]:
        for row in around[start]:
            if used[row]:
                continue
            nodes, way = [start], row
            while True:
                used[way] = True
                nodes.append(beyond(way, nodes[-1]))
                ahead = [other for other in around[nodes[-1]] if not used[other]]
                if nodes[-1] in corners or not ahead:
                    break
                way = ahead[0]
            found.append(Curve(tuple(nodes), points[nodes]))
    return found


def even_divisions(counts: list[int], sides: list[tuple[int, ...]]) -> list[int]:
    """Change counts by one here and there so that each zone has an even number of border edges.

    A zone with an odd one needs a tria. Odd zones are joined in pairs, or with the outside, across
    the curves that are divided most, and those get one division more.

    Parameters
    ----------
    counts : list of int
        Divisions of each curve.
    sides : list of tuple of int
        The zones on the sides of each curve.
    """
    counts = list(counts)
    total: dict[int, int] = defaultdict(int)
    doors: dict[int, list[int]] = defaultdict(list)
    for curve, zones in enumerate(sides):
        for zone in zones:
            total[zone] += counts[curve]
        if len(zones) <= 2 and len(set(zones)) == len(zones):
            for zone in zones:
                doors[zone].append(curve)
    odd = {zone for zone, count in sorted(total.items()) if count % 2}
    for zone in sorted(odd):
        if zone in odd:
            way, end = _way_to_odd(zone, odd, doors, sides, counts)
            for curve in way:
                counts[curve] += 1
            odd -= {zone, end} if way else {zone}
    return counts


OUTSIDE = -1


def _way_to_odd(
    start: int,
    odd: set[int],
    doors: dict[int, list[int]],
    sides: list[tuple[int, ...]],
    counts: list[int],
) -> tuple[list[int], int]:
    """Cheapest way across curves from a zone to another odd one or outside (Dijkstra 1959)."""
    queue: list[tuple[float, int, tuple[int, ...]]] = [(0.0, start, ())]
    seen = set()
    while queue:
        cost, zone, way = heappop(queue)
        if zone in seen:
            continue
        seen.add(zone)
        if way and (zone == OUTSIDE or zone in odd):
            return list(way), zone
        for curve in doors[zone]:
            others = [other for other in sides[curve] if other != zone] or [OUTSIDE]
            heappush(queue, (cost + 1.0 / counts[curve] ** 2, others[0], (*way, curve)))
    return [], start


def _turn(u: Floats, v: Floats) -> float:
    """Degrees between two directions."""
    return float(np.degrees(np.arctan2(np.linalg.norm(np.cross(u, v)), u @ v)))
