"""Meshes of gmsh, the mesher that a user would otherwise pick, in all of its configurations.

Every configuration runs in a process of its own, since some of them crash or never end.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi, radians
from pathlib import Path

import numpy as np

from benchmarks.isolation import isolated
from benchmarks.parts import Loop, Part, segments
from meshops.mesh import NO_NODE, Floats, Ids, ShellMesh

ALGORITHMS = {
    1: "MeshAdapt",
    5: "Delaunay",
    6: "Frontal-Delaunay",
    8: "Frontal-Delaunay for quads",
    9: "Packing of parallelograms",
    11: "Quasi-structured quads",
}
"""``Mesh.Algorithm``."""

RECOMBINATIONS = {0: "simple", 1: "Blossom", 2: "simple full-quad", 3: "Blossom full-quad"}
"""``Mesh.RecombinationAlgorithm``."""

TIMEOUT = 60.0
"""Seconds after which a configuration is given up; one that ends takes 20 at the most."""

CLASSIFYING_ANGLE = 40.0
"""Degrees between two trias of an STL file from which their edge bounds a surface."""

_TRIA, _QUAD = 2, 3
"""Numbers of the two element types in gmsh."""


@dataclass(frozen=True, order=True)
class Configuration:
    """How gmsh is to mesh."""

    algorithm: int
    recombination: int

    def __str__(self) -> str:
        return f"{ALGORITHMS[self.algorithm]} + {RECOMBINATIONS[self.recombination]}"


CONFIGURATIONS = tuple(Configuration(a, r) for a in ALGORITHMS for r in RECOMBINATIONS)


def gmsh_mesh(part: Part, configuration: Configuration) -> ShellMesh:
    """Mesh a planar part; raises IsolatedError where gmsh does not come back with elements."""
    return isolated(_mesh_part, part, configuration, timeout=TIMEOUT)


def gmsh_solid(path: Path, size: float, configuration: Configuration) -> ShellMesh:
    """Mesh the faces of a STEP, IGES or STL file; each face is a region. Raises as gmsh_mesh."""
    return isolated(_mesh_file, path, size, configuration, timeout=TIMEOUT)


def gmsh_polygon(places: Floats, configuration: Configuration) -> ShellMesh:
    """Mesh within a border (B, 2) that gets no further nodes, sizes as on the border."""
    return isolated(_mesh_polygon, places, configuration, timeout=TIMEOUT)


def _mesh_part(part: Part, configuration: Configuration) -> ShellMesh:
    import gmsh

    def build() -> None:
        loops = [add_loop(loop) for loop in (part.outline, *part.holes)]
        gmsh.model.geo.addPlaneSurface(loops)
        gmsh.model.geo.synchronize()
        _set_size(part.size)

    return generate(configuration, build)


def _mesh_file(path: Path, size: float, configuration: Configuration) -> ShellMesh:
    import gmsh

    def build() -> None:
        gmsh.merge(str(path))
        if path.suffix.lower() == ".stl":
            angle = radians(CLASSIFYING_ANGLE)
            gmsh.model.mesh.classifySurfaces(angle, forReparametrization=True, curveAngle=pi)
            gmsh.model.mesh.createGeometry()
        _set_size(size)

    return generate(configuration, build)


def _mesh_polygon(places: Floats, configuration: Configuration) -> ShellMesh:
    import gmsh

    def build() -> None:
        geo = gmsh.model.geo
        points = [geo.addPoint(x, y, 0.0) for x, y in places.tolist()]
        lines = [geo.addLine(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]
        geo.addPlaneSurface([geo.addCurveLoop(lines)])
        geo.synchronize()
        for line in lines:
            gmsh.model.mesh.setTransfiniteCurve(line, 2)

    return generate(configuration, build)


def add_loop(loop: Loop) -> int:
    """Add a closed loop of lines and arcs to gmsh's model; returns its tag."""
    import gmsh

    geo = gmsh.model.geo
    parts = segments(loop)
    ends = [geo.addPoint(*part.start, 0.0) for part in parts]
    curves = []
    for part, start, end in zip(parts, ends, [*ends[1:], ends[0]], strict=True):
        if part.centre is None:
            curves.append(geo.addLine(start, end))
        else:
            curves.append(geo.addCircleArc(start, geo.addPoint(*part.centre, 0.0), end))
    tag: int = geo.addCurveLoop(curves)
    return tag


def _set_size(size: float) -> None:
    import gmsh

    gmsh.option.setNumber("Mesh.MeshSizeMin", size)
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)


def generate(configuration: Configuration, build: Callable[[], None]) -> ShellMesh:
    """Mesh what `build` puts into a new model; raises ValueError where no element comes of it."""
    import gmsh

    gmsh.initialize(interruptible=False)
    try:
        options = {
            "General.Verbosity": 0,
            "General.NumThreads": 1,
            "Mesh.RandomSeed": 1,
            "Mesh.Algorithm": configuration.algorithm,
            "Mesh.RecombinationAlgorithm": configuration.recombination,
            "Mesh.RecombineAll": 1,
        }
        for name, value in options.items():
            gmsh.option.setNumber(name, value)
        gmsh.model.add("peer")
        build()
        gmsh.model.mesh.generate(2)
        return _shells()
    finally:
        gmsh.finalize()


def _shells() -> ShellMesh:
    """Read the elements of all faces; a plane mesh looks up. Raises ValueError for none."""
    import gmsh

    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    row_of_tag = np.zeros(int(tags.max(initial=0)) + 1, np.int64)
    row_of_tag[tags] = np.arange(len(tags))
    elements, region = [], []
    for _, face in gmsh.model.getEntities(2):
        kinds, _, nodes = gmsh.model.mesh.getElements(2, face)
        for kind, corners in zip(kinds, nodes, strict=True):
            if kind not in (_TRIA, _QUAD):
                raise ValueError(f"element type {kind}")
            count = 3 if kind == _TRIA else 4
            rows = row_of_tag[corners.reshape(-1, count)]
            padded = np.full((len(rows), 4), NO_NODE)
            padded[:, :count] = rows
            elements.append(padded)
            region.append(np.full(len(rows), face))
    if not elements:
        raise ValueError("no element")
    return _compact(coordinates.reshape(-1, 3), np.concatenate(elements), np.concatenate(region))


def _compact(points: Floats, elements: Ids, region: Ids) -> ShellMesh:
    """Keep the nodes that elements use, and turn a plane mesh to z > 0."""
    used, rows = np.unique(elements[elements != NO_NODE], return_inverse=True)
    compact = np.full(elements.shape, NO_NODE)
    compact[elements != NO_NODE] = rows.ravel()
    points = points[used]
    if not points[:, 2].any() and _signed_area(points, compact) < 0.0:
        tria = compact[:, 3] == NO_NODE
        compact[tria, :3] = compact[tria, 2::-1]
        compact[~tria] = compact[~tria, ::-1]
    return ShellMesh.build(points, compact, region=region)


def _signed_area(points: Floats, elements: Ids) -> float:
    """Half the cross product of the diagonals, summed; a tria repeats its last node."""
    a, b, c = (points[elements[:, k], :2] for k in range(3))
    d = np.where(elements[:, 3:] == NO_NODE, c, points[elements[:, 3], :2])
    one, other = c - a, d - b
    return 0.5 * float((one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]).sum())
