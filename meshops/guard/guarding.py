"""Guarding: each part of a change is kept or taken back by itself."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from meshops.edit import Edit, apply
from meshops.guard.correspondence import Change, correspondence, in_order_of
from meshops.guard.faults import appraise
from meshops.guard.restoring import restored
from meshops.guard.rows import Walks, edge_keys, fewer_rows
from meshops.guard.rules import Side, gains, harms, is_large, spoils, tria_pairs
from meshops.kernels.regularity import REGULAR
from meshops.mesh import NO_NODE, Bools, Floats, Ids, Ints, ShellMesh
from meshops.subdomain import Aim
from meshops.topology import valences
from meshops.workpiece import Workpiece


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
        Whether what neither gains anything nor does harm is kept too.

    Returns
    -------
    The mesh with what is kept. What is as it was keeps its ids; so does an element on the same
    nodes. ``before.mesh`` itself where nothing is kept.
    """
    mesh = before.mesh
    if after.digest == mesh.digest:
        return mesh
    change = in_order_of(restored(mesh, correspondence(mesh, after), before.setting), mesh)
    was, now = _changed(mesh, change)
    if not (was.any() or now.any()):
        return mesh
    part_was, part_now, parts = _parts(mesh, change, was, now)
    sides, pairs = _sides(before, change, part_was, part_now, parts)
    kept = ~harms(*sides, pairs, before.setting)
    kept &= ~_fewer_rows(before, change, part_was, part_now, parts)
    if not neutral:
        kept &= gains(*sides, aim) & ~spoils(*sides)
    if aim == "faults":
        kept &= ~is_large(*sides)
    if not kept.any():
        return mesh
    return apply(mesh, _edit(mesh, change, part_was, part_now, kept))


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


def _parts(mesh: ShellMesh, change: Change, was: Bools, now: Bools) -> tuple[Ids, Ids, int]:
    """Part of each element before and after, -1 for one that is as it was; how many there are.

    Elements are of one part where they share a node.
    """
    elements = np.concatenate([mesh.elements[was], change.elements[now]])
    owner, corner = np.nonzero(elements != NO_NODE)
    nodes = elements[owner, corner]
    count = len(elements) + len(change.points)
    graph = coo_array((np.ones(len(nodes), np.int8), (owner, len(elements) + nodes)), (count,) * 2)
    label = connected_components(graph, directed=False)[1][: len(elements)]
    found, label = np.unique(label, return_inverse=True)
    first = int(np.count_nonzero(was))
    part_was, part_now = (np.full(len(rows), -1, np.int64) for rows in (was, now))
    part_was[was], part_now[now] = label[:first], label[first:]
    return part_was, part_now, len(found)


def _sides(
    before: Workpiece, change: Change, part_was: Ids, part_now: Ids, parts: int
) -> tuple[tuple[Side, Side], tuple[Ids, Ids]]:
    """Both sides of a change, and how many pairs of trias each part has."""
    mesh = before.mesh
    irregular = _irregular(before, change)
    topology, count = before.topology, len(change.points)
    held = np.zeros(count, bool)
    held[: change.first_new] = mesh.locked_nodes & (before.outside < 0)
    rim = edge_keys(topology.edges[topology.is_border], count)

    def side(points: Floats, elements: Ints, part: Ids, amiss: Bools) -> Side:
        rows = part >= 0
        elements, part = elements[rows], part[rows]
        return Side(
            points=points,
            elements=elements,
            part=part,
            irregular=_irregular_of(elements, part, amiss, parts),
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


def _fewer_rows(
    before: Workpiece, change: Change, part_was: Ids, part_now: Ids, parts: int
) -> Bools:
    """(P,) bool: parts of a change that take rows out of a strip between barriers."""
    mesh, topology, count = before.mesh, before.topology, len(change.points)
    ends = topology.edges[~topology.crossable]
    # where a subdomain was cut out its mesh goes on
    barriers = edge_keys(ends[(before.outside[ends] < 0).all(axis=1)], count)
    points = np.concatenate([mesh.points, change.points[change.first_new :]])
    then = Walks.of(points, mesh.elements, part_was, barriers)
    now = Walks.of(change.points, change.elements, part_now, barriers)
    return fewer_rows(then, now, parts)


def _irregular(before: Workpiece, change: Change) -> tuple[Bools, Bools]:
    """(N + K,) bool: irregular nodes before and after."""
    count = len(change.points)
    outside = np.zeros(count, np.int32)
    outside[: change.first_new] = before.outside
    found = []
    for elements in (before.mesh.elements, change.elements):
        valence = valences(elements, count)
        found.append((outside >= 0) & (valence > 0) & (valence + outside != REGULAR))
    return found[0], found[1]


def _irregular_of(elements: Ints, part: Ids, irregular: Bools, parts: int) -> Ids:
    """(P,) how many irregular nodes each part has: no two parts share one."""
    owner, corner = np.nonzero(elements != NO_NODE)
    nodes, first = np.unique(elements[owner, corner], return_index=True)
    return np.bincount(part[owner[first]][irregular[nodes]], minlength=parts)


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
