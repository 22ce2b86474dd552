"""Rows: how many quads lie across a strip, from one barrier to the one opposite."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops.kernels.edges import find_edges
from meshops.mesh import NO_NODE, Bools, Floats, Ids, Ints

MOST = 64
"""Rows after which a walk ends: what is wider is no strip."""

STRIP = 8
"""Rows up to which a part counts as a strip, which keeps all of them."""

LEAST = 0.75
"""Share of the rows that stay across what is wider."""


SAME_WAY = 0.7
"""Cosine between the first steps of two walks from which they go the same way."""


@dataclass(frozen=True, eq=False)
class Walks:
    """Walks from the sides of quads that lie on a barrier, through opposite sides to the next one.

    Attributes
    ----------
    edge : (W,) int64
        The first side, as one number of its two nodes; ascending.
    way : (W, 3) float64
        Unit vector from the middle of the first side into the first quad.
    rows : (W,) int64
        Quads on the way; 0 where it does not come to a barrier.
    part : (W,) int64
        Of the change, that it passes through; -1 for none.
    steady : (W,) bool
        Whether walks that begin beside it have as many: there are rows.
    """

    edge: Ids
    way: Floats
    rows: Ids
    part: Ids
    steady: Bools

    @classmethod
    def of(cls, points: Floats, elements: Ints, part: Ids, barriers: Ids) -> Walks:
        """Walk from barriers, given by the keys of their edges, to barriers.

        `part` (M,) is that of a change which elements are of. Where a mesh ends otherwise, as a
        subdomain does, a walk ends without having come to anything.
        """
        edges, element_edges, edge_elements, uses, _ = find_edges(elements, len(points))
        keys = edge_keys(edges, len(points))
        is_barrier = np.isin(keys, barriers)
        stops = is_barrier | (uses != 2)
        rows, sides = np.nonzero((element_edges >= 0) & is_barrier[element_edges])
        quads = elements[rows, 3] != NO_NODE
        rows, sides = rows[quads], sides[quads]
        first = element_edges[rows, sides]
        order = np.argsort(keys[first], kind="stable")
        rows, sides, first = rows[order], sides[order], first[order]
        count, passed, last = _walk(
            elements, element_edges, edge_elements, stops, part, rows, sides
        )
        count[~is_barrier[last]] = 0
        way = points[elements[rows]].mean(axis=1) - points[edges[first]].mean(axis=1)
        way /= np.maximum(np.linalg.norm(way, axis=1), 1e-300)[:, None]
        return cls(keys[first], way, count, passed, _agree(edges[first], way, count))


def edge_keys(edges: Ints, nodes: int) -> Ids:
    """(E,) one number for the two nodes of each edge (E, 2), the smaller first."""
    keys: Ids = edges[:, 0].astype(np.int64) * nodes + edges[:, 1]
    return keys


def _walk(
    elements: Ints,
    element_edges: Ints,
    edge_elements: Ints,
    stops: Bools,
    part: Ids,
    rows: Ids,
    sides: Ids,
) -> tuple[Ids, Ids, Ids]:
    """Walk from sides of quads; (W,) quads on the way, 0 if it does not end, part and last edge."""
    count, last = np.zeros((2, len(rows)), np.int64)
    passed = np.full(len(rows), -1, np.int64)
    going, at, side = np.arange(len(rows)), rows.copy(), sides.copy()
    for step in range(1, MOST + 1):
        passed[going] = np.maximum(passed[going], part[at])
        beyond = element_edges[at, (side + 2) % 4]
        arrived = stops[beyond]
        count[going[arrived]], last[going[arrived]] = step, beyond[arrived]
        going, at, beyond = going[~arrived], at[~arrived], beyond[~arrived]
        pair = edge_elements[beyond]
        at = np.where(pair[:, 0] == at, pair[:, 1], pair[:, 0])
        is_quad = elements[at, 3] != NO_NODE
        going, at, beyond = going[is_quad], at[is_quad], beyond[is_quad]
        if not len(going):
            break
        side = (element_edges[at] == beyond[:, None]).argmax(axis=1)
    return count, passed, last


def _agree(ends: Ints, way: Floats, rows: Ids) -> Bools:
    """(W,) bool: walks that have as many rows as all that begin at one of their ends (W, 2).

    Those that go another way, into another plate, are none of these.
    """
    node, walk = ends.T.ravel(), np.tile(np.arange(len(ends)), 2)
    order = np.argsort(node, kind="stable")
    node, walk = node[order], walk[order]
    agree = np.ones(len(ends), bool)
    for step in range(1, len(node)):
        beside = np.nonzero(node[step:] == node[:-step])[0]
        if not len(beside):
            break
        one, other = walk[beside], walk[beside + step]
        differ = np.einsum("ij,ij->i", way[one], way[other]) > SAME_WAY
        differ &= rows[one] != rows[other]
        agree[one[differ]] = agree[other[differ]] = False
    return agree


def fewer_rows(before: Walks, after: Walks, parts: int) -> Bools:
    """(P,) bool: parts of a change that take rows out of a strip."""
    lost = np.zeros(parts, bool)
    then, now = _pairs(before, after)
    was, rows = before.rows[then], after.rows[now]
    gone = before.steady[then] & after.steady[now] & (was > 0) & (rows > 0)
    gone &= rows < np.where(was <= STRIP, was, LEAST * was)
    part = np.maximum(before.part[then], after.part[now])
    lost[part[gone & (part >= 0)]] = True
    return lost


def _pairs(before: Walks, after: Walks) -> tuple[Ids, Ids]:
    """Rows of the walks that begin at the same edge and go the same way."""
    first, last = (np.searchsorted(before.edge, after.edge, side) for side in ("left", "right"))
    found = np.full(len(after.edge), -1, np.int64)
    best = np.full(len(after.edge), -np.inf)
    for shift in range(int((last - first).max(initial=0))):
        candidate = np.minimum(first + shift, max(len(before.edge) - 1, 0))
        cosine = np.einsum("ij,ij->i", before.way[candidate], after.way)
        better = (first + shift < last) & (cosine > best)
        found[better], best[better] = candidate[better], cosine[better]
    known = np.nonzero(found >= 0)[0]
    return found[known], known
