"""Strips: elements one behind the other, each across a crossable edge from the last.

A strip has *cells*, the elements, and *rungs*, the edges between one cell and the next. Strips are
ragged arrays: strip s has the places from ``start[s]`` to ``start[s + 1]``.

start : (S + 1,) int32
cells : (C,) int32
    Element rows.
rungs : (C, 2) int32
    The edge between a cell and the next one, in the direction of the cell. The last rung of a strip
    leads back to its first cell, or is -1, -1 where the strip is open.
"""

from __future__ import annotations

import numpy as np

from meshops.kernels.vectors import compiled
from meshops.mesh import Bools, Ints

StripArrays = tuple[Ints, Ints, Ints]


@compiled
def put(added: Ints, at: int, a: int, b: int, c: int, d: int) -> int:
    """Write an element to row `at` and return the row of the next one."""
    added[at, 0], added[at, 1], added[at, 2], added[at, 3] = a, b, c, d
    return at + 1


@compiled
def across(
    element_edges: Ints, edge_elements: Ints, crossable: Bools, cell: int, side: int
) -> tuple[int, int]:
    """Find the element behind a side and which of its sides that is; -1, -1 at a barrier."""
    edge = element_edges[cell, side]
    if crossable[edge]:
        other = edge_elements[edge, 0] + edge_elements[edge, 1] - cell
        for k in range(4):
            if element_edges[other, k] == edge:
                return other, k
    return -1, -1


@compiled
def _set_rung(rungs: Ints, at: int, elements: Ints, cell: int, side: int) -> None:
    size = 3 if elements[cell, 3] < 0 else 4
    rungs[at, 0] = elements[cell, side]
    rungs[at, 1] = elements[cell, (side + 1) % size]


@compiled
def straight_strips(
    elements: Ints,
    element_edges: Ints,
    edge_elements: Ints,
    crossable: Bools,
    editable: Bools,
    trias: Ints,
    reach: int,
    steps: int,
) -> StripArrays:
    """Open strips that leave a tria and cross quads from side to opposite side.

    All that end at another tria behind at most `reach` quads, each found once, and all that end in
    one of the first `steps` quads.
    """
    longest = max(reach, steps) + 2
    room = 3 * len(trias) * (longest + steps * (steps + 3) // 2)
    start = np.zeros(3 * len(trias) * (steps + 1) + 1, np.int32)
    cells = np.empty(room, np.int32)
    rungs = np.full((room, 2), -1, np.int32)
    row = np.empty(longest, np.int32)
    crossed = np.empty((longest, 2), np.int32)
    seen = np.full(len(elements), -1, np.int32)
    done = np.zeros(len(elements), np.bool_)
    count = 0
    for number in range(3 * len(trias)):
        cell, side = trias[number // 3], number % 3
        done[cell] = True
        row[0], length = cell, 1
        seen[cell] = number
        while length < longest:
            _set_rung(crossed, length - 1, elements, cell, side)
            cell, side = across(element_edges, edge_elements, crossable, cell, side)
            if cell < 0 or not editable[cell] or seen[cell] == number:
                break
            seen[cell] = number
            row[length] = cell
            length += 1
            is_tria = elements[cell, 3] < 0
            if (is_tria and not done[cell]) or (not is_tria and length - 1 <= steps):
                first = start[count]
                cells[first : first + length] = row[:length]
                rungs[first : first + length - 1] = crossed[: length - 1]
                count += 1
                start[count] = first + length
            if is_tria:
                break
            side = (side + 2) % 4
    return start[: count + 1].copy(), cells[: start[count]].copy(), rungs[: start[count]].copy()


@compiled
def closed_strips(
    elements: Ints,
    element_edges: Ints,
    edge_elements: Ints,
    crossable: Bools,
    editable: Bools,
) -> StripArrays:
    """All rows of quads that close on themselves, except those that cross themselves."""
    start = np.zeros(2 * len(elements) + 1, np.int32)
    cells = np.empty(2 * len(elements), np.int32)
    rungs = np.empty((2 * len(elements), 2), np.int32)
    crossed = np.zeros(len(crossable), np.bool_)
    seen = np.full(len(elements), -1, np.int32)
    count = 0
    for number in range(2 * len(elements)):
        cell, side = number // 2, number % 2
        first = at = start[count]
        is_whole, is_closed = True, False
        while cell >= 0 and editable[cell] and elements[cell, 3] >= 0:
            edge = element_edges[cell, side]
            if crossed[edge]:
                is_closed = at > first and cell == cells[first] and side == number % 2
                break
            crossed[edge] = True
            is_whole &= seen[cell] != number
            seen[cell] = number
            cells[at] = cell
            _set_rung(rungs, at, elements, cell, side)
            at += 1
            cell, side = across(element_edges, edge_elements, crossable, cell, side)
            side = (side + 2) % 4
        if is_closed and is_whole:
            count += 1
            start[count] = at
    return start[: count + 1].copy(), cells[: start[count]].copy(), rungs[: start[count]].copy()


@compiled
def walks(
    elements: Ints,
    element_edges: Ints,
    edge_elements: Ints,
    crossable: Bools,
    editable: Bools,
    trias: Ints,
    reach: int,
    steps: int,
    partners: int,
) -> StripArrays:
    """Open strips: the shortest ways from each tria through quads, turning as they may.

    Those to the nearest `partners` other trias behind 1 to `reach` quads, each pair found once, and
    those to each quad across at most `steps` edges.
    """
    near = 3 * (3**steps - 1) // 2
    room = len(trias) * (partners * (reach + 2) + near * (steps + 1))
    start = np.zeros(len(trias) * (partners + near) + 1, np.int32)
    cells = np.empty(room, np.int32)
    rungs = np.full((room, 2), -1, np.int32)
    seen = np.full(len(elements), -1, np.int32)
    entry = np.empty(len(elements), np.int32)
    depth = np.empty(len(elements), np.int32)
    queue = np.empty(len(elements), np.int32)
    done = np.zeros(len(elements), np.bool_)
    count = 0
    for number in range(len(trias)):
        tria = trias[number]
        done[tria] = True
        seen[tria], depth[tria], queue[0] = number, 0, tria
        head, tail, met = 0, 1, 0
        while head < tail and met < partners:
            cell = queue[head]
            head += 1
            is_goal = elements[cell, 3] < 0 and cell != tria
            met += is_goal
            if (is_goal and depth[cell] > 1 and not done[cell]) or (
                not is_goal and 0 < depth[cell] <= steps
            ):
                _write_way(cell, elements, element_edges, edge_elements, entry, depth,
                           start[count], cells, rungs)  # fmt: skip
                count += 1
                start[count] = start[count - 1] + depth[cell] + 1
            if is_goal or depth[cell] > reach:
                continue
            for side in range(3 if cell == tria else 4):
                behind, at = across(element_edges, edge_elements, crossable, cell, side)
                if behind >= 0 and editable[behind] and seen[behind] != number:
                    seen[behind], entry[behind], depth[behind] = number, at, depth[cell] + 1
                    queue[tail] = behind
                    tail += 1
    return start[: count + 1].copy(), cells[: start[count]].copy(), rungs[: start[count]].copy()


@compiled
def _write_way(
    goal: int,
    elements: Ints,
    element_edges: Ints,
    edge_elements: Ints,
    entry: Ints,
    depth: Ints,
    first: int,
    cells: Ints,
    rungs: Ints,
) -> None:
    """Follow the sides by which cells were entered from the goal back to where the walk began."""
    cell = goal
    at = first + depth[goal]
    cells[at] = cell
    rungs[at, 0] = rungs[at, 1] = -1
    while at > first:
        at -= 1
        side = entry[cell]
        size = 3 if elements[cell, 3] < 0 else 4
        rungs[at, 0] = elements[cell, (side + 1) % size]
        rungs[at, 1] = elements[cell, side]
        edge = element_edges[cell, side]
        cell = edge_elements[edge, 0] + edge_elements[edge, 1] - cell
        cells[at] = cell
