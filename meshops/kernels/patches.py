"""Cutting patches out of a mesh."""

from __future__ import annotations

import numpy as np

from meshops.kernels.vectors import compiled
from meshops.mesh import Bools, Ints

FAR = 1 << 30
"""Rings to an element that cannot be reached."""


@compiled
def label_components(
    element_edges: Ints, edge_elements: Ints, crossable: Bools, selected: Bools
) -> Ints:
    """(M,) int32 component of each selected element across crossable edges; elsewhere -1.

    Components are numbered in the order of their first element.
    """
    m = len(element_edges)
    label = np.full(m, -1, np.int32)
    stack = np.empty(m, np.int32)
    components = 0
    for seed in range(m):
        if not selected[seed] or label[seed] >= 0:
            continue
        label[seed] = components
        stack[0] = seed
        top = 1
        while top > 0:
            top -= 1
            element = stack[top]
            for side in range(4):
                edge = element_edges[element, side]
                if edge < 0 or not crossable[edge]:
                    continue
                other = edge_elements[edge, 0] + edge_elements[edge, 1] - element
                if selected[other] and label[other] < 0:
                    label[other] = components
                    stack[top] = other
                    top += 1
        components += 1
    return label


@compiled
def rings_around(
    element_edges: Ints, edge_elements: Ints, crossable: Bools, centres: Ints
) -> Ints:
    """(M,) int32: crossable edges from each element to the nearest of the centres.

    ``FAR`` where there is no way.
    """
    m = len(element_edges)
    rings = np.full(m, FAR, np.int32)
    queue = np.empty(m, np.int32)
    tail = 0
    for centre in centres:
        if rings[centre] == FAR:
            rings[centre] = 0
            queue[tail] = centre
            tail += 1
    head = 0
    while head < tail:
        element = queue[head]
        head += 1
        for side in range(4):
            edge = element_edges[element, side]
            if edge < 0 or not crossable[edge]:
                continue
            other = edge_elements[edge, 0] + edge_elements[edge, 1] - element
            if rings[other] == FAR:
                rings[other] = rings[element] + 1
                queue[tail] = other
                tail += 1
    return rings


@compiled
def _root(parent: Ints, corner: int) -> int:
    while parent[corner] != corner:
        parent[corner] = parent[parent[corner]]
        corner = parent[corner]
    return corner


@compiled
def cut(
    rows: Ints,
    elements: Ints,
    element_edges: Ints,
    edge_elements: Ints,
    crossable: Bools,
    local: Ints,
) -> tuple[Ints, Ints, Ints]:
    """Cut connected elements out along every barrier, also those that end inside the patch.

    Two corners are the same patch node only where a crossable edge inside the patch joins them, so
    the patch is manifold even where the mesh around it is not, and a node on a slit appears once
    on either side.

    Parameters
    ----------
    rows : (m,) int32
        The elements to cut out, ascending.
    elements, element_edges, edge_elements, crossable
        The whole mesh and its topology.
    local : (M,) int32
        Scratch, all -1; left so.

    Returns
    -------
    patch_elements : (m, 4) int32
        The elements on patch nodes; border nodes come first.
    nodes : (n,) int32
        The mesh node of each patch node.
    border : (b, 2) int32
        Border edges on patch nodes, in the direction of their element.
    """
    m = len(rows)
    for i in range(m):
        local[rows[i]] = i
    parent = np.arange(4 * m).astype(np.int32)
    border_sides = np.empty(4 * m, np.int32)
    borders = 0
    for i in range(m):
        element = rows[i]
        size = 3 if elements[element, 3] < 0 else 4
        for side in range(size):
            ahead = (side + 1) % size
            edge = element_edges[element, side]
            other = -1
            if crossable[edge]:
                other = local[edge_elements[edge, 0] + edge_elements[edge, 1] - element]
            if other < 0:
                border_sides[borders] = 4 * i + side
                borders += 1
            elif other > i:
                neighbour = rows[other]
                for k in range(4):
                    if elements[neighbour, k] == elements[element, side]:
                        parent[_root(parent, 4 * other + k)] = _root(parent, 4 * i + side)
                    elif elements[neighbour, k] == elements[element, ahead]:
                        parent[_root(parent, 4 * other + k)] = _root(parent, 4 * i + ahead)
    for i in range(m):
        local[rows[i]] = -1

    number = np.full(4 * m, -1, np.int32)
    nodes = np.empty(4 * m, np.int32)
    count = 0
    border = np.empty((borders, 2), np.int32)
    for j in range(borders):
        i, side = border_sides[j] // 4, border_sides[j] % 4
        size = 3 if elements[rows[i], 3] < 0 else 4
        for end in range(2):
            corner = (side + end) % size
            root = _root(parent, 4 * i + corner)
            if number[root] < 0:
                number[root] = count
                nodes[count] = elements[rows[i], corner]
                count += 1
            border[j, end] = number[root]
    patch_elements = np.full((m, 4), -1, np.int32)
    for i in range(m):
        size = 3 if elements[rows[i], 3] < 0 else 4
        for corner in range(size):
            root = _root(parent, 4 * i + corner)
            if number[root] < 0:
                number[root] = count
                nodes[count] = elements[rows[i], corner]
                count += 1
            patch_elements[i, corner] = number[root]
    return patch_elements, nodes[:count].copy(), border
