"""Templates: groups of adjacent elements, and other elements for the polygon around them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import lru_cache
from itertools import combinations

import numpy as np

from meshops.mesh import NO_NODE, Ints
from meshops.topology import Topology

Template = tuple[tuple[int, ...], ...]
"""Elements by the corners of a polygon, counted from 0; ``CENTRE`` is a new node inside."""

CENTRE = -2

NOWHERE = -1
"""Fills up a template: the place of a node that is not there."""


def triples(topology: Topology, rows: Ints) -> Ints:
    """(S, 3) int32: each of some elements in the middle of any two of its neighbours."""
    edges = topology.element_edges[rows]
    crossable = topology.crossable[edges] & (edges >= 0)
    others = np.where(crossable, topology.edge_elements[edges].sum(axis=-1) - rows[:, None], -1)
    one, two = np.triu_indices(4, 1)
    middle = np.repeat(rows[:, None], len(one), axis=1)
    found = np.stack([others[:, one], middle, others[:, two]], axis=-1).reshape(-1, 3)
    whole = (found >= 0).all(axis=1) & (found[:, 0] != found[:, 2])
    chosen: Ints = found[whole & topology.editable[found].all(axis=1)].astype(np.int32)
    return chosen


@lru_cache
def dissections(corners: int) -> tuple[Template, ...]:
    """All ways to cut a polygon along its diagonals to quads, with one tria where that must be."""

    def trias(template: Template) -> int:
        return sum(len(element) == 3 for element in template)

    return tuple(t for t in _cuts(tuple(range(corners))) if trias(t) == corners % 2)


def _cuts(polygon: tuple[int, ...]) -> Iterator[Template]:
    """All ways to cut a polygon to quads and trias, by the element at its last side."""
    last = len(polygon) - 1
    if last == 1:
        yield ()
    for i in range(1, last):
        for left in _cuts(polygon[: i + 1]):
            for right in _cuts(polygon[i:]):
                yield ((polygon[0], polygon[i], polygon[last]), *left, *right)
            for j in range(i + 1, last):
                for middle in _cuts(polygon[i : j + 1]):
                    for right in _cuts(polygon[j:]):
                        quad = (polygon[0], polygon[i], polygon[j], polygon[last])
                        yield (quad, *left, *middle, *right)


@lru_cache
def stars(corners: int) -> tuple[Template, ...]:
    """All ways to join a new node inside to three corners so that quads and trias come out.

    With fewer the node would be a doublet, with more there would be more trias. Only a polygon of
    four corners may also be cut to four trias.
    """

    def element(spoke: int, following: int) -> tuple[int, ...]:
        steps = (following - spoke) % corners
        return (CENTRE, *((spoke + step) % corners for step in range(steps + 1)))

    joined = [*combinations(range(corners), 3), *([(0, 1, 2, 3)] if corners == 4 else [])]
    found = [
        tuple(element(a, b) for a, b in zip(spokes, spokes[1:] + spokes[:1], strict=True))
        for spokes in joined
    ]
    return tuple(t for t in found if all(len(nodes) <= 4 for nodes in t))


def fill(
    polygons: Ints, sizes: Ints, templates: Callable[[int], tuple[Template, ...]], centre: int
) -> Ints:
    """Put every template into every polygon.

    Parameters
    ----------
    polygons, sizes : (S, P) int32, (S,) int32
        As `cavity_polygons` makes them.
    templates : function
        The templates of a polygon by its corners: `dissections` or `stars`.
    centre : int
        Node row of ``CENTRE``.

    Returns
    -------
    (S, V, B, 4) int32 elements, V and B the most that a polygon here has; -1 where there is none.
    """
    tables = {int(n): _table(templates(int(n))) for n in np.unique(sizes) if n >= 3}
    most = np.max([table.shape[:2] for table in tables.values()] or [(1, 1)], axis=0)
    filled = np.full((len(polygons), *most, 4), NO_NODE, np.int32)
    # CENTRE and NOWHERE are places counted from the end
    places = np.column_stack(
        [polygons, np.full((len(polygons), 1), centre), np.full((len(polygons), 1), NO_NODE)]
    )
    for corners, table in tables.items():
        chosen = sizes == corners
        filled[chosen, : table.shape[0], : table.shape[1]] = places[chosen][:, table]
    return filled


@lru_cache
def _table(templates: tuple[Template, ...]) -> Ints:
    """(V, B, 4) int32 of some templates, read-only."""
    most = max((len(template) for template in templates), default=1)
    table = np.full((len(templates), most, 4), NOWHERE, np.int32)
    for variant, template in enumerate(templates):
        for row, nodes in enumerate(template):
            table[variant, row, : len(nodes)] = nodes
    table.flags.writeable = False
    return table
