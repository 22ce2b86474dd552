"""Remove a doublet: a node with only two elements vanishes and they become one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from meshops.mesh import NO_NODE, Ints
from meshops.operations.candidates import Candidates
from meshops.operations.places import nearest_first
from meshops.operations.relax import relax
from meshops.operations.sites import SiteOperation
from meshops.workpiece import Workpiece


@dataclass(frozen=True)
class RemoveDoublet(SiteOperation):
    """Merge two quads, or a quad and a tria, that share two edges, then relax the nodes around.

    Doublet removal: Canann, Muthukrishnan, Phillips (1998).
    """

    nested: ClassVar[bool] = True
    name: str = "remove-doublet"
    code: int = 9

    def candidates(self, workpiece: Workpiece) -> Candidates:
        """One element for each free node with two elements."""
        mesh = workpiece.mesh
        start, around = workpiece.around
        has_two = workpiece.topology.free_nodes & (np.diff(start) == 2)
        nodes = np.nonzero(has_two)[0].astype(np.int32)
        pairs = np.stack([around[start[nodes]], around[start[nodes] + 1]], axis=1)
        # a quad first; of two trias nothing would be left
        flip = mesh.is_tria[pairs[:, 0]]
        pairs[flip] = pairs[flip][:, ::-1]
        has_quad = ~mesh.is_tria[pairs[:, 0]]
        nodes, pairs = nodes[has_quad], pairs[has_quad]
        order = nearest_first(workpiece, pairs)[: self.pool]
        nodes, pairs = nodes[order], pairs[order]
        # (node, a, b, c) and (node, c, d, a) or (node, c, a)
        one = _beginning_at(nodes, mesh.elements[pairs[:, 0]])
        two = _beginning_at(nodes, mesh.elements[pairs[:, 1]])
        merged = np.concatenate([one[:, 1:], two[:, 2:3]], axis=1)
        merged[two[:, 3] == NO_NODE, 3] = NO_NODE
        return relax(workpiece, Candidates.padded(pairs, merged[:, None]))


def _beginning_at(nodes: Ints, elements: Ints) -> Ints:
    """Turn elements (S, 4) so that each begins at a node (S,)."""
    size = np.where(elements[:, 3] == NO_NODE, 3, 4)[:, None]
    first = (elements == nodes[:, None]).argmax(axis=1)[:, None]
    corner = np.arange(4)
    turned = np.where(corner < size, (first + corner) % size, corner)
    return np.take_along_axis(elements, turned, axis=1)
