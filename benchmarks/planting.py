"""Faults of shape that are put into a sound mesh: what a repair has to find and mend."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from meshops.harm.edges import INSIDE, Edges, kinds_of
from meshops.mesh import NO_NODE, Bools, Floats, Ids, ShellMesh

Rng = np.random.Generator

NEEDLE = 0.04
"""Share of an edge that a needle's short side is long."""


def planted(mesh: ShellMesh, rng: Rng, *, faults: int) -> tuple[ShellMesh, int]:
    """Put faults into a mesh, far from its lines and from each other where there is room.

    Returns the mesh and how many faults found a place.
    """
    taken = np.zeros(len(mesh.points), bool)
    count = 0
    for _ in range(faults):
        plant = PLANTS[int(rng.integers(len(PLANTS)))]
        rows = _free_quads(mesh, taken)
        inner = _free_quads(mesh, taken | _on_lines(mesh))
        if not len(inner):
            plant, inner = tria_pair, rows
        if not len(inner):
            break
        row = int(rng.choice(inner))
        corners = mesh.elements[row]
        mesh = plant(mesh, row, rng)
        around = mesh.elements[np.isin(mesh.elements, corners).any(axis=1)]
        taken = np.append(taken, np.zeros(len(mesh.points) - len(taken), bool))
        taken[around[around != NO_NODE]] = True
        count += 1
    return mesh, count


def tria_pair(mesh: ShellMesh, row: int, rng: Rng) -> ShellMesh:
    """Split a quad along one of its diagonals."""
    a, b, c, d = np.roll(mesh.elements[row], rng.integers(2)).tolist()
    return _instead(mesh, [row], [(a, b, c, NO_NODE), (a, c, d, NO_NODE)], row)


def doublet(mesh: ShellMesh, row: int, rng: Rng) -> ShellMesh:
    """Split a quad in two that share two sides, with a node in its middle."""
    a, b, c, d = np.roll(mesh.elements[row], rng.integers(2)).tolist()
    middle = mesh.points[mesh.elements[row]].mean(axis=0)
    m = len(mesh.points)
    return _instead(_with_node(mesh, middle), [row], [(a, b, c, m), (a, m, c, d)], row)


def needle(mesh: ShellMesh, row: int, rng: Rng) -> ShellMesh:
    """Put a node near the end of an inner edge: a needle on either side of it."""
    a, b, c, d = np.roll(mesh.elements[row], rng.integers(4)).tolist()
    has = np.isin(mesh.elements, (a, b)).sum(axis=1) == 2
    (other,) = (int(k) for k in np.flatnonzero(has) if k != row)
    start = int(np.flatnonzero(mesh.elements[other] == b)[0])
    _, _, e, f = np.roll(mesh.elements[other], -start).tolist()
    place = mesh.points[a] + NEEDLE * (mesh.points[b] - mesh.points[a])
    m = len(mesh.points)
    new = [(a, m, d, NO_NODE), (m, b, c, d), (m, a, e, NO_NODE), (b, m, e, f)]
    return _instead(_with_node(mesh, place), [row, other], new, row)


def misplaced_node(mesh: ShellMesh, row: int, rng: Rng) -> ShellMesh:
    """Move a corner of a quad beyond the diagonal of its neighbours, so that it is concave."""
    a, _, c, _ = np.roll(mesh.elements[row], rng.integers(4)).tolist()
    points = mesh.points.copy()
    points[a] += rng.uniform(0.5, 0.6) * (points[c] - points[a])
    return replace(mesh, points=points)


PLANTS: tuple[Callable[[ShellMesh, int, Rng], ShellMesh], ...] = (
    tria_pair,
    doublet,
    needle,
    misplaced_node,
)
"""The kinds of faults."""


def _on_lines(mesh: ShellMesh) -> Bools:
    """(N,) bool: nodes on borders, T-junctions, creases and edges between regions."""
    edges = Edges.of(mesh)
    held = np.zeros(len(mesh.points), bool)
    held[edges.nodes[kinds_of(mesh, edges) != INSIDE]] = True
    return held


def _free_quads(mesh: ShellMesh, held: Bools) -> Ids:
    """Quads none of whose nodes is held, and that have quads alone around them."""
    held = held.copy()
    trias = mesh.elements[mesh.is_tria, :3]
    held[trias] = True
    return np.flatnonzero(~mesh.is_tria & ~held[mesh.elements].any(axis=1))


def _with_node(mesh: ShellMesh, place: Floats) -> ShellMesh:
    points = np.concatenate([mesh.points, [place]])
    return ShellMesh.build(points, mesh.elements, region=mesh.region)


def _instead(
    mesh: ShellMesh, gone: list[int], new: list[tuple[int, int, int, int]], like: int
) -> ShellMesh:
    """Replace some elements by others in the region of one."""
    elements = np.concatenate([np.delete(mesh.elements, gone, axis=0), new])
    region = np.append(np.delete(mesh.region, gone), [mesh.region[like]] * len(new))
    return ShellMesh.build(mesh.points, elements, region=region)
