"""Where points lie on a mesh: in which elements, and where in them."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from meshops.mesh import NO_NODE, Floats, Ids, ShellMesh

_NEAREST = 16
"""Triangles of the old mesh among which the one that holds a point is looked for."""

_AT_ONCE = 20_000
"""Points looked for together: memory stays small."""

_HALVES = np.array([[0, 1, 2], [0, 2, 3]])
"""Corners of the two triangles of a quad."""


def find_places(mesh: ShellMesh, rows: Ids, points: Floats) -> tuple[Ids, Ids, Floats]:
    """Find for each point the triangle that holds it, or comes nearest, among some elements.

    Parameters
    ----------
    rows : (S,) int64
        Rows of the elements.
    points : (P, 3) float64

    Returns
    -------
    place : (P,) int64
        Of the element among ``rows``.
    corners : (P, 3) int64
        Which of its corners make the triangle.
    weights : (P, 3) float64
        Of these corners, none below 0; their sum is 1.
    """
    is_quad = mesh.elements[rows, 3] != NO_NODE
    place = np.concatenate([np.arange(len(rows)), np.flatnonzero(is_quad)])
    corners = np.repeat(_HALVES, [len(rows), int(is_quad.sum())], axis=0)
    nodes = mesh.elements[rows][place[:, None], corners]
    a, b, c = (mesh.points[nodes[:, k]] for k in range(3))
    count = min(_NEAREST, len(nodes))
    tree = KDTree((a + b + c) / 3)
    found = np.empty(len(points), np.int64)
    weights = np.empty((len(points), 3))
    for start in range(0, len(points), _AT_ONCE):
        part = slice(start, start + _AT_ONCE)
        near = tree.query(points[part], k=count)[1].reshape(-1, count)
        inside, miss = _within(points[part], a[near], b[near], c[near])
        best = np.argmin(miss, axis=1)
        row = np.arange(len(best))
        found[part] = near[row, best]
        weights[part] = np.clip(inside[row, best], 0.0, None)
    weights /= weights.sum(axis=1, keepdims=True)
    return place[found], corners[found], weights


def _within(points: Floats, a: Floats, b: Floats, c: Floats) -> tuple[Floats, Floats]:
    """Barycentric coordinates (P, k, 3) of points (P, 3) in triangles of corners (P, k, 3).

    And how far a point is outside of each or off its plane, in lengths of the triangle, (P, k).
    """
    u, v, offset = b - a, c - a, points[:, None] - a
    normal = np.cross(u, v)
    square = np.maximum(np.einsum("pkd,pkd->pk", normal, normal), 1e-300)
    second = np.einsum("pkd,pkd->pk", np.cross(offset, v), normal) / square
    third = np.einsum("pkd,pkd->pk", np.cross(u, offset), normal) / square
    weights = np.stack([1 - second - third, second, third], axis=2)
    height = np.einsum("pkd,pkd->pk", offset, normal) / square**0.75
    miss: Floats = np.maximum(-weights.min(axis=2), 0.0) + np.abs(height)
    return weights, miss
