"""Whether exchanging some elements for others leaves a mesh whole, places left aside.

The border of what comes must be that of what goes. From this follows that no hole opens and no
edge gets a third element; and, where all elements face the same way on a plane, that the area
stays.
"""

from __future__ import annotations

from meshops.kernels.vectors import compiled
from meshops.mesh import Bools, Ints


@compiled
def size_of(element: Ints) -> int:
    """Nodes of an element: 3 or 4."""
    return 3 if element[3] < 0 else 4


@compiled
def _outline(
    removed: Ints,
    elements: Ints,
    element_edges: Ints,
    edge_elements: Ints,
    crossable: Bools,
    gone: Ints,
    k: int,
    outline: Ints,
) -> tuple[int, int]:
    """Write the directed border sides of the elements that go to `outline`.

    Returns how many there are, -1 where a barrier runs between two of the elements, and how many
    edges are inside.
    """
    count = inner = 0
    for e in removed:
        size = size_of(elements[e])
        for side in range(size):
            edge = element_edges[e, side]
            if edge_elements[edge, 0] >= 0:
                other = edge_elements[edge, 0] + edge_elements[edge, 1] - e
                if gone[other] == k:
                    if not crossable[edge]:
                        return -1, 0
                    inner += 1
                    continue
            outline[count, 0] = elements[e, side]
            outline[count, 1] = elements[e, (side + 1) % size]
            count += 1
    return count, inner // 2


@compiled
def _inner_sides(added: Ints, outline: Ints, count: int, sides: Ints, inner: Ints) -> int:
    """Write the edges inside the elements that come to `inner` and return how many there are.

    -1 where their border is not the outline, or two of them have a side in the same direction.
    """
    total = 0
    for i in range(len(added)):
        size = size_of(added[i])
        for side in range(size):
            sides[total, 0] = added[i, side]
            sides[total, 1] = added[i, (side + 1) % size]
            total += 1
    found = on_border = 0
    for i in range(total):
        u, v = sides[i, 0], sides[i, 1]
        opposite = -1
        for j in range(total):
            if j != i and sides[j, 0] == u and sides[j, 1] == v:
                return -1
            if sides[j, 0] == v and sides[j, 1] == u:
                opposite = j
        if opposite > i:
            inner[found, 0] = u
            inner[found, 1] = v
            found += 1
        elif opposite < 0:
            matches = 0
            for j in range(count):
                matches += outline[j, 0] == u and outline[j, 1] == v
            if matches != 1:
                return -1
            on_border += 1
    return found if on_border == count else -1


@compiled
def _is_new(u: int, v: int, elements: Ints, start: Ints, around: Ints, gone: Ints, k: int) -> bool:
    """Whether no element that stays has the edge between nodes u and v."""
    for i in range(start[u], start[u + 1]):
        e = around[i]
        if gone[e] == k:
            continue
        size = size_of(elements[e])
        for side in range(size):
            a, b = elements[e, side], elements[e, (side + 1) % size]
            if (a == u and b == v) or (a == v and b == u):
                return False
    return True


@compiled
def _is_double(one: Ints, other: Ints) -> bool:
    """Whether one element has all nodes of the other."""
    shared = 0
    for i in range(4):
        for j in range(4):
            shared += one[i] >= 0 and one[i] == other[j]
    return shared >= min(size_of(one), size_of(other))


@compiled
def _has_doubles(
    added: Ints, elements: Ints, start: Ints, around: Ints, gone: Ints, k: int
) -> bool:
    """Whether an element that comes is a double of one that stays, or of another that comes."""
    nodes = len(start) - 1
    for i in range(len(added)):
        for j in range(i):
            if _is_double(added[i], added[j]):
                return True
        for corner in range(2):  # a double misses at most one corner
            node = added[i, corner]
            if node >= nodes:
                continue
            for at in range(start[node], start[node + 1]):
                if gone[around[at]] != k and _is_double(added[i], elements[around[at]]):
                    return True
    return False


@compiled
def _vanishes(node: int, start: Ints, around: Ints, free: Bools, gone: Ints, k: int) -> bool:
    """Whether a node that no new element has may go: it is free and nothing else uses it."""
    if not free[node]:
        return False
    stays = 0
    for e in around[start[node] : start[node + 1]]:
        stays += gone[e] != k
    return stays == 0


@compiled
def is_whole(
    k: int,
    removed: Ints,
    added: Ints,
    new_points: int,
    moved: Ints,
    elements: Ints,
    element_edges: Ints,
    edge_elements: Ints,
    crossable: Bools,
    zones: Ints,
    free: Bools,
    start: Ints,
    around: Ints,
    gone: Ints,
    leaving: Ints,
    coming: Ints,
    outline: Ints,
    sides: Ints,
    inner: Ints,
) -> bool:
    """Whether the mesh stays whole, without looking at places. Stamps `gone` with k."""
    nodes = len(start) - 1
    if not len(removed) and (len(added) or not len(moved)):
        return False
    euler = len(added) - len(removed)
    for e in removed:
        if zones[e] < 0 or zones[e] != zones[removed[0]] or gone[e] == k:
            return False
        gone[e] = k
        for corner in range(size_of(elements[e])):
            node = elements[e, corner]
            euler -= leaving[node] != k
            leaving[node] = k
    for i in range(len(added)):
        size = size_of(added[i])
        for corner in range(size):
            node = added[i, corner]
            if node < 0 or node >= nodes + new_points:
                return False
            if node < nodes and leaving[node] != k:
                return False
            for other in range(corner):
                if added[i, other] == node:
                    return False
            euler += coming[node] != k
            coming[node] = k
    for i in range(len(moved)):
        if not free[moved[i]] or (leaving[moved[i]] == k and coming[moved[i]] != k):
            return False
        for j in range(i):
            if moved[j] == moved[i]:
                return False

    count, inner_before = _outline(
        removed, elements, element_edges, edge_elements, crossable, gone, k, outline
    )
    if count < 0:
        return False
    found = _inner_sides(added, outline, count, sides, inner)
    # the same border and the same Euler number: the same surface, and nowhere pinched
    if found < 0 or euler - found + inner_before != 0:
        return False
    for i in range(found):
        u, v = inner[i, 0], inner[i, 1]
        if u < nodes and v < nodes and not _is_new(u, v, elements, start, around, gone, k):
            return False
    if _has_doubles(added, elements, start, around, gone, k):
        return False
    for e in removed:
        for corner in range(size_of(elements[e])):
            node = elements[e, corner]
            if coming[node] != k and not _vanishes(node, start, around, free, gone, k):
                return False
    return True
