"""Remeshing of one patch: mesh anew, recombine to quads, smooth, project, check, stitch in."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from meshops import _core
from meshops._core import (
    all_facing,
    has_doubles,
    smooth_laplace,
    split_quads,
    valid_elements,
)
from meshops.edit import Edit
from meshops.mesh import Floats, Ints
from meshops.patch import Patch, extract, join, stitch
from meshops.quality_sums import IRREGULAR, TALLY_SIZE
from meshops.remesher import RemeshError, remesh_isotropic
from meshops.surface import PatchSurface
from meshops.workpiece import Workpiece

Method = Callable[[Floats, Ints, Ints, float], tuple[Floats, Ints]]
"""Meshes a patch of trias anew within its border: points, trias, border, size -> points, trias."""

TRIA_OF_QUAD = 1.07
"""Edge of a regular tria of half a square's area, over the square's edge: (4 / 3) ** (1 / 4)."""

GOOD_PAIR = 0.5
"""Quads below this shape are formed only where a tria would stay alone otherwise."""

LEAST_PAIR = 0.05
"""Quads below this shape are not formed: no smoothing mends a flat corner on a fixed border."""

SMOOTHING_SWEEPS = 6

LEAST_CORNER = 0.05
"""`corner_jacobian_min` from which an element counts as sound: neither concave nor nearly flat."""

SURFACE_TOLERANCE = 0.1
"""Of the edge length: how far a new element's centre may be from the old surface, and an old node
from the new one. It is the level at which the chordal deviation of the standard criteria fails."""


def replace_patch(
    workpiece: Workpiece,
    rows: Ints,
    *,
    method: Method = remesh_isotropic,
    size: float | None = None,
    scale: float = 1.0,
) -> tuple[Edit, Floats]:
    """Remesh one patch; the edit, empty where that fails, and its change of the tally.

    `scale` multiplies the edge length: `size`, or else that of the run, or else of the patch.
    """
    patch = extract(workpiece.topology, rows)
    surface = PatchSurface.of(patch.points, patch.elements)
    edge = size or workpiece.setting.element_size or surface.mean_edge(patch)
    anew = None
    if len(rows) > 1:
        anew = remesh_patch(patch, surface, workpiece.reference or surface, edge * scale, method)
    if anew is None:
        return Edit(), np.zeros(TALLY_SIZE)
    points, elements = anew
    edit = stitch(workpiece.mesh, patch, points[patch.border_nodes :], elements)
    return edit, replacement_change(workpiece, patch, points, elements, edit)


def joint_change(workpiece: Workpiece, done: Sequence[tuple[Edit, Floats]]) -> Floats:
    """(TALLY_SIZE,) what some replaced patches change together, by what each changes alone.

    Neighbouring patches share nodes, at which more elements may meet than either foretells. Nothing
    is made of that where the fitness counts trias alone.
    """
    change: Floats = np.sum([alone for _, alone in done], axis=0)
    if len(done) > 1 and workpiece.setting.fitness.kind != "trias":
        edit = join(workpiece.mesh, [edit for edit, _ in done])
        change[IRREGULAR] = workpiece.irregular_change(edit.removed, edit.added_elements)
    return change


def replacement_change(
    workpiece: Workpiece, patch: Patch, points: Floats, elements: Ints, edit: Edit
) -> Floats:
    """(TALLY_SIZE,) what other elements in the place of a patch add to the tally of the mesh."""
    change = workpiece.tally_of(points, elements) - workpiece.tally_of(patch.points, patch.elements)
    change[IRREGULAR] = workpiece.irregular_change(patch.rows, edit.added_elements)
    return change


def remesh_patch(
    patch: Patch,
    surface: PatchSurface,
    reference: PatchSurface,
    edge: float,
    method: Method = remesh_isotropic,
) -> tuple[Floats, Ints] | None:
    """Mesh a patch anew with quads, its border kept.

    Parameters
    ----------
    patch : Patch
    surface : PatchSurface
        Of the patch as it is.
    reference : PatchSurface
        That new nodes must stay on; it may be larger than the patch.
    edge : float
        Edge length of the quads.
    method : Method

    Returns
    -------
    (points, elements), border nodes first at the rows that they have in the patch; None where no
    valid mesh came out.
    """
    try:
        points, trias = method(patch.points, surface.trias, patch.border, TRIA_OF_QUAD * edge)
    except RemeshError:
        return None
    elements = recombine(points, trias)
    points = smooth_laplace(points, elements, patch.border_nodes, SMOOTHING_SWEEPS)
    reference.project(points, patch.border_nodes)
    sound = valid_elements(points, elements, LEAST_CORNER)
    if not sound.all():
        elements = split_quads(points, elements, ~sound)
        if not valid_elements(points, elements, LEAST_CORNER).all():
            return None
    tolerance = SURFACE_TOLERANCE * edge
    normals = reference.normals_at(points, elements, tolerance)
    if normals is None or not all_facing(points, elements, normals):
        return None
    if has_doubles(elements, len(points)):
        return None
    if not surface.is_covered(patch, points, elements, tolerance):
        return None
    return points, elements


def recombine(points: Floats, trias: Ints) -> Ints:
    """Pair trias (T, 3) to quads, as many as can be and good ones first; (M, 4) elements."""
    return _core.recombine(points, trias, LEAST_PAIR, GOOD_PAIR)
