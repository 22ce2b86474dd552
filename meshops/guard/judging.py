"""Judging: a change in parts, what each was and is, and whether it does harm."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops.guard.correspondence import Change, in_order_of
from meshops.guard.faults import appraise
from meshops.guard.parts import parts_of
from meshops.guard.rules import Side, harms, tria_pairs
from meshops.guard.surface import leaves_surface, shifts_border, turns_of
from meshops.mesh import NEW, NO_NODE, Bools, Floats, Ids, Ints, ShellMesh, following
from meshops.rows import Walks, barriers_of, edge_keys
from meshops.topology import REGULAR, valences
from meshops.workpiece import Workpiece


@dataclass(frozen=True, eq=False)
class Judged:
    """A change in P parts that can be kept or taken back each by itself.

    Attributes
    ----------
    change : Change
    part_was, part_now : (M,) int64
        Part of each element before and after; -1 for one that is as it was.
    sides : (Side, Side)
        What went and what came.
    harmed : (P,) bool
        Which parts break a rule.
    """

    change: Change
    part_was: Ids
    part_now: Ids
    sides: tuple[Side, Side]
    harmed: Bools

    @classmethod
    def of(cls, before: Workpiece, change: Change) -> Judged | None:
        """Judge a change of a mesh; None where there is none."""
        change = in_order_of(change, before.mesh)
        was, now = _changed(before.mesh, change)
        if not (was.any() or now.any()):
            return None
        part_was, part_now, parts = parts_of(before.mesh, change, was, now)
        sides, pairs = _sides(before, change, part_was, part_now, parts)
        harmed = harms(*sides, pairs, before.setting)
        harmed |= _leaves_surface(before, change, sides, part_was)
        harmed |= _fewer_rows(before, change, part_now, parts)
        return cls(change, part_was, part_now, sides, harmed)

    def rows_now(self, chosen: Bools) -> Ids:
        """Rows of the elements after that are of some parts (P,) bool."""
        rows: Ids = np.nonzero(np.append(chosen, False)[self.part_now])[0]
        return rows


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
    ends = np.sort(np.stack([elements, following(elements)], axis=2).reshape(-1, 2), axis=1)
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
    walks = Walks.of(change.points, change.elements, part_now, barriers_of(topology, count))
    ids = np.append(before.mesh.node_ids, np.full(count - change.first_new, NEW))
    return rows.lost(walks, ids, parts)


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
