"""Points that are the same in all but name, as in files that write each face by itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from meshops.mesh import NO_NODE, Bools, Floats, Ids

TOLERANCE = 1e-6
"""Distance over the diagonal of the bounding box up to which points are the same."""

COARSE = 1e-5
"""The same where the file writes so few digits that they tell no smaller distances."""

OF_EDGE = 0.05
"""Distance over the shortest edge there up to which they are: no element is ever closed by it."""


@dataclass(frozen=True, eq=False)
class Weld:
    """What points of a file are the same.

    Attributes
    ----------
    point_of : (n,) int64
        The first of the points that a point is the same as; often itself.
    apart : (n,) bool
        Points that lie on others, or nearly so, but belong to faces that are joined to their
        neighbours, or are a little too far away: the file may mean a border there.
    before, after : int
        How many points the faces have.
    """

    point_of: Ids
    apart: Bools
    before: int
    after: int

    @property
    def held(self) -> Bools:
        """(n,) bool: the points that are to be locked, since they are apart from others."""
        held = np.zeros(len(self.point_of), bool)
        held[self.point_of[self.apart]] = True
        return held

    @property
    def notes(self) -> tuple[str, ...]:
        """What was done, a sentence each."""
        found = []
        if self.after < self.before:
            found.append(
                f"Faces shared no points: {self.before:,} points are welded to {self.after:,}."
            )
        if self.apart.any():
            found.append(
                f"{int(self.apart.sum()):,} points lie on others without being the same: they are "
                "locked, and the border between them stays."
            )
        return tuple(found)


def weld(points: Floats, corners: Ids, resolution: float) -> Weld:
    """Find the points that are the same at faces that share none with any other face.

    Parameters
    ----------
    points : (n, 3) float64
    corners : (m, 4) int64
        Rows of points, ``NO_NODE`` last in a tria.
    resolution : float
        Up to which the file tells two numbers apart.
    """
    every = np.arange(len(points))
    valid = corners[corners != NO_NODE]
    used = np.zeros(len(points), bool)
    used[valid] = True
    count = int(used.sum())
    nothing = Weld(every, np.zeros(len(points), bool), count, count)
    if not count or not np.isfinite(points).all():
        return nothing
    loose = _loose(corners, len(points))
    pairs, is_near = _same(points, corners, used, resolution)
    joined = loose[pairs].any(axis=1) & is_near
    graph = coo_array(
        (np.ones(int(joined.sum()), bool), tuple(pairs[joined].T)), shape=(len(points),) * 2
    )
    label = connected_components(graph, directed=False)[1]
    first = np.full(int(label.max()) + 1, len(points), np.int64)
    np.minimum.at(first, label, every)
    point_of = first[label]
    apart = np.zeros(len(points), bool)
    apart[pairs[point_of[pairs[:, 0]] != point_of[pairs[:, 1]]]] = True
    return Weld(point_of, apart, count, len(np.unique(point_of[used])))


def _loose(corners: Ids, points: int) -> Bools:
    """(n,) bool: corners of faces none of whose corners another face has."""
    real = corners != NO_NODE
    uses = np.bincount(corners[real], minlength=points)
    alone = ((uses[corners] == 1) | ~real).all(axis=1)
    loose = np.zeros(points, bool)
    loose[corners[alone][real[alone]]] = True
    return loose


def _same(points: Floats, corners: Ids, used: Bools, resolution: float) -> tuple[Ids, Bools]:
    """(k, 2) pairs of used points that may be the same, and (k,) whether they are near enough."""
    shortest = _shortest_edges(points, corners)
    edges = shortest[used & (shortest > 0.0) & np.isfinite(shortest)]
    with np.errstate(all="ignore"):
        diagonal = float(np.linalg.norm(np.ptp(points[used], axis=0)))
    if not len(edges) or not np.isfinite(diagonal):
        return np.zeros((0, 2), np.int64), np.zeros(0, bool)
    limit = OF_EDGE * float(np.median(edges))
    reach = min(max(TOLERANCE * diagonal, resolution), limit)
    least = min(max(TOLERANCE * diagonal, min(resolution, COARSE * diagonal)), limit)
    rows = np.flatnonzero(used)
    distinct, first, kind = np.unique(points[rows], axis=0, return_index=True, return_inverse=True)
    kind = kind.ravel()
    equal = np.stack([rows[first[kind]], rows], axis=1)
    near = cKDTree(distinct).query_pairs(reach, output_type="ndarray")
    close = rows[first[near]].reshape(-1, 2)
    apart = np.linalg.norm(points[close[:, 0]] - points[close[:, 1]], axis=1)
    cap = OF_EDGE * shortest[close].min(axis=1)
    few = apart <= cap
    pairs: Ids = np.concatenate([equal[equal[:, 0] != equal[:, 1]], close[few]])
    is_near = np.ones(len(pairs), bool)
    is_near[len(pairs) - int(few.sum()) :] = apart[few] <= least
    return pairs, is_near


def _shortest_edges(points: Floats, corners: Ids) -> Floats:
    """(n,) length of the shortest edge at each point, infinite where there is none."""
    ahead = np.where(corners == NO_NODE, corners[:, :1], corners)
    ends = np.roll(ahead, -1, axis=1)
    a, b = ahead.ravel(), ends.ravel()
    real = a != b
    a, b = a[real], b[real]
    with np.errstate(all="ignore"):
        lengths = np.linalg.norm(points[a] - points[b], axis=1)
    shortest = np.full(len(points), np.inf)
    np.minimum.at(shortest, a, lengths)
    np.minimum.at(shortest, b, lengths)
    return shortest
