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
def _walk(
    element_edges: Ints,
    edge_elements: Ints,
    crossable: Bools,
    allowed: Bools,
    rings: Ints,
    queue: Ints,
    tail: int,
    most: int,
) -> int:
    """Give rings to the elements around those in the queue; return its new end.

    Only elements that are allowed and have ``FAR`` are visited, up to ring `most`.
    """
    head = 0
    while head < tail:
        element = queue[head]
        head += 1
        if rings[element] >= most:
            break
        for side in range(4):
            edge = element_edges[element, side]
            if edge < 0 or not crossable[edge]:
                continue
            other = edge_elements[edge, 0] + edge_elements[edge, 1] - element
            if rings[other] == FAR and allowed[other]:
                rings[other] = rings[element] + 1
                queue[tail] = other
                tail += 1
    return tail


@compiled
def rings_around(
    element_edges: Ints, edge_elements: Ints, crossable: Bools, allowed: Bools, centres: Ints
) -> Ints:
    """(M,) int32: crossable edges from each element to the nearest of the centres.

    ``FAR`` where there is no way through allowed elements.
    """
    rings = np.full(len(element_edges), FAR, np.int32)
    queue = np.empty(len(element_edges), np.int32)
    tail = 0
    for centre in centres:
        if rings[centre] == FAR:
            rings[centre] = 0
            queue[tail] = centre
            tail += 1
    _walk(element_edges, edge_elements, crossable, allowed, rings, queue, tail, FAR)
    return rings


@compiled
def nearby(
    element_edges: Ints,
    edge_elements: Ints,
    crossable: Bools,
    allowed: Bools,
    centre: int,
    shift: int,
) -> int:
    """Row of the element that is visited as number `shift` from a centre; 0 is the centre itself.

    The last one where there are not so many.
    """
    rings = np.full(len(element_edges), FAR, np.int32)
    queue = np.empty(len(element_edges), np.int32)
    rings[centre] = 0
    queue[0] = centre
    most = 0
    tail = 1
    while tail <= shift and most < 64:
        rings[:] = FAR
        rings[centre] = 0
        most += 2
        tail = _walk(element_edges, edge_elements, crossable, allowed, rings, queue, 1, most)
    found: int = queue[min(shift, tail - 1)]
    return found


@compiled
def disc(
    element_edges: Ints,
    edge_elements: Ints,
    crossable: Bools,
    allowed: Bools,
    centre: int,
    most: int,
) -> Bools:
    """(M,) bool: allowed elements across at most `most` crossable edges from a centre."""
    rings = np.full(len(element_edges), FAR, np.int32)
    queue = np.empty(len(element_edges), np.int32)
    rings[centre] = 0
    queue[0] = centre
    _walk(element_edges, edge_elements, crossable, allowed, rings, queue, 1, most)
    return rings < FAR


@compiled
def strip(
    element_edges: Ints,
    edge_elements: Ints,
    crossable: Bools,
    allowed: Bools,
    first: int,
    last: int,
    most: int,
) -> Bools:
    """(M,) bool: elements within `most` crossable edges from the shortest way between two.

    A disc around the first where there is no way.
    """
    rings = np.full(len(element_edges), FAR, np.int32)
    queue = np.empty(len(element_edges), np.int32)
    rings[last] = 0
    queue[0] = last
    _walk(element_edges, edge_elements, crossable, allowed, rings, queue, 1, FAR)
    way = np.empty(len(element_edges), np.int32)
    way[0] = first
    steps = 1
    element = first
    while rings[first] < FAR and rings[element] > 0:
        for side in range(4):
            edge = element_edges[element, side]
            if edge < 0 or not crossable[edge]:
                continue
            other = edge_elements[edge, 0] + edge_elements[edge, 1] - element
            if rings[other] < rings[element]:
                element = other
                break
        way[steps] = element
        steps += 1
    rings[:] = FAR
    for i in range(steps):
        queue[i] = way[i]
        rings[way[i]] = 0
    _walk(element_edges, edge_elements, crossable, allowed, rings, queue, steps, most)
    return rings < FAR


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
