"""Whole new OBJ, OFF and STL files."""

from __future__ import annotations

import numpy as np

from meshops.mesh import NO_NODE, Floats, Ids, Ints, ShellMesh


def obj_text(mesh: ShellMesh) -> str:
    """Text of an OBJ file."""
    points = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.points.tolist()]
    faces = [" ".join(["f", *(str(node + 1) for node in face)]) for face in _faces(mesh)]
    return "\n".join([*points, *faces, ""])


def off_text(mesh: ShellMesh) -> str:
    """Text of an OFF file."""
    points = [f"{x!r} {y!r} {z!r}" for x, y, z in mesh.points.tolist()]
    faces = [" ".join(map(str, [len(face), *face])) for face in _faces(mesh)]
    return "\n".join(["OFF", f"{len(points)} {len(faces)} 0", *points, *faces, ""])


def stl_text(mesh: ShellMesh) -> str:
    """Text of an STL file: quads are split along their shorter diagonals."""
    trias, _ = split_trias(mesh)
    return solids_text(mesh.points[trias], np.zeros(len(trias), np.int64), [""])


def solids_text(places: Floats, solid: Ids, names: list[str]) -> str:
    """Text of trias (K, 3, 3) of solids (K,) with their names."""
    rows = []
    for number, name in enumerate(names):
        rows.append(f"solid {name}".rstrip())
        some = places[solid == number]
        for normal, corners in zip(normals_of(some).tolist(), some.tolist(), strict=True):
            rows += ["facet normal " + " ".join(map(repr, normal)), " outer loop"]
            rows += ["  vertex " + " ".join(map(repr, corner)) for corner in corners]
            rows += [" endloop", "endfacet"]
        rows.append(f"endsolid {name}".rstrip())
    return "\n".join([*rows, ""])


def split_trias(mesh: ShellMesh) -> tuple[Ints, Ids]:
    """Split quads along their shorter diagonals.

    Returns
    -------
    trias : (K, 3) int32
        Those of the mesh, and two for each quad, in the order of the elements.
    element : (K,) int64
        The element that each is of.
    """
    a, b, c, d = mesh.elements.T
    p = mesh.points
    other = np.linalg.norm(p[b] - p[d], axis=1) < np.linalg.norm(p[a] - p[c], axis=1)
    first = np.where(other, [a, b, d], [a, b, c]).T
    second = np.where(other, [b, c, d], [a, c, d]).T
    first[mesh.is_tria] = mesh.elements[mesh.is_tria, :3]
    second[mesh.is_tria] = NO_NODE
    both = np.stack([first, second], axis=1).reshape(-1, 3)
    there = both[:, 0] != NO_NODE
    return both[there], np.repeat(np.arange(len(mesh.elements)), 2)[there]


def normals_of(places: Floats) -> Floats:
    """(K, 3) unit normals of trias (K, 3, 3), 0 where one has no area."""
    normals = np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    found: Floats = np.divide(normals, lengths, out=np.zeros_like(normals), where=lengths > 0.0)
    return found


def _faces(mesh: ShellMesh) -> list[list[int]]:
    return [[i for i in element if i != NO_NODE] for element in mesh.elements.tolist()]
