"""Edges of a mesh and the elements at them."""

from __future__ import annotations

import numpy as np

from meshops.kernels.vectors import compiled
from meshops.mesh import Bools, Ints


@compiled
def _sorted_by(keys: Ints, order: Ints, nodes: int) -> Ints:
    """Bring rows into the ascending order of their keys, which are nodes; equals stay as they are.

    By counting, in a time that grows with the number of rows and nodes and no faster.
    """
    starts = np.zeros(nodes + 1, np.int32)
    for row in order:
        starts[keys[row] + 1] += 1
    for node in range(nodes):
        starts[node + 1] += starts[node]
    found = np.empty_like(order)
    for row in order:
        found[starts[keys[row]]] = row
        starts[keys[row]] += 1
    return found


@compiled
def find_edges(elements: Ints, nodes: int) -> tuple[Ints, Ints, Ints, Ints, Bools]:
    """Find the edges of elements (M, 4), each once, ordered by their nodes.

    Returns
    -------
    edges : (E, 2) int32
        Node rows, the smaller first.
    element_edges : (M, 4) int32
        The edge of each side; -1 fourth for a tria.
    edge_elements : (E, 2) int32
        The two elements of an edge that has exactly two; elsewhere -1.
    uses : (E,) int32
        How many elements meet at an edge.
    opposed : (E,) bool
        Edges of exactly two elements that run along them in opposite directions.
    """
    m = len(elements)
    ends = np.empty((4 * m, 2), np.int32)
    sides = np.empty(4 * m, np.int32)
    count = 0
    for e in range(m):
        size = 3 if elements[e, 3] < 0 else 4
        for k in range(size):
            a, b = elements[e, k], elements[e, (k + 1) % size]
            ends[count, 0], ends[count, 1] = min(a, b), max(a, b)
            sides[count] = 4 * e + k
            count += 1
    # by the larger node, then by the smaller: what is sorted stays in order among equals
    order = _sorted_by(ends[:, 1], np.arange(count).astype(np.int32), nodes)
    order = _sorted_by(ends[:, 0], order, nodes)
    edges = np.empty((count, 2), np.int32)
    element_edges = np.full((m, 4), -1, np.int32)
    edge_elements = np.full((count, 2), -1, np.int32)
    uses = np.zeros(count, np.int32)
    opposed = np.zeros(count, np.bool_)
    found = -1
    first_forward = False
    for i in order:
        e, k = sides[i] // 4, sides[i] % 4
        size = 3 if elements[e, 3] < 0 else 4
        a, b = elements[e, k], elements[e, (k + 1) % size]
        forward = a < b
        low, high = ends[i, 0], ends[i, 1]
        if found < 0 or edges[found, 0] != low or edges[found, 1] != high:
            found += 1
            edges[found, 0], edges[found, 1] = low, high
            edge_elements[found, 0] = e
            first_forward = forward
        elif uses[found] == 1:
            edge_elements[found, 1] = e
            opposed[found] = forward != first_forward
        else:
            opposed[found] = False
        uses[found] += 1
        element_edges[e, k] = found
    found += 1
    for edge in range(found):
        if uses[edge] != 2:
            edge_elements[edge, 0] = -1
            edge_elements[edge, 1] = -1
            opposed[edge] = False
    return (
        edges[:found].copy(),
        element_edges,
        edge_elements[:found].copy(),
        uses[:found].copy(),
        opposed[:found].copy(),
    )
