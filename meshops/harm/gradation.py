"""Sizes against the gradation that a mesh has: its own edges, smoothed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from meshops.harm.edges import Edges, middles_of, used_nodes
from meshops.mesh import Floats, ShellMesh

ROUNDS = 4
"""Times that a node takes the mean of its neighbours' sizes."""

NEAREST = 4
"""Nodes that a size between nodes follows from."""

NEAR_EDGES = 12
"""Edges before that count as the neighbourhood of a new one."""


@dataclass(frozen=True, eq=False)
class Gradation:
    """How long edges are around a place, in all directions alike: geometric means.

    Attributes
    ----------
    places : (n, 3) float64
    logarithms : (n,) float64
        Of the sizes there.
    """

    places: Floats
    logarithms: Floats

    @classmethod
    def of(cls, mesh: ShellMesh, edges: Edges) -> Gradation:
        """Take the gradation of a mesh: at each node the mean of its edges, smoothed."""
        lengths = edges.lengths(mesh)
        known = lengths > 0.0
        start, end = edges.nodes[known].T
        logs, count = np.log(lengths[known]), len(mesh.points)
        degree = np.bincount(start, minlength=count) + np.bincount(end, minlength=count)
        total = np.bincount(start, logs, count) + np.bincount(end, logs, count)
        sizes = total / np.maximum(degree, 1)
        for _ in range(ROUNDS):
            around = np.bincount(start, sizes[end], count) + np.bincount(end, sizes[start], count)
            sizes = (sizes + around) / (1 + degree)
        there = used_nodes(mesh) & (degree > 0)
        return cls(mesh.points[there], sizes[there])

    def at(self, places: Floats) -> Floats:
        """(n,) sizes at places (n, 3), from the nearest nodes."""
        if not len(self.places):
            return np.ones(len(places))
        count = min(NEAREST, len(self.places))
        distance, rows = cKDTree(self.places).query(places, np.arange(1, count + 1))
        scale = np.exp(self.logarithms[rows[:, :1]])
        weights = 1.0 / (distance**2 + (1e-3 * scale) ** 2)
        sizes: Floats = np.exp((weights * self.logarithms[rows]).sum(1) / weights.sum(1))
        return sizes

    def of_elements(self, mesh: ShellMesh) -> Floats:
        """(M,) sizes at the middles of elements."""
        return self.at(middles_of(mesh))


@dataclass(frozen=True)
class SizeRatio:
    """Edges over the size that the mesh had there before.

    Attributes
    ----------
    least, greatest : float
        Of all edges.
    shrunk, grown : float
        How much shorter (below 1) or longer (above 1) than any edge near it before the worst new
        edge is, of those that are out of bounds.
    place : (x, y, z) or None
        Of the worst.
    """

    least: float
    greatest: float
    shrunk: float = 1.0
    grown: float = 1.0
    place: tuple[float, float, float] | None = None


def size_ratio(mesh: ShellMesh, edges: Edges, gradation: Gradation) -> SizeRatio:
    """Least and greatest ratio of the edges of a mesh."""
    ratios = edges.lengths(mesh) / gradation.at(mesh.points[edges.nodes].mean(axis=1))
    if not len(ratios):
        return SizeRatio(1.0, 1.0)
    return SizeRatio(float(ratios.min()), float(ratios.max()))


def compare_sizes(
    before: ShellMesh,
    edges_before: Edges,
    after: ShellMesh,
    edges_after: Edges,
    gradation: Gradation,
    bounds: tuple[float, float],
) -> SizeRatio:
    """Compare the edges of a mesh with the gradation and with the edges near them before.

    Within the `bounds`, ratios to the gradation, any edge is right; beyond them none may be
    shorter or longer than those around it were.
    """
    middles = after.points[edges_after.nodes].mean(axis=1)
    lengths = edges_after.lengths(after)
    ratios = lengths / gradation.at(middles)
    if not len(ratios):
        return SizeRatio(1.0, 1.0)
    shrunk, grown, place = 1.0, 1.0, None
    out = np.flatnonzero((ratios < bounds[0]) | (ratios > bounds[1]))
    if len(out) and len(edges_before.nodes):
        old = edges_before.lengths(before)
        count = np.arange(1, min(NEAR_EDGES, len(old)) + 1)
        tree = cKDTree(before.points[edges_before.nodes].mean(axis=1))
        near = old[tree.query(middles[out], count)[1]]
        longer = np.where(ratios[out] > bounds[1], lengths[out] / near.max(axis=1), 1.0)
        least = np.maximum(near.min(axis=1), np.finfo(float).tiny)
        shorter = np.where(ratios[out] < bounds[0], lengths[out] / least, 1.0)
        grown, shrunk = max(1.0, float(longer.max())), min(1.0, float(shorter.min()))
        worst = np.argmax(np.maximum(longer, 1.0 / np.maximum(shorter, 1e-300)))
        x, y, z = middles[out[worst]].tolist()
        place = (x, y, z)
    return SizeRatio(float(ratios.min()), float(ratios.max()), shrunk, grown, place)
