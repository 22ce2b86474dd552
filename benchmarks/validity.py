"""Whether a plane mesh is still a mesh of the same part: plain checks, shared with no operation."""

from __future__ import annotations

import numpy as np

from meshops.mesh import NO_NODE, Bools, Floats, ShellMesh
from meshops.topology import topology

AREA_TOLERANCE = 1e-9
"""Of the area of the part."""


def faults(before: ShellMesh, after: ShellMesh) -> list[str]:
    """List in words what is wrong with a plane mesh that descends from another; none: it is valid.

    Elements must be convex and look up, the area and the number of holes must be the same, no edge
    may have more than two elements, and locked nodes must be where they were.
    """
    checks = {
        "an element is not convex": bool((_corner_areas(after) <= 0.0).any()),
        "the area changed": abs(_area(after) - _area(before)) > AREA_TOLERANCE * _area(before),
        "a hole opened or closed": _euler_characteristic(before) != _euler_characteristic(after),
        "more than two elements meet at an edge": bool(topology(after).is_t_junction.any()),
        "a locked node moved": not _locked_places(before) <= _locked_places(after),
    }
    return [fault for fault, found in checks.items() if found]


def _corner_areas(mesh: ShellMesh) -> Floats:
    """(C,) cross product at every corner of every element, seen from above."""
    quads, trias = mesh.elements[~mesh.is_tria], mesh.elements[mesh.is_tria, :3]
    areas = []
    for corners in (mesh.points[quads, :2], mesh.points[trias, :2]):
        ahead = np.roll(corners, -1, axis=1) - corners
        back = np.roll(corners, 1, axis=1) - corners
        areas.append((ahead[..., 0] * back[..., 1] - ahead[..., 1] * back[..., 0]).ravel())
    return np.concatenate(areas)


def _area(mesh: ShellMesh) -> float:
    """Half the cross product of the diagonals, summed; a tria repeats its last node."""
    corners = mesh.elements.copy()
    tria = mesh.is_tria
    corners[tria, 3] = corners[tria, 2]
    a, b, c, d = np.swapaxes(mesh.points[corners, :2], 0, 1)
    one, other = c - a, d - b
    return 0.5 * float((one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]).sum())


def _euler_characteristic(mesh: ShellMesh) -> int:
    used: Bools = np.zeros(len(mesh.points), bool)
    used[mesh.elements[mesh.elements != NO_NODE]] = True
    return int(np.count_nonzero(used)) - len(topology(mesh).edges) + len(mesh.elements)


def _locked_places(mesh: ShellMesh) -> set[tuple[float, ...]]:
    return set(map(tuple, mesh.points[mesh.locked_nodes].tolist()))
