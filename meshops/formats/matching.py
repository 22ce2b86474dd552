"""Which element of a file that was read again is which of its model: by their places alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from meshops.formats.polygon_text import split_trias
from meshops.mesh import NEW, NO_NODE, Floats, Ids, Ints, ShellMesh
from meshops.quality import median_edge

ROUNDING = 1e-6
"""Of an edge: how far a node may stand from its place because a file has so many digits."""

SINGLE = 4.0 * float(np.finfo(np.float32).eps)
"""Of the largest coordinate: what a file of single precision loses."""


def matched(model: ShellMesh, again: ShellMesh, *, is_split: bool) -> ShellMesh | None:
    """Give the model the ids that its nodes and elements have in a file that was read again.

    Parameters
    ----------
    model, again : ShellMesh
    is_split : bool
        Whether the file has two trias for each quad: an element has the id of its first one then.

    Returns
    -------
    ShellMesh or None
        None where the elements do not match one to one, each on nodes in its places.
    """
    owner = np.arange(len(model.elements))
    elements = model.elements
    if is_split:
        trias, owner = split_trias(model)
        elements = np.column_stack([trias, np.full(len(trias), NO_NODE, np.int32)])
    if len(elements) != len(again.elements):
        return None
    here, there = _corners(model.points, elements), _corners(again.points, again.elements)
    reach = rounding(model) + SINGLE * float(np.abs(model.points).max())
    distance, rows = cKDTree(there.mean(axis=1)).query(here.mean(axis=1))
    if (distance > reach).any() or len(np.unique(rows)) < len(rows):
        return None
    apart = np.linalg.norm(here[:, :, None] - there[rows][:, None], axis=3)
    nearest = apart.argmin(axis=2)
    is_tria = elements[:, 3] == NO_NODE
    if (apart.min(axis=2) > reach).any() or (is_tria != again.is_tria[rows]).any():
        return None
    element_ids = np.empty(len(model.elements), np.int64)
    element_ids[owner[::-1]] = again.element_ids[rows[::-1]]
    corners = again.elements[rows]
    corners = np.where(corners == NO_NODE, corners[:, 2:3], corners)
    nodes = np.take_along_axis(corners, nearest, axis=1)
    node_ids = model.node_ids.copy()
    is_corner = elements != NO_NODE
    node_ids[elements[is_corner]] = again.node_ids[nodes[is_corner]]
    return replace(model, node_ids=node_ids, element_ids=element_ids)


def renumbered(again: ShellMesh, numbered: ShellMesh, model: ShellMesh) -> ShellMesh:
    """Give a file that was read again the ids of its model, where its own are places in the file.

    `numbered` is what `matched` returned for both.
    """
    return replace(
        again,
        node_ids=_renamed(again.node_ids, numbered.node_ids, model.node_ids),
        element_ids=_renamed(again.element_ids, numbered.element_ids, model.element_ids),
    )


def _renamed(ids: Ids, known: Ids, names: Ids) -> Ids:
    """Name of each id by the known ones; NEW for one that is not known."""
    order = np.argsort(known, kind="stable")
    rows = order[np.minimum(np.searchsorted(known[order], ids), len(known) - 1)]
    return np.where(known[rows] == ids, names[rows], NEW)


def rounding(model: ShellMesh) -> float:
    """How far places in a deck may be from those of the model that it was written of."""
    return ROUNDING * median_edge(model)


def _corners(points: Floats, elements: Ints) -> Floats:
    """(M, 4, 3) corners; a tria's last one twice."""
    last = np.where(elements[:, 3:] == NO_NODE, elements[:, 2:3], elements[:, 3:])
    corners: Floats = points[np.column_stack([elements[:, :3], last])]
    return corners
