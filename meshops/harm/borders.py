"""How far the lines of a part have moved: free borders, T-junctions, region edges and creases."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from meshops.harm.changes import Changes
from meshops.harm.edges import (
    BORDER,
    FEATURE,
    FEATURE_ANGLE,
    INSIDE,
    JUNCTION,
    LINES,
    REGION,
    Edges,
    Kinds,
    kinds_of,
)
from meshops.harm.nearest import to_segments
from meshops.harm.rows import Walks
from meshops.mesh import Bools, Floats, Ids, ShellMesh

CORNER_ANGLE = 30.0
"""Degrees that a line turns by at a corner."""

LIMIT = 0.01
"""Share of the local edge, or of the local width, that a line may move by."""

CREASE_SLACK = 8.0
"""Degrees that a crease may be flatter than the limit in one mesh and count in the other."""


@dataclass(frozen=True)
class LineDeviation:
    """How far lines of one kind lie apart, in shares of the local edge or width before.

    Attributes
    ----------
    kind : str
        As in ``LINES``.
    after_off_before, before_off_after : float
        Largest distance of the nodes and middles of edges of one from the lines of the other.
    place : (x, y, z) or None
        Of the largest.
    corners_lost : int
        Corners before at which no node of a line is any more.
    """

    kind: str
    after_off_before: float
    before_off_after: float
    place: tuple[float, float, float] | None
    corners_lost: int

    @property
    def worst(self) -> float:
        """The larger distance."""
        return max(self.after_off_before, self.before_off_after)


@dataclass(frozen=True, eq=False)
class Lines:
    """The lines of a mesh.

    Attributes
    ----------
    mesh : ShellMesh
    edges : Edges
    kinds, loose : (E,) int8
        Kinds of edges; `loose` has flatter creases too.
    scale : (E,) float64
        The length of an edge, or the width of the part across it where that is less.
    """

    mesh: ShellMesh
    edges: Edges
    kinds: Kinds
    loose: Kinds
    scale: Floats

    @classmethod
    def of(cls, mesh: ShellMesh, edges: Edges, kinds: Kinds, walks: Walks) -> Lines:
        """Take the lines of a mesh, with the width of the part from walks across."""
        scale = edges.lengths(mesh)
        np.minimum.at(scale, walks.edge, walks.width)
        loose = kinds_of(mesh, edges, FEATURE_ANGLE - CREASE_SLACK)
        return cls(mesh, edges, kinds, loose, scale)


def compare_lines(before: Lines, after: Lines, changes: Changes) -> tuple[LineDeviation, ...]:
    """Compare the lines of two meshes, kind by kind."""
    return tuple(_deviation(before, after, changes, kind) for kind in LINES)


def corner_nodes(mesh: ShellMesh, edges: Edges, on_line: Bools) -> Ids:
    """Nodes of lines that these turn at as at a corner, or at which not just two edges meet.

    `on_line`, (E,) bool, says which edges are lines.
    """
    ends = edges.nodes[on_line]
    count = np.bincount(ends.ravel(), minlength=len(mesh.points))
    where = np.flatnonzero(count == 2)
    owner = np.concatenate([ends[:, 0], ends[:, 1]])
    other = np.concatenate([ends[:, 1], ends[:, 0]])
    order = np.argsort(owner, kind="stable")
    first = np.searchsorted(owner[order], where)
    one, two = (mesh.points[other[order[first + k]]] - mesh.points[where] for k in (0, 1))
    sine = np.linalg.norm(np.cross(one, two), axis=1)
    inner = np.degrees(np.arctan2(sine, np.einsum("ij,ij->i", one, two)))
    turned = where[180.0 - inner >= CORNER_ANGLE]
    return np.union1d(turned, np.flatnonzero((count > 0) & (count != 2)))


def _deviation(before: Lines, after: Lines, changes: Changes, kind: int) -> LineDeviation:
    old, new = before.kinds == kind, after.kinds == kind
    # a crease that has become a border or a region edge is still where it was
    old_near, new_near = (_targets(lines, kind) for lines in (before, after))
    keys_before = _keys(before.edges.nodes, len(before.mesh.points))
    keys_after = _keys(changes.node_before[after.edges.nodes], len(before.mesh.points))
    new_here = new & ~np.isin(keys_after, keys_before[old_near])
    old_here = old & ~np.isin(keys_before, keys_after[new_near])
    off_new, at_new = _distances(after, new_here, before, old_near)
    off_old, at_old = _distances(before, old_here, after, new_near, scale=before.scale)
    place = at_new if off_new >= off_old else at_old
    return LineDeviation(
        LINES[kind],
        off_new,
        off_old,
        place if max(off_new, off_old) > 0.0 else None,
        _corners_lost(before, after, old, new_near),
    )


def _targets(lines: Lines, kind: int) -> Bools:
    """Edges that a line of a kind may lie on: T-junctions and borders stay what they are."""
    if kind == FEATURE:
        return np.not_equal(lines.loose, INSIDE)
    kinds = (REGION, JUNCTION, BORDER) if kind == REGION else (kind,)
    return np.isin(lines.kinds, kinds)


def _distances(
    source: Lines,
    wanted: Bools,
    target: Lines,
    allowed: Bools,
    scale: Floats | None = None,
) -> tuple[float, tuple[float, float, float] | None]:
    """Largest distance of nodes and middles of some edges to lines of the other mesh."""
    rows = np.flatnonzero(wanted)
    if not len(rows):
        return 0.0, None
    ends = source.mesh.points[source.edges.nodes[rows]]
    samples = np.concatenate([ends[:, 0], ends[:, 1], ends.mean(axis=1)])
    goal = np.flatnonzero(allowed)
    distance, nearest = to_segments(samples, target.mesh.points[target.edges.nodes[goal]])
    if not len(goal):
        return float("inf"), _place(samples[0])
    local = target.scale[goal[nearest]] if scale is None else np.tile(scale[rows], 3)
    # coordinates of decks are rounded, so nothing below that is a distance
    noise = 1e-7 * np.abs(samples).max(initial=0.0)
    share = np.where(distance > noise, distance, 0.0) / np.maximum(local, np.finfo(float).tiny)
    worst = int(np.argmax(share))
    return float(share[worst]), _place(samples[worst])


def _keys(ends: Ids, count: int) -> Ids:
    """Name edges by their nodes before; those that the old mesh does not know are all called -1."""
    low, high = ends.min(axis=1), ends.max(axis=1)
    return np.where(low < 0, -1, low * count + high)


def _corners_lost(before: Lines, after: Lines, old: Bools, new: Bools) -> int:
    corners = corner_nodes(before.mesh, before.edges, old)
    if not len(corners):
        return 0
    nodes = np.unique(after.edges.nodes[new])
    if not len(nodes):
        return len(corners)
    local = np.full(len(before.mesh.points), np.inf)
    for k in (0, 1):
        np.minimum.at(local, before.edges.nodes[old][:, k], before.scale[old])
    distance, _ = cKDTree(after.mesh.points[nodes]).query(before.mesh.points[corners])
    noise = 1e-7 * np.abs(before.mesh.points).max(initial=0.0)
    return int(np.count_nonzero(distance > LIMIT * local[corners] + noise))


def _place(point: Floats) -> tuple[float, float, float]:
    x, y, z = point.tolist()
    return x, y, z
