"""Exact distances from points to segments and to trias.

Items are sorted by their reach into octaves, with a tree of the middles of each: an item that is
nearer than the best known one has its middle within the sum of that distance and its own reach.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial import cKDTree

from meshops.mesh import Floats, Ids

CHUNK = 20_000
"""Points that are looked up at once, which bounds the memory."""

_TINY = 1e-300

Measure = Callable[[Floats, Floats], Floats]


def to_segments(points: Floats, segments: Floats) -> tuple[Floats, Ids]:
    """(P,) distances of points (P, 3) to the nearest of segments (S, 2, 3), and its row.

    Infinite and -1 where there is no segment.
    """
    return _nearest(points, segments, _point_to_segment)


def to_trias(points: Floats, trias: Floats) -> tuple[Floats, Ids]:
    """(P,) distances of points (P, 3) to the nearest of trias (T, 3, 3), and its row.

    Infinite and -1 where there is no tria.
    """
    return _nearest(points, trias, _point_to_tria)


def _nearest(points: Floats, items: Floats, measure: Measure) -> tuple[Floats, Ids]:
    best, nearest = np.full(len(points), np.inf), np.full(len(points), -1, np.int64)
    if not len(points) or not len(items):
        return best, nearest
    middles = items.mean(axis=1)
    reach = np.linalg.norm(items - middles[:, None], axis=2).max(axis=1)
    octave = np.floor(np.log2(np.maximum(reach, _TINY)))
    groups = [np.flatnonzero(octave == value) for value in np.unique(octave)]
    trees = [cKDTree(middles[group]) for group in groups]
    for start in range(0, len(points), CHUNK):
        rows = np.arange(start, min(start + CHUNK, len(points)))
        for group, tree in zip(groups, trees, strict=True):
            _, found = tree.query(points[rows])
            _improve(best, nearest, rows, group[found], measure(points[rows], items[group[found]]))
        for group, tree in zip(groups, trees, strict=True):
            near = tree.query_ball_point(points[rows], best[rows] + reach[group].max())
            count = np.array([len(found) for found in near])
            if not count.any():
                continue
            owner = np.repeat(rows, count)
            found = group[np.concatenate([f for f in near if f]).astype(np.int64)]
            distance = measure(points[owner], items[found])
            order = np.lexsort((found, distance, owner))
            first = order[np.unique(owner[order], return_index=True)[1]]
            _improve(best, nearest, owner[first], found[first], distance[first])
    return best, nearest


def _improve(best: Floats, nearest: Ids, rows: Ids, items: Ids, distance: Floats) -> None:
    better = distance < best[rows]
    best[rows[better]], nearest[rows[better]] = distance[better], items[better]


def _point_to_segment(points: Floats, segments: Floats) -> Floats:
    start, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    share = np.einsum("ij,ij->i", points - start, along)
    share /= np.maximum(np.einsum("ij,ij->i", along, along), _TINY)
    foot = start + np.clip(share, 0.0, 1.0)[:, None] * along
    distance: Floats = np.linalg.norm(points - foot, axis=1)
    return distance


def _point_to_tria(points: Floats, trias: Floats) -> Floats:
    a, b, c = trias.transpose(1, 0, 2)
    normal = np.cross(b - a, c - a)
    square = np.einsum("ij,ij->i", normal, normal)
    height = np.einsum("ij,ij->i", points - a, normal) / np.maximum(square, _TINY)
    foot = points - height[:, None] * normal
    inside = square > 0.0
    distance = np.full(len(points), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        inside &= np.einsum("ij,ij->i", np.cross(end - start, foot - start), normal) >= 0.0
        side = np.stack([start, end], axis=1)
        distance = np.minimum(distance, _point_to_segment(points, side))
    return np.where(inside, np.linalg.norm(points - foot, axis=1), distance)
