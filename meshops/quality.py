"""The quality of each element: its measures, its penalties, whether it fails, its Q.I."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from meshops.criteria import Scoring
from meshops.errors import InputError
from meshops.kernels import quality as kernel
from meshops.kernels import surface
from meshops.kernels.measures import CHORDAL_DEV
from meshops.mesh import NO_NODE, Bools, Floats, Ints, ShellMesh


def element_values(mesh: ShellMesh, scoring: Scoring, reference: ShellMesh | None = None) -> Floats:
    """Measure every element by the twelve element criteria.

    Returns (M, 12) float64: lengths in the mesh's unit, angles in degrees. NaN where a criterion
    does not apply to the element; chordal deviation is NaN without a reference surface.
    """
    values = np.empty((len(mesh.elements), kernel.CRITERIA))
    kernel.measure_elements(mesh.points, mesh.elements, scoring.criteria.normalised_size, values)
    if reference is not None:
        values[:, CHORDAL_DEV] = _chordal_deviation(mesh, reference)
    return values


def element_penalties(
    mesh: ShellMesh, scoring: Scoring, reference: ShellMesh | None = None
) -> Floats:
    """(M, 12) penalties; NaN where a criterion is not active or does not apply."""
    scoring = replace(scoring, with_reference=reference is not None)
    penalties: Floats = kernel.penalise(element_values(mesh, scoring, reference), *scoring.arrays)
    return penalties


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
    failing: Bools = penalties > scoring.penalties[3] + kernel.SLACK
    return failing


def index_of_penalties(penalties: Floats, scoring: Scoring) -> Floats:
    """(M,) Q.I. of elements by their (M, 12) penalties.

    The weighted mean of the penalties that pass plus the weighted sum of those that fail, over the
    criteria that apply to the element.
    """
    weights = np.where(np.isnan(penalties), 0.0, scoring.weights[: kernel.CRITERIA])
    failing = failing_penalties(penalties, scoring)
    weighted = weights * np.nan_to_num(penalties)
    total = np.where(failing, 0.0, weights).sum(axis=1)
    passing = np.where(failing, 0.0, weighted).sum(axis=1)
    mean = np.divide(passing, total, out=np.zeros(len(penalties)), where=total > 0.0)
    index: Floats = mean + np.where(failing, weighted, 0.0).sum(axis=1)
    return index


def median_edge(mesh: ShellMesh) -> float:
    """Median length of the mesh's edges, each counted once; InputError for no element."""
    if not len(mesh.elements):
        raise InputError("the mesh has no element to take a size from: give the element size")
    edges, _ = _edges(mesh.elements)
    vectors = mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]]
    return float(np.median(np.linalg.norm(vectors, axis=1)))


def _edges(elements: Ints) -> tuple[Ints, Ints]:
    """Return the edges (E, 2), each once, and the (M, 4) edge of every side.

    A tria's fourth side repeats its third.
    """
    corners = elements.copy()
    is_tria = corners[:, 3] == NO_NODE
    corners[is_tria, 3] = corners[is_tria, 2]
    following = np.roll(corners, -1, axis=1)
    following[is_tria, 2] = corners[is_tria, 0]
    sides = np.sort(np.stack([corners, following], axis=2).reshape(-1, 2), axis=1)
    edges, edge_of_side = np.unique(sides, axis=0, return_inverse=True)
    return edges, edge_of_side.reshape(len(elements), 4).astype(np.int32)


def _chordal_deviation(mesh: ShellMesh, reference: ShellMesh) -> Floats:
    """(M,) largest distance from an edge mid-point of the element to the reference surface."""
    trias = _trias(reference)
    if not len(trias):
        raise InputError("the reference surface has no element: chordal deviation needs one")
    edges, edge_of_side = _edges(mesh.elements)
    middles = mesh.points[edges].mean(axis=1)
    spheres = surface.bounding_spheres(reference.points, trias)
    _, distances, _ = surface.nearest(middles, reference.points, trias, spheres)
    deviation: Floats = distances[edge_of_side].max(axis=1)
    return deviation


def _trias(mesh: ShellMesh) -> Ints:
    """(T, 3) trias of a surface, quads split in two, those without area left out."""
    quads = mesh.elements[~mesh.is_tria]
    trias = np.concatenate([mesh.elements[:, :3], quads[:, [0, 2, 3]]])
    a, b, c = mesh.points[trias].transpose(1, 0, 2)
    return trias[np.cross(b - a, c - a).any(axis=1)]
