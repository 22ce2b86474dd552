"""Example meshes, made and not read: the paper's test piece."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np

from meshops._core import greedy_matching, merge_pairs, pair_shapes, tria_neighbours
from meshops.mesh import NO_NODE, Bools, Floats, Ids, Ints, ShellMesh
from meshops.topology import topology

SIZE = 5.0
"""Element size of the plate."""

_CELLS = 20
"""Squares along a side of the plate."""

_RADII = (15.0, 19.5, 24.0)
"""Of the hole, of the ring of quads around it, and of one more circle of nodes."""

_COUNTS = (19, 19, 27)
"""Nodes on each circle. An odd hole border leaves an odd number of trias: 4 Q + 3 T counts every
inner edge twice and every border edge once."""

_PHASES = (0.0, 0.0, 0.1)
"""Angle of the first node on each circle, in parts of the step to the next."""

_LATTICE_FROM = 26.0
"""Distance from the middle beyond which nodes are those of the square lattice."""

_LEAST_SHAPE = 0.4
"""Two trias whose quad has a worst corner with a sine below this stay trias."""

_DECIMALS = 3
"""Places are rounded, so that the last bit of a cosine does not change the digest."""


def plate() -> ShellMesh:
    """Return the test piece of the paper's section 4.1: a square plate with a hole in the middle.

    100 by 100 in the plane z = 0, 362 quads and 11 trias of size 5. The ring of quads around the
    hole, which the paper made with QuickEdit, is locked together with its nodes. Numbers go along
    diagonals from the lower right to the upper left, the diagonals from the lower left corner on
    (section 5.1), for elements and nodes alike.
    """
    points = _nodes()
    ring = _ring()
    elements = np.concatenate([ring, _recombined(points, _transition_and_lattice(points))])
    locked_nodes = np.zeros(len(points), bool)
    locked_nodes[ring] = True
    locked_elements = np.arange(len(elements)) < len(ring)

    border = topology(ShellMesh.build(points, elements))
    still = locked_nodes.copy()
    still[border.edges[border.is_border]] = True
    points = _relaxed(points, border.edges, still).round(_DECIMALS)

    node_order = _along_diagonals(points)
    number = np.argsort(node_order)
    centres = np.array([points[nodes[nodes >= 0]].mean(axis=0) for nodes in elements])
    element_order = _along_diagonals(centres)
    return ShellMesh.build(
        points[node_order],
        _from_lowest(np.where(elements < 0, NO_NODE, number[elements]))[element_order],
        locked_nodes=locked_nodes[node_order],
        locked_elements=locked_elements[element_order],
    )


EXAMPLES: Mapping[str, Callable[[], ShellMesh]] = MappingProxyType({"plate": plate})
"""What can be asked for by name."""


def _nodes() -> Floats:
    """(N, 3) circle after circle from the hole on, then the lattice."""
    middle = np.full(2, 0.5 * _CELLS * SIZE)
    circles = []
    for radius, count, phase in zip(_RADII, _COUNTS, _PHASES, strict=True):
        angle = 2.0 * np.pi * (np.arange(count) + phase) / count
        circles.append(middle + radius * np.column_stack([np.cos(angle), np.sin(angle)]))
    steps = SIZE * np.arange(_CELLS + 1)
    lattice = np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
    outside = ((lattice - middle) ** 2).sum(axis=1) > _LATTICE_FROM**2
    flat = np.concatenate([*circles, lattice[outside]]).round(_DECIMALS)
    return np.column_stack([flat, np.zeros(len(flat))])


def _ring() -> Ints:
    """(K, 4) quads between the first circle and the second."""
    count = _COUNTS[0]
    here = np.arange(count, dtype=np.int32)
    ahead = np.roll(here, -1)
    return np.column_stack([here, here + count, ahead + count, ahead])


def _transition_and_lattice(points: Floats) -> Ints:
    """(T, 3) Delaunay trias outside the ring, counter-clockwise."""
    from scipy.spatial import Delaunay

    hole, ring = _COUNTS[:2]
    trias = Delaunay(points[hole:, :2]).simplices.astype(np.int32)
    outside: Ints = trias[(trias >= ring).any(axis=1)] + np.int32(hole)
    return outside


def _recombined(points: Floats, trias: Ints) -> Ints:
    """(M, 4) quads of good pairs of trias; the others stay trias, as an automatic mesher does."""
    neighbours = tria_neighbours(trias, len(points))
    shapes = pair_shapes(points, trias, neighbours)
    return merge_pairs(trias, neighbours, greedy_matching(neighbours, shapes, _LEAST_SHAPE))


def _relaxed(points: Floats, edges: Ints, still: Bools) -> Floats:
    """Move every node that is not still to the mean of its neighbours, once."""
    ends = np.concatenate([edges, edges[:, ::-1]])
    total = np.zeros_like(points)
    np.add.at(total, ends[:, 0], points[ends[:, 1]])
    mean = total / np.bincount(ends[:, 0], minlength=len(points))[:, None]
    return np.where(still[:, None], points, mean)


def _along_diagonals(places: Floats) -> Ids:
    """(n,) rows in the order of the paper's numbers."""
    x, y = places[:, 0], places[:, 1]
    return np.lexsort([y - x, np.round((x + y) / SIZE)])


def _from_lowest(elements: Ids) -> Ids:
    """Turn each element so that its lowest node comes first, whichever way it was made."""
    size = np.where(elements[:, 3:] == NO_NODE, 3, 4)
    first = np.where(elements == NO_NODE, len(elements) * 4, elements).argmin(axis=1)[:, None]
    corner = np.arange(4)
    turned = np.where(corner < size, (first + corner) % size, corner)
    return np.take_along_axis(elements, turned, axis=1)
