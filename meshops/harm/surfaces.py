"""How far the surface has moved, and the area of each region."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from meshops.harm.changes import Changes
from meshops.harm.edges import (
    FEATURE_ANGLE,
    Edges,
    area_vectors,
    corners_of,
    dihedral_angles,
    middles_of,
    used_nodes,
)
from meshops.harm.nearest import to_trias
from meshops.mesh import Bools, Floats, Ids, ShellMesh

LIMIT = 0.01
"""Share of the local edge that a node may lie off the surface."""

AREA_LIMIT = 0.001
"""Share of a region's area that it may change by."""

SMOOTH = 60.0
"""Degrees up to which two elements lie on one side, and from 180 back, on each other."""

_SPLITS = ((0, 1, 2), (0, 2, 3), (0, 1, 3), (1, 2, 3))
"""A warped quad is what lies between its two ways to be split: either will do."""


@dataclass(frozen=True)
class SurfaceDeviation:
    """How far two surfaces lie apart, in shares of the local edge before.

    Attributes
    ----------
    nodes : float
        Largest distance of a new or moved node from the old surface.
    middles : float
        Of the middle of a new element.
    back : float
        Of an old node or middle, that is no longer there, from the new surface.
    facets : float
        How far the old mesh itself lies off a smooth surface through its nodes, at the most and
        where it has changed: what the middles and the way back cannot but differ by.
    turned : int
        New elements whose normal is opposite to that of the surface.
    place : (x, y, z) or None
        Where a node is farthest off.
    """

    nodes: float
    middles: float
    back: float
    facets: float
    turned: int
    place: tuple[float, float, float] | None

    @property
    def excess(self) -> float:
        """The largest share beyond what the facets of the old mesh explain."""
        return max(self.nodes, self.middles - self.facets, self.back - self.facets)


def areas_by_region(mesh: ShellMesh, folded: Bools) -> dict[int, float]:
    """Area of each region: quads by both of their splits, the mean.

    What is `folded` back, (M,) bool, or lies outside of a concave quad, covers nothing and counts
    against what it lies on.
    """
    if not len(mesh.elements):
        return {}
    corners, normals = mesh.points[corners_of(mesh)], area_vectors(mesh)
    areas = np.zeros(len(corners))
    for a, b, c in _SPLITS:
        half = np.cross(corners[:, b] - corners[:, a], corners[:, c] - corners[:, a])
        sign = np.sign(np.einsum("ij,ij->i", half, normals))
        areas += 0.25 * sign * np.linalg.norm(half, axis=1)
    areas[mesh.is_tria] = np.linalg.norm(normals[mesh.is_tria], axis=1)
    areas[folded] *= -1.0
    regions, which = np.unique(mesh.region, return_inverse=True)
    return dict(zip(regions.tolist(), np.bincount(which, areas).tolist(), strict=True))


def folded_elements(mesh: ShellMesh, edges: Edges) -> Bools:
    """(M,) bool: elements that look the other way than those around them, over shared edges.

    Only neighbours that run along their common edge as elements of one side do have a say, and not
    across a crease: what is folded back turns by nearly 180 degrees.
    """
    normals = area_vectors(mesh)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = normals / np.maximum(lengths, np.finfo(float).tiny)
    two = edges.pair[:, 0] >= 0
    pair, sides, angles = edges.pair[two], edges.pair_sides[two], dihedral_angles(mesh, edges)[two]
    agree = mesh.elements[pair[:, 0], sides[:, 0]] != mesh.elements[pair[:, 1], sides[:, 1]]
    one, other = pair[agree & ((angles < SMOOTH) | (angles > 180.0 - SMOOTH))].T
    around = normals
    for _ in range(2):
        total = np.zeros_like(normals)
        for axis in range(3):
            total[:, axis] += np.bincount(one, around[other, axis], len(normals))
            total[:, axis] += np.bincount(other, around[one, axis], len(normals))
        around = total
    folded: Bools = np.einsum("ij,ij->i", normals, around) < 0.0
    return folded


def worst_area_change(before: dict[int, float], after: dict[int, float]) -> tuple[float, int]:
    """Largest relative change of a region's area, and its region; 1 for one that came or went."""
    worst, where = 0.0, 0
    for region in {*before, *after}:
        old, new = before.get(region, 0.0), after.get(region, 0.0)
        change = abs(new - old) / max(old, new, np.finfo(float).tiny)
        if change > worst:
            worst, where = change, region
    return worst, where


def compare_surfaces(
    before: ShellMesh, edges: Edges, after: ShellMesh, changes: Changes
) -> SurfaceDeviation:
    """Measure the distances both ways where something has changed."""
    came = np.flatnonzero(changes.element_before < 0)
    gone = np.flatnonzero(~changes.kept_elements)
    if not len(came) and not len(gone):
        return SurfaceDeviation(0.0, 0.0, 0.0, 0.0, 0, None)
    old_trias, old_owner = _trias(before)
    new_trias, _ = _trias(after)
    local = _local_edge(before, edges)
    noise = 1e-7 * np.abs(before.points).max(initial=0.0)

    def off(points: Floats) -> tuple[Floats, Ids]:
        distance, row = to_trias(points, old_trias)
        if not len(old_trias):
            return distance, row
        share = np.where(distance > noise, distance, 0.0) / local[old_owner[row]]
        return share, old_owner[row]

    nodes = np.flatnonzero((changes.node_before < 0) & used_nodes(after))
    of_nodes, _ = off(after.points[nodes])
    middles = middles_of(after)[came]
    of_middles, owners = off(middles)
    normals = area_vectors(before), area_vectors(after)[came]
    turned = _turned(normals[0], normals[1], owners, middles, before) if len(old_trias) else 0
    back = _back(before, gone, changes, new_trias, local, noise)
    place = None
    if of_nodes.max(initial=0.0) > 0.0:
        x, y, z = after.points[nodes[np.argmax(of_nodes)]].tolist()
        place = (x, y, z)
    return SurfaceDeviation(
        nodes=float(of_nodes.max(initial=0.0)),
        middles=float(of_middles.max(initial=0.0)),
        back=back,
        facets=_facets(before, edges, gone),
        turned=turned,
        place=place,
    )


def _back(
    before: ShellMesh, gone: Ids, changes: Changes, trias: Floats, local: Floats, noise: float
) -> float:
    """Largest distance of what has gone from the new surface."""
    corners = corners_of(before)[gone]
    middles = middles_of(before)[gone]
    share = np.zeros(len(before.points))
    np.maximum.at(share, corners.ravel(), np.repeat(1.0 / local[gone], 4))
    lost = np.flatnonzero(~changes.kept_nodes & (share > 0.0))
    points = np.concatenate([middles, before.points[lost]])
    distance, _ = to_trias(points, trias)
    scale = np.concatenate([1.0 / local[gone], share[lost]])
    return float((np.where(distance > noise, distance, 0.0) * scale).max(initial=0.0))


def _turned(old: Floats, new: Floats, owners: Ids, middles: Floats, before: ShellMesh) -> int:
    """How many new elements look the other way than the surface under their middle."""
    against = np.einsum("ij,ij->i", old[owners], new) < 0.0
    if not against.any():
        return 0
    # next to a crease the nearest element may be the one beyond it, or be folded itself
    count = min(8, len(before.elements))
    tree = cKDTree(middles_of(before))
    near = tree.query(middles[against], np.arange(1, count + 1))[1]
    agree = np.einsum("ikj,ij->ik", old[near], new[against]) > 0.0
    return int(np.count_nonzero(~agree.any(axis=1)))


def _facets(before: ShellMesh, edges: Edges, gone: Ids) -> float:
    """Sagitta of an arc that turns at each edge as the mesh does, over its chord: a quarter."""
    angles = dihedral_angles(before, edges)
    beside = np.zeros(len(edges.nodes), bool)
    found = edges.of_side[gone]
    beside[found[found >= 0]] = True
    smooth = beside & (angles < FEATURE_ANGLE)
    # half of the turn at each end of the chord: sagitta = chord * tan(turn / 4) / 2; both meshes
    return float(np.tan(np.radians(angles[smooth].max(initial=0.0)) / 4.0))


def _local_edge(mesh: ShellMesh, edges: Edges) -> Floats:
    """(M,) shortest edge of each element with any length."""
    lengths = edges.lengths(mesh)
    sides = np.where(edges.of_side >= 0, lengths[edges.of_side], np.inf)
    sides = np.where(sides > 0.0, sides, np.inf)
    shortest = sides.min(axis=1)
    middle = np.where(np.isfinite(sides), sides, 0.0).sum(axis=1)
    mean = middle / np.maximum(np.isfinite(sides).sum(axis=1), 1)
    # a needle's short edge is no measure of the mesh around it
    local: Floats = np.maximum(np.where(np.isfinite(shortest), shortest, 1.0), 0.5 * mean)
    return local


def _trias(mesh: ShellMesh) -> tuple[Floats, Ids]:
    """(T, 3, 3) trias and all splits of quads, and (T,) their elements."""
    tria, quad = np.flatnonzero(mesh.is_tria), np.flatnonzero(~mesh.is_tria)
    parts = [mesh.elements[quad][:, split] for split in _SPLITS]
    nodes = np.concatenate([mesh.elements[tria][:, :3], *parts])
    return mesh.points[nodes], np.concatenate([tria, np.tile(quad, len(_SPLITS))])
