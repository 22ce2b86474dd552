"""Partition of a mesh into subdomains around bad places."""

from __future__ import annotations

import numpy as np

from meshops.kernels.vectors import compiled
from meshops.mesh import Bools, Ints


@compiled
def partition(
    element_edges: Ints,
    edge_elements: Ints,
    crossable: Bools,
    editable: Bools,
    bad: Ints,
    rings: int,
    most: int,
) -> Ints:
    """(M,) int32 subdomain of each element; -1 for an element that is in none.

    Each bad element that is in no subdomain yet starts one: all free elements around it, ring by
    ring. Work grows with the number of elements in subdomains, not with the mesh.
    """
    label = np.full(len(element_edges), -1, np.int32)
    queue = np.empty(most, np.int32)
    depth = np.empty(most, np.int32)
    found = 0
    for centre in bad:
        if label[centre] >= 0 or not editable[centre]:
            continue
        label[centre] = found
        queue[0] = centre
        depth[0] = 0
        head = 0
        tail = 1
        while head < tail:
            element = queue[head]
            if depth[head] >= rings:
                break
            for side in range(4):
                edge = element_edges[element, side]
                if edge < 0 or not crossable[edge]:
                    continue
                other = edge_elements[edge, 0] + edge_elements[edge, 1] - element
                if label[other] < 0 and editable[other] and tail < most:
                    label[other] = found
                    queue[tail] = other
                    depth[tail] = depth[head] + 1
                    tail += 1
            head += 1
        found += 1
    return label
