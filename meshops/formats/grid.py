"""A file's points and cells, and the shell mesh within them: what else there is stays and locks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from meshops.errors import InputError
from meshops.formats.checks import Place, checked_mesh
from meshops.formats.locks import Lock, lock_of, most_first
from meshops.mesh import NO_NODE, Bools, Floats, Ids, Ints, ShellMesh

KINDS = ("points", "lines", "surface cells of more nodes", "solids")
"""Cells that are no linear shells, by their dimension."""


class Others(NamedTuple):
    """Cells that are no linear shells, as many nodes each: point rows (K, n), and their dimension.

    The end nodes of a line and the corners of a solid come first.
    """

    rows: Ids
    dimension: int


@dataclass(frozen=True, eq=False)
class Grid:
    """Points and cells of a file.

    Attributes
    ----------
    source : str
        Name of the file, for messages.
    points : (N, 3) float64
    node_ids : (N,) int64
        All different.
    corners : (M, 4) int64
        Point rows of the quads and trias; ``NO_NODE`` stands last in a tria.
    shell_ids : (M,) int64
        All different.
    parts : (M,) int64
        What tells the regions of the shells apart.
    others : sequence of Others
        Their nodes are locked.
    held_nodes : (N,) bool, optional
        More nodes that are locked, and ``held_by``, the words that say why.
    held_by : str
    """

    source: str
    points: Floats
    node_ids: Ids
    corners: Ids
    shell_ids: Ids
    parts: Ids
    others: Sequence[Others] = ()
    held_nodes: Bools | None = None
    held_by: str = ""


@dataclass(frozen=True, eq=False)
class Shells:
    """The mesh of a grid.

    Attributes
    ----------
    mesh : ShellMesh
    element_of : (M,) int64
        The mesh row of each shell of the grid, -1 where it is none. Shells on the same nodes have
        the same row: they are edited together.
    locks : tuple of Lock
    notes : tuple of str
    """

    mesh: ShellMesh
    element_of: Ids
    locks: tuple[Lock, ...] = ()
    notes: tuple[str, ...] = field(default=())


def shells_of(grid: Grid, node_place: Place, element_place: Place) -> Shells:
    """Make the mesh of a grid.

    Raises
    ------
    InputError
        Where a cell names a point that is not there, and as ``checked_mesh``.
    """
    _check_rows(grid, element_place)
    proper = _proper(grid.corners)
    first, element_of, twisted = _folded(grid.corners, proper)
    parts = _parts_together(grid.parts, element_of, len(first))
    by_others = np.zeros((len(KINDS), len(grid.points)), bool)
    for rows, dimension in grid.others:
        by_others[dimension, rows] = True
    repeated = grid.corners[~proper]
    by_repeated = np.zeros(len(grid.points), bool)
    by_repeated[repeated[repeated != NO_NODE]] = True
    held = np.zeros(len(grid.points), bool) if grid.held_nodes is None else grid.held_nodes
    corners = grid.corners[first]
    faces = _on_solids(corners, grid.others, len(grid.points))
    beside_lines = _beside_inner_lines(corners, parts, grid.others, len(grid.points))
    mesh = checked_mesh(
        source=grid.source,
        points=grid.points,
        node_ids=grid.node_ids,
        corners=np.where(corners == NO_NODE, 0, grid.node_ids[corners]),
        element_ids=grid.shell_ids[first],
        region=_regions(parts),
        locked_nodes=by_others.any(axis=0) | by_repeated | held,
        locked_elements=faces | beside_lines | twisted,
        node_place=node_place,
        element_place=lambda row: element_place(int(first[row])),
    )
    used = np.zeros(len(grid.points), bool)
    used[corners[corners != NO_NODE]] = True
    reasons = [
        *(("nodes", by_others[i] & used, kind) for i, kind in enumerate(KINDS)),
        ("nodes", by_repeated & used, "cells that name a node twice"),
        ("nodes", held & used, grid.held_by),
        ("elements", faces, "faces of solids"),
        ("elements", beside_lines, "lines inside a region"),
        ("elements", twisted, "cells on the same nodes, turned the other way"),
    ]
    locks = [
        lock_of("nodes", grid.node_ids[mask], words)
        if kind == "nodes"
        else lock_of("elements", grid.shell_ids[first][mask], words)
        for kind, mask, words in reasons
        if mask.any()
    ]
    return Shells(mesh, element_of, most_first(locks), _notes(proper, element_of, len(first)))


def _notes(proper: Bools, element_of: Ids, count: int) -> tuple[str, ...]:
    notes = []
    if not proper.all():
        notes.append(f"{int((~proper).sum()):,} cells name a node twice: they stay as they are.")
    copies = int((element_of >= 0).sum()) - count
    if copies:
        notes.append(f"{copies:,} cells lie on the nodes of others: they are edited together.")
    return tuple(notes)


def _check_rows(grid: Grid, element_place: Place) -> None:
    outside = (grid.corners >= len(grid.points)) | (grid.corners < NO_NODE)
    outside[:, :3] |= grid.corners[:, :3] == NO_NODE
    bad = np.flatnonzero(outside.any(axis=1))
    if len(bad):
        row = int(bad[0])
        raise InputError(
            f"{element_place(row)}: element {grid.shell_ids[row]} names a node that is not there; "
            "add the node or correct the element."
        )
    for rows, _ in grid.others:
        if rows.size and (rows.min() < 0 or rows.max() >= len(grid.points)):
            raise InputError(
                f"{grid.source}: a cell of {rows.shape[1]} nodes names a node that is not there; "
                "correct it."
            )


def _proper(corners: Ids) -> Bools:
    """(M,) bool: which shells name no node twice."""
    ordered = np.sort(corners, axis=1)
    proper: Bools = (np.diff(ordered, axis=1) != 0).all(axis=1)
    return proper


def _folded(corners: Ids, proper: Bools) -> tuple[Ids, Ids, Bools]:
    """Fold shells on the same nodes to one.

    Returns
    -------
    first : (m,) int64
        The first shell of each.
    element_of : (M,) int64
        Which of these a shell belongs to, -1 where it is not proper.
    twisted : (m,) bool
        Where shells go round their nodes in different ways.
    """
    rows = np.flatnonzero(proper)
    ordered = np.sort(corners[rows], axis=1)
    _, first, kind = np.unique(ordered, axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first)
    rank = np.empty(len(order), np.int64)
    rank[order] = np.arange(len(order))
    element_of = np.full(len(corners), -1, np.int64)
    element_of[rows] = rank[kind.ravel()]
    first = rows[first[order]]
    twisted = np.zeros(len(first), bool)
    for row in np.setdiff1d(rows, first):
        element = element_of[row]
        twisted[element] |= not _same_way(corners[row], corners[first[element]])
    return first, element_of, twisted


def _same_way(one: Ids, other: Ids) -> bool:
    a, b = one[one != NO_NODE], other[other != NO_NODE]
    turn = int(np.flatnonzero(b == a[0])[0])
    return bool((np.roll(b, -turn) == a).all())


def _parts_together(parts: Ids, element_of: Ids, count: int) -> Ids:
    """(m,) part of each element; copies of different parts make a part of its own."""
    rows = np.flatnonzero(element_of >= 0)
    rows = rows[np.argsort(element_of[rows], kind="stable")]
    together = parts[rows[np.searchsorted(element_of[rows], np.arange(count))]]
    if len(rows) == count:
        return together
    several: dict[int, list[int]] = {}
    copied = np.flatnonzero(np.bincount(element_of[rows], minlength=count) > 1)
    for row in rows[np.isin(element_of[rows], copied)]:
        several.setdefault(int(element_of[row]), []).append(int(parts[row]))
    number = int(parts.max(initial=0))
    numbers: dict[tuple[int, ...], int] = {}
    for element, found in several.items():
        key = tuple(sorted(found))
        if len(set(key)) > 1:
            together[element] = numbers.setdefault(key, number + 1 + len(numbers))
    return together


def _regions(parts: Ids) -> Ints:
    """Parts as regions: by their own number, or counted where one is too large for that."""
    limit = np.iinfo(np.int32)
    if len(parts) and (parts.min() < limit.min or parts.max() > limit.max):
        parts = np.unique(parts, return_inverse=True)[1].ravel() + 1
    return parts.astype(np.int32)


def _on_solids(corners: Ids, others: Sequence[Others], points: int) -> Bools:
    """(m,) bool: which shells may be faces of solids, since these name all of their nodes."""
    on_solid = np.zeros(points + 1, bool)
    for rows, dimension in others:
        if dimension == 3:
            on_solid[rows] = True
    # a tria has no fourth node to be on one
    on_solid[NO_NODE] = bool(on_solid.any())
    return np.asarray(on_solid[corners].all(axis=1))


def _beside_inner_lines(corners: Ids, parts: Ids, others: Sequence[Others], points: int) -> Bools:
    """(m,) bool: one shell beside each line that lies inside a region, so that its edge stays."""
    beside = np.zeros(len(corners), bool)
    lines = [rows[:, :2] for rows, dimension in others if dimension == 1]
    if not lines or not len(corners):
        return beside
    keys = _edge_keys(np.concatenate(lines), points)
    ahead = np.where(corners == NO_NODE, corners[:, :1], corners)
    ends = np.roll(ahead, -1, axis=1)
    sides = _edge_keys(np.stack([ahead, ends], axis=-1).reshape(-1, 2), points)
    element = np.repeat(np.arange(len(corners)), 4)
    real = (ahead != ends).ravel()
    sides, element = sides[real], element[real]
    order = np.argsort(sides, kind="stable")
    sides, element = sides[order], element[order]
    start = np.flatnonzero(np.r_[True, np.diff(sides) != 0])
    count = np.diff(np.r_[start, len(sides)])
    one, other = element[start], element[np.minimum(start + 1, len(element) - 1)]
    inner = (count == 2) & (parts[one] == parts[other]) & np.isin(sides[start], keys)
    beside[one[inner]] = True
    return beside


def _edge_keys(ends: Ids, points: int) -> Ids:
    keys: Ids = np.minimum(ends[:, 0], ends[:, 1]) * points + np.maximum(ends[:, 0], ends[:, 1])
    return keys
