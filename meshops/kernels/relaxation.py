"""Relaxation: the nodes of each small edit move to where its elements are better."""

from __future__ import annotations

import numpy as np

from meshops.kernels.smoothing import smooth
from meshops.kernels.vectors import compiled
from meshops.mesh import Bools, Floats, Ints


@compiled
def _gather(
    added: Ints,
    elements: Ints,
    start: Ints,
    around: Ints,
    mobile: Ints,
    gone: Ints,
    seen: Ints,
    k: int,
    out: Ints,
) -> int:
    """Write the elements around the mobile nodes, as they are after the edit, to `out`."""
    count = 0
    for i in range(len(added)):
        if count < len(out):
            out[count] = added[i]
        count += 1
    for node in mobile:
        if node >= len(start) - 1:
            continue
        for i in range(start[node], start[node + 1]):
            e = around[i]
            if gone[e] != k and seen[e] != k:
                seen[e] = k
                if count < len(out):
                    out[count] = elements[e]
                count += 1
    return count


@compiled
def _number(local: Ints, mobile: Ints, rows: Ints, stamps: Ints, k: int, nodes: Ints) -> int:
    """Renumber the nodes of elements in place, those that move last; how many stay in place.

    The mesh rows go to `nodes`, and `rows` keeps the number of each of them.
    """
    for node in mobile:
        stamps[node] = k
        rows[node] = -1
    count = 0
    for i in range(len(local)):
        for corner in range(4):
            node = local[i, corner]
            if node >= 0 and stamps[node] != k:
                stamps[node] = k
                rows[node] = count
                nodes[count] = node
                count += 1
    fixed = count
    for node in mobile:
        rows[node] = count
        nodes[count] = node
        count += 1
    for i in range(len(local)):
        for corner in range(4):
            if local[i, corner] >= 0:
                local[i, corner] = rows[local[i, corner]]
    return fixed


@compiled
def relax_candidates(
    removed_start: Ints,
    removed: Ints,
    added_start: Ints,
    added: Ints,
    point_start: Ints,
    new_points: Floats,
    moved_start: Ints,
    moved: Ints,
    moved_to: Floats,
    points: Floats,
    elements: Ints,
    start: Ints,
    around: Ints,
    free: Bools,
    most: int,
    sweeps: int,
) -> tuple[Floats, Ints, Ints, Floats]:
    """Smooth the new points, the moved nodes and the free nodes of the elements that come.

    Parameters
    ----------
    removed_start, ..., moved_to
        The arrays of the candidates.
    points, elements, start, around
        The mesh and the elements of its nodes.
    free : (N,) bool
        Nodes that may move.
    most : int
        A candidate that moves nodes of more elements than this stays as it is.
    sweeps : int

    Returns
    -------
    new_points, moved_start, moved, moved_to
        As in the candidates.
    """
    nodes = len(points)
    most_points = 0
    for k in range(len(point_start) - 1):
        most_points = max(most_points, point_start[k + 1] - point_start[k])
    places = np.empty((nodes + most_points, 3))
    places[:nodes] = points
    gone = np.full(len(elements), -1, np.int32)
    seen = np.full(len(elements), -1, np.int32)
    chosen = np.full(nodes, -1, np.int32)
    stamps = np.full(nodes + most_points, -1, np.int32)
    rows = np.empty(nodes + most_points, np.int32)
    mobile = np.empty(len(moved) + 4 * len(added) + most_points, np.int32)
    local = np.empty((most, 4), np.int32)
    local_nodes = np.empty(4 * most + len(mobile), np.int32)
    local_points = np.empty((len(local_nodes), 3))
    after = new_points.copy()
    out_start = np.zeros_like(moved_start)
    out = np.empty(len(moved) + 4 * len(added), np.int32)
    out_to = np.empty((len(out), 3))
    total = 0
    for k in range(len(removed_start) - 1):
        comes = added[added_start[k] : added_start[k + 1]]
        appears = point_start[k + 1] - point_start[k]
        places[nodes : nodes + appears] = new_points[point_start[k] : point_start[k + 1]]
        for e in removed[removed_start[k] : removed_start[k + 1]]:
            gone[e] = k
        count = 0
        for i in range(moved_start[k], moved_start[k + 1]):
            places[moved[i]] = moved_to[i]
            chosen[moved[i]] = k
            mobile[count] = moved[i]
            count += 1
        for i in range(len(comes)):
            for node in comes[i]:
                if 0 <= node < nodes and free[node] and chosen[node] != k:
                    chosen[node] = k
                    mobile[count] = node
                    count += 1
        old = count  # nodes of the mesh come first, new points follow
        for i in range(appears):
            mobile[count] = nodes + i
            count += 1

        found = _gather(comes, elements, start, around, mobile[:count], gone, seen, k, local)
        if found <= most:
            fixed = _number(local[:found], mobile[:count], rows, stamps, k, local_nodes)
            for i in range(fixed + count):
                local_points[i] = places[local_nodes[i]]
            smooth(local_points[: fixed + count], local[:found], fixed, sweeps)
            for i in range(count):
                places[mobile[i]] = local_points[fixed + i]
        for i in range(old):
            out[total] = mobile[i]
            out_to[total] = places[mobile[i]]
            total += 1
            places[mobile[i]] = points[mobile[i]]
        for i in range(appears):
            after[point_start[k] + i] = places[nodes + i]
        out_start[k + 1] = total
    return after, out_start, out[:total].copy(), out_to[:total].copy()
