"""Guarding: each part of a change is kept or taken back by itself."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from meshops.edit import Edit, apply
from meshops.guard.correspondence import Change, correspondence, in_order_of
from meshops.guard.faults import appraise
from meshops.guard.parts import parts_of
from meshops.guard.restoring import restored
from meshops.guard.rules import (
    Side,
    area_change,
    gains,
    harms,
    is_large,
    spoils,
    tria_pairs,
)
from meshops.guard.surface import leaves_surface, shifts_border, turns_of
from meshops.mesh import NEW, NO_NODE, Bools, Floats, Ids, Ints, ShellMesh
from meshops.patch import join, without_doubles
from meshops.quality import region_areas
from meshops.rows import Walks, edge_keys
from meshops.subdomain import Aim
from meshops.topology import REGULAR, valences
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
    change = in_order_of(change, mesh)
    was, now = _changed(mesh, change)
    if not (was.any() or now.any()):
        return Edit()
    part_was, part_now, parts = parts_of(mesh, change, was, now)
    sides, pairs = _sides(before, change, part_was, part_now, parts)
    kept = ~harms(*sides, pairs, before.setting)
    kept &= ~_leaves_surface(before, change, sides, part_was)
    kept &= ~_fewer_rows(before, change, part_now, parts)
    if not neutral:
        kept &= gains(*sides, aim) & ~spoils(*sides)
    if is_least:
        kept &= ~is_large(*sides)
    kept &= ~_beyond_area(before, change, sides, part_now, kept)
    edit = _edit(mesh, change, part_was, part_now, kept)
    while origin is not None and origin.mesh is not mesh and not edit.is_empty:
        harmed = _harmed_places(origin, apply(mesh, edit), aim)
        touching = _near(harmed, change, part_now, kept)
        if not touching.any():
            break
        kept &= ~touching
        edit = _edit(mesh, change, part_was, part_now, kept)
    return edit


def _harmed_places(origin: Workpiece, after: ShellMesh, aim: Aim) -> Floats:
    """(K, 3) nodes of all elements that came where a mesh does harm to the one it descends from.

    They are where they are in the mesh, even where they would go home in the end.
    """
    now = change = correspondence(origin.mesh, after)
    if aim != "flow":
        change = restored(origin.mesh, change, origin.setting)
    change = in_order_of(change, origin.mesh)
    part_was, part_now, parts = parts_of(origin.mesh, change, *_changed(origin.mesh, change))
    sides, pairs = _sides(origin, change, part_was, part_now, parts)
    harmed = harms(*sides, pairs, origin.setting)
    harmed |= _leaves_surface(origin, change, sides, part_was)
    harmed |= _fewer_rows(origin, change, part_now, parts)
    elements = change.elements[np.append(harmed, False)[part_now]]
    places: Floats = now.points[np.unique(elements[elements != NO_NODE])]
    return places


def _near(places: Floats, change: Change, part_now: Ids, kept: Bools) -> Bools:
    """(P,) bool: which of the parts that are kept have a node in one of some places (K, 3)."""
    near = np.zeros(len(kept), bool)
    rows = np.nonzero(np.append(kept, False)[part_now])[0]
    if not len(places) or not len(rows):
        return near
    row, corner = np.nonzero(change.elements[rows] != NO_NODE)
    nodes = change.points[change.elements[rows[row], corner]]
    near[part_now[rows[row[cKDTree(places).query(nodes)[0] == 0.0]]]] = True
    return near


def _changed(mesh: ShellMesh, change: Change) -> tuple[Bools, Bools]:
    """Which elements went, (M,) bool, and which came; one whose nodes have moved is both."""
    moved = change.moved(mesh)
    now = change.origin < 0
    known = ~now
    now[known] = (change.elements[known] != mesh.elements[change.origin[known]]).any(axis=1)
    now |= (moved[change.elements] & (change.elements != NO_NODE)).any(axis=1)
    was = np.ones(len(mesh.elements), bool)
    was[change.origin[~now]] = False
    return was, now


def _sides(
    before: Workpiece, change: Change, part_was: Ids, part_now: Ids, parts: int
) -> tuple[tuple[Side, Side], tuple[Ids, Ids]]:
    """Both sides of a change, and how many pairs of trias each part has."""
    mesh = before.mesh
    irregular = _irregular(before, change, part_was, part_now, parts)
    topology, count = before.topology, len(change.points)
    held = np.zeros(count, bool)
    held[: change.first_new] = mesh.locked_nodes & (before.outside < 0)
    rim = edge_keys(topology.edges[topology.is_border & _is_real(before)], count)

    def side(points: Floats, elements: Ints, part: Ids, amiss: Ids) -> Side:
        rows = part >= 0
        elements, part = elements[rows], part[rows]
        return Side(
            points=points,
            elements=elements,
            part=part,
            irregular=amiss,
            on_edge=_on_edge(elements, held, rim),
            appraisal=appraise(points, elements, before.setting),
        )

    was = side(mesh.points, mesh.elements, part_was, irregular[0])
    now = side(change.points, change.elements, part_now, irregular[1])
    pairs = (
        tria_pairs(mesh.elements, count, part_was, parts),
        tria_pairs(change.elements, count, part_now, parts),
    )
    return (was, now), pairs


def _on_edge(elements: Ints, held: Bools, rim: Ids) -> Bools:
    """(K,) bool: elements with a side on the rim, keys of edges, or with a node that is held."""
    is_node = elements != NO_NODE
    following = np.roll(elements, -1, axis=1)
    following[~is_node[:, 3], 2] = elements[~is_node[:, 3], 0]
    ends = np.sort(np.stack([elements, following], axis=2).reshape(-1, 2), axis=1)
    on_rim = np.isin(edge_keys(ends, len(held)), rim).reshape(-1, 4) & is_node
    found: Bools = (on_rim | (held[elements] & is_node)).any(axis=1)
    return found


def _is_real(before: Workpiece) -> Bools:
    """(E,) bool: edges at which the mesh ends, if it ends there, and not just a subdomain of it."""
    start, end = before.topology.edges.T
    real: Bools = (before.outside[start] < 0) & (before.outside[end] < 0)
    return real


def _leaves_surface(
    before: Workpiece, change: Change, sides: tuple[Side, Side], part_was: Ids
) -> Bools:
    """(P,) bool: parts of a change whose surface is another one."""
    parts = sides[0].parts
    shifted = shifts_border(before, change, part_was, parts)
    return leaves_surface(*sides, turns_of(before, part_was, parts), shifted)


def _fewer_rows(before: Workpiece, change: Change, part_now: Ids, parts: int) -> Bools:
    """(P,) bool: parts of a change that take rows out of a strip between barriers.

    They are seen in a whole mesh alone.
    """
    rows, topology, count = before.setting.rows, before.topology, len(change.points)
    if rows is None:
        return np.zeros(parts, bool)
    barriers = edge_keys(topology.edges[~topology.crossable], count)
    walks = Walks.of(change.points, change.elements, part_now, barriers)
    ids = np.append(before.mesh.node_ids, np.full(count - change.first_new, NEW))
    return rows.lost(walks, ids, parts)


def _beyond_area(
    before: Workpiece, change: Change, sides: tuple[Side, Side], part_now: Ids, kept: Bools
) -> Bools:
    """(P,) bool: parts that are left out so that each region keeps its area, the greatest first.

    The facets of a bent part are others than they were, and a border is where it was within a share
    of an edge: a little for each part, which adds up over a region.
    """
    areas, beyond = before.setting.areas, np.zeros(len(kept), bool)
    if areas is None or not kept.any():
        return beyond
    growth = area_change(*sides)
    region = np.full(len(kept), -1, np.int64)
    region[part_now[part_now >= 0]] = change.region[part_now >= 0]
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


def _irregular(
    before: Workpiece, change: Change, part_was: Ids, part_now: Ids, parts: int
) -> tuple[Ids, Ids]:
    """(P,) irregular nodes of each part before, and after it alone has changed."""
    count = len(change.points)
    outside = np.zeros(count, np.int32)
    outside[: change.first_new] = before.outside
    valence = valences(before.mesh.elements, count)
    goes = _corner_keys(before.mesh.elements, part_was, count)
    comes = _corner_keys(change.elements, part_now, count)
    keys, where = np.unique(np.concatenate([goes, comes]), return_inverse=True)
    part, node = keys // count, keys % count
    leaving = np.bincount(where[: len(goes)], minlength=len(keys))
    coming = np.bincount(where[len(goes) :], minlength=len(keys))
    found = []
    for elements in (valence[node], valence[node] - leaving + coming):
        irregular = (outside[node] >= 0) & (elements > 0) & (elements + outside[node] != REGULAR)
        found.append(np.bincount(part[irregular], minlength=parts))
    return found[0], found[1]


def _corner_keys(elements: Ints, part: Ids, nodes: int) -> Ids:
    """One number for the part and the node of each corner of the elements of any part."""
    rows = np.nonzero(part >= 0)[0]
    owner, corner = np.nonzero(elements[rows] != NO_NODE)
    keys: Ids = part[rows[owner]] * nodes + elements[rows[owner], corner]
    return keys


def _edit(mesh: ShellMesh, change: Change, part_was: Ids, part_now: Ids, kept: Bools) -> Edit:
    """Make the edit of the parts that are kept."""
    stays = np.append(kept, False)
    gone, comes = stays[part_was], np.nonzero(stays[part_now])[0]
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
