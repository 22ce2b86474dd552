"""Places where a small edit could be made, and which of them comes first."""

from __future__ import annotations

import numpy as np

from meshops.mesh import Ints
from meshops.workpiece import Workpiece


def nearest_first(workpiece: Workpiece, touched: Ints) -> Ints:
    """Order places by the elements (S, W) that they are of, -1 for none; (S,) int32 rows.

    Those nearest to a bad element come first, then those with the worse element, then as they are.
    """
    bad = workpiece.bad_elements
    badness = np.full(len(workpiece.mesh.elements) + 1, len(bad))
    badness[bad] = np.arange(len(bad))
    rings = np.append(workpiece.rings, np.iinfo(np.int32).max)
    order: Ints = np.lexsort((badness[touched].min(axis=1), rings[touched].min(axis=1))).astype(
        np.int32
    )
    return order


def crossable_pairs(workpiece: Workpiece) -> Ints:
    """(S, 2) pairs of elements on either side of a crossable edge, both of which may go."""
    topology = workpiece.topology
    pairs = topology.edge_elements[topology.crossable]
    editable: Ints = pairs[topology.editable[pairs].all(axis=1)]
    return editable


def padded_around(nodes: Ints, start: Ints, around: Ints) -> Ints:
    """(S, W) elements around each of some nodes, -1 beyond the last."""
    counts = start[nodes + 1] - start[nodes]
    places = np.arange(counts.max(initial=1), dtype=np.int32)
    used = places < counts[:, None]
    rows: Ints = np.where(used, around[np.where(used, start[nodes][:, None] + places, 0)], -1)
    return rows
