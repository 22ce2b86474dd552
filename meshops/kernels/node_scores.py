"""How good a node's place is: what the user's criteria say of the elements around it.

That is how severe their faults are, their highest Q.I., and the sum of Q.I. or of its squares.

Arguments that always travel together are tuples here:

net : points (N, 3), elements (M, 4), start (N + 1,), around
    The mesh and the elements of its nodes, as `elements_of_nodes` finds them.
ground : points (n, 3), trias (T, 3), spheres (T, 4), tolerance, least
    The surface, and how far from it the centre of an element may be; no trias where it is plane.
    Last the worst corner that an element may get.
state : quality (M, 2), trial (M, 2), surface (M, 4), least (M,), values (12,)
    The severity of an element's faults and its Q.I., as it is and in the trial at hand; the normal
    of the surface under it and its distance from there; the soundness that it must keep; scratch.
"""

from __future__ import annotations

from math import inf, isnan

import numpy as np

from meshops.kernels.measures import ASPECT_RATIO, CRITERIA, measure_element
from meshops.kernels.quality import SLACK, fault_of, penalty_between
from meshops.kernels.soundness import FACING
from meshops.kernels.surface import nearest
from meshops.kernels.vectors import (
    Vector,
    add,
    area_vector,
    compiled,
    corner_jacobian_min,
    dot,
    inlined,
    scale,
    unit,
)
from meshops.mesh import Bools, Floats, Ints

Net = tuple[Floats, Ints, Ints, Ints]
Ground = tuple[Floats, Ints, Floats, float, float]
State = tuple[Floats, Floats, Floats, Floats, Floats]
Scoring = tuple[Floats, Floats, Bools, Floats, Floats]
Score = tuple[float, float, float]

LAPLACE, WORST, EVEN = 0, 1, 2
"""Methods: to the mean of the neighbours; for the worst elements first; for the mean element."""

GAIN = 1e-6
"""Share of the sum by which a node must lower it to move."""

ROUNDING = 1e-12
"""Share by which a sum may differ with the order of its terms."""

SIZE_SHARE = 1.0 / 1024.0
"""What a fault of size counts over one of shape: all around a node together less than one."""

REJECTED = (inf, inf, inf)


@inlined
def row(array: Floats, i: int) -> Vector:
    """First three numbers of row i."""
    return array[i, 0], array[i, 1], array[i, 2]


@inlined
def element_faults(
    points: Floats, element: Ints, values: Floats, scoring: Scoring
) -> tuple[float, float, float]:
    """Severity of an element's faults of shape and of size, and its Q.I. as it is reported."""
    levels, weights, active, penalties, sizing = scoring
    measure_element(points, element[0], element[1], element[2], element[3], sizing, values)
    limit = penalties[3] + SLACK
    shape, size, failing, passing, weight = 0.0, 0.0, 0.0, 0.0, 0.0
    for c in range(CRITERIA):
        if not active[c]:
            continue
        p = penalty_between(
            values[c], levels[c, 0], levels[c, 1], levels[c, 2], levels[c, 3], levels[c, 4],
            penalties,
        )  # fmt: skip
        if isnan(p):
            continue
        fault = fault_of(values[c], p, levels[c, 0], levels[c, 4], levels[c, 5], limit)
        if c > ASPECT_RATIO:
            shape += fault
        else:
            size += fault
        if p > limit:
            failing += weights[c] * p
        else:
            passing += weights[c] * p
            weight += weights[c]
    return shape, size, failing + (passing / weight if weight > 0.0 else 0.0)


@inlined
def element_quality(
    points: Floats, element: Ints, values: Floats, scoring: Scoring
) -> tuple[float, float]:
    """Severity of an element's faults, shape before size, and its Q.I."""
    shape, size, index = element_faults(points, element, values, scoring)
    return shape + SIZE_SHARE * size, index


@inlined
def soundness(points: Floats, element: Ints, normal: Vector) -> float:
    """Worst corner of an element along its own normal; below -1 where it faces another way.

    `normal` is that of the surface under it.
    """
    a, b, c, d = element[0], element[1], element[2], element[3]
    own = unit(area_vector(points, a, b, c, d))
    facing = dot(own, normal)
    if facing < FACING:
        return facing - 2.0
    corner: float = corner_jacobian_min(points, a, b, c, d, own[0], own[1], own[2])
    return corner


@inlined
def centre(points: Floats, element: Ints) -> Vector:
    """Mean of an element's nodes."""
    size = 4 if element[3] >= 0 else 3
    total = (0.0, 0.0, 0.0)
    for k in range(size):
        total = add(total, row(points, element[k]))
    return scale(total, 1.0 / size)


@compiled
def foot(ground: Ground, place: Vector) -> tuple[Vector, Vector, float]:
    """Nearest point of the surface, the unit normal there, and the distance."""
    points, trias = ground[0], ground[1]
    found, distance, tria = nearest(np.array(place).reshape(1, 3), points, trias, ground[2])
    t = tria[0]
    normal = unit(area_vector(points, trias[t, 0], trias[t, 1], trias[t, 2], -1))
    return row(found, 0), normal, distance[0]


@inlined
def is_better(new: Score, old: Score, method: int) -> bool:
    """Whether a score is better: faults are less severe, or as severe and the sum is lower."""
    if new[0] != old[0]:
        return new[0] < old[0]
    if method == LAPLACE:
        return new[2] <= old[2]
    return new[2] < old[2] * (1.0 - GAIN)


@inlined
def score_now(net: Net, node: int, method: int, quality: Floats) -> Score:
    """Severity of the faults around a node, the highest Q.I., and the sum of Q.I. or squares."""
    _, _, start, around = net
    failed, highest, total = 0.0, 0.0, 0.0
    for i in range(start[node], start[node + 1]):
        index = quality[around[i], 1]
        failed += quality[around[i], 0]
        highest = max(highest, index)
        total += index if method == EVEN else index * index
    return failed, highest, total


@compiled
def score_trial(
    net: Net, node: int, method: int, now: Score, state: State, scoring: Scoring
) -> Score:
    """Score of a node where it stands; REJECTED as soon as it cannot be better than `now`."""
    points, elements, start, around = net
    quality, trial, surface, least, values = state
    first, last = start[node], start[node + 1]
    worst = around[first]
    for i in range(first, last):
        if quality[around[i], 1] > quality[worst, 1]:
            worst = around[i]
    # the element that is the worst now rejects most trials, and what is spared then is time gained
    failed, total = 0.0, 0.0
    for i in range(first - 1, last):
        e = worst if i < first else around[i]
        if i >= first and e == worst:
            continue
        if soundness(points, elements[e], row(surface, e)) < least[e]:
            return REJECTED
        fails, index = element_quality(points, elements[e], values, scoring)
        trial[e, 0], trial[e, 1] = fails, index
        failed += fails
        total += index if method == EVEN else index * index
        if failed > now[0] or (method != EVEN and index > now[1]):
            return REJECTED
        if now[0] == 0.0 and total > now[2] * (1.0 + ROUNDING):
            return REJECTED
    return score_now(net, node, method, trial)
