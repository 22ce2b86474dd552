"""Plain measures of small meshes.

They are written for reading, one element at a time, and share nothing with the code that they
judge but the definition of a barrier.
"""

from collections import Counter, defaultdict
from dataclasses import dataclass
from functools import lru_cache

import numpy as np


def corners(element):
    """Node rows of one element, three or four."""
    return [int(node) for node in element if node >= 0]


def sides(element):
    """Directed sides of one element, in order."""
    nodes = corners(element)
    return list(zip(nodes, nodes[1:] + nodes[:1], strict=True))


def centre(mesh, row):
    return mesh.points[corners(mesh.elements[row])].mean(axis=0)


@lru_cache(maxsize=8)
def area_vectors(mesh):
    """Half the sum of cross products around each element (Newell)."""
    nodes = np.where(mesh.elements < 0, mesh.elements[:, [2]], mesh.elements)
    points = mesh.points[nodes]
    points = points - points[:, :1]
    return np.cross(points, np.roll(points, -1, axis=1)).sum(axis=1) / 2


@lru_cache(maxsize=8)
def users(mesh):
    """(low, high) of each edge -> [(element, whether it runs from low to high)]."""
    found = defaultdict(list)
    for row, element in enumerate(mesh.elements):
        for a, b in sides(element):
            found[min(a, b), max(a, b)].append((row, a < b))
    return dict(found)


@lru_cache(maxsize=8)
def crossable_edges(mesh, feature_angle=30.0):
    """The edges that no barrier is on, by the definition in Topology."""
    result = set()
    vectors = area_vectors(mesh)
    lengths = [np.sqrt(v @ v) for v in vectors]
    least = np.cos(np.radians(feature_angle))
    for edge, uses in users(mesh).items():
        if len(uses) != 2:
            continue
        (one, forward), (two, other_forward) = uses
        if forward == other_forward or mesh.region[one] != mesh.region[two]:
            continue
        if mesh.locked_elements[one] or mesh.locked_elements[two]:
            continue
        size = lengths[one] * lengths[two]
        if size > 0 and vectors[one] @ vectors[two] >= least * size:
            result.add(edge)
    return frozenset(result)


def within(mesh, first, steps):
    """Rows of the elements that so many steps across crossable edges from one can reach."""
    edge_users = users(mesh)
    beside = defaultdict(set)
    for edge in crossable_edges(mesh):
        (one, _), (two, _) = edge_users[edge]
        beside[one].add(two)
        beside[two].add(one)
    reached = {first}
    for _ in range(steps):
        reached = reached.union(*(beside[row] for row in reached))
    return reached


def fans(mesh):
    """[(node, elements, whether they close around it)]: elements that crossable edges connect."""
    crossable = crossable_edges(mesh)
    edge_users = users(mesh)
    around = defaultdict(set)
    for row, element in enumerate(mesh.elements):
        for node in corners(element):
            around[node].add(row)
    found = []
    for node, elements in around.items():
        left = set(elements)
        while left:
            fan, todo, closed = set(), [min(left)], True
            while todo:
                row = todo.pop()
                if row in fan:
                    continue
                fan.add(row)
                for a, b in sides(mesh.elements[row]):
                    if node not in (a, b):
                        continue
                    edge = min(a, b), max(a, b)
                    if edge in crossable:
                        todo += [other for other, _ in edge_users[edge]]
                    else:
                        closed = False
            left -= fan
            found.append((node, frozenset(fan), closed))
    return found


def place(mesh, node):
    return tuple(mesh.points[node])


def barriers(mesh):
    """Barrier edges by the places of their ends, with how many elements meet there."""
    crossable = crossable_edges(mesh)
    return Counter(
        {
            frozenset((place(mesh, a), place(mesh, b))): len(uses)
            for (a, b), uses in users(mesh).items()
            if (a, b) not in crossable
        }
    )


def straightened(sides):
    """Directed sides by places, those in one line as one side."""
    following, leading = defaultdict(list), defaultdict(list)
    for a, b in sides:
        following[a].append(b)
        leading[b].append(a)

    def is_bend(at):
        if len(following[at]) != 1 or len(leading[at]) != 1:
            return True
        u = np.subtract(at, leading[at][0])
        v = np.subtract(following[at][0], at)
        return np.linalg.norm(np.cross(u, v)) > 1e-9 * np.linalg.norm(u) * np.linalg.norm(v)

    found = []
    for a in [at for at in following if is_bend(at)]:
        for b in following[a]:
            while not is_bend(b):
                (b,) = following[b]
            found.append((a, b))
    return found


@dataclass(frozen=True)
class Zone:
    """What an operation may not change in an area that barriers bound, and its trias and sides."""

    outline: frozenset
    region: int
    euler: int
    area_vector: np.ndarray
    area: float
    trias: int
    sides: int


def zones(mesh, *, straight=False):
    """Areas bounded by barriers, each with its directed sides on them as its name.

    `straight`: sides in one line count as one.
    """
    crossable, edge_users, vectors = crossable_edges(mesh), users(mesh), area_vectors(mesh)
    left = set(range(len(mesh.elements)))
    found = []
    while left:
        members, todo = set(), [min(left)]
        while todo:
            row = todo.pop()
            if row in members:
                continue
            members.add(row)
            for a, b in sides(mesh.elements[row]):
                edge = min(a, b), max(a, b)
                if edge in crossable:
                    todo += [other for other, _ in edge_users[edge]]
        left -= members
        members = sorted(members)
        directed = [side for row in members for side in sides(mesh.elements[row])]
        edges = {(min(side), max(side)) for side in directed}
        outline = [
            (place(mesh, a), place(mesh, b))
            for a, b in directed
            if (min(a, b), max(a, b)) not in crossable
        ]
        found.append(
            Zone(
                outline=frozenset(Counter(straightened(outline) if straight else outline).items()),
                region=int(mesh.region[members[0]]),
                euler=len({node for side in directed for node in side}) - len(edges) + len(members),
                area_vector=vectors[members].sum(axis=0),
                area=float(np.linalg.norm(vectors[members], axis=1).sum()),
                trias=int(np.count_nonzero(mesh.is_tria[members])),
                sides=len(outline),
            )
        )
    return found


def unsound(mesh, least=0.0):
    """Rows of elements with a corner that is flat or turns the wrong way round their normal."""
    found = []
    vectors = area_vectors(mesh)
    for row, element in enumerate(mesh.elements):
        nodes = corners(element)
        normal = vectors[row]
        length = np.linalg.norm(normal)
        if len(set(nodes)) < len(nodes) or length == 0:
            found.append(row)
            continue
        points = mesh.points[nodes]
        forward = np.roll(points, -1, axis=0) - points
        backward = np.roll(points, 1, axis=0) - points
        sines = np.cross(forward, backward) @ (normal / length)
        longer = np.maximum((forward**2).sum(axis=1), (backward**2).sum(axis=1))
        if (sines < (least - 1e-12) * longer).any() or (sines <= 0).any():
            found.append(row)
    return found


def doubles(mesh):
    """Pairs of elements of which one has all nodes of the other."""
    sets = [frozenset(corners(element)) for element in mesh.elements]
    around = defaultdict(set)
    for row, nodes in enumerate(sets):
        for node in nodes:
            around[node].add(row)
    return [
        (row, other)
        for row, nodes in enumerate(sets)
        for other in set.intersection(*(around[node] for node in nodes))
        if other != row
    ]


def distances_to_trias(query, trias):
    """Distance of a point to each of (T, 3, 3) trias: to the foot on its plane where that is
    inside, or else to the nearest of its sides."""
    a, b, c = np.swapaxes(trias, 0, 1)
    normal = np.cross(b - a, c - a)
    square = np.maximum((normal**2).sum(axis=1), 1e-300)
    height = ((query - a) * normal).sum(axis=1) / square
    foot = query - height[:, None] * normal
    best = np.full(len(trias), np.inf)
    inside = (normal != 0).any(axis=1)
    for p, q in ((a, b), (b, c), (c, a)):
        along = np.maximum(((q - p) ** 2).sum(axis=1), 1e-300)
        t = np.clip(((query - p) * (q - p)).sum(axis=1) / along, 0, 1)
        best = np.minimum(best, np.linalg.norm(query - (p + t[:, None] * (q - p)), axis=1))
        inside &= (np.cross(q - p, foot - p) * normal).sum(axis=1) >= 0
    return np.where(inside, np.linalg.norm(query - foot, axis=1), best)


def trias_of(mesh):
    """(T, 3, 3) corners of the mesh with both ways to split each quad, so T is 4 a quad."""
    quads = mesh.elements[~mesh.is_tria]
    parts = [quads[:, [i, j, k]] for i, j, k in ((0, 1, 2), (0, 2, 3), (0, 1, 3), (1, 2, 3))]
    return mesh.points[np.concatenate([mesh.elements[mesh.is_tria, :3], *parts])]
