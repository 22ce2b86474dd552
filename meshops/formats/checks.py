"""The checks that every mesh passes before it is used, whatever file it comes from."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from meshops.errors import InputError
from meshops.mesh import NO_NODE, Bools, Floats, Ids, Ints, ShellMesh

Place = Callable[[int], str]
"""Says where a row of an array comes from: 'name, line n' where the format has lines."""


def checked_mesh(
    *,
    source: str,
    points: Floats,
    node_ids: Ids,
    corners: Ids,
    element_ids: Ids,
    region: Ints,
    locked_nodes: Bools,
    locked_elements: Bools,
    node_place: Place,
    element_place: Place,
) -> ShellMesh:
    """Make a ShellMesh of what a file says, keeping only the nodes that its elements use.

    Elements on the same nodes, as those of a doubler, are locked.

    Parameters
    ----------
    source : str
        Name of the file.
    points, node_ids, locked_nodes : (N, 3) float64, (N,) int64, (N,) bool
        A node may come twice with the same coordinates.
    corners : (M, 4) int64
        Node ids; a tria has 0 last.
    element_ids, region, locked_elements : (M,) int64, (M,) int32, (M,) bool
    node_place, element_place
        Name the place of a row, for messages.

    Raises
    ------
    InputError
        No element; a coordinate that is not finite; a node or element id used twice; an element
        that names a missing node or one node twice; no element that is alone on its nodes.
    """
    if not len(corners):
        raise InputError(f"{source} holds no linear shell element: there is nothing to repair.")
    _check_finite(points, node_ids, node_place)
    _check_element_ids(element_ids, element_place)
    nodes = _distinct_nodes(node_ids, points, node_place)
    elements = _element_rows(corners, node_ids[nodes], element_ids, element_place)
    _check_repeated_nodes(elements, corners, element_ids, element_place)
    same = on_same_nodes(elements)
    if same.all():
        _refuse_same_nodes(elements, element_ids, element_place)
    used = np.unique(elements[elements != NO_NODE])
    compact = np.where(elements == NO_NODE, NO_NODE, np.searchsorted(used, elements))
    # nodes keep the order of the file, not that of their ids
    order = np.argsort(nodes[used], kind="stable")
    rank = np.empty(len(used), np.int64)
    rank[order] = np.arange(len(used))
    kept = nodes[used][order]
    return ShellMesh.build(
        points=points[kept],
        elements=np.where(compact == NO_NODE, NO_NODE, rank[compact]),
        region=region,
        locked_nodes=locked_nodes[kept],
        locked_elements=locked_elements | same,
        node_ids=node_ids[kept],
        element_ids=element_ids,
    )


def _check_finite(points: Floats, node_ids: Ids, place: Place) -> None:
    bad = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(bad):
        row = int(bad[0])
        raise InputError(
            f"{place(row)}: node {node_ids[row]} has a coordinate that is not a finite number; "
            "correct it."
        )


def _check_element_ids(element_ids: Ids, place: Place) -> None:
    order = np.argsort(element_ids, kind="stable")
    twice = np.flatnonzero(np.diff(element_ids[order]) == 0)
    if len(twice):
        first, second = (int(order[twice[0] + k]) for k in (0, 1))
        raise InputError(
            f"{place(second)}: element {element_ids[second]} is defined a second time "
            f"(first: {place(first)}); renumber or remove one."
        )


def _distinct_nodes(node_ids: Ids, points: Floats, place: Place) -> Ids:
    """Rows of the distinct nodes, in the order of their ids."""
    order = np.argsort(node_ids, kind="stable")
    again = np.zeros(len(order), bool)
    again[1:] = np.diff(node_ids[order]) == 0
    here, before = order[again], order[np.flatnonzero(again) - 1]
    differ = np.flatnonzero((points[here] != points[before]).any(axis=1))
    if len(differ):
        second, first = int(here[differ[0]]), int(before[differ[0]])
        raise InputError(
            f"{place(second)}: node {node_ids[second]} is defined a second time with other "
            f"content (first: {place(first)}); renumber or remove one."
        )
    distinct: Ids = order[~again]
    return distinct


def _element_rows(corners: Ids, sorted_ids: Ids, element_ids: Ids, place: Place) -> Ids:
    """(M, 4) positions of the corners among ``sorted_ids``, NO_NODE where a corner is 0."""
    if not len(sorted_ids):
        raise InputError(f"{place(0)}: element {element_ids[0]} names nodes, but there are none.")
    found = np.minimum(np.searchsorted(sorted_ids, corners), len(sorted_ids) - 1)
    absent = corners == 0
    absent[:, :3] = False
    missing = np.argwhere((sorted_ids[found] != corners) & ~absent)
    if len(missing):
        row, corner = missing[0]
        raise InputError(
            f"{place(int(row))}: element {element_ids[row]} names node {corners[row, corner]}, "
            "which is not defined; add the node or correct the element."
        )
    return np.where(absent, NO_NODE, found)


def _check_repeated_nodes(elements: Ids, corners: Ids, element_ids: Ids, place: Place) -> None:
    ordered = np.sort(elements, axis=1)
    rows = np.flatnonzero((np.diff(ordered, axis=1) == 0).any(axis=1))
    if len(rows):
        row = int(rows[0])
        values, counts = np.unique(corners[row], return_counts=True)
        raise InputError(
            f"{place(row)}: element {element_ids[row]} names node {values[counts > 1][0]} twice; "
            "make it a tria or remove it."
        )


def _refuse_same_nodes(elements: Ids, element_ids: Ids, place: Place) -> None:
    ordered = np.sort(elements, axis=1)
    twice = (ordered == ordered[0]).all(axis=1).nonzero()[0]
    first, second = int(twice[0]), int(twice[1])
    raise InputError(
        f"{place(second)}: elements {element_ids[first]} and {element_ids[second]} lie on the "
        "same nodes, and so do all others; remove one of each."
    )


def on_same_nodes(elements: Ints | Ids) -> Bools:
    """(M,) bool: which elements (M, 4) have all their nodes in common with another one."""
    ordered = np.sort(elements, axis=1)
    order = np.lexsort(ordered.T)
    same = (np.diff(ordered[order], axis=0) == 0).all(axis=1)
    found = np.zeros(len(elements), bool)
    found[order[1:][same]] = True
    found[order[:-1][same]] = True
    return found


def without_repeated_nodes(corners: Ids) -> tuple[Ids, Bools]:
    """Turn quads that name a node twice in a row into the trias that they mean.

    Where all elements do so there is no mesh, but a mistake: then they are left.

    Parameters
    ----------
    corners : (M, 4) int64
        Node ids; a tria has 0 last.

    Returns
    -------
    corners : (M, 4) int64
    is_repeated : (M,) bool
    """
    twice = (corners == np.roll(corners, -1, axis=1)) & (corners[:, 3:] != 0)
    distinct = np.array([len(set(row)) for row in corners[twice.any(axis=1)].tolist()], int)
    rows = np.flatnonzero(twice.any(axis=1))[distinct == 3]
    is_repeated = np.zeros(len(corners), bool)
    if len(rows) == len(corners):
        return corners, is_repeated
    is_repeated[rows] = True
    found = corners.copy()
    keep = ~twice[rows]
    found[rows, :3] = corners[rows][keep].reshape(-1, 3)
    found[rows, 3] = 0
    return found, is_repeated


def note_on(element_ids: Ids, which: Bools, what: str) -> tuple[str, ...]:
    """Note what is true of some elements, 'Left as trias: elements 5, 7.'; nothing of none."""
    ids = element_ids[which].tolist()
    if not ids:
        return ()
    named = ", ".join(map(str, ids[:5])) + (f" and {len(ids) - 5:,} more" if len(ids) > 5 else "")
    return (f"{what}: element{'s' * (len(ids) > 1)} {named}.",)
