"""Holes: the closed borders inside the zones of a mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops._core import trace_loops
from meshops.mesh import Ints
from meshops.patch import Patch, components, extract
from meshops.workpiece import Workpiece


@dataclass(frozen=True, eq=False)
class Hole:
    """A closed border inside a zone.

    Attributes
    ----------
    nodes : (h,) int32
        Mesh rows of its nodes in order, the elements on the left.
    elements : (h,) int32
        Mesh row of the element at the edge from each node to the next.
    """

    nodes: Ints
    elements: Ints


def holes(workpiece: Workpiece) -> list[Hole]:
    """All holes of the mesh, those next to a bad element first.

    A zone's outer border is that with the largest extent; every other closed border of it is a
    hole, also that around locked elements.
    """
    topology, rings = workpiece.topology, workpiece.rings
    found = []
    for rows in components(topology, np.ones(len(workpiece.mesh.elements), bool)):
        patch = extract(topology, rows)
        loops = [(patch.border[loop, 0], loop) for loop in border_loops(patch)]
        extents = [np.linalg.norm(np.ptp(patch.points[nodes], axis=0)) for nodes, _ in loops]
        outer = int(np.argmax(extents)) if loops else 0
        owner, side = border_sides(patch)
        barrier = ~topology.crossable[topology.element_edges[rows[owner], side]]
        found += [
            Hole(patch.nodes[nodes], rows[owner[loop]])
            for k, (nodes, loop) in enumerate(loops)
            if k != outer and barrier[loop].all()
        ]
    return sorted(found, key=lambda hole: (rings[hole.elements].min(), hole.nodes.min()))


def border_loops(patch: Patch) -> list[Ints]:
    """Rows of the patch's border edges, in order around each closed border."""
    order, start = trace_loops(patch.border)
    return np.split(order, start[1:-1])


def border_sides(patch: Patch) -> tuple[Ints, Ints]:
    """(b,) element of each border edge, as a row of the patch, and which of its sides it is."""
    size = np.where(patch.elements[:, 3:] < 0, 3, 4)
    corner = np.arange(4)
    end = np.take_along_axis(patch.elements, (corner + 1) % size, axis=1)
    nodes = len(patch.points)
    sides = np.where(corner < size, patch.elements.astype(np.int64) * nodes + end, -1).ravel()
    order = np.argsort(sides, kind="stable")
    border = patch.border.astype(np.int64) @ np.array([nodes, 1])
    found = order[np.searchsorted(sides[order], border)]
    return found // 4, found % 4
