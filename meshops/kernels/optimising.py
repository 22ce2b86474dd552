"""Places of nodes that make the elements around them better, found by a local pattern search.

No derivative is taken, as Q.I. has kinks and plains. For the tuples ``net``, ``ground``, ``state``
and ``scoring`` see :mod:`meshops.kernels.node_scores`.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from meshops.kernels.measures import CRITERIA
from meshops.kernels.node_scores import (
    LAPLACE,
    Ground,
    Net,
    Score,
    Scoring,
    State,
    centre,
    element_quality,
    foot,
    is_better,
    row,
    score_now,
    score_trial,
    soundness,
)
from meshops.kernels.smoothing import elements_of_nodes
from meshops.kernels.vectors import (
    Vector,
    add,
    compiled,
    cross,
    dot,
    inlined,
    length,
    scale,
    subtract,
    unit,
)
from meshops.mesh import Floats, Ints

SWEEPS = 16

FIRST_STEP, WAKING_STEP, LEAST_STEP = 0.25, 0.06, 0.01
"""Of the mean edge at a node: the first step of the search; the step once a neighbour has moved;
and one that is not worth a trial, so that the node sleeps."""

LAPLACE_TRIALS = 3

HALF = sqrt(0.5)
DIRECTIONS = np.array(
    [(1, 0), (-1, 0), (0, 1), (0, -1), (HALF, HALF), (-HALF, -HALF), (-HALF, HALF), (HALF, -HALF)]
)


@inlined
def put(points: Floats, node: int, place: Vector) -> None:
    """Place a node."""
    points[node, 0], points[node, 1], points[node, 2] = place


@inlined
def _frame(net: Net, node: int, surface: Floats) -> tuple[Vector, Vector, Vector, float]:
    """Two tangents at a node, the step to the mean of its neighbours, and its mean edge.

    The first tangent points along an edge, so that the search turns with the mesh.
    """
    points, elements, start, around = net
    place = row(points, node)
    normal, total, along = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    edges, count = 0.0, 0
    for i in range(start[node], start[node + 1]):
        e = around[i]
        normal = add(normal, row(surface, e))
        size = 4 if elements[e, 3] >= 0 else 3
        for k in range(size):
            if elements[e, k] == node:
                # the element's next corner: each edge of a closed fan comes once
                following = k + 1 if k + 1 < size else 0
                along = subtract(row(points, elements[e, following]), place)
                total = add(total, along)
                edges += length(along)
                count += 1
    normal = unit(normal)
    along = unit(subtract(along, scale(normal, dot(along, normal))))
    step = scale(total, 1.0 / count)
    step = subtract(step, scale(normal, dot(step, normal)))
    return along, cross(normal, along), step, edges / count


@compiled
def _search(
    net: Net, node: int, method: int, reach: float, now: Score, state: State, scoring: Scoring
) -> bool:
    """Poll eight directions, going on from each better place, then once more all the way.

    Hooke and Jeeves (1961). Leaves the node at the best place; whether that is a new one.
    """
    points = net[0]
    along, across, _, edge = _frame(net, node, state[2])
    old = place = row(points, node)
    best = now
    for k in range(len(DIRECTIONS) + 1):
        if k < len(DIRECTIONS):
            x, y = reach * edge * DIRECTIONS[k, 0], reach * edge * DIRECTIONS[k, 1]
            trial = add(place, add(scale(along, x), scale(across, y)))
        elif place == old:
            break
        else:
            trial = add(place, subtract(place, old))
        put(points, node, trial)
        score = score_trial(net, node, method, best, state, scoring)
        if is_better(score, best, method):
            best, place = score, trial
    put(points, node, place)
    return place != old


@compiled
def _relax(net: Net, node: int, now: Score, state: State, scoring: Scoring) -> bool:
    """Go to the mean of the neighbours, or half or a quarter of the way (Freitag 1997)."""
    points = net[0]
    _, _, step, edge = _frame(net, node, state[2])
    old = row(points, node)
    for _ in range(LAPLACE_TRIALS):
        if length(step) < LEAST_STEP * edge:
            break
        put(points, node, add(old, step))
        if is_better(score_trial(net, node, LAPLACE, now, state, scoring), now, LAPLACE):
            return True
        step = scale(step, 0.5)
    put(points, node, old)
    return False


@compiled
def lies_on(net: Net, node: int, ground: Ground, state: State) -> bool:
    """Whether the elements around a node lie on a curved surface; if so, notes where."""
    points, elements, start, around = net
    _, _, surface, least, _ = state
    first, last = start[node], start[node + 1]
    under = np.empty((last - first, 4))
    for i in range(first, last):
        e = around[i]
        _, normal, distance = foot(ground, centre(points, elements[e]))
        if distance > max(ground[3], surface[e, 3]):
            return False
        if soundness(points, elements[e], normal) < least[e]:
            return False
        under[i - first, 0], under[i - first, 1], under[i - first, 2] = normal
        under[i - first, 3] = distance
    for i in range(first, last):
        surface[around[i]] = under[i - first]
    return True


@compiled
def move(
    net: Net,
    node: int,
    method: int,
    reach: float,
    ground: Ground,
    state: State,
    scoring: Scoring,
) -> bool:
    """Move a node to a better place on the surface; whether one was found."""
    points = net[0]
    now = score_now(net, node, method, state[0])
    if method == LAPLACE:
        found = _relax(net, node, now, state, scoring)
    else:
        found = now[2] > 0.0 and _search(net, node, method, reach, now, state, scoring)
    if found and len(ground[1]) > 0:
        put(points, node, foot(ground, row(points, node))[0])
    if not found or not is_better(score_trial(net, node, method, now, state, scoring), now, method):
        return False
    return len(ground[1]) == 0 or lies_on(net, node, ground, state)


@inlined
def keep(net: Net, node: int, ground: Ground, state: State, step: Floats) -> None:
    """Note what the elements around a node are like now, and wake the nodes around it."""
    points, elements, start, around = net
    quality, trial, surface, least, _ = state
    for i in range(start[node], start[node + 1]):
        e = around[i]
        quality[e] = trial[e]
        least[e] = min(ground[4], soundness(points, elements[e], row(surface, e)))
        for k in range(4):
            other = elements[e, k]
            if other >= 0 and step[other] >= 0.0:
                step[other] = max(step[other], WAKING_STEP)


@compiled
def appraise(net: Net, plane: Vector, ground: Ground, scoring: Scoring) -> State:
    """State of all elements before any node moves."""
    points, elements, _, _ = net
    m = len(elements)
    quality, surface, least = np.empty((m, 2)), np.zeros((m, 4)), np.empty(m)
    values = np.empty(CRITERIA)
    for e in range(m):
        normal, distance = plane, 0.0
        if len(ground[1]) > 0:
            _, normal, distance = foot(ground, centre(points, elements[e]))
        surface[e, 0], surface[e, 1], surface[e, 2] = normal
        surface[e, 3] = distance
        least[e] = min(ground[4], soundness(points, elements[e], normal))
        quality[e, 0], quality[e, 1] = element_quality(points, elements[e], values, scoring)
    return quality, quality.copy(), surface, least, values


@compiled
def optimise(
    points: Floats,
    elements: Ints,
    nodes: Ints,
    method: int,
    plane: Floats,
    ground: Ground,
    scoring: Scoring,
) -> int:
    """Move nodes to places where the elements around them are better, in place.

    No element is turned over, gets a corner below ``least`` or leaves the surface; none that does
    already gets worse. Of the elements around a node that moves no more fail than before, and
    their highest Q.I. does not rise, but for ``EVEN``, which lowers their sum.

    Parameters
    ----------
    points, elements
        The mesh, or the part of it that is all elements around the nodes.
    nodes : (K,) int32
        Rows of the nodes that may move; elements close around each.
    method : int
        ``LAPLACE``, ``WORST`` or ``EVEN`` of node_scores.
    plane : (3,) float64
        Unit normal of a plane surface.
    ground, scoring
        See node_scores; scoring is ``Scoring.arrays``.

    Returns
    -------
    int
        How many times a node was visited.
    """
    start, around = elements_of_nodes(elements, len(points))
    net = (points, elements, start, around)
    state = appraise(net, (plane[0], plane[1], plane[2]), ground, scoring)
    step = np.full(len(points), -1.0)
    step[nodes] = FIRST_STEP
    worst = np.empty(len(nodes))
    visits = 0
    for _ in range(SWEEPS):
        for i in range(len(nodes)):
            worst[i] = score_now(net, nodes[i], method, state[0])[1]
        for i in np.argsort(-worst, kind="mergesort"):
            node = nodes[i]
            if step[node] < LEAST_STEP:
                continue
            visits += 1
            old = row(points, node)
            if move(net, node, method, step[node], ground, state, scoring):
                keep(net, node, ground, state, step)
            else:
                put(points, node, old)
                step[node] *= 0.0 if method == LAPLACE else 0.5
    return visits
