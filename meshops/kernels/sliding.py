"""Places of border nodes along their border, found together with those of inner nodes.

A border is where the mesh that a run began with has it, so that it does not creep away however
often its nodes slide. For the tuples ``net``, ``ground``, ``state`` and ``scoring`` see
:mod:`meshops.kernels.node_scores`.

line : neighbours (N, 2), rails (R, 2, 3), tolerance
    The neighbours of each node that slides, elsewhere -1; the edges that it slides along; and how
    far from them it and its edges may be, of its shortest edge.
"""

from __future__ import annotations

from math import inf

import numpy as np

from meshops.kernels.node_scores import (
    Ground,
    Net,
    Scoring,
    State,
    is_better,
    row,
    score_now,
    score_trial,
)
from meshops.kernels.optimising import (
    FIRST_STEP,
    LEAST_STEP,
    SWEEPS,
    appraise,
    keep,
    lies_on,
    move,
    put,
)
from meshops.kernels.smoothing import elements_of_nodes
from meshops.kernels.vectors import (
    Vector,
    add,
    compiled,
    dot,
    length,
    scale,
    subtract,
    unit,
)
from meshops.mesh import Floats, Ints

Line = tuple[Ints, Floats, float]

SAMPLES = 4
"""Parts into which an edge is divided to see whether it follows the border."""


@compiled
def nearest_on_rails(place: Vector, rails: Floats) -> tuple[Vector, float]:
    """Nearest point of edges (R, 2, 3), and its distance; infinite where there is no edge."""
    best, found = inf, place
    for i in range(len(rails)):
        start = row(rails[i], 0)
        way = subtract(row(rails[i], 1), start)
        size = dot(way, way)
        along = dot(subtract(place, start), way) / size if size > 0.0 else 0.0
        point = add(start, scale(way, min(max(along, 0.0), 1.0)))
        off = subtract(point, place)
        if dot(off, off) < best:
            best, found = dot(off, off), point
    return found, np.sqrt(best)


@compiled
def _follows(net: Net, node: int, line: Line, most: float) -> bool:
    """Whether a node and its two border edges are nowhere farther than `most` from the rails."""
    points, (neighbours, rails, _) = net[0], line
    place = row(points, node)
    for side in range(2):
        way = subtract(row(points, neighbours[node, side]), place)
        for k in range(SAMPLES):
            if nearest_on_rails(add(place, scale(way, k / SAMPLES)), rails)[1] > most:
                return False
    return True


@compiled
def _frame(net: Net, node: int, line: Line) -> tuple[Vector, float, float]:
    """Tangent at a border node along the border, its shorter border edge, its shortest edge.

    The last is that across where a part is narrow.
    """
    points, elements, start, around = net
    place = row(points, node)
    before, after = row(points, line[0][node, 0]), row(points, line[0][node, 1])
    along = unit(subtract(after, before))
    edge = min(length(subtract(place, before)), length(subtract(after, place)))
    shortest = edge
    for i in range(start[node], start[node + 1]):
        e = around[i]
        size = 4 if elements[e, 3] >= 0 else 3
        for k in range(size):
            other = elements[e, (k + 1) % size]
            if elements[e, k] == node or other == node:
                way = subtract(row(points, other), row(points, elements[e, k]))
                shortest = min(shortest, length(way))
    return along, edge, shortest


@compiled
def _slide(
    net: Net,
    node: int,
    method: int,
    reach: float,
    line: Line,
    ground: Ground,
    state: State,
    scoring: Scoring,
) -> bool:
    """Move a border node to a better place along its border; whether one was found.

    Polls a step to either side, and once more on from the better one.
    """
    points = net[0]
    _, rails, tolerance = line
    now = score_now(net, node, method, state[0])
    along, edge, shortest = _frame(net, node, line)
    most = tolerance * shortest
    old = place = row(points, node)
    best = now
    for k in range(3):
        if k < 2:
            trial = add(old, scale(along, reach * edge * (1 - 2 * k)))
        elif place == old:
            break
        else:
            trial = add(place, subtract(place, old))
        trial = nearest_on_rails(trial, rails)[0]
        put(points, node, trial)
        score = score_trial(net, node, method, best, state, scoring)
        if is_better(score, best, method) and _follows(net, node, line, most):
            best, place = score, trial
    put(points, node, place)
    if place == old:
        return False
    score_trial(net, node, method, now, state, scoring)  # notes the quality at this place
    return len(ground[1]) == 0 or lies_on(net, node, ground, state)


@compiled
def _shift(
    net: Net,
    node: int,
    method: int,
    shift: float,
    line: Line,
    ground: Ground,
    state: State,
    scoring: Scoring,
) -> bool:
    """Move a border node along its border, be that better or not; whether it may."""
    along, edge, shortest = _frame(net, node, line)
    trial = add(row(net[0], node), scale(along, shift * edge))
    put(net[0], node, nearest_on_rails(trial, line[1])[0])
    if score_trial(net, node, method, (inf, inf, inf), state, scoring)[0] == inf:
        return False
    if not _follows(net, node, line, line[2] * shortest):
        return False
    return len(ground[1]) == 0 or lies_on(net, node, ground, state)


@compiled
def slide(
    points: Floats,
    elements: Ints,
    nodes: Ints,
    method: int,
    plane: Floats,
    line: Line,
    shift: float,
    ground: Ground,
    scoring: Scoring,
) -> int:
    """Move nodes, those on a border along it, as `optimise` moves inner ones, in place.

    Along a border of which each element fails alike, no node can do anything alone: `shift`, of its
    edges, is what all border nodes beside failing elements do at first.

    Parameters
    ----------
    points, elements
        The mesh, or the part of it that is all elements around the nodes.
    nodes : (K,) int32
        Rows of the nodes that may move.
    method, plane, ground, scoring
        See `optimise`; only ``EVEN`` lets one element get better at the cost of another.
    line
        See above: nodes without neighbours there are inner nodes.
    shift : float

    Returns
    -------
    int
        How many times a node was visited.
    """
    start, around = elements_of_nodes(elements, len(points))
    net = (points, elements, start, around)
    state = appraise(net, (plane[0], plane[1], plane[2]), ground, scoring)
    step = np.full(len(points), -1.0)
    for node in nodes:  # the others sleep until a neighbour has moved
        step[node] = FIRST_STEP if score_now(net, node, method, state[0])[0] > 0.0 else 0.0
    if shift != 0.0:
        for node in nodes:
            if step[node] > 0.0 and line[0][node, 0] >= 0:
                old = row(points, node)
                if _shift(net, node, method, shift, line, ground, state, scoring):
                    keep(net, node, ground, state, step)
                else:
                    put(points, node, old)
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
            if line[0][node, 0] >= 0:
                moved = _slide(net, node, method, step[node], line, ground, state, scoring)
            else:
                moved = move(net, node, method, step[node], ground, state, scoring)
            if moved:
                keep(net, node, ground, state, step)
            else:
                put(points, node, old)
                step[node] *= 0.5
    return visits
