"""Meshing of CAD files by gmsh: the only file that imports it (the extra ``[cad]``)."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from meshops.errors import InputError
from meshops.geometry import default_size, same_nodes
from meshops.mesh import NO_NODE, Ids, ShellMesh
from meshops.opposites import Face, Line, matched_divisions

PROPERTY = 1
"""Region of all elements: faces meet at feature edges, which no operation crosses anyhow."""

TRIA, QUAD = 2, 3
"""Element types of gmsh."""

ATTEMPTS = 4
"""How often the borders of faces that fall onto each other are divided twice as finely."""

SAMPLES = 33
"""Directions by which the turn of a curve is measured."""

OPTIONS = {
    "General.Terminal": 0,
    "General.NumThreads": 1,
    "Geometry.OCCSewFaces": 1,
    "Mesh.Algorithm": 9,  # packing of parallelograms: the fewest failing elements of all
    "Mesh.RecombineAll": 1,
    "Mesh.RecombinationAlgorithm": 1,  # Blossom
    "Mesh.MeshSizeExtendFromBoundary": 0,
    "Mesh.MeshSizeFromPoints": 0,
    "Mesh.RandomSeed": 1,
}


def mesh_cad(path: Path, size: float | None = None) -> ShellMesh:
    """Mesh all faces of a .step or .iges file with quads of an edge length.

    Nodes on an edge are shared by its faces. Without a size it is that of ``default_size``.

    Raises
    ------
    InputError
        Where gmsh is not installed, or the file cannot be read or meshed.
    """
    if size is not None and not 0.0 < size < np.inf:
        raise InputError(f"the element size must be a number above 0, not {size:g}.")
    if not path.is_file():
        raise InputError(f"{path} is not there: check its name.")
    with _gmsh() as gmsh:
        try:
            gmsh.open(str(path.resolve()))
            box = np.array(gmsh.model.getBoundingBox(-1, -1)).reshape(2, 3)
            faces = gmsh.model.getEntities(2)
        except Exception as error:  # gmsh raises plain Exception
            raise InputError(f"{path} cannot be read as CAD: {error}.") from error
        if not faces:
            raise InputError(f"{path} has no face to mesh: check the file.")
        edge = default_size(box) if size is None else size
        try:
            gmsh.option.setNumber("Mesh.MeshSizeMin", edge)
            gmsh.option.setNumber("Mesh.MeshSizeMax", edge)
            return _meshed(gmsh, edge)
        except Exception as error:
            reason = str(error).rstrip(".")
            raise InputError(f"{path} cannot be meshed at size {edge:g}: {reason}.") from error


@contextmanager
def _gmsh() -> Iterator[Any]:
    """Open a session of gmsh with our options; it is closed whatever happens."""
    try:
        import gmsh
    except ImportError as error:
        raise InputError(
            "CAD files need gmsh: install it by pip install 'meshipelago[cad]'."
        ) from error
    # interruptible: gmsh would take the signals that end a run
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    try:
        for name, value in OPTIONS.items():
            gmsh.option.setNumber(name, value)
        yield gmsh
    finally:
        gmsh.finalize()


def _meshed(gmsh: Any, size: float) -> ShellMesh:
    """Mesh all faces; the borders of those that fall onto each other are divided more finely."""
    least: dict[int, int] = {}
    for _ in range(ATTEMPTS):
        _match_opposite_sides(gmsh, size, least)
        gmsh.model.mesh.generate(2)
        mesh, numbers = _shells(gmsh)
        doubled = same_nodes(mesh)
        if not len(doubled):
            return mesh
        for face in {gmsh.model.mesh.getElement(number)[3] for number in numbers[doubled]}:
            for _, curve in gmsh.model.getBoundary([(2, face)], oriented=False):
                edges = len(gmsh.model.mesh.getElements(1, curve)[1][0])
                least[curve] = max(2 * edges, least.get(curve, 1))
        gmsh.model.mesh.clear()
        gmsh.model.mesh.removeConstraints()
    x, y, z = mesh.points[mesh.elements[doubled[0], :3]].mean(axis=0)
    raise InputError(
        f"faces near ({x:.4g}, {y:.4g}, {z:.4g}) fall onto each other, use a smaller size"
    )


def _match_opposite_sides(gmsh: Any, size: float, least: dict[int, int]) -> None:
    """Divide the sides of narrow and round faces, and map those that have four of them."""
    faces = {}
    for _, number in gmsh.model.getEntities(2):
        loops = gmsh.model.occ.getCurveLoops(number)[1]
        curves = tuple(tuple(abs(int(curve)) for curve in loop) for loop in loops)
        is_plane = gmsh.model.getType(2, number) == "Plane"
        faces[number] = Face(gmsh.model.occ.getMass(2, number), curves, is_plane)
    used = {curve for face in faces.values() for loop in face.loops for curve in loop}
    lines = {curve: _line(gmsh, curve) for curve in sorted(used)}
    divisions = matched_divisions(list(faces.values()), lines, size, least)
    for curve, edges in divisions.items():
        gmsh.model.mesh.setTransfiniteCurve(curve, edges + 1)
    for number, face in faces.items():
        if face.is_map(divisions):
            gmsh.model.mesh.setTransfiniteSurface(number)


def _line(gmsh: Any, curve: int) -> Line:
    """Measure a curve."""
    (first,), (last,) = gmsh.model.getParametrizationBounds(1, curve)
    along = np.linspace(first, last, SAMPLES)
    ways = np.array(gmsh.model.getDerivative(1, curve, along)).reshape(-1, 3)
    ways /= np.linalg.norm(ways, axis=1, keepdims=True).clip(1e-300)
    turns = np.arccos((ways[1:] * ways[:-1]).sum(axis=1).clip(-1.0, 1.0))
    return Line(gmsh.model.occ.getMass(1, curve), float(np.degrees(turns).sum()))


def _shells(gmsh: Any) -> tuple[ShellMesh, Ids]:
    """Take the trias and quads of all faces out of gmsh, nodes in the order of their tags.

    Beside the mesh: (M,) gmsh's tags of the elements.
    """
    tags, places, _ = gmsh.model.mesh.getNodes()
    blocks, numbers = [], []
    for kind, corners in ((QUAD, 4), (TRIA, 3)):
        element_tags, nodes = gmsh.model.mesh.getElementsByType(kind)
        block = np.full((len(element_tags), 4), NO_NODE, np.int64)
        block[:, :corners] = np.asarray(nodes, np.int64).reshape(-1, corners)
        blocks.append(block)
        numbers.append(np.asarray(element_tags, np.int64))
    elements = np.concatenate(blocks)
    if not len(elements):
        raise InputError("gmsh made no element")
    used = np.unique(elements[elements != NO_NODE])
    order = np.argsort(tags)
    points = places.reshape(-1, 3)[order[np.searchsorted(tags[order], used)]]
    rows = np.where(elements == NO_NODE, NO_NODE, np.searchsorted(used, elements))
    region = np.full(len(rows), PROPERTY, np.int32)
    return ShellMesh.build(points, rows, region=region), np.concatenate(numbers)
