"""Simulated annealing of a patch by small changes (Kirkpatrick, Gelatt and Vecchi 1983).

Every trial changes the topology in one place and relaxes the nodes there, or moves one node. What
it adds to the energy decides whether it stays. The energy is what a mesh lacks: of each element its
Q.I., and more where it fails or is a tria or is not sound; of each inner node, whether it is
irregular, that is whether other than four elements meet there.

See :mod:`meshops.kernels.living` for ``live`` and :mod:`meshops.kernels.node_scores` for ``ground``
and ``scoring``. And:

prices : (4,)
    What a failing element, a tria, an irregular node and an element that is not sound cost.
site : plane (3,), ground, outside (N,), fixed, area, wanted
    The normal of a plane patch, (0, 0, 0) where it is curved and `ground` counts; how many elements
    outside of the patch meet at a node, -1 where that node may have any number; how many nodes stay
    where they are; the mean area of a quad, a tria being half of one; the wanted sizes.
wanted : sizes (X, Y, Z), origin (3,), cell
    Edge lengths by place, each for a cube of a grid.
costs : of_elements (M,), of_nodes (N,), stamps (M,), node_stamps (N,), values (12,)
    The energy as it is, and scratch.
"""

from __future__ import annotations

from math import log

import numpy as np

from meshops.kernels.living import (
    ELEMENT_CHANGES,
    NODE_CHANGES,
    Live,
    ahead,
    behind,
    corner,
    element_with_side,
    living,
    put,
    settle,
    size_of_row,
    take_back,
)
from meshops.kernels.measures import CRITERIA
from meshops.kernels.node_scores import (
    Ground,
    Scoring,
    centre,
    element_quality,
    foot,
    soundness,
)
from meshops.kernels.retopology import (
    collapse_diagonal_of,
    collapse_side,
    open_node,
    open_trias,
    split_row,
    swap_side,
)
from meshops.kernels.vectors import Vector, add, area_vector, compiled, cross, dot, length, scale, subtract, unit
from meshops.mesh import Bools, Floats, Ids, Ints

Prices = tuple[float, float, float, float]
Wanted = tuple[Floats, Floats, float]
Site = tuple[Floats, Ground, Ints, int, float, Wanted]
Costs = tuple[Floats, Floats, Ids, Ids, Floats]

SOUND = 0.05
"""`corner_jacobian_min` from which an element is sound."""

MOST_VALENCE = 8
"""Elements that may meet at a node."""

FAR_FROM_REGULAR = 1.5
"""What each element too many or too few at a node costs beyond the first, over what that costs."""

MOST_INDEX = 4.0
"""Of a failing element: beyond that it does not matter by how much, so that it can change."""

OFF_SIZE = 0.25
"""What an element costs that has e times the area that is wanted there, or an e-th of it."""

LOOKS = 5
"""Elements that a trial looks at to find one where there is something to gain."""

SWEEPS = 2
"""Of relaxation after a change."""

OPPOSITE = 0.4
"""Weight of the far node of a quad in the place that a node relaxes to (Herrmann 1976)."""

MOVE, SWAP, COLLAPSE, OPEN, COLLAPSE_SIDE, OPEN_TRIAS = 0.4, 0.7, 0.79, 0.88, 0.93, 0.97
"""Up to which number between 0 and 1 a trial is of each kind; beyond them a quad is split."""

FARTHEST = 0.3
"""Of the mean edge at a node: the farthest that it is moved in a trial."""


@compiled
def _draw(random: Ids) -> float:
    """Next number from 0 to 1 of a xorshift generator (Marsaglia 2003); `random` (1,) uint64."""
    x = random[0]
    x ^= x << np.uint64(13)
    x ^= x >> np.uint64(7)
    x ^= x << np.uint64(17)
    random[0] = x
    return float(x >> np.uint64(11)) * (1.0 / 9007199254740992.0)


@compiled
def _size_off(area: float, place: Vector, wanted: Wanted) -> float:
    """Logarithm of a quad's area over the one that is wanted in its place."""
    sizes, origin, cell = wanted
    i = min(max(int((place[0] - origin[0]) / cell), 0), sizes.shape[0] - 1)
    j = min(max(int((place[1] - origin[1]) / cell), 0), sizes.shape[1] - 1)
    k = min(max(int((place[2] - origin[2]) / cell), 0), sizes.shape[2] - 1)
    size = sizes[i, j, k]
    return log(max(area, 1e-12 * size * size) / (size * size))


@compiled
def _element_cost(
    live: Live, e: int, site: Site, prices: Prices, values: Floats, scoring: Scoring
) -> float:
    points, elements = live[0], live[1]
    element = elements[e]
    if element[0] < 0:
        return 0.0
    failed, index = element_quality(points, element, values, scoring)
    a, b, c, d = element[0], element[1], element[2], element[3]
    area = length(area_vector(points, a, b, c, d))
    # by area, so that a mesh does not get better by having fewer elements
    away = _size_off(area if d >= 0 else 2.0 * area, centre(points, element), site[5])
    share = area / site[4]
    cost: float = share * OFF_SIZE * away * away + failed * prices[0] * min(index / MOST_INDEX, 1.0)
    if failed == 0.0:
        cost += share * index
    if element[3] < 0:
        cost += prices[1]
    plane, ground = site[0], site[1]
    normal = (plane[0], plane[1], plane[2])
    if plane[0] == 0.0 and plane[1] == 0.0 and plane[2] == 0.0:
        _, normal, distance = foot(ground, centre(points, element))
        if distance > ground[3]:
            cost += prices[3]
    lowest = soundness(points, element, normal)
    if lowest < SOUND:
        cost += prices[3] * (1.0 + SOUND - lowest)
    return cost


@compiled
def _node_cost(live: Live, node: int, site: Site, prices: Prices) -> float:
    around, outside = live[3], site[2]
    if outside[node] < 0 or around[node] == 0:
        return 0.0
    away = abs(around[node] + outside[node] - 4)
    if away == 0:
        return 0.0
    return prices[2] * (1.0 + FAR_FROM_REGULAR * (away - 1))


@compiled
def _is_whole(live: Live, site: Site) -> bool:
    """Whether the elements that changed leave a surface: each side once, each node well used."""
    _, elements, ring, around, log, _, _, sizes = live
    outside, fixed = site[2], site[3]
    for i in range(sizes[ELEMENT_CHANGES]):
        for j in range(1, 5):  # a node that has lost elements
            node = log[i, j]
            if node < 0:
                continue
            if node < fixed and around[node] == 0:
                return False
            if node >= fixed and 0 < around[node] < 3:
                return False
        e = log[i, 0]
        size = size_of_row(live, e)
        for k in range(size):
            a, b = elements[e, k], ahead(live, e, k)
            if a == b or (size == 4 and k < 2 and a == elements[e, k + 2]):
                return False
            valence = around[a] + max(outside[a], 0)
            if valence > MOST_VALENCE or (a >= fixed and valence < 3):
                return False
            same = opposed = 0
            for m in range(around[a]):
                other = ring[a, m]
                c = corner(live, other, a)
                same += ahead(live, other, c) == b
                opposed += behind(live, other, c) == b
            if same != 1 or opposed > 1:
                return False
    return True


@compiled
def _relaxed(live: Live, node: int) -> tuple[Vector, float]:
    """Where a node relaxes to, between the mean of its neighbours and that of parallelograms.

    Also returns the mean edge at the node.
    """
    points, elements, ring, around = live[0], live[1], live[2], live[3]
    here = (points[node, 0], points[node, 1], points[node, 2])
    total, weight, edges = (0.0, 0.0, 0.0), 0.0, 0.0
    for i in range(around[node]):
        e = ring[node, i]
        k = corner(live, e, node)
        a, b = ahead(live, e, k), behind(live, e, k)
        p, q = (points[a, 0], points[a, 1], points[a, 2]), (points[b, 0], points[b, 1], points[b, 2])
        edges += 0.5 * (length(subtract(p, here)) + length(subtract(q, here)))
        total = add(total, add(p, q))
        weight += 2.0
        if elements[e, 3] >= 0:
            o = elements[e, (k + 2) % 4]
            total = subtract(total, scale((points[o, 0], points[o, 1], points[o, 2]), OPPOSITE))
            weight -= OPPOSITE
    return scale(total, 1.0 / weight), edges / around[node]


@compiled
def _onto(site: Site, place: Vector) -> Vector:
    """Bring a place to the surface."""
    plane, ground = site[0], site[1]
    if plane[0] == 0.0 and plane[1] == 0.0 and plane[2] == 0.0:
        on_surface: Vector = foot(ground, place)[0]
        return on_surface
    return place


@compiled
def _relax_changed(live: Live, site: Site, changed: Ints, count: int) -> bool:
    """Relax the free ones of some nodes."""
    for _ in range(SWEEPS):
        for i in range(count):
            node = changed[i]
            if node >= site[3] and live[3][node] > 0:
                place = _relaxed(live, node)[0]
                if not put(live, node, _onto(site, place)):
                    return False
    return True


@compiled
def _move(live: Live, site: Site, node: int, random: Ids) -> bool:
    """Move a node: a part of the way to where it relaxes, or anywhere near."""
    points, elements, ring = live[0], live[1], live[2]
    if node < site[3]:
        return False
    here = (points[node, 0], points[node, 1], points[node, 2])
    relaxed, edge = _relaxed(live, node)
    if _draw(random) < 0.3:
        return put(live, node, _onto(site, add(here, scale(subtract(relaxed, here), _draw(random)))))
    e = ring[node, 0]
    k = corner(live, e, node)
    a, b = ahead(live, e, k), behind(live, e, k)
    p = subtract((points[a, 0], points[a, 1], points[a, 2]), here)
    q = subtract((points[b, 0], points[b, 1], points[b, 2]), here)
    normal = unit(cross(p, q))
    along = unit(subtract(p, scale(normal, dot(p, normal))))
    across = cross(normal, along)
    reach = FARTHEST * edge * _draw(random)
    x, y = reach * (2.0 * _draw(random) - 1.0), reach * (2.0 * _draw(random) - 1.0)
    return put(live, node, _onto(site, add(here, add(scale(along, x), scale(across, y)))))


@compiled
def _change(live: Live, site: Site, e: int, random: Ids) -> bool:
    """Make one change of the topology at an element."""
    elements = live[1]
    kind, i, j = _draw(random), int(_draw(random) * 1000.0), int(_draw(random) * 1000.0)
    kind = MOVE + kind * (1.0 - MOVE)
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
def _pick(live: Live, costs: Costs, threshold: float, most: int, random: Ids) -> int:
    """An element, rather one where there is something to gain; -1 where none is found."""
    elements = live[1]
    found = -1
    for _ in range(10 * LOOKS):
        e = int(_draw(random) * most)
        if elements[e, 0] < 0:
            continue
        found = e
        cost = costs[0][e]
        for k in range(size_of_row(live, e)):
            cost += costs[1][elements[e, k]]
        if cost > threshold or _draw(random) < 1.0 / LOOKS:
            break
    return found


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
        As the module says.
    temperatures : (hot, cold)
        On the scale of the energy; it falls from one to the other by the same share each trial.
    trials : int
    seed : int

    Returns
    -------
    Whether there was room for the patch, its points and elements after it, border nodes first, and
    the energy before and after.
    """
    room = len(elements) // 2 + 40
    fits, live = living(points, elements, room)
    if not fits:
        return False, points, elements, 0.0, 0.0
    of_elements, of_nodes = np.zeros(len(live[1])), np.zeros(len(live[0]))
    counted = np.zeros(len(live[0]), np.int32)
    counted[: len(outside)] = outside
    area, quads = 0.0, 0.0
    for e in range(len(elements)):
        a, b, c, d = elements[e, 0], elements[e, 1], elements[e, 2], elements[e, 3]
        area += length(area_vector(points, a, b, c, d))
        quads += 0.5 if d < 0 else 1.0
    site = (plane, ground, counted, fixed, area / quads, wanted)
    values = np.empty(CRITERIA)
    stamps, node_stamps = np.full(len(live[1]), -1), np.full(len(live[0]), -1)
    costs = (of_elements, of_nodes, stamps, node_stamps, values)
    for e in range(len(elements)):
        of_elements[e] = _element_cost(live, e, site, prices, values, scoring)
    for node in range(len(points)):
        of_nodes[node] = _node_cost(live, node, site, prices)
    energy = before = of_elements.sum() + of_nodes.sum()
    random = np.array([seed + 1], np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    for _ in range(8):
        _draw(random)
    nodes_changed, rows_changed = np.empty(64, np.int32), np.empty(128, np.int32)
    fresh = np.empty(128)
    hot, cold = temperatures
    temperature, fall = hot, (cold / hot) ** (1.0 / max(trials, 1))
    threshold = 0.5 * prices[2]
    most = len(live[1])
    for trial in range(trials):
        temperature *= fall
        e = _pick(live, costs, threshold, most, random)
        if e < 0:
            continue
        if _draw(random) < MOVE:
            k = int(_draw(random) * size_of_row(live, e))
            done = _move(live, site, live[1][e, k], random)
            nodes = 0
        else:
            done = _change(live, site, e, random) and _is_whole(live, site)
            nodes = 0
            if done:
                nodes = _changed_nodes(live, node_stamps, trial, nodes_changed)
                done = _relax_changed(live, site, nodes_changed, nodes)
        rows = _changed_elements(live, stamps, trial, rows_changed) if done else -1
        if rows < 0:
            take_back(live)
            continue
        limit = -temperature * log(max(_draw(random), 1e-300))
        gain = 0.0
        for i in range(rows):
            gain -= of_elements[rows_changed[i]]
        for i in range(nodes):
            node = nodes_changed[i]
            gain += _node_cost(live, node, site, prices) - of_nodes[node]
        for i in range(rows):
            fresh[i] = _element_cost(live, rows_changed[i], site, prices, values, scoring)
            gain += fresh[i]
            if gain > limit:
                break
        if gain > limit:
            take_back(live)
            continue
        for i in range(rows):
            of_elements[rows_changed[i]] = fresh[i]
        for i in range(nodes):
            of_nodes[nodes_changed[i]] = _node_cost(live, nodes_changed[i], site, prices)
        energy += gain
        settle(live)
    used = live[3] > 0
    used[:fixed] = True
    rows_of = np.cumsum(used).astype(np.int32) - np.int32(1)
    kept = live[1][live[1][:, 0] >= 0].copy()
    for i in range(len(kept)):
        for k in range(4):
            if kept[i, k] >= 0:
                kept[i, k] = rows_of[kept[i, k]]
    return True, live[0][used].copy(), kept, before, energy
