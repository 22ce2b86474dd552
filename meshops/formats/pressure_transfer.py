"""Fields of pressure carried over to elements that are new or reshaped.

An element gets the mean of the field over its area, or its values at the corners; then all of them
are corrected by as little as it takes to keep the force and the moment of the load.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from meshops.formats.difference import Difference
from meshops.formats.places import find_places
from meshops.mesh import NO_NODE, Bools, Floats, Ids, ShellMesh

_MIDDLES = (np.arange(6) + 0.5) / 6
"""Where a field is sampled along each side of an element, to find its mean over the area."""

_GAUSS = 0.5 + np.array([-0.5, 0.5]) / np.sqrt(3.0)
"""Where force and moment are: exact for pressures that are bilinear."""

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
    corners = _corner_points(after, new)
    points = np.einsum("sk,tkd->tsd", _shapes(_MIDDLES, _MIDDLES), corners)
    found = _field_at(before, old, values, points.reshape(-1, 3))
    weights = np.maximum(np.linalg.norm(_sample_vectors(corners, _MIDDLES), axis=2), 1e-300)
    means = (found.reshape(weights.shape) * weights).sum(axis=1) / weights.sum(axis=1)
    pressures = np.repeat(means[:, None], 4, axis=1)
    if uneven:
        at_corners = _field_at(before, old, values, _inner_corners(after, new).reshape(-1, 3))
        pressures = at_corners.reshape(-1, 4)
    kept = _is_kept(before, old, after)
    return pressures + _correction(before, old[~kept], values[~kept], after, new, pressures, acting)


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
    places = _corner_points(before, gone).reshape(-1, 3)
    middle = places.mean(axis=0)
    size = float(np.abs(places - middle).max()) or 1.0

    def effects(mesh: ShellMesh, rows: Ids, at_corners: Floats) -> Floats:
        """(K, 6) force and moment of each element, integrated over it."""
        corners = _corner_points(mesh, rows)
        shape, vectors = _shapes(_GAUSS, _GAUSS), _sample_vectors(corners, _GAUSS)
        points = np.einsum("sk,tkd->tsd", shape, corners)
        along = acting(vectors.reshape(-1, 3), points.reshape(-1, 3)).reshape(vectors.shape)
        along = along * (at_corners @ shape.T)[..., None] / len(shape)
        moments = np.cross((points - middle) / size, along)
        found: Floats = np.concatenate([_FORCE_FIRST * along, moments], axis=2).sum(axis=1)
        return found

    lacking = effects(before, gone, _as_quads(before, gone, values)).sum(axis=0)
    lacking -= effects(after, new, _as_quads(after, new, pressures)).sum(axis=0)
    per_unit = effects(after, new, np.ones((len(new), 4)))
    areas = np.linalg.norm(area_vectors(after, new)[0], axis=1)
    share = per_unit / np.maximum(areas, 1e-300)[:, None]
    answer = np.linalg.lstsq(per_unit.T @ share, lacking, rcond=1e-10)[0]
    correction: Floats = (share @ answer)[:, None]
    return correction


def _corner_points(mesh: ShellMesh, rows: Ids) -> Floats:
    """(T, 4, 3) corners; a tria is a quad whose last two are one."""
    elements = mesh.elements[rows]
    corners: Floats = mesh.points[np.where(elements == NO_NODE, elements[:, 2:3], elements)]
    return corners


def _as_quads(mesh: ShellMesh, rows: Ids, values: Floats) -> Floats:
    """(T, 4) values at the corners of ``_corner_points``."""
    is_tria = mesh.is_tria[rows][:, None] & (np.arange(4) == 3)
    quads: Floats = np.where(is_tria, values[:, 2:3], values)
    return quads


def _shapes(at: Floats, across: Floats) -> Floats:
    """(s, 4) bilinear shape functions on a grid of their coordinates."""
    u, v = (grid.ravel() for grid in np.meshgrid(at, across, indexing="ij"))
    return np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=1)


def _sample_vectors(corners: Floats, at: Floats) -> Floats:
    """(T, s, 3) area vector at each point of a grid, as if it were the same all over."""
    u, v = (grid.ravel() for grid in np.meshgrid(at, at, indexing="ij"))
    du = np.einsum("sk,tkd->tsd", np.stack([v - 1, 1 - v, v, -v], axis=1), corners)
    dv = np.einsum("sk,tkd->tsd", np.stack([u - 1, -u, u, 1 - u], axis=1), corners)
    vectors: Floats = np.cross(du, dv)
    return vectors


def _inner_corners(mesh: ShellMesh, rows: Ids) -> Floats:
    """(T, 4, 3) corners, a little inside, so that each is in one old element."""
    corners = _corner_points(mesh, rows)
    _, centres = area_vectors(mesh, rows)
    inner: Floats = corners + 1e-6 * (centres[:, None] - corners)
    return inner


def _field_at(mesh: ShellMesh, rows: Ids, values: Floats, points: Floats) -> Floats:
    """(P,) value of the field at points: in the triangle that holds them, or comes nearest."""
    place, corners, weights = find_places(mesh, rows, points)
    found: Floats = np.einsum("pk,pk->p", weights, values[place[:, None], corners])
    return found
