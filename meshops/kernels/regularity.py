"""Regular nodes: inner nodes at which four elements meet."""

from __future__ import annotations

import numpy as np

from meshops.kernels.vectors import compiled
from meshops.mesh import Bools, Ints

REGULAR = 4
"""Elements that meet at a regular inner node."""


@compiled
def is_irregular(valence: int, outside: int) -> bool:
    """Whether a node is used and has other than four elements.

    `outside` is how many of them are not of the mesh; -1: any number may meet at the node.
    """
    return outside >= 0 and valence > 0 and valence + outside != REGULAR


@compiled
def irregular_change(
    goes: Ints, comes: Ints, elements: Ints, start: Ints, outside: Ints, counts: Ints
) -> int:
    """How many more nodes are irregular once the elements (B, 4) have come for those in rows.

    Parameters
    ----------
    goes, comes : (R,) int32, (B, 4) int32
        Rows from N on stand for new nodes.
    elements, start
        The mesh, and ``elements_of_nodes`` of it.
    outside : (N,) int32
        Elements at each node that are not of the mesh, -1 where any number may be.
    counts : (N + A,) int32
        Scratch, all 0 before and after.
    """
    nodes = len(start) - 1
    for e in goes:
        for node in elements[e]:
            if node >= 0:
                counts[node] -= 1
    for i in range(len(comes)):
        for node in comes[i]:
            if node >= 0:
                counts[node] += 1
    change = 0
    for i in range(len(goes) + len(comes)):
        for k in range(4):
            node = elements[goes[i], k] if i < len(goes) else comes[i - len(goes), k]
            if node < 0 or counts[node] == 0:
                continue
            had = start[node + 1] - start[node] if node < nodes else 0
            free = outside[node] if node < nodes else 0
            change += is_irregular(had + counts[node], free) - is_irregular(had, free)
            counts[node] = 0
    return change


@compiled
def irregular_nodes(start: Ints, outside: Ints) -> Bools:
    """(N,) bool: which nodes are irregular."""
    irregular = np.zeros(len(outside), np.bool_)
    for node in range(len(outside)):
        irregular[node] = is_irregular(start[node + 1] - start[node], outside[node])
    return irregular
