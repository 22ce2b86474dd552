"""Small meshes of every kind that the operations must leave whole."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from hypothesis import strategies as st

from meshops.mesh import ShellMesh
from tests.measures import *  # noqa: F403 - what is measured of a mesh is wanted with it
from tests.measures import centre, corners


def sheet(columns, rows, *, seed=0, jitter=0.0, trias=0.0, holes=0.0):
    """Unit quads in the plane z = 0; inner nodes jittered, some quads split, some taken away."""
    rng = np.random.default_rng(seed)
    node = np.arange((columns + 1) * (rows + 1)).reshape(rows + 1, columns + 1)
    y, x = np.divmod(node.ravel(), columns + 1)
    points = np.stack([x, y, 0 * x], axis=1).astype(float)
    inner = (x > 0) & (x < columns) & (y > 0) & (y < rows)
    points[inner, :2] += rng.uniform(-jitter, jitter, (np.count_nonzero(inner), 2))
    quads = np.stack([node[:-1, :-1], node[:-1, 1:], node[1:, 1:], node[1:, :-1]], axis=-1)
    quads = quads.reshape(-1, 4)
    elements = []
    for quad in quads[rng.random(len(quads)) >= holes]:
        a, b, c, d = np.roll(quad, rng.integers(4))
        if rng.random() < trias:
            elements += [(a, b, c, -1), (a, c, d, -1)]
        else:
            elements.append((a, b, c, d))
    return tidy(ShellMesh.build(points, np.reshape(elements, (-1, 4))))


def tidy(mesh):
    """The mesh without nodes that no element uses, with ids from 1."""
    used, rows = np.unique(mesh.elements, return_inverse=True)
    rows = rows.reshape(mesh.elements.shape).astype(np.int32)
    if used[0] < 0:
        used, rows = used[1:], rows - 1
    return ShellMesh.build(
        mesh.points[used],
        rows,
        region=mesh.region,
        locked_nodes=mesh.locked_nodes[used],
        locked_elements=mesh.locked_elements,
    )


def shaped(mesh, shape):
    """The plane mesh laid on a surface, a function of x and y."""
    x, y, _ = mesh.points.T
    points = np.stack([np.broadcast_to(c, len(x)) for c in shape(x, y)], axis=1)
    return ShellMesh.build(
        points,
        mesh.elements,
        region=mesh.region,
        locked_nodes=mesh.locked_nodes,
        locked_elements=mesh.locked_elements,
    )


def cylinder(mesh, radius=8.0):
    return shaped(mesh, lambda x, y: (radius * np.sin(x / radius), y, radius * np.cos(x / radius)))


def paraboloid(mesh, curvature=0.04):
    return shaped(mesh, lambda x, y: (x, y, curvature * ((x - 2) ** 2 + (y - 2) ** 2)))


def folded(mesh, at):
    """Bent up by 90 degrees at x = `at`, where the nodes must lie on that line."""
    return shaped(mesh, lambda x, y: (np.minimum(x, at), y, np.maximum(x - at, 0.0)))


def in_two_regions(mesh, at):
    """Elements whose centre is beyond x = `at` belong to region 7."""
    beyond = [centre(mesh, row)[0] > at for row in range(len(mesh.elements))]
    return with_(mesh, region=np.where(beyond, 7, 3))


def partly_flipped(mesh, at):
    """Elements whose centre is beyond x = `at` are numbered clockwise."""
    elements = mesh.elements.copy()
    for row, element in enumerate(elements):
        if centre(mesh, row)[0] > at:
            size = len(corners(element))
            elements[row, :size] = element[:size][::-1]
    return with_(mesh, elements=elements)


def joined(*meshes):
    """Several meshes as one; nodes at the same place become one node."""
    points = np.concatenate([mesh.points for mesh in meshes])
    places, rows = np.unique(np.round(points, 9), axis=0, return_inverse=True)
    first = np.unique(rows, return_index=True)[1]
    elements, offset = [], 0
    for mesh in meshes:
        mine = rows.ravel()[offset : offset + len(mesh.points)]
        elements.append(np.where(mesh.elements < 0, -1, mine[mesh.elements]))
        offset += len(mesh.points)
    assert len(first) == len(places)
    return ShellMesh.build(
        points[first],
        np.concatenate(elements),
        region=np.concatenate([mesh.region for mesh in meshes]),
    )


def rib(columns, rows, *, at, start=0.0, seed=0, jitter=0.0, trias=0.0):
    """A plate that stands on the line y = `at` of the plane z = 0, from x = `start` on."""
    flat = sheet(columns, rows, seed=seed, jitter=jitter, trias=trias)
    return shaped(flat, lambda x, y: (x + start, at, y))


def needle(x, y):
    """A tria that touches the plane z = 0 in the single node (x, y)."""
    return ShellMesh.build([(x, y, 0.0), (x + 0.4, y, 1.0), (x - 0.4, y, 1.0)], [(0, 1, 2, -1)])


def annulus(around=16, rings=4, *, seed=0, jitter=0.0):
    """A plane ring of quads from radius 2 outwards."""
    rng = np.random.default_rng(seed)
    ring, spoke = np.divmod(np.arange(around * (rings + 1)), around)
    inner = (ring > 0) & (ring < rings)
    radius = 2.0 + ring + inner * rng.uniform(-jitter, jitter, len(ring))
    angle = 2 * np.pi / around * (spoke + inner * rng.uniform(-jitter, jitter, len(ring)))
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle], axis=1)
    elements = [
        (r * around + s, (r + 1) * around + s, (r + 1) * around + t, r * around + t)
        for r in range(rings)
        for s, t in pairwise([*range(around), 0])
    ]
    return ShellMesh.build(points, elements)


def torus(around=36, along=60):
    """A mesh without any border."""
    node = np.arange(around * along).reshape(around, along)
    u = 2 * np.pi * np.arange(around)[:, None] / around
    v = 2 * np.pi * np.arange(along)[None, :] / along
    radius = 5 + np.cos(u)
    points = np.stack([radius * np.cos(v), radius * np.sin(v), np.sin(u) + 0 * v], axis=-1)
    ahead, up = np.roll(node, -1, axis=0), np.roll(node, -1, axis=1)
    quads = np.stack([node, ahead, np.roll(ahead, -1, axis=1), up], axis=-1)
    return ShellMesh.build(points.reshape(-1, 3), quads.reshape(-1, 4))


def with_(mesh, **changes):
    """The mesh with other arrays."""
    return ShellMesh.build(**{**mesh.__getstate__(), **changes})


def with_random_locks(mesh, rng, *, nodes=0.0, elements=0.0):
    return with_(
        mesh,
        locked_nodes=rng.random(len(mesh.points)) < nodes,
        locked_elements=rng.random(len(mesh.elements)) < elements,
    )


def shuffled(mesh, rng):
    """The same mesh with its elements in another order, as decks have them."""
    order = rng.permutation(len(mesh.elements))
    return with_(
        mesh,
        elements=mesh.elements[order],
        region=mesh.region[order],
        locked_elements=mesh.locked_elements[order],
    )


PLANE_KINDS = ("plain", "holes", "regions", "flipped", "annulus", "locks")
FLAT_KINDS = (*PLANE_KINDS, "folded", "t-junction", "slit", "bow-tie")
CURVED_KINDS = ("cylinder", "paraboloid", "curved-t-junction")


def make(kind, seed):
    """A random mesh of a kind. Jitter and trias are drawn, so that some meshes are regular."""
    rng = np.random.default_rng(seed)
    jitter, trias = rng.choice([0.0, 0.15, 0.3]), rng.choice([0.0, 0.2, 0.6])
    columns, rows = (int(n) for n in rng.integers(3, 8, 2))
    rough = {"jitter": jitter, "trias": trias, "seed": int(rng.integers(2**31))}
    gentle = {**rough, "jitter": min(jitter, 0.15)}

    def straight(length):
        """A plate with a straight line of nodes at x = 0, for seams."""
        left = sheet(3, length, **rough)
        right = sheet(3, length, **{**rough, "seed": rough["seed"] + 1})
        return joined(shaped(left, lambda x, y: (x - 3, y, 0 * x)), right)

    match kind:
        case "plain":
            mesh = sheet(columns, rows, **rough)
        case "holes":
            mesh = sheet(columns + 2, rows + 2, **rough, holes=0.15)
        case "regions":
            mesh = in_two_regions(sheet(columns, rows, **rough), columns / 2)
        case "flipped":
            mesh = partly_flipped(sheet(columns, rows, **rough), columns / 2)
        case "annulus":
            mesh = annulus(seed=rough["seed"], jitter=jitter / 2)
        case "locks":
            mesh = sheet(columns + 1, rows + 1, **rough)
            mesh = with_random_locks(mesh, rng, nodes=0.08, elements=rng.choice([0.0, 0.08]))
        case "folded":
            mesh = folded(straight(rows), 0.0)
        case "t-junction":
            # three plates that meet along x = 0
            wall = shaped(sheet(3, rows, **rough), lambda x, y: (0 * x, y, x))
            mesh = joined(straight(rows), wall)
        case "slit":
            # a rib that ends in the middle of the skin
            skin = joined(
                shaped(sheet(6, 3, **rough), lambda x, y: (x, y - 3, 0 * x)),
                sheet(6, 3, **{**rough, "seed": rough["seed"] + 1}),
            )
            mesh = joined(skin, rib(3, 2, at=0.0, start=float(rng.integers(0, 3))))
        case "bow-tie":
            skin = sheet(columns, rows, **{**rough, "jitter": 0.0})
            mesh = joined(skin, needle(1.0, 1.0), needle(2.0, 2.0))
        case "cylinder":
            mesh = cylinder(sheet(columns, rows, **gentle))
        case "paraboloid":
            mesh = paraboloid(sheet(columns, rows, **gentle))
        case "curved-t-junction":
            skin = joined(
                shaped(sheet(5, 3, **gentle), lambda x, y: (x, y - 3, 0 * x)),
                sheet(5, 3, **{**gentle, "seed": rough["seed"] + 1}),
            )
            bent = cylinder(skin)
            wall = shaped(
                sheet(5, 2, **gentle),
                lambda x, y: ((8 + y) * np.sin(x / 8), 0 * y, (8 + y) * np.cos(x / 8)),
            )
            mesh = joined(bent, wall)
    return shuffled(mesh, rng)


def meshes(kinds):
    """Hypothesis strategy: random meshes of some kinds."""
    return st.builds(make, st.sampled_from(kinds), st.integers(0, 10**6))
