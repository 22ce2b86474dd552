"""Merging nodes in pairs: what is left of the elements around them, and how good it is."""
# ruff: noqa: FBT001 - compiled functions take no keyword-only arguments

from __future__ import annotations

import numpy as np
from numba import njit

from meshops.kernels.quality import CRITERIA, TALLY_SIZE, add_element, add_values
from meshops.kernels.smoothing import area_vector, worst_corner
from meshops.mesh import Bools, Floats, Ids, Ints

LEAST_CORNER = 0.02
"""`worst_corner` from which a merged element counts as sound."""


@njit(cache=True)
def merged_element(element: Ints, target: Ints, out: Ints) -> int:
    """Write the nodes that an element has after merging to `out`; return how many: 4, 3 or 0.

    A quad that loses one node is a tria; one that loses two, or whose opposite nodes meet, and a
    tria that loses one, vanish (the paper's Figures 9 and 11).
    """
    size = 4 if element[3] >= 0 else 3
    count = 0
    for k in range(size):
        node = target[element[k]]
        if count == 0 or out[count - 1] != node:
            out[count] = node
            count += 1
    if count > 1 and out[0] == out[count - 1]:
        count -= 1
    if count < 3 or (count == 4 and (out[0] == out[2] or out[1] == out[3])):
        return 0
    if count == 3:
        out[3] = -1
    return count


@njit(cache=True)
def _uses(
    node: int,
    without: int,
    other: int,
    elements: Ints,
    start: Ints,
    around: Ints,
    target: Ints,
    out: Ints,
) -> int:
    """Count the elements around `node` in which `other` is next to the node's target.

    The elements are seen after merging; those that have the node `without` are left out.
    """
    uses = 0
    for i in range(start[node], start[node + 1]):
        element = elements[around[i]]
        if without in (element[0], element[1], element[2], element[3]):
            continue
        size = merged_element(element, target, out)
        for k in range(size):
            if out[k] == target[node]:
                if other in (out[(k + 1) % size], out[(k - 1 + size) % size]):
                    uses += 1
                break
    return uses


@njit(cache=True)
def _is_manifold(
    a: int, b: int, elements: Ints, start: Ints, around: Ints, target: Ints, same: Ints, out: Ints
) -> bool:
    """Whether the edges that merging a into b leaves at b still have the elements they may have."""
    nodes = np.empty(4, np.int32)
    for i in range(start[a], start[a + 1]):
        size = merged_element(elements[around[i]], target, nodes)
        for k in range(size):
            if nodes[k] != b:
                continue
            for step in (1, size - 1):
                other = nodes[(k + step) % size]
                after = _uses(b, -2, other, elements, start, around, target, out)
                after += _uses(a, b, other, elements, start, around, target, out)
                before = _uses(b, -2, other, elements, start, around, same, out)
                if after > (2 if before == 0 else before):
                    return False
    return True


@njit(cache=True)
def evaluate_merges(
    genomes: Ids,
    pool: Ints,
    on_border: Bools,
    points: Floats,
    elements: Ints,
    start: Ints,
    around: Ints,
    normals: Floats,
    values: Floats,
    tally: Floats,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    normalised: bool,
) -> Floats:
    """Tally of the mesh after merging pairs of nodes at once, for many choices of pairs.

    Parameters
    ----------
    genomes : (P, G) int64
        Rows of the pool; a row beyond it merges nothing.
    pool : (K, 3) int32
        Nodes a and b, and whether they meet half-way (1) or at b (0).
    on_border : (K,) bool
        Whether the edge between a and b is on the border.
    points, elements
        The mesh; start, around: the elements of its nodes.
    normals : (M, 3) float64
        Unit normals of the elements.
    values : (M, 12) float64
        Measures of the elements.
    tally : (TALLY_SIZE,) float64
        The tally of the whole mesh.
    levels, weights, active, penalties, normalised
        The scoring.

    Returns
    -------
    (P, TALLY_SIZE) float64; NaN where two pairs share a node, or where merging would invert an
    element, tear the mesh or join it to itself.
    """
    tallies = np.empty((len(genomes), TALLY_SIZE))
    points = points.copy()
    same = np.arange(len(points)).astype(np.int32)
    target = same.copy()
    node_seen = np.full(len(points), -1, np.int64)
    element_seen = np.full(len(elements), -1, np.int64)
    affected = np.empty(len(elements), np.int32)
    out = np.empty(4, np.int32)
    normal = np.empty(3)
    scratch = np.empty(CRITERIA)
    places = np.empty((genomes.shape[1], 3))
    for p in range(len(genomes)):
        row = tallies[p]
        row[:] = tally
        valid = True
        for gene in genomes[p]:
            if gene >= len(pool):
                continue
            a, b = pool[gene, 0], pool[gene, 1]
            if node_seen[a] == p or node_seen[b] == p:
                valid = False
                break
            node_seen[a] = p
            node_seen[b] = p
        if not valid:
            row[:] = np.nan
            continue

        touched = 0
        euler = 0  # twice the change of nodes - edges + elements
        for g in range(genomes.shape[1]):
            gene = genomes[p, g]
            if gene >= len(pool):
                continue
            a, b = pool[gene, 0], pool[gene, 1]
            target[a] = b
            places[g] = points[b]
            euler -= 2
            if on_border[gene]:
                euler += 1
            for end in range(1 + pool[gene, 2]):
                for i in range(start[pool[gene, end]], start[pool[gene, end] + 1]):
                    if element_seen[around[i]] != p:
                        element_seen[around[i]] = p
                        affected[touched] = around[i]
                        touched += 1
            if pool[gene, 2]:
                points[b] = 0.5 * (points[a] + points[b])
        for i in range(touched):
            e = affected[i]
            add_values(
                row, values[e], elements[e, 3] < 0, -1.0,
                levels, weights, active, penalties, normalised,
            )  # fmt: skip
            size = merged_element(elements[e], target, out)
            euler += (4 if elements[e, 3] >= 0 else 3) - size
            if size == 0:
                euler -= 2
                continue
            area_vector(points, out, normal)
            area = np.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
            if area <= 0.0:
                valid = False
                break
            normal /= area
            facing = (
                normal[0] * normals[e, 0] + normal[1] * normals[e, 1] + normal[2] * normals[e, 2]
            )
            if facing < 0.5 or (
                worst_corner(points, out, normal[0], normal[1], normal[2]) < LEAST_CORNER
            ):
                valid = False
                break
            add_element(
                row, points, out[0], out[1], out[2], out[3], 1.0, scratch,
                levels, weights, active, penalties, normalised,
            )  # fmt: skip
        valid = valid and euler == 0
        for gene in genomes[p]:
            if valid and gene < len(pool):
                valid = _is_manifold(
                    pool[gene, 0], pool[gene, 1], elements, start, around, target, same, out
                )
        for g in range(genomes.shape[1]):
            gene = genomes[p, g]
            if gene < len(pool):
                target[pool[gene, 0]] = pool[gene, 0]
                points[pool[gene, 1]] = places[g]
        if not valid:
            row[:] = np.nan
    return tallies


@njit(cache=True)
def rewire(elements: Ints, target: Ints) -> tuple[Ints, Ints, Ints]:
    """Find which of the elements (M, 4) vanish by merging, which change, and to what nodes."""
    removed = np.empty(len(elements), np.int32)
    changed = np.empty(len(elements), np.int32)
    nodes = np.empty((len(elements), 4), np.int32)
    gone = kept = 0
    out = np.empty(4, np.int32)
    for e in range(len(elements)):
        size = merged_element(elements[e], target, out)
        if size == 0:
            removed[gone] = e
            gone += 1
            continue
        same = True
        for k in range(4):
            same = same and elements[e, k] == out[k]
        if not same:
            changed[kept] = e
            nodes[kept] = out
            kept += 1
    return removed[:gone].copy(), changed[:kept].copy(), nodes[:kept].copy()
