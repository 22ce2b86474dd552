"""Fields of pressure carried over to elements that are new or reshaped.

An element gets the mean of the field over its area, or its values at the corners; then all of them
are corrected by as little as it takes to keep the force and the moment of the load.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.spatial import KDTree

from meshops.formats.difference import Difference
from meshops.mesh import NO_NODE, Bools, Floats, Ids, ShellMesh

_SAMPLES = 6
"""Along each side of an element: enough for force to stay within a percent before correction."""

_NEAREST = 16
"""Triangles of the old mesh among which the one that holds a point is looked for."""

_FORCE_FIRST = 1e3
"""Weight of an error of force against one of moment, where both cannot be kept."""

AreaVectors = Callable[[Floats, Floats], Floats]
"""Turns the area vectors (K, 3) at some centres (K, 3) into those along which a load acts."""


def touched_elements(change: Difference) -> Bools:
    """(M,) bool: which elements of an edited mesh are new, or have other nodes or moved ones."""
    touched = np.asarray(np.isin(change.mesh.elements, change.moved).any(axis=1))
    touched[change.rewired] = True
    touched[change.new_elements] = True
    return touched


def carry_over(
    before: ShellMesh,
    old: Ids,
    values: Floats,
    after: ShellMesh,
    new: Ids,
    acting: AreaVectors,
) -> Floats:
    """Pressures (T, 4) at the corners of the elements ``new`` of an edited mesh.

    Parameters
    ----------
    before, old : ShellMesh, (S,) int64
        The mesh as it was and the rows of its elements that are samples of the field.
    values : (S, 4) float64
        Pressures at their corners; of a tria the last counts for nothing.
    after, new : ShellMesh, (T,) int64
    acting
        Directions of the load.
    """
    uneven = bool((values != values[:, :1]).any())
    points = _sample_points(after, new)
    found = _field_at(before, old, values, points.reshape(-1, 3))
    weights = _sample_weights(after, new)
    means = (found.reshape(weights.shape) * weights).sum(axis=1) / weights.sum(axis=1)
    pressures = np.repeat(means[:, None], 4, axis=1)
    if uneven:
        at_corners = _field_at(before, old, values, _inner_corners(after, new).reshape(-1, 3))
        pressures = at_corners.reshape(-1, 4)
    kept = _is_kept(before, old, after)
    return pressures + _correction(before, old[~kept], values[~kept], after, new, pressures, acting)


def mean_pressures(mesh: ShellMesh, rows: Ids, values: Floats) -> Floats:
    """(K,) mean of the pressures (K, 4) at the corners of elements."""
    counts = mesh.elements[rows] != NO_NODE
    means: Floats = (values * counts).sum(axis=1) / counts.sum(axis=1)
    return means


def area_vectors(mesh: ShellMesh, rows: Ids) -> tuple[Floats, Floats]:
    """(K, 3), (K, 3): area vectors and centres of elements."""
    elements = mesh.elements[rows]
    is_tria = elements[:, 3] == NO_NODE
    a, b, c, d = (mesh.points[elements[:, k]] for k in range(4))
    d = np.where(is_tria[:, None], c, d)
    vectors: Floats = np.cross(c - a, d - b) / 2
    vectors[is_tria] = np.cross(b - a, c - a)[is_tria] / 2
    centres = np.where(is_tria[:, None], (a + b + c) / 3, (a + b + c + d) / 4)
    return vectors, centres


def _is_kept(before: ShellMesh, old: Ids, after: ShellMesh) -> Bools:
    """(S,) bool: which elements are in the edited mesh, on the same nodes in the same places."""
    row_of = {int(e): row for row, e in enumerate(after.element_ids.tolist()) if e}
    kept = np.zeros(len(old), bool)
    for k, row in enumerate(old.tolist()):
        other = row_of.get(int(before.element_ids[row]), -1)
        if other < 0:
            continue
        mine, theirs = before.elements[row], after.elements[other]
        kept[k] = bool(
            ((mine == NO_NODE) == (theirs == NO_NODE)).all()
            and (before.points[mine] == after.points[theirs])[mine != NO_NODE].all()
        )
    return kept


def _correction(
    before: ShellMesh,
    gone: Ids,
    values: Floats,
    after: ShellMesh,
    new: Ids,
    pressures: Floats,
    acting: AreaVectors,
) -> Floats:
    """(T, 1) what to add so that force and moment stay; the least in the mean over the area."""
    if not len(gone):
        return np.zeros((len(new), 1))
    vectors, centres = area_vectors(before, gone)
    others, places = area_vectors(after, new)
    middle = centres.mean(axis=0)
    size = float(np.abs(centres - middle).max()) or 1.0

    def effect(vectors: Floats, centres: Floats) -> Floats:
        along = acting(vectors, centres)
        moments = np.cross((centres - middle) / size, along)
        return np.concatenate([_FORCE_FIRST * along, moments], axis=1)

    lacking = mean_pressures(before, gone, values) @ effect(vectors, centres)
    per_unit = effect(others, places)
    lacking -= mean_pressures(after, new, pressures) @ per_unit
    share = per_unit / np.maximum(np.linalg.norm(others, axis=1), 1e-300)[:, None]
    answer = np.linalg.lstsq(per_unit.T @ share, lacking, rcond=1e-10)[0]
    correction: Floats = (share @ answer)[:, None]
    return correction


def _sample_points(mesh: ShellMesh, rows: Ids) -> Floats:
    """(T, s, 3) points in the elements, on a grid of their bilinear coordinates."""
    u, v = _grid()
    shape = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=1)
    elements = mesh.elements[rows]
    corners = mesh.points[np.where(elements == NO_NODE, elements[:, 2:3], elements)]
    points: Floats = np.einsum("sk,tkd->tsd", shape, corners)
    return points


def _sample_weights(mesh: ShellMesh, rows: Ids) -> Floats:
    """(T, s) area that each sample point stands for."""
    u, v = _grid()
    zero = np.zeros_like(u)
    along = np.stack([v - 1, 1 - v, v, -v], axis=1)
    across = np.stack([u - 1, -u, u, 1 - u], axis=1) + zero[:, None]
    elements = mesh.elements[rows]
    corners = mesh.points[np.where(elements == NO_NODE, elements[:, 2:3], elements)]
    du = np.einsum("sk,tkd->tsd", along, corners)
    dv = np.einsum("sk,tkd->tsd", across, corners)
    weights: Floats = np.maximum(np.linalg.norm(np.cross(du, dv), axis=2), 1e-300)
    return weights


def _grid() -> tuple[Floats, Floats]:
    middle = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    u, v = np.meshgrid(middle, middle, indexing="ij")
    return u.ravel(), v.ravel()


def _inner_corners(mesh: ShellMesh, rows: Ids) -> Floats:
    """(T, 4, 3) corners, a little inside, so that each is in one old element."""
    elements = mesh.elements[rows]
    corners = mesh.points[np.where(elements == NO_NODE, elements[:, 2:3], elements)]
    _, centres = area_vectors(mesh, rows)
    inner: Floats = corners + 1e-6 * (centres[:, None] - corners)
    return inner


def _field_at(mesh: ShellMesh, rows: Ids, values: Floats, points: Floats) -> Floats:
    """(P,) value of the field at points: in the triangle that holds them, or comes nearest."""
    elements = mesh.elements[rows]
    is_quad = elements[:, 3] != NO_NODE
    corners = np.concatenate([elements[:, [0, 1, 2]], elements[is_quad][:, [0, 2, 3]]])
    at_corners = np.concatenate([values[:, [0, 1, 2]], values[is_quad][:, [0, 2, 3]]])
    a, b, c = (mesh.points[corners[:, k]] for k in range(3))
    count = min(_NEAREST, len(corners))
    near: Ids = KDTree((a + b + c) / 3).query(points, k=count)[1].reshape(len(points), count)
    u, v = b - a, c - a
    normal = np.cross(u, v)
    square = np.maximum(np.einsum("ij,ij->i", normal, normal), 1e-300)
    offset = points[:, None] - a[near]
    second = np.einsum("pkd,pkd->pk", np.cross(offset, v[near]), normal[near]) / square[near]
    third = np.einsum("pkd,pkd->pk", np.cross(u[near], offset), normal[near]) / square[near]
    weights = np.stack([1 - second - third, second, third], axis=2)
    height = np.einsum("pkd,pkd->pk", offset, normal[near]) / square[near] ** 0.75
    # how far outside, and how far off its plane, in lengths of the triangle
    miss = np.maximum(-weights.min(axis=2), 0.0) + np.abs(height)
    best = np.argmin(miss, axis=1)
    row = np.arange(len(points))
    inside = np.clip(weights[row, best], 0.0, None)
    inside /= inside.sum(axis=1, keepdims=True)
    found: Floats = np.einsum("pk,pk->p", inside, at_corners[near[row, best]])
    return found
