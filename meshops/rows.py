"""Rows: how many quads lie across a strip, from one barrier to the one opposite."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops._core import find_edges
from meshops.mesh import NO_NODE, Bools, Floats, Ids, Ints, ShellMesh
from meshops.topology import Topology, topology

MOST = 64
"""Rows after which a walk ends: what is wider is no strip."""

STRIP = 8
"""Rows up to which a part counts as a strip, which keeps all of them."""

LEAST = 0.75
"""Share of the rows that stay across what is wider."""

SAME_WAY = 0.7
"""Cosine between the first steps of two walks from which they go the same way, and between the
sides at both ends of a walk from which it goes across."""

APART = 0.5
"""Of its first side, and a tenth of its way: how far off a walk may end and be the same one."""


@dataclass(frozen=True, eq=False)
class Walks:
    """Walks from the sides of quads that lie on a barrier, through opposite sides to the next one.

    Attributes
    ----------
    edge : (W, 2) int64
        The nodes of the first side, the smaller first; rows of a mesh.
    way : (W, 3) float64
        Unit vector from the middle of the first side into the first quad.
    across : (W, 3) float64
        From the middle of the first side to that of the last one.
    length : (W,) float64
        Of the first side.
    rows : (W,) int64
        Quads on the way; 0 where it does not come to a barrier that is parallel.
    part : (W,) int64
        Of the change, that it passes through; -1 for none.
    """

    edge: Ids
    way: Floats
    across: Floats
    length: Floats
    rows: Ids
    part: Ids

    @classmethod
    def of(cls, points: Floats, elements: Ints, part: Ids, barriers: Ids) -> Walks:
        """Walk from barriers, given by the keys of their edges, to barriers.

        `part` (M,) is that of a change which elements are of.
        """
        edges, element_edges, edge_elements, uses, _ = find_edges(elements, len(points))
        is_barrier = np.isin(edge_keys(edges, len(points)), barriers)
        stops = is_barrier | (uses != 2)
        element, side = np.nonzero((element_edges >= 0) & is_barrier[element_edges])
        quads = elements[element, 3] != NO_NODE
        element, side = element[quads], side[quads]
        first = element_edges[element, side]
        rows, passed, last = _walk(
            elements, element_edges, edge_elements, stops, part, element, side
        )
        middles = points[edges].mean(axis=1)
        sides = points[edges[:, 1]] - points[edges[:, 0]]
        lengths = np.linalg.norm(sides, axis=1)
        cosine = np.abs(np.einsum("ij,ij->i", sides[first], sides[last]))
        rows[~is_barrier[last] | (cosine < SAME_WAY * lengths[first] * lengths[last])] = 0
        way = points[elements[element]].mean(axis=1) - middles[first]
        way /= np.maximum(np.linalg.norm(way, axis=1), 1e-300)[:, None]
        across = middles[last] - middles[first]
        return cls(edges[first].astype(np.int64), way, across, lengths[first], rows, passed)


def edge_keys(edges: Ints, nodes: int) -> Ids:
    """(E,) one number for the two nodes of each edge (E, 2), the smaller first."""
    keys: Ids = edges[:, 0].astype(np.int64) * nodes + edges[:, 1]
    return keys


@dataclass(frozen=True, eq=False)
class Rows:
    """The rows that a mesh has across its strips, to be kept by what becomes of it.

    Attributes
    ----------
    node_ids : (N,) int64
        Of the mesh; all different.
    walks : Walks
        Those that go where there are rows: walks that begin beside them have as many.
    """

    node_ids: Ids
    walks: Walks

    @classmethod
    def of(cls, mesh: ShellMesh, feature_angle: float) -> Rows:
        """Find the rows of a mesh between its barriers."""
        barriers = barriers_of(topology(mesh, feature_angle=feature_angle), len(mesh.points))
        none = np.full(len(mesh.elements), -1, np.int64)
        walks = Walks.of(mesh.points, mesh.elements, none, barriers)
        kept = np.nonzero((walks.rows > 0) & _agree(walks))[0]
        order = kept[np.lexsort((walks.edge[kept, 1], walks.edge[kept, 0]))]
        return cls(
            mesh.node_ids,
            Walks(*(getattr(walks, name)[order] for name in walks.__dataclass_fields__)),
        )

    def lost(self, walks: Walks, node_ids: Ids, parts: int) -> Bools:
        """(P,) bool: parts of a change after which a strip has fewer rows than it had.

        `node_ids` are those of the nodes that the walks name.
        """
        lost = np.zeros(parts, bool)
        known = np.argsort(self.node_ids, kind="stable")
        at = np.minimum(np.searchsorted(self.node_ids[known], node_ids), len(known) - 1)
        rows = np.where(self.node_ids[known[at]] == node_ids, known[at], -1)
        edge = np.sort(rows[walks.edge], axis=1)
        then, now = _pairs(self.walks, walks, edge, len(self.node_ids))
        before, after = self.walks.rows[then], walks.rows[now]
        fewer = (after > 0) & (after < np.where(before <= STRIP, before, LEAST * before))
        off = np.linalg.norm(self.walks.across[then] - walks.across[now], axis=1)
        way = np.linalg.norm(self.walks.across[then], axis=1)
        fewer &= off <= APART * walks.length[now] + 0.1 * way
        part = walks.part[now]
        lost[part[fewer & (part >= 0)]] = True
        return lost


def barriers_of(found: Topology, nodes: int) -> Ids:
    """Keys of the edges that a walk does not cross, of that many nodes."""
    return edge_keys(found.edges[~found.crossable], nodes)


def rows_across(found: Topology, chosen: Bools) -> tuple[int, int] | None:
    """Fewest and most quads across the strips that elements (M,) bool lie in; None for no strip."""
    mesh, part = found.mesh, np.where(chosen, 0, -1)
    barriers = barriers_of(found, len(mesh.points))
    rows = Walks.of(mesh.points, mesh.elements, part, barriers)
    narrow = rows.rows[(rows.part == 0) & (rows.rows > 0) & (rows.rows <= STRIP)]
    return (int(narrow.min()), int(narrow.max())) if len(narrow) else None


def _walk(
    elements: Ints,
    element_edges: Ints,
    edge_elements: Ints,
    stops: Bools,
    part: Ids,
    element: Ids,
    side: Ids,
) -> tuple[Ids, Ids, Ids]:
    """Walk from sides of quads; (W,) quads on the way, 0 if it does not end, part and last edge."""
    count, last = np.zeros((2, len(element)), np.int64)
    passed = np.full(len(element), -1, np.int64)
    going = np.arange(len(element))
    for step in range(1, MOST + 1):
        passed[going] = np.maximum(passed[going], part[element])
        beyond = element_edges[element, (side + 2) % 4]
        arrived = stops[beyond]
        count[going[arrived]], last[going[arrived]] = step, beyond[arrived]
        going, element, beyond = going[~arrived], element[~arrived], beyond[~arrived]
        pair = edge_elements[beyond]
        element = np.where(pair[:, 0] == element, pair[:, 1], pair[:, 0])
        is_quad = elements[element, 3] != NO_NODE
        going, element, beyond = going[is_quad], element[is_quad], beyond[is_quad]
        if not len(going):
            break
        side = (element_edges[element] == beyond[:, None]).argmax(axis=1)
    return count, passed, last


def _agree(walks: Walks) -> Bools:
    """(W,) bool: walks that have as many rows as all that begin at one of their ends.

    Those that go another way, into another plate, are none of these.
    """
    node, walk = walks.edge.T.ravel(), np.tile(np.arange(len(walks.edge)), 2)
    order = np.argsort(node, kind="stable")
    node, walk = node[order], walk[order]
    agree = np.ones(len(walks.edge), bool)
    for step in range(1, len(node)):
        beside = np.nonzero(node[step:] == node[:-step])[0]
        if not len(beside):
            break
        one, other = walk[beside], walk[beside + step]
        differ = np.einsum("ij,ij->i", walks.way[one], walks.way[other]) > SAME_WAY
        differ &= walks.rows[one] != walks.rows[other]
        agree[one[differ]] = agree[other[differ]] = False
    return agree


def _pairs(before: Walks, after: Walks, edge: Ids, nodes: int) -> tuple[Ids, Ids]:
    """Rows of the walks that begin at the same edge and go the same way.

    `edge` (W, 2) are the edges of those after by the nodes of those before, -1 where there is none.
    """
    known = before.edge[:, 0] * nodes + before.edge[:, 1]
    wanted = np.where((edge >= 0).all(axis=1), edge[:, 0] * nodes + edge[:, 1], -1)
    first, last = (np.searchsorted(known, wanted, where) for where in ("left", "right"))
    found = np.full(len(wanted), -1, np.int64)
    best = np.full(len(wanted), SAME_WAY)
    for shift in range(int((last - first).max(initial=0))):
        candidate = np.minimum(first + shift, max(len(known) - 1, 0))
        cosine = np.einsum("ij,ij->i", before.way[candidate], after.way)
        better = (first + shift < last) & (cosine > best)
        found[better], best[better] = candidate[better], cosine[better]
    now = np.nonzero(found >= 0)[0]
    return found[now], now
