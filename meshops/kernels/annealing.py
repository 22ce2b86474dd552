"""Simulated annealing of a patch by small changes (Kirkpatrick, Gelatt and Vecchi 1983).

Every trial changes the topology in one place and relaxes the nodes there, or moves one node. What
it adds to the energy decides whether it stays: what lowers it does, what raises it does the more
rarely the more it raises it and the lower the temperature is.

See :mod:`meshops.kernels.living` for ``live``, :mod:`meshops.kernels.lacking` for ``site`` and
``prices``, :mod:`meshops.kernels.node_scores` for ``ground`` and ``scoring``. And:

books : of_elements (M,), of_nodes (N,), stamps (M,), node_stamps (N,), nodes (K,), rows (K,),
    fresh (K,), values (12,)
    The energy as it is, and scratch for what a trial changes.
"""

from __future__ import annotations

from math import log

import numpy as np

from meshops.kernels.lacking import (
    Prices,
    Site,
    Wanted,
    element_cost,
    node_cost,
)
from meshops.kernels.living import (
    ELEMENT_CHANGES,
    NODE_CHANGES,
    Live,
    living,
    settle,
    size_of_row,
    take_back,
)
from meshops.kernels.measures import CRITERIA
from meshops.kernels.node_scores import Ground, Scoring
from meshops.kernels.retopology import (
    collapse_diagonal_of,
    collapse_side,
    is_whole,
    open_node,
    open_trias,
    split_row,
    swap_side,
)
from meshops.kernels.vectors import area_vector, compiled, length
from meshops.kernels.wandering import Random, draw, move_node, relax_nodes
from meshops.mesh import Floats, Ids, Ints

Books = tuple[Floats, Floats, Ids, Ids, Ints, Ints, Floats, Floats]

LOOKS = 5
"""Elements that a trial looks at to find one where there is something to gain."""

MOVE = 0.4
"""Share of the trials that move a node."""

SWAP, COLLAPSE, OPEN, COLLAPSE_SIDE, OPEN_TRIAS = 0.5, 0.65, 0.8, 0.88, 0.95
"""Up to which number between 0 and 1 a change is of each kind; beyond them a quad is split."""

ROOM = 40
"""Elements and nodes that may come to a patch, besides half as many as it has."""

SCRATCH = 128
"""Elements that a trial may touch."""


@compiled
def _change(live: Live, site: Site, e: int, random: Random) -> bool:
    """Make one change of the topology at an element."""
    elements = live[1]
    kind, i, j = draw(random), int(draw(random) * 1000.0), int(draw(random) * 1000.0)
    side = i % size_of_row(live, e)
    if kind < SWAP:
        return swap_side(live, e, side, j)
    if kind < COLLAPSE:
        return collapse_diagonal_of(live, e, side, site[3])
    if kind < OPEN:
        return open_node(live, elements[e, side], i // 4, j, site[3])
    if kind < COLLAPSE_SIDE:
        return collapse_side(live, e, side, site[3])
    if kind < OPEN_TRIAS:
        return open_trias(live, elements[e, side], i // 4, j, site[3])
    return split_row(live, e, j)


@compiled
def _changed_nodes(live: Live, node_stamps: Ids, stamp: int, out: Ints) -> int:
    """Write the nodes of the elements that changed, before and after, to `out`."""
    elements, log, sizes = live[1], live[4], live[7]
    count = 0
    for i in range(sizes[ELEMENT_CHANGES]):
        for j in range(8):
            node = log[i, 1 + j] if j < 4 else elements[log[i, 0], j - 4]
            if node >= 0 and node_stamps[node] != stamp and count < len(out):
                node_stamps[node] = stamp
                out[count] = node
                count += 1
    return count


@compiled
def _changed_elements(live: Live, stamps: Ids, stamp: int, out: Ints) -> int:
    """Write the elements that changed, or whose nodes moved, to `out`; -1 if there are too many."""
    ring, around, log, moved, sizes = live[2], live[3], live[4], live[5], live[7]
    count = 0
    for i in range(sizes[ELEMENT_CHANGES]):
        if stamps[log[i, 0]] != stamp:
            stamps[log[i, 0]] = stamp
            out[count] = log[i, 0]
            count += 1
    for i in range(sizes[NODE_CHANGES]):
        for k in range(around[moved[i]]):
            e = ring[moved[i], k]
            if stamps[e] != stamp:
                if count == len(out):
                    return -1
                stamps[e] = stamp
                out[count] = e
                count += 1
    return count


@compiled
def _pick(live: Live, books: Books, threshold: float, random: Random) -> int:
    """Draw an element, rather one where there is something to gain; -1 where none is found."""
    elements = live[1]
    found = -1
    for _ in range(10 * LOOKS):
        e = int(draw(random) * len(elements))
        if elements[e, 0] < 0:
            continue
        found = e
        cost = books[0][e]
        for k in range(size_of_row(live, e)):
            cost += books[1][elements[e, k]]
        if cost > threshold or draw(random) < 1.0 / LOOKS:
            break
    return found


@compiled
def _attempt(
    live: Live, site: Site, books: Books, prices: Prices, trial: int, random: Random
) -> tuple[int, int]:
    """Change something; how many nodes have other elements, and how many elements are to be judged.

    None is to be judged where nothing was done, and -1 where it is to be taken back.
    """
    _, _, stamps, node_stamps, changed_nodes, changed_rows, _, _ = books
    e = _pick(live, books, 0.5 * prices[2], random)
    if e < 0:
        return 0, 0
    nodes = 0
    if draw(random) < MOVE:
        k = int(draw(random) * size_of_row(live, e))
        done = move_node(live, site, live[1][e, k], random)
    else:
        done = _change(live, site, e, random) and is_whole(live, site[2], site[3])
        if done:
            nodes = _changed_nodes(live, node_stamps, trial, changed_nodes)
            done = relax_nodes(live, site, changed_nodes, nodes)
    if not done:
        return 0, -1
    return nodes, _changed_elements(live, stamps, trial, changed_rows)


@compiled
def _gain(
    live: Live,
    site: Site,
    books: Books,
    prices: Prices,
    nodes: int,
    rows: int,
    limit: float,
    scoring: Scoring,
) -> float:
    """Find what a trial adds to the energy; anything above the limit where it is more."""
    of_elements, of_nodes, _, _, changed_nodes, changed_rows, fresh, values = books
    gain = 0.0
    for i in range(rows):
        gain -= of_elements[changed_rows[i]]
    for i in range(nodes):
        node = changed_nodes[i]
        gain += node_cost(live, node, site, prices) - of_nodes[node]
    for i in range(rows):
        fresh[i] = element_cost(live, changed_rows[i], site, prices, values, scoring)
        gain += fresh[i]
        if gain > limit:
            break
    return gain


@compiled
def _book(live: Live, site: Site, books: Books, prices: Prices, nodes: int, rows: int) -> None:
    """Keep a trial."""
    of_elements, of_nodes, _, _, changed_nodes, changed_rows, fresh, _ = books
    for i in range(rows):
        of_elements[changed_rows[i]] = fresh[i]
    for i in range(nodes):
        of_nodes[changed_nodes[i]] = node_cost(live, changed_nodes[i], site, prices)
    settle(live)


@compiled
def _mean_area(points: Floats, elements: Ints) -> float:
    """Mean area of a quad, a tria being half of one."""
    area, quads = 0.0, 0.0
    for e in range(len(elements)):
        a, b, c, d = elements[e, 0], elements[e, 1], elements[e, 2], elements[e, 3]
        area += length(area_vector(points, a, b, c, d))
        quads += 0.5 if d < 0 else 1.0
    return area / quads


@compiled
def _compact(live: Live, fixed: int) -> tuple[Floats, Ints]:
    """Points that are used, those that stay first, and elements."""
    points, elements, _, around, _, _, _, _ = live
    used = around > 0
    used[:fixed] = True
    numbers = np.cumsum(used).astype(np.int32) - np.int32(1)
    kept = elements[elements[:, 0] >= 0].copy()
    for e in range(len(kept)):
        for k in range(4):
            if kept[e, k] >= 0:
                kept[e, k] = numbers[kept[e, k]]
    return points[used].copy(), kept


@compiled
def anneal(
    points: Floats,
    elements: Ints,
    outside: Ints,
    fixed: int,
    plane: Floats,
    ground: Ground,
    wanted: Wanted,
    prices: Prices,
    temperatures: tuple[float, float],
    trials: int,
    seed: int,
    scoring: Scoring,
) -> tuple[bool, Floats, Ints, float, float]:
    """Anneal a patch.

    Parameters
    ----------
    points : (n, 3) float64
        The first `fixed` ones are those of the border.
    elements : (m, 4) int32
    outside : (n,) int32
        How many elements outside of the patch meet at each node; -1: any number may meet there.
    fixed : int
    plane, ground, wanted, prices, scoring
        As :mod:`meshops.kernels.lacking` says.
    temperatures : (hot, cold)
        On the scale of the energy; it falls from one to the other by the same share each trial.
    trials : int
    seed : int

    Returns
    -------
    Whether there was room for the patch, its points and elements after it, border nodes first, and
    the energy before and after.
    """
    fits, live = living(points, elements, len(elements) // 2 + ROOM)
    if not fits:
        return False, points, elements, 0.0, 0.0
    most, most_nodes = len(live[1]), len(live[0])
    counted = np.zeros(most_nodes, np.int32)
    counted[: len(outside)] = outside
    site = (plane, ground, counted, fixed, _mean_area(points, elements), wanted)
    books = (
        np.zeros(most),
        np.zeros(most_nodes),
        np.full(most, -1),
        np.full(most_nodes, -1),
        np.empty(SCRATCH, np.int32),
        np.empty(SCRATCH, np.int32),
        np.empty(SCRATCH),
        np.empty(CRITERIA),
    )
    for e in range(len(elements)):
        books[0][e] = element_cost(live, e, site, prices, books[7], scoring)
    for node in range(len(points)):
        books[1][node] = node_cost(live, node, site, prices)
    before = energy = books[0].sum() + books[1].sum()
    random = np.array([seed + 1], np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    temperature = temperatures[0]
    fall = (temperatures[1] / temperatures[0]) ** (1.0 / max(trials, 1))
    for trial in range(trials):
        temperature *= fall
        nodes, rows = _attempt(live, site, books, prices, trial, random)
        if rows > 0:
            # drawn before the energy is known, so that what is surely too much is not finished
            limit = -temperature * log(max(draw(random), 1e-300))
            gain = _gain(live, site, books, prices, nodes, rows, limit, scoring)
            if gain <= limit:
                energy += gain
                _book(live, site, books, prices, nodes, rows)
                continue
        take_back(live)
    after, kept = _compact(live, fixed)
    return True, after, kept, before, energy
