"""ShellMesh: a mixed mesh of quads and trias as one frozen value."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]
Ids = NDArray[np.int64]
Bools = NDArray[np.bool_]

NO_NODE = -1
"""Stands in the fourth place of a tria."""

NEW = 0
"""The deck id of a node or element that the user's deck does not know."""


@dataclass(frozen=True, eq=False)
class ShellMesh:
    """Quads and trias on shared nodes; never changed, only replaced.

    Rows are the compact numbering that the paper calls Renumber: node and element ``i`` of the
    arrays is number ``i + 1`` in a procedure. ``node_ids`` and ``element_ids`` are the lasting map
    back to the user's deck.

    Attributes
    ----------
    points : (N, 3) float64
        Node coordinates, in the deck's length unit.
    elements : (M, 4) int32
        Node rows, counter-clockwise; a tria has ``NO_NODE`` last.
    region : (M,) int32
        The property that an element belongs to. No operation mixes two regions.
    locked_nodes : (N,) bool
        Nodes that neither move nor vanish.
    locked_elements : (M,) bool
        Elements that keep their nodes.
    node_ids : (N,) int64
        The node's id in the user's deck, or ``NEW``.
    element_ids : (M,) int64
        The element's id in the user's deck, or ``NEW``.
    """

    points: Floats
    elements: Ints
    region: Ints
    locked_nodes: Bools
    locked_elements: Bools
    node_ids: Ids
    element_ids: Ids

    @classmethod
    def build(
        cls,
        points: ArrayLike,
        elements: ArrayLike,
        *,
        region: ArrayLike | None = None,
        locked_nodes: ArrayLike | None = None,
        locked_elements: ArrayLike | None = None,
        node_ids: ArrayLike | None = None,
        element_ids: ArrayLike | None = None,
    ) -> Self:
        """Make a mesh of its arrays, copied and made read-only.

        What is left out is: one region, nothing locked, ids 1..n. Raises ValueError where shapes
        do not fit or an element names a node that is not there.
        """
        p = _frozen(points, np.float64)
        e = _frozen(elements, np.int32)
        if p.ndim != 2 or p.shape[1] != 3 or e.ndim != 2 or e.shape[1] != 4:
            raise ValueError(f"points {p.shape} must be (N, 3) and elements {e.shape} (M, 4)")
        n, m = len(p), len(e)
        if m and (e[:, :3].min() < 0 or e[:, 3].min() < NO_NODE or e.max() >= n):
            raise ValueError("an element names a node that is not there")
        mesh = cls(
            points=p,
            elements=e,
            region=_frozen(np.zeros(m) if region is None else region, np.int32),
            locked_nodes=_frozen(np.zeros(n) if locked_nodes is None else locked_nodes, np.bool_),
            locked_elements=_frozen(
                np.zeros(m) if locked_elements is None else locked_elements, np.bool_
            ),
            node_ids=_frozen(np.arange(1, n + 1) if node_ids is None else node_ids, np.int64),
            element_ids=_frozen(
                np.arange(1, m + 1) if element_ids is None else element_ids, np.int64
            ),
        )
        if not (mesh.locked_nodes.shape == mesh.node_ids.shape == (n,)):
            raise ValueError("locked_nodes and node_ids need one value a node")
        if not (mesh.region.shape == mesh.locked_elements.shape == mesh.element_ids.shape == (m,)):
            raise ValueError("region, locked_elements and element_ids need one value an element")
        return mesh

    @property
    def is_tria(self) -> Bools:
        """(M,) bool: which elements are trias."""
        tria: Bools = self.elements[:, 3] == NO_NODE
        return tria

    @cached_property
    def digest(self) -> str:
        """Hash of all arrays: equal digests, equal meshes."""
        return digest_of((name, getattr(self, name)) for name in self.__dataclass_fields__)

    @cached_property
    def surface_digest(self) -> str:
        """Hash of points and elements alone: equal digests, equal surfaces."""
        return digest_of((name, getattr(self, name)) for name in ("points", "elements"))

    def __getstate__(self) -> dict[str, object]:
        """Only the arrays travel; what is derived from them is made again where it is needed."""
        return {name: getattr(self, name) for name in self.__dataclass_fields__}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Make the arrays read-only again: a mesh never changes."""
        for array in state.values():
            array.flags.writeable = False
        self.__dict__.update(state)


def digest_of(arrays: Iterable[tuple[str, NDArray[Any]]]) -> str:
    """Hash of named arrays: their names, types, shapes and values."""
    h = hashlib.blake2b(digest_size=16)
    for name, values in arrays:
        array = np.ascontiguousarray(values)
        h.update(f"{name} {array.dtype.str} {array.shape};".encode())
        h.update(array.data if array.size else b"")
    return h.hexdigest()


def _frozen(values: ArrayLike, dtype: type) -> NDArray[Any]:
    array: NDArray[Any] = np.array(values, dtype=dtype, order="C")
    array.flags.writeable = False
    return array


def following(elements: Ints) -> Ints:
    """(M, 4) int32: the node after each corner of elements (M, 4), around the element.

    It means nothing where there is no corner.
    """
    after = np.roll(elements, -1, axis=1)
    tria = elements[:, 3] == NO_NODE
    after[tria, 2] = elements[tria, 0]
    return after


def centres_of(points: Floats, elements: Ints) -> Floats:
    """(M, 3) mean corner of elements (M, 4)."""
    is_corner = elements != NO_NODE
    corners = points[elements] * is_corner[..., None]
    means: Floats = corners.sum(axis=1) / is_corner.sum(axis=1)[:, None]
    return means
