"""Guarding: each part of a change is kept or taken back by itself."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from meshops.edit import Edit, apply
from meshops.guard.correspondence import Change, correspondence
from meshops.guard.judging import Judged
from meshops.guard.restoring import restored
from meshops.guard.rules import area_change, gains, is_large, spoils
from meshops.mesh import NO_NODE, Bools, Floats, ShellMesh
from meshops.patch import join, without_doubles
from meshops.quality import region_areas
from meshops.subdomain import Aim
from meshops.workpiece import Workpiece

MOST_OF_REGION = 0.0008
"""Of its area that a region may gain or lose, of which a thousandth is promised."""


def guarded(
    before: Workpiece, after: ShellMesh, aim: Aim = "faults", *, neutral: bool = False
) -> ShellMesh:
    """Keep what a change gains without harm, and take the rest of it back.

    Parameters
    ----------
    before : Workpiece
        The mesh that is changed, under the setting of the run; ids of nodes and of elements differ.
    after : ShellMesh
        What it was made to: it descends from the mesh by edits.
    aim : "faults", "flow" or "tidy"
        Whether fewer irregular nodes alone are a gain: not where faults are the aim.
    neutral : bool
        Whether what neither gains anything nor does harm is kept too, however much it is.

    Returns
    -------
    The mesh with what is kept. What is as it was keeps its ids; so does an element on the same
    nodes. ``before.mesh`` itself where nothing is kept.
    """
    if after.digest == before.mesh.digest:
        return before.mesh
    edit = _kept_edit(before, correspondence(before.mesh, after), aim, neutral=neutral)
    return before.mesh if edit.is_empty else apply(before.mesh, edit)


def guarded_edits(
    before: Workpiece,
    edits: list[Edit],
    aim: Aim,
    *,
    origin: Workpiece,
    neutral: bool = False,
) -> ShellMesh:
    """Apply edits of different places, of which each part is guarded; see `guarded`.

    Here ids may be those of a mesh that was changed before: new ones are all alike. Edits that put
    an element on the nodes of another one are left out, and so are parts by which the mesh would do
    harm to the `origin`, from which all changes began: many small harms may be one that is not.
    """
    mesh = before.mesh
    by_row = ShellMesh.build(mesh.points, mesh.elements, region=mesh.region)
    after = apply(by_row, join(mesh, without_doubles(mesh, edits)))
    change = correspondence(by_row, after)
    edit = _kept_edit(before, change, aim, neutral=neutral, origin=origin)
    return mesh if edit.is_empty else apply(mesh, edit)


def _kept_edit(
    before: Workpiece, change: Change, aim: Aim, *, neutral: bool, origin: Workpiece | None = None
) -> Edit:
    """Make the edit of those parts of a change that are kept."""
    mesh = before.mesh
    is_least = aim == "faults" and not neutral
    if is_least:
        change = restored(mesh, change, before.setting)
    judged = Judged.of(before, change)
    if judged is None:
        return Edit()
    kept, sides = ~judged.harmed, judged.sides
    if not neutral:
        kept &= gains(*sides, aim) & ~spoils(*sides)
    if is_least:
        kept &= ~is_large(*sides)
    kept &= ~_beyond_area(before, judged, kept)
    edit = _edit(mesh, judged, kept)
    while origin is not None and origin.mesh is not mesh and not edit.is_empty:
        touching = _near(_harmed_places(origin, apply(mesh, edit), aim), judged, kept)
        if not touching.any():
            break
        kept &= ~touching
        edit = _edit(mesh, judged, kept)
    return edit


def _harmed_places(origin: Workpiece, after: ShellMesh, aim: Aim) -> Floats:
    """(K, 3) nodes of all elements that came where a mesh does harm to the one it descends from.

    They are where they are in the mesh, even where they would go home in the end.
    """
    now = change = correspondence(origin.mesh, after)
    if aim != "flow":
        change = restored(origin.mesh, change, origin.setting)
    judged = Judged.of(origin, change)
    if judged is None:
        return np.zeros((0, 3))
    elements = judged.change.elements[judged.rows_now(judged.harmed)]
    places: Floats = now.points[np.unique(elements[elements != NO_NODE])]
    return places


def _near(places: Floats, judged: Judged, kept: Bools) -> Bools:
    """(P,) bool: which of the parts that are kept have a node in one of some places (K, 3)."""
    near, rows = np.zeros(len(kept), bool), judged.rows_now(kept)
    if not len(places) or not len(rows):
        return near
    elements = judged.change.elements[rows]
    row, corner = np.nonzero(elements != NO_NODE)
    nodes = judged.change.points[elements[row, corner]]
    near[judged.part_now[rows[row[cKDTree(places).query(nodes)[0] == 0.0]]]] = True
    return near


def _beyond_area(before: Workpiece, judged: Judged, kept: Bools) -> Bools:
    """(P,) bool: parts that are left out so that each region keeps its area, the greatest first.

    The facets of a bent part are others than they were, and a border is where it was within a share
    of an edge: a little for each part, which adds up over a region.
    """
    areas, beyond = before.setting.areas, np.zeros(len(kept), bool)
    if areas is None or not kept.any():
        return beyond
    growth, part_now = area_change(*judged.sides), judged.part_now
    region = np.full(len(kept), -1, np.int64)
    region[part_now[part_now >= 0]] = judged.change.region[part_now >= 0]
    has_grown = region_areas(before.mesh) - areas
    for number in np.unique(region[kept & (region >= 0)]):
        mine = np.nonzero(kept & (region == number))[0]
        excess = has_grown[number] + growth[mine].sum()
        for part in mine[np.argsort(-np.abs(growth[mine]), kind="stable")]:
            if abs(excess) <= MOST_OF_REGION * areas[number]:
                break
            if growth[part] * excess > 0.0:
                beyond[part], excess = True, excess - growth[part]
    return beyond


def _edit(mesh: ShellMesh, judged: Judged, kept: Bools) -> Edit:
    """Make the edit of the parts that are kept."""
    change, comes = judged.change, judged.rows_now(kept)
    gone = np.append(kept, False)[judged.part_was]
    origin = change.origin[comes]
    gone[origin[origin >= 0]] = False
    elements = change.elements[comes]
    nodes = np.zeros(len(change.points), bool)
    nodes[elements[elements != NO_NODE]] = True
    moved = np.nonzero(nodes & change.moved(mesh))[0].astype(np.int32)
    moved = moved[moved < change.first_new]
    fresh = np.nonzero(nodes[change.first_new :])[0] + change.first_new
    rows = np.arange(len(change.points), dtype=np.int32)
    rows[fresh] = change.first_new + np.arange(len(fresh))
    elements = np.where(elements == NO_NODE, np.int32(NO_NODE), rows[elements])
    known = origin >= 0
    other = known.copy()
    other[known] = (elements[known] != mesh.elements[origin[known]]).any(axis=1)
    return Edit(
        removed=np.nonzero(gone)[0].astype(np.int32),
        rewired=origin[other],
        rewired_to=elements[other],
        added_points=change.points[fresh],
        added_elements=elements[~known],
        added_region=change.region[comes[~known]],
        moved=moved,
        moved_to=change.points[moved],
    )
