"""Meshing from geometry: a surface of raw trias becomes a mesh of quads.

The surface is divided into zones along its features, and further where it turns too far to be
flattened. The lines between zones are chained to curves, the curves divided evenly, and each zone
is meshed within its divided border.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from meshops._core import (
    clip_ears,
    pack_parallelograms,
    smooth_laplace,
    split_quads,
    unite_trias,
    valid_elements,
)
from meshops.errors import InputError
from meshops.mesh import NO_NODE, Floats, Ids, Ints, ShellMesh
from meshops.outlines import Outlines, loops_of
from meshops.patch import Patch, extract
from meshops.remeshing import LEAST_CORNER, SMOOTHING_SWEEPS, recombine
from meshops.surface import PatchSurface
from meshops.topology import FEATURE_ANGLE, topology
from meshops.zones import flat_zones, flattened

SIZES_ALONG = 40
"""Edges along the longest side of a part where no size is given."""

CAD = (".step", ".stp", ".iges", ".igs")

ATTEMPTS = 5
"""How often the borders of zones that fail are divided twice as finely."""

PROPERTY = 1
"""Region of all elements."""


def mesh_geometry(path: Path, size: float | None = None) -> ShellMesh:
    """Mesh a part by the kind of its file: CAD by gmsh, trias by ``mesh_surface``.

    Raises
    ------
    InputError
        Where the file is not readable or cannot be meshed.
    """
    if path.suffix.lower() in CAD:
        from meshops.cad import mesh_cad

        return mesh_cad(path, size)
    from meshops.formats import read_deck

    surface = read_deck(path).mesh
    return mesh_surface(surface, default_size(surface.points) if size is None else size)


def same_nodes(mesh: ShellMesh) -> Ids:
    """(k,) rows of all elements that lie on the same nodes as another one."""
    ordered = np.sort(mesh.elements, axis=1)
    _, kind, count = np.unique(ordered, axis=0, return_inverse=True, return_counts=True)
    rows: Ids = np.flatnonzero(count[kind.ravel()] > 1)
    return rows


def default_size(points: Floats) -> float:
    """Edge length where none is given: a share of the longest side of the bounding box."""
    if not len(points):
        raise InputError("the part has no points: check the file.")
    return float(np.ptp(points, axis=0).max()) / SIZES_ALONG


def mesh_surface(
    surface: ShellMesh, size: float, *, feature_angle: float = FEATURE_ANGLE
) -> ShellMesh:
    """Mesh a surface with quads of an edge length, and trias where its borders force them.

    Parameters
    ----------
    surface : ShellMesh
        Trias of any shape that share their nodes; quads are split.
    size : float
        Edge length, in the unit of the points.
    feature_angle : float
        Degrees between two trias from which their edge is a feature and stays.

    Raises
    ------
    InputError
        Where the surface has no element, or a zone of it cannot be meshed at this size.
    """
    if not len(surface.elements):
        raise InputError("the surface has no element: check the file.")
    if not 0.0 < size < np.inf:
        raise InputError(f"the element size must be a number above 0, not {size:g}.")
    trias = split_quads(surface.points, surface.elements, ~surface.is_tria)
    raw = topology(ShellMesh.build(surface.points, trias), feature_angle=feature_angle)
    zones = flat_zones(raw)
    finer = np.ones(len(zones), np.int32)
    for _ in range(ATTEMPTS):
        outlines = Outlines.of(raw, zones, size, finer)
        meshed = [_mesh_zone(extract(zone.topology, zone.rows), outlines, size) for zone in zones]
        failed = np.array([found is None for found in meshed])
        if not failed.any():
            whole = [found for found in meshed if found is not None]
            mesh = _assembled(outlines.points, whole)
            of_zone = np.repeat(np.arange(len(zones)), [len(elements) for _, elements in whole])
            failed[of_zone[same_nodes(mesh)]] = True
            if not failed.any():
                return mesh
        finer[failed] *= 2
    zone = zones[int(np.argmax(failed))]
    x, y, z = surface.points[trias[zone.rows, :3]].mean(axis=(0, 1))
    raise InputError(
        f"the surface near ({x:.4g}, {y:.4g}, {z:.4g}) folds or crosses itself when it is meshed "
        f"at size {size:g}: use a smaller size or repair it."
    )


def _assembled(outline: Floats, zones: list[tuple[Floats, Ints]]) -> ShellMesh:
    """Put the zones together: nodes of the outlines first, then the inner ones of each zone."""
    first = count = len(outline)
    elements = []
    for inner, quads in zones:
        elements.append(np.where(quads >= first, quads + np.int32(count - first), quads))
        count += len(inner)
    all_elements = np.concatenate(elements)
    return ShellMesh.build(
        np.concatenate([outline, *(inner for inner, _ in zones)]),
        all_elements,
        region=np.full(len(all_elements), PROPERTY, np.int32),
    )


def _mesh_zone(patch: Patch, outlines: Outlines, size: float) -> tuple[Floats, Ints] | None:
    """Mesh one zone within its divided border.

    Returns its inner nodes, (k, 3), and its elements, (m, 4), on rows of the outlines and then of
    the inner nodes. None where the border, divided too coarsely, crosses itself.
    """
    raw = flattened(patch)
    if raw is None:
        return None
    loops = [outlines.loop(patch.nodes[loop].tolist()) for loop in loops_of(patch.border)]
    rows = np.array([row for loop in loops for row in loop], np.int32)
    start = np.cumsum([0, *map(len, loops)]).astype(np.int32)
    numbers = np.arange(len(rows), dtype=np.int32)
    ahead = np.concatenate([np.roll(loop, -1) for loop in np.split(numbers, start[1:-1])])
    border = np.stack([numbers, ahead], axis=1)
    on_border = outlines.points[rows]
    flat = raw.flattened(on_border)
    room = raw.room(size) + len(rows)
    trias = clip_ears(flat, start)
    packed = None if trias is None else pack_parallelograms(flat, trias, border, size, room)
    if packed is None:
        return None
    inside, anew = packed
    points = np.concatenate([on_border, raw.lift_inner(inside[len(rows) :])])
    elements = _quads(points, anew, len(rows), PatchSurface.of(patch.points, patch.elements))
    inner = points[len(rows) :]
    first = len(outlines.points)
    rows = np.concatenate([rows, np.arange(first, first + len(inner), dtype=np.int32)])
    return inner, np.where(elements == NO_NODE, np.int32(NO_NODE), rows[elements])


def _quads(points: Floats, trias: Ints, border_nodes: int, surface: PatchSurface) -> Ints:
    """Pair trias to quads, those left alone too, and smooth; inner points change in place."""
    elements = recombine(points, trias)
    points[:] = smooth_laplace(points, elements, border_nodes, SMOOTHING_SWEEPS)
    elements = unite_trias(points, elements)
    points[:] = smooth_laplace(points, elements, border_nodes, SMOOTHING_SWEEPS)
    surface.project(points, border_nodes)
    sound = valid_elements(points, elements, LEAST_CORNER)
    return split_quads(points, elements, ~sound)
