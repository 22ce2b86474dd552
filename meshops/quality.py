"""The quality of each element: its measures, its penalties, whether it fails, its Q.I."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from meshops import _core
from meshops.criteria import (
    CHORDAL_DEV,
    CRITERIA,
    MAX_ANGLE_QUAD,
    MAX_ANGLE_TRIA,
    MIN_ANGLE_QUAD,
    MIN_ANGLE_TRIA,
    NAMES,
    SIZES,
    SLACK,
    Scoring,
)
from meshops.errors import InputError
from meshops.mesh import NO_NODE, Bools, Floats, Ints, ShellMesh

SHAPES = [row for row, name in enumerate(NAMES[:CRITERIA]) if name not in SIZES]
"""Rows of the criteria of shape among those of elements."""


def element_values(mesh: ShellMesh, scoring: Scoring, reference: ShellMesh | None = None) -> Floats:
    """Measure every element by the twelve element criteria.

    Returns (M, 12) float64: lengths in the mesh's unit, angles in degrees. NaN where a criterion
    does not apply to the element; chordal deviation is NaN without a reference surface.
    """
    values = _core.measure_elements(mesh.points, mesh.elements, scoring.sizing)
    if reference is not None:
        values[:, CHORDAL_DEV] = chordal_deviation(mesh, reference)
    return values


def element_penalties(
    mesh: ShellMesh, scoring: Scoring, reference: ShellMesh | None = None
) -> Floats:
    """(M, 12) penalties; NaN where a criterion is not active or does not apply."""
    scoring = replace(scoring, with_reference=reference is not None)
    return _core.penalise(element_values(mesh, scoring, reference), scoring.core)


def failed_elements(mesh: ShellMesh, scoring: Scoring, reference: ShellMesh | None = None) -> Bools:
    """(M,) bool: which elements fail one of the active criteria."""
    penalties = element_penalties(mesh, scoring, reference)
    failed: Bools = np.any(failing_penalties(penalties, scoring), axis=1)
    return failed


def element_index(mesh: ShellMesh, scoring: Scoring, reference: ShellMesh | None = None) -> Floats:
    """(M,) Q.I. of each element: see :func:`index_of_penalties`."""
    return index_of_penalties(element_penalties(mesh, scoring, reference), scoring)


def failing_penalties(penalties: Floats, scoring: Scoring) -> Bools:
    """Which of some penalties lie beyond that of the fail level; NaN does not."""
    failing: Bools = penalties > scoring.penalties[3] + SLACK
    return failing


def failed_by_family(penalties: Floats, scoring: Scoring) -> tuple[Bools, Bools]:
    """(M,) bool each: elements that fail a criterion of shape, and those that fail by size alone.

    By their (M, 12) penalties.
    """
    failing = failing_penalties(penalties, scoring)
    by_size = np.isin(NAMES[:CRITERIA], SIZES)
    shape: Bools = np.any(failing[:, ~by_size], axis=1)
    size: Bools = np.any(failing[:, by_size], axis=1) & ~shape
    return shape, size


def index_of_penalties(penalties: Floats, scoring: Scoring) -> Floats:
    """(M,) Q.I. of elements by their (M, 12) penalties.

    The weighted mean of the penalties that pass plus the weighted sum of those that fail, over the
    criteria that apply to the element.
    """
    weights = np.where(np.isnan(penalties), 0.0, scoring.weights[:CRITERIA])
    failing = failing_penalties(penalties, scoring)
    weighted = weights * np.nan_to_num(penalties)
    total = np.where(failing, 0.0, weights).sum(axis=1)
    passing = np.where(failing, 0.0, weighted).sum(axis=1)
    mean = np.divide(passing, total, out=np.zeros(len(penalties)), where=total > 0.0)
    index: Floats = mean + np.where(failing, weighted, 0.0).sum(axis=1)
    return index


def angle_extremes(mesh: ShellMesh) -> tuple[Floats, Floats]:
    """Smallest and largest angle of each element, (M,) degrees; over 180 in a concave corner."""
    values = _core.measure_elements(mesh.points, mesh.elements, np.zeros(7))
    is_tria = mesh.is_tria
    least = np.where(is_tria, values[:, MIN_ANGLE_TRIA], values[:, MIN_ANGLE_QUAD])
    most = np.where(is_tria, values[:, MAX_ANGLE_TRIA], values[:, MAX_ANGLE_QUAD])
    return least, most


def element_areas(points: Floats, elements: Ints) -> Floats:
    """(M,) areas; half the cross product of its diagonals for a quad."""
    corners = points[elements]
    tria = elements[:, 3] == NO_NODE
    corners[tria, 3] = corners[tria, 2]
    vectors = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    areas: Floats = 0.5 * np.linalg.norm(vectors, axis=1)
    return areas


def region_areas(mesh: ShellMesh) -> Floats:
    """(R,) area of each region."""
    areas = np.bincount(mesh.region, element_areas(mesh.points, mesh.elements))
    return areas.astype(np.float64)


def median_edge(mesh: ShellMesh) -> float:
    """Median length of the mesh's edges, each counted once; InputError for no element."""
    if not len(mesh.elements):
        raise InputError("the mesh has no element to take a size from: give the element size")
    edges = _core.find_edges(mesh.elements, len(mesh.points))[0]
    vectors = mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]]
    return float(np.median(np.linalg.norm(vectors, axis=1)))


def chordal_deviation(mesh: ShellMesh, reference: ShellMesh) -> Floats:
    """(M,) largest distance from an edge mid-point of the element to the reference surface.

    An edge that the reference has too lies on it: where a mesh came of the reference, only what
    changed costs time. Raises InputError where the reference has no element.
    """
    trias = _trias(reference)
    if not len(trias):
        raise InputError("the reference surface has no element: chordal deviation needs one")
    edges, element_edges = _core.find_edges(mesh.elements, len(mesh.points))[:2]
    others = np.flatnonzero(~_known_edges(mesh, edges, reference))
    distances = np.zeros(len(edges))
    distances[others] = _distances(mesh.points[edges[others]].mean(axis=1), reference, trias)
    of_sides = np.where(element_edges >= 0, distances[element_edges], 0.0)
    deviation: Floats = of_sides.max(axis=1, initial=0.0)
    return deviation


def _known_edges(mesh: ShellMesh, edges: Ints, reference: ShellMesh) -> Bools:
    """(E,) bool: edges between two places between which the reference has an edge."""
    both = np.concatenate([reference.points, mesh.points])
    order = np.lexsort(both.T)
    is_other = np.ones(len(both), bool)
    is_other[1:] = (both[order[1:]] != both[order[:-1]]).any(axis=1)
    place = np.empty(len(both), np.int64)
    place[order] = np.cumsum(is_other)
    own = np.sort(place[len(reference.points) :][edges], axis=1)
    of_reference = _core.find_edges(reference.elements, len(reference.points))[0]
    known = np.sort(place[: len(reference.points)][of_reference], axis=1)
    base = len(both) + 1
    found: Bools = np.isin(own @ [base, 1], known @ [base, 1])
    return found


def _distances(queries: Floats, reference: ShellMesh, trias: Ints) -> Floats:
    """(Q,) distances from places (Q, 3) to a surface."""
    found = np.zeros(len(queries))
    if not len(queries):
        return found
    spheres = _core.bounding_spheres(reference.points, trias)
    tree = cKDTree(spheres[:, :3])
    # a tria that is nearer than the nearest centre has its own centre within its radius of that
    bounds = tree.query(queries)[0] + spheres[:, 3].max()
    for row, near in enumerate(tree.query_ball_point(queries, bounds * (1.0 + 1e-9))):
        rows = np.sort(near)
        _, distance, _ = _core.nearest(
            queries[row : row + 1], reference.points, trias[rows], spheres[rows]
        )
        found[row] = distance[0]
    return found


def _trias(mesh: ShellMesh) -> Ints:
    """(T, 3) trias of a surface, quads split in two, those without area left out."""
    quads = mesh.elements[~mesh.is_tria]
    trias = np.concatenate([mesh.elements[:, :3], quads[:, [0, 2, 3]]])
    a, b, c = mesh.points[trias].transpose(1, 0, 2)
    return trias[np.cross(b - a, c - a).any(axis=1)]
