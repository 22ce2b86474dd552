"""Judging small edits of a mesh: whether each leaves it whole, and how good it is then.

Whether it stays whole is found without looking at places (kernels.exchanging), then whether all
elements that come or whose nodes move are sound, then what they add to the tally.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from meshops.kernels.exchanging import is_whole, size_of
from meshops.kernels.quality import CRITERIA, IRREGULAR, TALLY_SIZE, add_element, add_values
from meshops.kernels.regularity import irregular_change
from meshops.kernels.smoothing import own_corner
from meshops.kernels.soundness import FACING
from meshops.kernels.vectors import (
    Vector,
    add,
    area_vector,
    compiled,
    corner_jacobian_min,
    dot,
    inlined,
    length,
    unit,
)
from meshops.mesh import Bools, Floats, Ints

LEAST_CORNER = 0.04
"""`corner_jacobian_min` from which a new element counts as sound. One that was worse before may
stay so where only its nodes move, but may not get worse still."""


@inlined
def _is_sound(points: Floats, element: Ints, normal: Vector, least: float) -> bool:
    """Whether an element faces the way of a unit normal and no corner is worse than `least`."""
    a, b, c, d = element[0], element[1], element[2], element[3]
    n = unit(area_vector(points, a, b, c, d))
    if not dot(n, normal) >= FACING:
        return False
    corner: float = corner_jacobian_min(points, a, b, c, d, n[0], n[1], n[2])
    return corner >= least


@inlined
def _area_of(points: Floats, element: Ints) -> Vector:
    vector: Vector = area_vector(points, element[0], element[1], element[2], element[3])
    return vector


@inlined
def _shares_a_node(one: Ints, other: Ints) -> bool:
    for i in range(4):
        for j in range(4):
            if one[i] >= 0 and one[i] == other[j]:
                return True
    return False


@compiled
def _normal_under(element: Ints, rows: Ints, points: Floats, elements: Ints) -> Vector:
    """Mean normal of the elements `rows` that share a node with an element; of all, if none does.

    A long patch may bend, so that its far end says nothing about this one.
    """
    near = everything = (0.0, 0.0, 0.0)
    for e in rows:
        area = _area_of(points, elements[e])
        everything = add(everything, area)
        if _shares_a_node(element, elements[e]):
            near = add(near, area)
    normal: Vector = unit(near) if length(near) > 0.0 else unit(everything)
    return normal


@compiled
def _all_sound(
    removed: Ints,
    added: Ints,
    affected: Ints,
    points: Floats,
    places: Floats,
    elements: Ints,
) -> bool:
    """Whether the elements that come or whose nodes move are sound at their new places."""
    for i in range(len(added)):
        normal = _normal_under(added[i], removed, points, elements)
        if not _is_sound(places, added[i], normal, LEAST_CORNER):
            return False
    for e in affected:
        element = elements[e]
        corner = own_corner(points, element[0], element[1], element[2], element[3])
        normal = unit(_area_of(points, element))
        if corner < LEAST_CORNER:
            # the normal of an element that is not sound says little: those around it say more
            normal = _normal_under(element, affected, points, elements)
        if not _is_sound(places, element, normal, min(LEAST_CORNER, corner)):
            return False
    return True


@compiled
def _put_in(
    tally: Floats,
    points: Floats,
    element: Ints,
    values: Floats,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    sizing: Floats,
) -> None:
    """Add an element to a tally; a function, so that it is compiled in once."""
    add_element(
        tally, points, element[0], element[1], element[2], element[3], 1.0, values,
        levels, weights, active, penalties, sizing,
    )  # fmt: skip


@compiled
def _take_out(
    tally: Floats,
    element: Ints,
    values: Floats,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    sizing: Floats,
) -> None:
    """Take an element of the mesh out of a tally by its measures (12,)."""
    add_values(tally, values, element[3] < 0, -1.0, levels, weights, active, penalties, sizing)


@inlined
def _centre(points: Floats, element: Ints, out: Floats) -> None:
    size = size_of(element)
    for axis in range(3):
        total = 0.0
        for corner in range(size):
            total += points[element[corner], axis] / size
        out[axis] = total


@compiled
def _edge(points: Floats, elements: Ints, rows: Ints, others: Ints) -> float:
    """Edge of a square of the mean area of two lots of elements, a tria counting as half."""
    area = count = 0.0
    for part in (rows, others):
        for e in part:
            area += length(_area_of(points, elements[e]))
            count += 0.5 if elements[e, 3] < 0 else 1.0
    return sqrt(area / count)


@compiled
def _most(start: Ints) -> int:
    most = 0
    for k in range(len(start) - 1):
        most = max(most, start[k + 1] - start[k])
    return most


@compiled
def judge_candidates(
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
    element_edges: Ints,
    edge_elements: Ints,
    crossable: Bools,
    zones: Ints,
    free: Bools,
    start: Ints,
    around: Ints,
    outside: Ints,
    values: Floats,
    tally: Floats,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    sizing: Floats,
) -> tuple[Floats, Floats, Floats]:
    """Tally of the mesh after each candidate alone.

    Parameters
    ----------
    removed_start, ..., moved_to
        The arrays of the candidates.
    points, elements, element_edges, edge_elements, crossable, zones, free
        The mesh and its topology; `free` (N,) bool: nodes that may move or vanish.
    start, around
        The elements of its nodes.
    outside : (N,) int32
        How many elements that are not of the mesh meet at each node, -1 where any number may.
    values : (M, 12) float64
        Measures of the elements as they are.
    tally : (TALLY_SIZE,) float64
        The tally of the whole mesh.
    levels, weights, active, penalties, sizing
        The scoring.

    Returns
    -------
    tallies : (K, TALLY_SIZE) float64
        NaN for a candidate that would not leave the mesh whole and its new elements sound, and for
        one that does nothing.
    edges : (K,) float64
        Edge of a square of the mean area of the elements that a candidate touches.
    centres : (B, 3) float64
        Of the elements that come. Neither this nor the edge is set where the tally is NaN.
    """
    count, nodes = len(removed_start) - 1, len(points)
    most_removed, most_added = _most(removed_start), _most(added_start)
    gone = np.full(len(elements), -1, np.int32)
    seen = np.full(len(elements), -1, np.int32)
    leaving = np.full(nodes, -1, np.int32)
    coming = np.full(nodes + _most(point_start), -1, np.int32)
    outline = np.empty((4 * most_removed, 2), np.int32)
    sides = np.empty((4 * most_added, 2), np.int32)
    inner = np.empty((4 * most_added, 2), np.int32)
    affected = np.empty(len(elements), np.int32)
    counts = np.zeros(nodes + _most(point_start), np.int32)
    scratch = np.empty(CRITERIA)
    places = np.empty((nodes + _most(point_start), 3))
    places[:nodes] = points
    tallies = np.full((count, TALLY_SIZE), np.nan)
    edges = np.zeros(count)
    centres = np.zeros((len(added), 3))
    for k in range(count):
        goes = removed[removed_start[k] : removed_start[k + 1]]
        comes = added[added_start[k] : added_start[k + 1]]
        moves = moved[moved_start[k] : moved_start[k + 1]]
        appears = point_start[k + 1] - point_start[k]
        if not is_whole(
            k, goes, comes, appears, moves, elements, element_edges, edge_elements, crossable,
            zones, free, start, around, gone, leaving, coming, outline, sides, inner,
        ):  # fmt: skip
            continue
        places[nodes : nodes + appears] = new_points[point_start[k] : point_start[k + 1]]
        touched = 0
        for i in range(moved_start[k], moved_start[k + 1]):
            places[moved[i]] = moved_to[i]
            for j in range(start[moved[i]], start[moved[i] + 1]):
                e = around[j]
                if gone[e] != k and seen[e] != k:
                    seen[e] = k
                    affected[touched] = e
                    touched += 1
        if _all_sound(goes, comes, affected[:touched], points, places, elements):
            edges[k] = _edge(points, elements, goes, affected[:touched])
            row = tallies[k]
            row[:] = tally
            for e in goes:
                _take_out(row, elements[e], values[e], levels, weights, active, penalties, sizing)
            for i in range(len(comes)):
                _centre(places, comes[i], centres[added_start[k] + i])
                _put_in(
                    row, places, comes[i], scratch,
                    levels, weights, active, penalties, sizing,
                )  # fmt: skip
            row[IRREGULAR] += irregular_change(goes, comes, elements, start, outside, counts)
            for i in range(touched):
                e = affected[i]
                _take_out(row, elements[e], values[e], levels, weights, active, penalties, sizing)
                _put_in(
                    row, places, elements[e], scratch,
                    levels, weights, active, penalties, sizing,
                )  # fmt: skip
        for node in moves:
            places[node] = points[node]
    return tallies, edges, centres
