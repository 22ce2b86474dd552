"""Parts: what of a change can be kept or taken back by itself."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from meshops.guard.correspondence import Change
from meshops.mesh import NO_NODE, Bools, Ids, Ints, ShellMesh, following


def parts_of(mesh: ShellMesh, change: Change, was: Bools, now: Bools) -> tuple[Ids, Ids, int]:
    """Part of each element before and after, -1 for one that is as it was; how many there are.

    `was` (M,) and `now` say which elements went and came. Two elements are of one part where one
    cannot be there without the other: where they have the same side, before and after; where the
    edge between them goes or comes; and where they share a node that moves, goes or comes.
    """
    gone, come = mesh.elements[was], change.elements[now]
    count, nodes = len(gone) + len(come), len(change.points)
    owner, start, end = _sides_of(np.concatenate([gone, come]))
    links = [
        _same_side(owner, start.astype(np.int64) * nodes + end),
        _passing_edges(owner, start, end, nodes, len(gone)),
        _restless_nodes(owner, start, change.moved(mesh)),
    ]
    pairs = np.concatenate(links, axis=1)
    graph = coo_array((np.ones(pairs.shape[1], np.int8), tuple(pairs)), (count, count))
    parts, label = connected_components(graph, directed=False)
    part_was, part_now = (np.full(len(rows), -1, np.int64) for rows in (was, now))
    part_was[was], part_now[now] = label[: len(gone)], label[len(gone) :]
    return part_was, part_now, int(parts)


def _sides_of(elements: Ints) -> tuple[Ids, Ints, Ints]:
    """Element, first and last node of each side."""
    row, side = np.nonzero(elements != NO_NODE)
    return row, elements[row, side], following(elements)[row, side]


def _chained(owner: Ids, key: Ids) -> NDArray[np.int64]:
    """(2, L) links from each element to the next one with the same key."""
    order = np.argsort(key, kind="stable")
    alike = np.nonzero(np.diff(key[order]) == 0)[0]
    return np.stack([owner[order[alike]], owner[order[alike + 1]]])


def _same_side(owner: Ids, side: Ids) -> NDArray[np.int64]:
    """Links between elements that have a side in the same direction: they lie in one place."""
    return _chained(owner, side)


def _passing_edges(owner: Ids, start: Ints, end: Ints, nodes: int, gone: int) -> NDArray[np.int64]:
    """Links between elements at an edge that is only there before or only after."""
    key = np.minimum(start, end).astype(np.int64) * nodes + np.maximum(start, end)
    before = owner < gone
    passing = np.where(before, ~np.isin(key, key[~before]), ~np.isin(key, key[before]))
    return _chained(owner[passing], key[passing])


def _restless_nodes(owner: Ids, node: Ints, moved: Bools) -> NDArray[np.int64]:
    """Links between elements at a node that is not where it was, or not there before or after."""
    restless = moved[node]
    return _chained(owner[restless], node[restless].astype(np.int64))
