"""Rows of elements across strips, webs and flanges: from one line to the one opposite."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from meshops.harm.edges import INSIDE, Edges, Kinds, middles_of
from meshops.mesh import Bools, Floats, Ids, ShellMesh

MOST = 64
"""Rows after which a walk ends: what is wider is no strip."""

STRIP = 8
"""Rows up to which a part counts as a strip, which keeps all of them."""

LEAST = 0.75
"""Share of the rows that stay across what is wider than a strip."""

PARALLEL = 0.7
"""Least cosine between the edges at both ends of a walk that goes across."""


@dataclass(frozen=True, eq=False)
class Walks:
    """Walks from each side of an element that lies on a line, straight across to the next line.

    Through a quad it leaves by the opposite side, through a tria by the side that is straighter on.

    Attributes
    ----------
    starts : (W, 3) float64
        Within the first element, near the middle of its side.
    across : (W, 3) float64
        From the middle of the first side to that of the last.
    length : (W,) float64
        Of the first side.
    edge : (W,) int64
        Of the first side.
    rows : (W,) int64
        Elements on the way.
    arrived : (W,) bool
        Whether it came to a line that is parallel to the first.
    steady : (W,) bool
        Whether all elements on the way are quads, and those beside it on the line go through as
        many: the part has rows there.
    """

    starts: Floats
    across: Floats
    length: Floats
    edge: Ids
    rows: Ids
    arrived: Bools
    steady: Bools

    @property
    def width(self) -> Floats:
        """(W,) from one line to the other; infinite where none was reached."""
        return np.where(self.arrived, np.linalg.norm(self.across, axis=1), np.inf)


def walk_across(mesh: ShellMesh, edges: Edges, kinds: Kinds) -> Walks:
    """Walk from every side on a line."""
    on_line = edges.of_side >= 0
    on_line &= kinds[edges.of_side] != INSIDE
    element, side = np.nonzero(on_line)
    first = edges.of_side[element, side]
    begin, along = _side(mesh, element, side)
    count = len(element)
    inward = middles_of(mesh)[element] - begin
    starts = begin + 0.2 * inward
    rows, end, last = np.zeros(count, np.int64), begin.copy(), along.copy()
    arrived, regular, walking = np.zeros(count, bool), np.ones(count, bool), np.arange(count)
    heading = inward.copy()
    for _ in range(MOST):
        if not len(walking):
            break
        here, entry = element[walking], side[walking]
        rows[walking] += 1
        regular[walking] &= ~mesh.is_tria[here]
        leave = _opposite(mesh, here, entry, heading[walking])
        middle, direction = _side(mesh, here, leave)
        heading[walking] = middle - _side(mesh, here, entry)[0]
        end[walking], last[walking] = middle, direction
        edge = edges.of_side[here, leave]
        at_line = kinds[edge] != INSIDE
        arrived[walking[at_line]] = True
        is_other = edges.pair[edge, 0] == here
        following = np.where(is_other, edges.pair[edge, 1], edges.pair[edge, 0])
        entered = np.where(is_other, edges.pair_sides[edge, 1], edges.pair_sides[edge, 0])
        element[walking], side[walking] = following, entered
        walking = walking[~at_line]
    length = np.linalg.norm(along, axis=1)
    cosine = np.abs(np.einsum("ij,ij->i", along, last))
    arrived &= cosine >= PARALLEL * length * np.linalg.norm(last, axis=1)
    across, sound = end - begin, arrived & regular
    steady = sound & _as_beside(edges.nodes[first], across, np.where(sound, rows, -1))
    return Walks(starts, across, length, first, rows, arrived, steady)


@dataclass(frozen=True)
class RowsAcross:
    """Rows before and after, of the walks that both meshes have.

    Attributes
    ----------
    compared : int
        Walks that were found in both, from and to the same places.
    least : float
        Smallest ratio of rows after to rows before; 1 where there is none.
    fewer : int
        Walks with fewer rows than they had to keep: all in a strip, else the share `LEAST`.
    place : (x, y, z) or None
        Where that is worst.
    before, after : int
        Rows there.
    """

    compared: int
    least: float
    fewer: int
    place: tuple[float, float, float] | None
    before: int
    after: int


def compare_rows(before: Walks, after: Walks) -> RowsAcross:
    """Compare the rows from one line to another, wherever both meshes go the same way.

    Only where the part has rows is there something to keep; afterwards any walk counts.
    """
    sound = np.flatnonzero(before.steady)
    now = np.flatnonzero(after.arrived)
    if not len(sound) or not len(now):
        return RowsAcross(0, 1.0, 0, None, 0, 0)
    distance, found = cKDTree(before.starts[sound]).query(after.starts[now])
    then = sound[found]
    reach = 0.5 * np.maximum(before.length[then], after.length[now])
    apart = np.linalg.norm(before.across[then] - after.across[now], axis=1)
    alike = (distance <= reach) & (apart <= reach + 0.1 * before.width[then])
    then, now = then[alike], now[alike]
    if not len(then):
        return RowsAcross(0, 1.0, 0, None, 0, 0)
    ratio = after.rows[now] / before.rows[then]
    fewer = (ratio < 1.0) & ((before.rows[then] <= STRIP) | (ratio < LEAST))
    worst = int(np.argmin(np.where(fewer, ratio - 1.0, ratio)))
    x, y, z = after.starts[now[worst]].tolist()
    return RowsAcross(
        compared=len(then),
        least=float(ratio.min()),
        fewer=int(np.count_nonzero(fewer)),
        place=(x, y, z),
        before=int(before.rows[then[worst]]),
        after=int(after.rows[now[worst]]),
    )


def _side(mesh: ShellMesh, element: Ids, side: Ids) -> tuple[Floats, Floats]:
    """Middle and direction of sides."""
    size = np.where(mesh.is_tria[element], 3, 4)
    start = mesh.points[mesh.elements[element, side]]
    end = mesh.points[mesh.elements[element, (side + 1) % size]]
    return 0.5 * (start + end), end - start


def _as_beside(ends: Ids, across: Floats, rows: Ids) -> Bools:
    """(W,) bool: walks all of whose neighbours on the line, that go the same way, have its rows.

    `ends` are the nodes of the first sides, `rows` -1 where a walk is no measure.
    """
    node, walk = ends.T.ravel(), np.tile(np.arange(len(ends)), 2)
    order = np.argsort(node, kind="stable")
    node, walk = node[order], walk[order]
    count = np.bincount(node)[node] if len(node) else node
    place = np.arange(len(node)) - np.searchsorted(node, node)
    alike, beside = np.ones(len(ends), bool), np.zeros(len(ends), bool)
    for step in range(1, int(count.max(initial=1))):
        here = np.flatnonzero(place + step < count)
        one, other = walk[here], walk[here + step]
        cosine = np.einsum("ij,ij->i", across[one], across[other])
        lengths = np.linalg.norm(across[one], axis=1) * np.linalg.norm(across[other], axis=1)
        same_way = cosine > PARALLEL * lengths
        one, other = one[same_way], other[same_way]
        beside[one] = beside[other] = True
        different = rows[one] != rows[other]
        alike[one[different]] = alike[other[different]] = False
    return alike & beside


def _opposite(mesh: ShellMesh, element: Ids, side: Ids, heading: Floats) -> Ids:
    """Side by which a walk leaves an element."""
    leave = (side + 2) % 4
    tria = np.flatnonzero(mesh.is_tria[element])
    if len(tria):
        here, entry = element[tria], side[tria]
        begin = _side(mesh, here, entry)[0]
        ahead = [
            np.einsum("ij,ij->i", _side(mesh, here, (entry + k) % 3)[0] - begin, heading[tria])
            for k in (1, 2)
        ]
        leave[tria] = (entry + np.where(ahead[0] >= ahead[1], 1, 2)) % 3
    return leave
