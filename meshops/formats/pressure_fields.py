"""Fields of pressure: which loads on shells are even over areas, and which differ by element.

An even load is an attribute of its shells, and its area keeps its border. A load that differs from
element to element is a sample of a field: neighbours of different values are of one region all the
same, and what is meshed anew there gets the field as it was.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from meshops.formats.fortran import real
from meshops.mesh import Bools, Ids, Ints

_AROUND = 3
"""Elements at a node from which it is inside of an area and not on its border."""

FEWEST_SAMPLES = 5
"""Different values of a layer: fewer make a field of it only where they differ little."""

SMALLEST_STEP = 0.05
"""Areas whose values differ by less, relative to the larger one, are steps of one field."""


Layer = tuple[str, ...]
"""What loads have in common that add up to one field of pressure."""


class Load(Protocol):
    """A load of an element, as typed."""

    @property
    def layer(self) -> Layer:
        """Equal for loads that differ in their values alone."""

    @property
    def key(self) -> tuple[str, ...]:
        """Equal for equal loads."""

    @property
    def values(self) -> tuple[str, ...]:
        """One value, or one at each of four corners."""


L = TypeVar("L", bound=Load)
L_co = TypeVar("L_co", bound=Load, covariant=True)


class Loaded(Protocol[L_co]):
    """A load and the elements that have it."""

    @property
    def elements(self) -> Sequence[int]:
        """Their ids."""

    @property
    def pressure(self) -> L_co:
        """The load."""


@dataclass(frozen=True, eq=False)
class Field(Generic[L]):
    """Pressures of one layer that differ from element to element.

    Attributes
    ----------
    sample : Load
        How it is typed.
    values : dict of int to tuple of float
        By element id: one value, or one at each corner.
    """

    sample: L
    values: dict[int, tuple[float, ...]]


@dataclass(frozen=True, eq=False)
class ShellLoads(Generic[L]):
    """Loads of shells, even ones and fields.

    Attributes
    ----------
    even : dict of int to tuple of Load
        By element id.
    graded : dict of int to tuple of (Layer, int)
        By element id: the fields that it is a sample of, and in which of their areas it is.
    fields : dict of Layer to Field
    """

    even: dict[int, tuple[L, ...]]
    graded: dict[int, tuple[tuple[Layer, int], ...]]
    fields: dict[Layer, Field[L]]


def sort_loads(cards: Iterable[Loaded[L]], element_ids: Ids, corners: Ids) -> ShellLoads[L]:
    """Tell even loads from fields.

    Parameters
    ----------
    element_ids, corners : (M,) int64, (M, 4) int64
        Of all shells; a tria has 0 last.
    """
    layers: dict[Layer, dict[int, list[L]]] = defaultdict(lambda: defaultdict(list))
    order = np.argsort(element_ids)
    ascending = element_ids[order]
    for card in cards:
        by_row = layers[card.pressure.layer]
        for row in _rows(card.elements, ascending, order):
            by_row[row].append(card.pressure)
    pairs = _neighbours(corners)
    even: dict[int, list[L]] = defaultdict(list)
    graded: dict[int, list[tuple[Layer, int]]] = defaultdict(list)
    fields: dict[Layer, Field[L]] = {}
    for layer, by_row in layers.items():
        area, is_field = _areas(by_row, pairs, corners)
        for row, loads in by_row.items():
            element = int(element_ids[row])
            if not is_field[row]:
                even[element] += loads
                continue
            field = fields.setdefault(layer, Field(loads[0], {}))
            field.values[element] = _sum(loads)
            graded[element].append((layer, int(area[row])))
    return ShellLoads(
        {element: tuple(loads) for element, loads in even.items()},
        {element: tuple(found) for element, found in graded.items()},
        fields,
    )


def _rows(elements: Sequence[int], ascending: Ids, order: Ids) -> list[int]:
    """Rows of the shells among some element ids."""
    if isinstance(elements, range):
        first, stop = np.searchsorted(ascending, [elements.start, elements.stop])
        rows: list[int] = order[first:stop].tolist()
        return rows
    places = np.searchsorted(ascending, elements)
    places = np.minimum(places, len(ascending) - 1)
    found: list[int] = order[places[ascending[places] == elements]].tolist()
    return found


def _neighbours(corners: Ids) -> Ids:
    """(P, 2) rows of elements that share an edge which no third one has."""
    rows, sides = np.nonzero(corners)
    size = np.where(corners[:, 3] == 0, 3, 4)[rows]
    ends = np.stack([corners[rows, sides], corners[rows, (sides + 1) % size]], axis=1)
    _, edge, uses = np.unique(
        np.sort(ends, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    edge = edge.reshape(-1)
    inner = uses[edge] == 2
    order = np.argsort(edge[inner], kind="stable")
    pairs: Ids = rows[inner][order].reshape(-1, 2)
    return pairs


def _areas(by_row: Mapping[int, Sequence[Load]], pairs: Ids, corners: Ids) -> tuple[Ints, Bools]:
    """Area of each row, and whether its values differ; of rows with loads, all others mean nothing.

    Rows of equal loads that touch make an area. Areas that touch are one where they differ little,
    or where one of many values is that of a strip or less, without a node inside.
    """
    count = len(corners)
    kinds: dict[tuple[object, ...], int] = {}
    kind = np.full(count, -1, np.int64)
    size: list[float] = []
    corners_differ: list[bool] = []
    for row, loads in by_row.items():
        key = tuple(sorted(load.key for load in loads))
        if key not in kinds:
            kinds[key] = len(kinds)
            values = _sum(loads)
            size.append(float(np.mean(values)))
            corners_differ.append(len(values) > 1)
        kind[row] = kinds[key]
    values_of = np.array(size)
    pairs = pairs[(kind[pairs] >= 0).all(axis=1)]
    left, right = pairs.T
    uneven = np.array(corners_differ)[kind] & (kind >= 0)
    same = (kind[left] == kind[right]) & ~uneven[left]
    patch = _components(pairs[same], count)
    is_wide = _has_inside(patch, corners, kind >= 0)
    one, other = values_of[kind[left]], values_of[kind[right]]
    small = ~(is_wide[patch[left]] & is_wide[patch[right]])
    small &= len(kinds) >= FEWEST_SAMPLES
    near = np.abs(one - other) <= SMALLEST_STEP * np.maximum(np.abs(one), np.abs(other))
    area = _components(pairs[same | small | near], count)
    differs = np.zeros(area.max() + 1, bool)
    differs[area[uneven]] = True
    differs[area[left[(small | near) & ~same]]] = True
    return area, differs[area] & (kind >= 0)


def _has_inside(patch: Ints, corners: Ids, is_loaded: Bools) -> Bools:
    """(patches,) bool: which have a node inside, that no loaded element of another one is at."""
    rows, sides = np.nonzero((corners != 0) & is_loaded[:, None])
    _, node = np.unique(corners[rows, sides], return_inverse=True)
    node = node.reshape(-1)
    lowest = np.full(node.max(initial=0) + 1, len(corners))
    highest = np.zeros(len(lowest), np.int64)
    np.minimum.at(lowest, node, patch[rows])
    np.maximum.at(highest, node, patch[rows])
    inside = (lowest == highest) & (np.bincount(node, minlength=len(lowest)) >= _AROUND)
    found = np.zeros(int(patch.max()) + 1, bool)
    found[lowest[inside]] = True
    return found


def _components(pairs: Ids, count: int) -> Ints:
    graph = coo_array((np.ones(len(pairs), bool), (pairs[:, 0], pairs[:, 1])), (count, count))
    label: Ints = connected_components(graph, directed=False)[1]
    return label


def _sum(loads: Sequence[Load]) -> tuple[float, ...]:
    """Pressure of loads together: one value, or four where corners differ."""
    values = np.array([np.resize([real(text) for text in load.values], 4) for load in loads])
    total = tuple(values.sum(axis=0).tolist())
    return total[:1] if len(set(total)) == 1 else total
