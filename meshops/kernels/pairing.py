"""Pairing trias to quads: a matching of the trias' adjacency graph."""

from __future__ import annotations

import numpy as np

from meshops.kernels.vectors import compiled, edge, inlined
from meshops.mesh import Bools, Floats, Ints


@compiled
def tria_neighbours(trias: Ints, nodes: int) -> Ints:
    """(T, 3) int32: the tria across side k (node k to node k + 1), or -1."""
    count = len(trias)
    neighbours = np.full((count, 3), -1, np.int32)
    start = np.zeros(nodes + 1, np.int32)
    for t in range(count):
        for k in range(3):
            start[trias[t, k] + 1] += 1
    for n in range(nodes):
        start[n + 1] += start[n]
    fill = start[:-1].copy()
    owners = np.empty(3 * count, np.int32)  # of the sides that begin at each node
    ends = np.empty(3 * count, np.int32)
    for t in range(count):
        for k in range(3):
            node = trias[t, k]
            owners[fill[node]] = t
            ends[fill[node]] = trias[t, (k + 1) % 3]
            fill[node] += 1
    for t in range(count):
        for k in range(3):
            a, b = trias[t, k], trias[t, (k + 1) % 3]
            for i in range(start[b], start[b + 1]):
                if ends[i] == a:
                    neighbours[t, k] = owners[i]
    return neighbours


@compiled
def _quad_shape(points: Floats, a: int, b: int, c: int, d: int) -> float:
    """Shape of quad abcd in [-1, 1]: its worst corner's sine, 1 for a rectangle."""
    nx = ny = nz = 0.0
    p, q, r, s = points[a], points[b], points[c], points[d]
    ux, uy, uz = r[0] - p[0], r[1] - p[1], r[2] - p[2]
    vx, vy, vz = s[0] - q[0], s[1] - q[1], s[2] - q[2]
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    size = np.sqrt(nx * nx + ny * ny + nz * nz)
    if size <= 0.0:
        return -1.0
    worst = 1.0
    for k in range(4):
        if k == 0:
            o, f, g = p, q, s
        elif k == 1:
            o, f, g = q, r, p
        elif k == 2:
            o, f, g = r, s, q
        else:
            o, f, g = s, p, r
        ux, uy, uz = f[0] - o[0], f[1] - o[1], f[2] - o[2]
        vx, vy, vz = g[0] - o[0], g[1] - o[1], g[2] - o[2]
        cross = (
            (uy * vz - uz * vy) * nx + (uz * vx - ux * vz) * ny + (ux * vy - uy * vx) * nz
        ) / size
        lengths = np.sqrt((ux * ux + uy * uy + uz * uz) * (vx * vx + vy * vy + vz * vz))
        if lengths <= 0.0:
            return -1.0
        worst = min(worst, cross / lengths)
    return worst


@compiled
def pair_shapes(points: Floats, trias: Ints, neighbours: Ints) -> Floats:
    """(T, 3) float64: shape of the quad that tria t makes with its neighbour across side k.

    Sides without a neighbour have -2.
    """
    shapes = np.full(trias.shape, -2.0)
    for t in range(len(trias)):
        for k in range(3):
            other = neighbours[t, k]
            if other < t:
                continue
            a, b = trias[t, k], trias[t, (k + 1) % 3]
            opposite = trias[t, (k + 2) % 3]
            for side in range(3):
                if neighbours[other, side] == t and trias[other, side] == b:
                    apex = trias[other, (side + 2) % 3]
                    shapes[t, k] = _quad_shape(points, a, apex, b, opposite)
                    shapes[other, side] = shapes[t, k]
    return shapes


@compiled
def match_greedily(neighbours: Ints, shapes: Floats, least: float) -> Ints:
    """Pair neighbours by falling shape down to `least`; (T,) int32 mate of each tria or -1."""
    count = len(neighbours)
    mate = np.full(count, -1, np.int32)
    pairs = np.empty(neighbours.size, np.int32)
    falling = np.empty(neighbours.size)
    found = 0
    for t in range(count):
        for k in range(3):
            # each pair once: of equals the one with the first tria comes first
            if neighbours[t, k] > t and shapes[t, k] >= least:
                pairs[found] = 3 * t + k
                falling[found] = -shapes[t, k]
                found += 1
    for i in np.argsort(falling[:found], kind="mergesort"):
        t = pairs[i] // 3
        other = neighbours[t, pairs[i] - 3 * t]
        if mate[t] < 0 and mate[other] < 0:
            mate[t] = other
            mate[other] = t
    return mate


@compiled
def _sides_by_shape(shapes: Floats) -> Ints:
    """(T, 3) sides of each tria, the best shape first; of equals the first."""
    order = np.empty(shapes.shape, np.int32)
    for t in range(len(shapes)):
        first, second, third = 0, 1, 2
        if shapes[t, second] > shapes[t, first]:
            first, second = second, first
        if shapes[t, third] > shapes[t, second]:
            second, third = third, second
            if shapes[t, second] > shapes[t, first]:
                first, second = second, first
        order[t, 0], order[t, 1], order[t, 2] = first, second, third
    return order


@compiled
def _base_of_both(base: Ints, parent: Ints, mate: Ints, a: int, b: int, mark: Ints) -> int:
    mark[:] = 0
    while True:
        a = base[a]
        mark[a] = 1
        if mate[a] < 0:
            break
        a = parent[mate[a]]
    while True:
        b = base[b]
        if mark[b]:
            return b
        b = parent[mate[b]]


@compiled
def _mark_path(
    base: Ints, parent: Ints, mate: Ints, in_blossom: Ints, v: int, stem: int, child: int
) -> None:
    while base[v] != stem:
        in_blossom[base[v]] = 1
        in_blossom[base[mate[v]]] = 1
        parent[v] = child
        child = mate[v]
        v = parent[mate[v]]


@compiled
def match_completely(neighbours: Ints, shapes: Floats, mate: Ints) -> Ints:
    """Augment a matching to one of greatest cardinality (Edmonds' blossom algorithm, 1965).

    Better shapes are tried first. Changes and returns `mate`, (T,) int32.
    """
    count = len(neighbours)
    base = np.empty(count, np.int32)
    parent = np.empty(count, np.int32)
    in_tree = np.empty(count, np.int32)
    in_blossom = np.empty(count, np.int32)
    mark = np.empty(count, np.int32)
    queue = np.empty(count, np.int32)
    order = _sides_by_shape(shapes)
    for root in range(count):
        if mate[root] >= 0:
            continue
        for t in range(count):
            base[t] = t
        parent[:] = -1
        in_tree[:] = 0
        in_tree[root] = 1
        queue[0] = root
        head, tail = 0, 1
        end = -1
        while head < tail and end < 0:
            v = queue[head]
            head += 1
            for j in range(3):
                to = neighbours[v, order[v, j]]
                if to < 0 or base[v] == base[to] or mate[v] == to:
                    continue
                if to == root or (mate[to] >= 0 and parent[mate[to]] >= 0):
                    stem = _base_of_both(base, parent, mate, v, to, mark)
                    in_blossom[:] = 0
                    _mark_path(base, parent, mate, in_blossom, v, stem, to)
                    _mark_path(base, parent, mate, in_blossom, to, stem, v)
                    for t in range(count):
                        if in_blossom[base[t]]:
                            base[t] = stem
                            if not in_tree[t]:
                                in_tree[t] = 1
                                queue[tail] = t
                                tail += 1
                elif parent[to] < 0:
                    parent[to] = v
                    if mate[to] < 0:
                        end = to
                        break
                    in_tree[mate[to]] = 1
                    queue[tail] = mate[to]
                    tail += 1
        while end >= 0:
            before = parent[end]
            following = mate[before]
            mate[end] = before
            mate[before] = end
            end = following
    return mate


@compiled
def merge_pairs(trias: Ints, neighbours: Ints, mate: Ints) -> Ints:
    """(M, 4) int32 elements: a quad for each pair, a tria (-1 last) for each that is alone."""
    elements = np.full((len(trias), 4), -1, np.int32)
    count = 0
    for t in range(len(trias)):
        other = mate[t]
        if other < 0:
            elements[count, :3] = trias[t]
            count += 1
        elif other > t:
            for k in range(3):
                if neighbours[t, k] == other:
                    a, b = trias[t, k], trias[t, (k + 1) % 3]
                    for side in range(3):
                        if trias[other, side] == b and trias[other, (side + 1) % 3] == a:
                            elements[count, 0] = a
                            elements[count, 1] = trias[other, (side + 2) % 3]
                            elements[count, 2] = b
                            elements[count, 3] = trias[t, (k + 2) % 3]
                    break
            count += 1
    return elements[:count].copy()


@compiled
def pair_up(points: Floats, trias: Ints, least: float, good: float) -> Ints:
    """(M, 4) elements of trias (T, 3), paired as completely as can be, good quads first.

    No quad is of a shape below `least`; those down to `good` are taken greedily.
    """
    neighbours = tria_neighbours(trias, len(points))
    shapes = pair_shapes(points, trias, neighbours)
    allowed = neighbours.copy()
    for t in range(len(trias)):
        for k in range(3):
            if shapes[t, k] < least:
                allowed[t, k] = -1
    mate = match_completely(allowed, shapes, match_greedily(allowed, shapes, good))
    return merge_pairs(trias, neighbours, mate)


@compiled
def _is_better_across(points: Floats, a: int, b: int, c: int, d: int) -> bool:
    """Whether quad abcd is split along ac rather than along bd."""
    return min(_tria_shape(points, a, b, c), _tria_shape(points, a, c, d)) >= min(
        _tria_shape(points, a, b, d), _tria_shape(points, b, c, d)
    )


@compiled
def as_trias(points: Floats, elements: Ints) -> Ints:
    """(T, 3) int32: trias as they are, quads split along their better diagonal, in their order."""
    trias = np.empty((2 * len(elements), 3), np.int32)
    count = 0
    for e in range(len(elements)):
        a, b, c, d = elements[e, 0], elements[e, 1], elements[e, 2], elements[e, 3]
        if d >= 0 and not _is_better_across(points, a, b, c, d):
            trias[count, 0], trias[count, 1], trias[count, 2] = a, b, d
            trias[count + 1, 0], trias[count + 1, 1], trias[count + 1, 2] = b, c, d
            count += 2
            continue
        trias[count, 0], trias[count, 1], trias[count, 2] = a, b, c
        count += 1
        if d >= 0:
            trias[count, 0], trias[count, 1], trias[count, 2] = a, c, d
            count += 1
    return trias[:count].copy()


@compiled
def split_quads(points: Floats, elements: Ints, chosen: Bools) -> Ints:
    """Split the chosen quads along their better diagonal.

    Returns (M', 4) int32 elements, all others as they are; the two trias of a quad take its place.
    """
    result = np.full((2 * len(elements), 4), -1, np.int32)
    count = 0
    for e in range(len(elements)):
        a, b, c, d = elements[e]
        if d < 0 or not chosen[e]:
            result[count] = elements[e]
            count += 1
            continue
        if _is_better_across(points, a, b, c, d):
            result[count, 0], result[count, 1], result[count, 2] = a, b, c
            result[count + 1, 0], result[count + 1, 1], result[count + 1, 2] = a, c, d
        else:
            result[count, 0], result[count, 1], result[count, 2] = a, b, d
            result[count + 1, 0], result[count + 1, 1], result[count + 1, 2] = b, c, d
        count += 2
    return result[:count].copy()


@inlined
def _tria_shape(points: Floats, a: int, b: int, c: int) -> float:
    """Area over the sum of squared sides: greatest for the regular tria."""
    ux, uy, uz = edge(points, a, b)
    vx, vy, vz = edge(points, a, c)
    wx, wy, wz = vx - ux, vy - uy, vz - uz
    nx, ny, nz = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
    sides = ux * ux + uy * uy + uz * uz + vx * vx + vy * vy + vz * vz + wx * wx + wy * wy + wz * wz
    if sides <= 0.0:
        return 0.0
    shape: float = np.sqrt(nx * nx + ny * ny + nz * nz) / sides
    return shape
