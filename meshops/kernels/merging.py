"""Merging nodes in pairs: what is left of the elements around them, and how good it is."""

from __future__ import annotations

import numpy as np

from meshops.kernels.quality import (
    CRITERIA,
    ELEMENTS,
    IRREGULAR,
    QUADS,
    TALLY_SIZE,
    TRIAS,
    add_element,
    add_values,
)
from meshops.kernels.regularity import irregular_change
from meshops.kernels.soundness import FACING
from meshops.kernels.vectors import area_vector, compiled, corner_jacobian_min, inlined, unit
from meshops.mesh import Bools, Floats, Ids, Ints

LEAST_CORNER = 0.02
"""`corner_jacobian_min` from which a merged element counts as sound."""

MOST_NEIGHBOURS = 128
"""Places for the neighbours of a merged node, two for each of its elements; no pair of nodes with
more is merged."""


@inlined
def merged_element(elements: Ints, e: int, target: Ints, out: Ints) -> int:
    """Write the nodes that an element has after merging to `out`; return how many: 4, 3 or 0.

    A quad that loses one node is a tria; one that loses two, or whose opposite nodes meet, and a
    tria that loses one, vanish (the paper's Figures 9 and 11).
    """
    size = 4 if elements[e, 3] >= 0 else 3
    count = 0
    for k in range(size):
        node = target[elements[e, k]]
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


@compiled
def _neighbours(
    node: int,
    without: int,
    elements: Ints,
    start: Ints,
    around: Ints,
    target: Ints,
    out: Ints,
    found: Ints,
    count: int,
) -> int:
    """Append to `found` the two neighbours of a node in each element around it; the new count.

    The elements are seen after merging; those that have the node `without` are left out.
    """
    place = target[node]
    for i in range(start[node], start[node + 1]):
        e = around[i]
        if without in (elements[e, 0], elements[e, 1], elements[e, 2], elements[e, 3]):
            continue
        size = merged_element(elements, e, target, out)
        for k in range(size):
            if out[k] == place:
                if count + 2 <= len(found):
                    found[count] = out[(k + 1) % size]
                    found[count + 1] = out[(k - 1 + size) % size]
                count += 2
                break
    return count


@compiled
def _is_manifold(
    a: int,
    b: int,
    elements: Ints,
    start: Ints,
    around: Ints,
    target: Ints,
    same: Ints,
    out: Ints,
    before: Ints,
    after: Ints,
) -> bool:
    """Whether the edges at b have, after merging a into b, as many elements as they may have.

    That is two for an edge that was not there, and for any other at most as many as it had.
    """
    old = _neighbours(b, -2, elements, start, around, same, out, before, 0)
    new = _neighbours(b, -2, elements, start, around, target, out, after, 0)
    new = _neighbours(a, b, elements, start, around, target, out, after, new)
    if max(old, new) > len(after):
        return False
    for i in range(new):
        had = uses = 0
        for j in range(old):
            had += before[j] == after[i]
        for j in range(new):
            uses += after[j] == after[i]
        if uses > (2 if had == 0 else had):
            return False
    return True


@compiled
def evaluate_merges(
    genomes: Ids,
    pool: Ints,
    on_border: Bools,
    points: Floats,
    elements: Ints,
    start: Ints,
    around: Ints,
    outside: Ints,
    normals: Floats,
    values: Floats,
    tally: Floats,
    levels: Floats,
    weights: Floats,
    active: Bools,
    penalties: Floats,
    sizing: Floats,
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
    outside : (N,) int32
        How many elements that are not of the mesh meet at each node, -1 where any number may.
    normals : (M, 3) float64
        Unit normals of the elements.
    values : (M, 12) float64
        Measures of the elements.
    tally : (TALLY_SIZE,) float64
        The tally of the whole mesh.
    levels, weights, active, penalties, sizing
        The scoring; where no criterion is active, elements are counted and not measured.

    Returns
    -------
    (P, TALLY_SIZE) float64; NaN where two pairs share a node, or where merging would invert an
    element, tear the mesh or join it to itself.
    """
    tallies = np.empty((len(genomes), TALLY_SIZE))
    measured = active.any()
    points = points.copy()
    same = np.arange(len(points)).astype(np.int32)
    target = same.copy()
    node_seen = np.full(len(points), -1, np.int64)
    element_seen = np.full(len(elements), -1, np.int64)
    affected = np.empty(len(elements), np.int32)
    merged = np.empty((len(elements), 4), np.int32)
    counts = np.zeros(len(points), np.int32)
    out = np.empty(4, np.int32)
    before = np.empty(MOST_NEIGHBOURS, np.int32)
    after = np.empty(MOST_NEIGHBOURS, np.int32)
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

        touched = comes = 0
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
            if measured:
                add_values(
                    row, values[e], elements[e, 3] < 0, -1.0,
                    levels, weights, active, penalties, sizing,
                )  # fmt: skip
            else:
                row[ELEMENTS] -= 1.0
                row[TRIAS if elements[e, 3] < 0 else QUADS] -= 1.0
            size = merged_element(elements, e, target, out)
            euler += (4 if elements[e, 3] >= 0 else 3) - size
            if size == 0:
                euler -= 2
                continue
            merged[comes] = out
            comes += 1
            n = unit(area_vector(points, out[0], out[1], out[2], out[3]))
            facing = n[0] * normals[e, 0] + n[1] * normals[e, 1] + n[2] * normals[e, 2]
            if (
                facing < FACING
                or corner_jacobian_min(points, out[0], out[1], out[2], out[3], n[0], n[1], n[2])
                < LEAST_CORNER
            ):
                valid = False
                break
            if measured:
                add_element(
                    row, points, out[0], out[1], out[2], out[3], 1.0, scratch,
                    levels, weights, active, penalties, sizing,
                )  # fmt: skip
            else:
                row[ELEMENTS] += 1.0
                row[TRIAS if out[3] < 0 else QUADS] += 1.0
        valid = valid and euler == 0
        if valid and measured:
            row[IRREGULAR] += irregular_change(
                affected[:touched], merged[:comes], elements, start, outside, counts
            )
        for gene in genomes[p]:
            if valid and gene < len(pool):
                valid = _is_manifold(
                    pool[gene, 0], pool[gene, 1], elements, start, around, target, same, out,
                    before, after,
                )  # fmt: skip
        for g in range(genomes.shape[1]):
            gene = genomes[p, g]
            if gene < len(pool):
                target[pool[gene, 0]] = pool[gene, 0]
                points[pool[gene, 1]] = places[g]
        if not valid:
            row[:] = np.nan
    return tallies


@compiled
def rewire(elements: Ints, target: Ints) -> tuple[Ints, Ints, Ints]:
    """Find which of the elements (M, 4) vanish by merging, which change, and to what nodes."""
    removed = np.empty(len(elements), np.int32)
    changed = np.empty(len(elements), np.int32)
    nodes = np.empty((len(elements), 4), np.int32)
    gone = kept = 0
    out = np.empty(4, np.int32)
    for e in range(len(elements)):
        size = merged_element(elements, e, target, out)
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
