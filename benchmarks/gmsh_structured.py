"""Meshes of gmsh that are meant as they are: in rows, or graded on purpose."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import cos, pi, sin

from benchmarks.isolation import isolated
from benchmarks.parts import PARTS, Part
from benchmarks.peers import TIMEOUT, Configuration, add_loop, generate
from meshops.mesh import ShellMesh

CONFIGURATION = Configuration(8, 1)
"""Frontal-Delaunay for quads, with Blossom."""


def gmsh_structured(name: str) -> ShellMesh:
    """Mesh one of ``GMSH_PARTS``; raises IsolatedError where gmsh does not come back with it."""
    return isolated(_mesh, name, timeout=TIMEOUT)


def _mesh(name: str) -> ShellMesh:
    return generate(CONFIGURATION, GMSH_PARTS[name])


def _transfinite(
    corners: tuple[tuple[float, float], ...], counts: tuple[int, int], ratio: float
) -> None:
    """Quads in rows between four corners, graded along the first side."""
    import gmsh

    geo = gmsh.model.geo
    points = [geo.addPoint(x, y, 0.0) for x, y in corners]
    lines = [geo.addLine(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]
    face = geo.addPlaneSurface([geo.addCurveLoop(lines)])
    geo.synchronize()
    for k, line in enumerate(lines):
        growth = (ratio if k == 0 else 1.0 / ratio) if k % 2 == 0 else 1.0
        gmsh.model.mesh.setTransfiniteCurve(line, counts[k % 2] + 1, "Progression", growth)
    gmsh.model.mesh.setTransfiniteSurface(face)


def _ring() -> None:
    """Quarters of a ring, each transfinite."""
    import gmsh

    geo = gmsh.model.geo
    centre = geo.addPoint(0, 0, 0)
    turns = [k * pi / 2.0 for k in range(4)]
    inner, outer = ([geo.addPoint(r * cos(t), r * sin(t), 0) for t in turns] for r in (30.0, 50.0))
    spokes = [geo.addLine(a, b) for a, b in zip(inner, outer, strict=True)]
    arcs = [
        [geo.addCircleArc(ring[k], centre, ring[(k + 1) % 4]) for k in range(4)]
        for ring in (inner, outer)
    ]
    faces = []
    for k in range(4):
        loop = [spokes[k], arcs[1][k], -spokes[(k + 1) % 4], -arcs[0][k]]
        faces.append(geo.addPlaneSurface([geo.addCurveLoop(loop)]))
    geo.synchronize()
    for spoke in spokes:
        gmsh.model.mesh.setTransfiniteCurve(spoke, 6, "Progression", 1.1)
    for arc in (*arcs[0], *arcs[1]):
        gmsh.model.mesh.setTransfiniteCurve(arc, 13)
    for face in faces:
        gmsh.model.mesh.setTransfiniteSurface(face)


def _graded(part: Part) -> None:
    """Mesh a part with elements that grow with the distance from its corner."""
    import gmsh

    gmsh.model.geo.addPlaneSurface([add_loop(loop) for loop in (part.outline, *part.holes)])
    gmsh.model.geo.synchronize()
    field = gmsh.model.mesh.field
    tag = field.add("MathEval")
    field.setString(tag, "F", f"{part.size} * (0.5 + 0.012 * Sqrt(x * x + y * y))")
    field.setAsBackgroundMesh(tag)
    for option in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)


_PLATE = ((0.0, 0.0), (120.0, 0.0), (120.0, 40.0), (0.0, 40.0))
_TRAPEZIUM = ((0.0, 0.0), (120.0, 10.0), (110.0, 50.0), (10.0, 40.0))
_WEB = ((0.0, 0.0), (200.0, 0.0), (200.0, 8.0), (0.0, 8.0))

GMSH_PARTS: dict[str, Callable[[], None]] = {
    "transfinite plate": partial(_transfinite, _PLATE, (30, 10), 1.0),
    "transfinite plate, graded": partial(_transfinite, _PLATE, (26, 8), 1.12),
    "transfinite trapezium": partial(_transfinite, _TRAPEZIUM, (24, 9), 1.06),
    "transfinite web": partial(_transfinite, _WEB, (40, 4), 1.0),
    "transfinite ring": _ring,
    **{f"{part.name}, graded": partial(_graded, part) for part in PARTS},
}
"""How to build each in a new model."""
