"""Large meshes of known badness: the plate, side by side."""

from __future__ import annotations

from math import ceil, isqrt

import numpy as np

from meshops.examples import SIZE, plate
from meshops.mesh import NO_NODE, ShellMesh


def tiled(elements: int) -> ShellMesh:
    """Lay copies of the plate side by side to a mesh of at least so many elements."""
    tile = plate()
    count = ceil(elements / len(tile.elements))
    columns = max(isqrt(count), 1)
    column, row = np.divmod(np.arange(count), ceil(count / columns))
    side = float(np.ptp(tile.points[:, 0]))
    offsets = side * np.column_stack([column, row, np.zeros(count)])
    points = (offsets[:, None, :] + tile.points).reshape(-1, 3)
    # nodes on the seams are in the same places to the last bit but for rounding
    keys = np.round(points / SIZE, 6)
    _, first, merged = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    shifts = len(tile.points) * np.arange(count)[:, None, None]
    rows = np.where(tile.elements == NO_NODE, 0, tile.elements + shifts).reshape(-1, 4)
    is_node = np.tile(tile.elements != NO_NODE, (count, 1))
    return ShellMesh.build(
        points[first],
        np.where(is_node, merged.ravel()[rows], NO_NODE),
        locked_nodes=np.tile(tile.locked_nodes, count)[first],
        locked_elements=np.tile(tile.locked_elements, count),
    )
