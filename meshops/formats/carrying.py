"""What a file says at its nodes and elements, carried over to the mesh that edits made of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from meshops.formats.difference import Difference, compare
from meshops.formats.ids import IdSet
from meshops.mesh import NEW, NO_NODE, Bools, Floats, Ids, ShellMesh, centres_of

NEAREST = 8
"""Elements by their centre, and nodes, that are looked at around a place."""

LARGEST_ID = 2**31 - 1
"""Ids are 32-bit integers in most files."""


@dataclass(frozen=True, eq=False)
class Carried:
    """Where each node and element of an edited mesh comes from.

    Attributes
    ----------
    before, after : ShellMesh
    difference : Difference
    node_rows : (N,) int64
        Row in ``before`` of each node of ``after``, -1 where it is new.
    element_rows : (M,) int64
        Row in ``before`` of each element of ``after``; of a new one that of the nearest element
        of its region.
    """

    before: ShellMesh
    after: ShellMesh
    difference: Difference
    node_rows: Ids
    element_rows: Ids

    @classmethod
    def of(
        cls, before: ShellMesh, after: ShellMesh, taken_nodes: IdSet, taken_elements: IdSet
    ) -> Carried:
        """Compare the mesh of a file with a mesh that edits have made of it.

        Raises as ``compare``.
        """
        difference = compare(
            before,
            after,
            taken_nodes=taken_nodes,
            taken_elements=taken_elements,
            limit=LARGEST_ID,
        )
        after = difference.mesh  # in which elements on the nodes of gone ones have their ids
        node_rows = _rows(before.node_ids, after.node_ids)
        element_rows = _rows(before.element_ids, after.element_ids)
        new = np.flatnonzero(element_rows < 0)
        if len(new):
            centres = centres_of(after.points, after.elements)[new]
            element_rows[new] = _Hosts(before).at(centres, after.region[new])[0]
        return cls(before, after, difference, node_rows, element_rows)

    @property
    def is_unchanged(self) -> bool:
        """Whether the mesh is that of the file."""
        d = self.difference
        changes = (d.moved, d.new_nodes, d.rewired, d.new_elements, d.gone_nodes, d.gone_elements)
        return not any(len(rows) for rows in changes)

    @cached_property
    def displaced(self) -> Ids:
        """Rows of the nodes of ``after`` that are new or have moved, in order."""
        d = self.difference
        rows: Ids = np.union1d(d.new_nodes, d.moved).astype(np.int64)
        return rows

    def node_values(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values at the nodes of ``before`` (n, ...) as those of ``after`` (N, ...).

        Floating-point ones are interpolated where a node is new or has moved, integers are those of
        the nearest node; a numbering, whose values are all different, goes on with new numbers.
        """
        found = values[np.maximum(self.node_rows, 0)]
        new = self.node_rows < 0
        if is_numbering(values):
            found[new] = values.max() + 1 + np.arange(np.count_nonzero(new))
        elif np.issubdtype(values.dtype, np.inexact):
            found[self.displaced] = self._interpolated(values)
        else:
            corners, weights = self._hosts
            near = corners[np.arange(len(corners)), weights.argmax(axis=1)]
            found[new] = values[near[new[self.displaced]]]
        return found

    def element_values(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values of the elements of ``before`` (m, ...) as those of ``after`` (M, ...).

        A new element has those of the nearest one; a numbering goes on with new numbers.
        """
        found = values[self.element_rows]
        new = self.after.element_ids == NEW
        if is_numbering(values):
            found[new] = values.max() + 1 + np.arange(np.count_nonzero(new))
        return found

    @cached_property
    def _hosts(self) -> tuple[Ids, Floats]:
        """(k, 4) nodes of ``before`` around each displaced node, and their weights."""
        rows = self.displaced
        element = np.zeros(len(self.after.points), np.int64)
        corner = self.after.elements != NO_NODE
        element[self.after.elements[corner]] = np.nonzero(corner)[0]
        regions = self.after.region[element[rows]]
        hosts, weights = _Hosts(self.before).at(self.after.points[rows], regions)
        corners = self.before.elements[hosts].astype(np.int64)
        return np.where(corners == NO_NODE, corners[:, :1], corners), weights

    def _interpolated(self, values: NDArray[Any]) -> NDArray[Any]:
        corners, weights = self._hosts
        around = values[corners]
        shape = (len(corners), 4) + (1,) * (values.ndim - 1)
        with np.errstate(all="ignore"):
            # a corner of no weight has no say, even where its value is no number
            parts = np.where(weights.reshape(shape) > 0.0, around * weights.reshape(shape), 0.0)
            mean = parts.sum(axis=1).astype(values.dtype)
        heaviest = around[np.arange(len(corners)), weights.argmax(axis=1)]
        alike = (around == heaviest[:, None]) | (weights.reshape(shape) <= 0.0)
        found: NDArray[Any] = np.where(alike.all(axis=1) | ~np.isfinite(mean), heaviest, mean)
        return found


def is_numbering(values: NDArray[Any]) -> bool:
    """Tell whether integers (n,) number what they belong to: they are all different."""
    if values.ndim != 1 or len(values) < 2 or not np.issubdtype(values.dtype, np.integer):
        return False
    has_room = int(values.max()) < np.iinfo(values.dtype).max // 2
    return has_room and len(np.unique(values)) == len(values)


class _Hosts:
    """Finds the element that a place lies on, or nearest to."""

    def __init__(self, mesh: ShellMesh) -> None:
        self._mesh = mesh
        self._centres = centres_of(mesh.points, mesh.elements)
        corner = mesh.elements != NO_NODE
        nodes = mesh.elements[corner]
        order = np.argsort(nodes, kind="stable")
        self._around = np.nonzero(corner)[0][order]
        self._start = np.searchsorted(nodes[order], np.arange(len(mesh.points) + 1))
        self._nodes = cKDTree(mesh.points)

    def at(self, places: Floats, regions: NDArray[Any]) -> tuple[Ids, Floats]:
        """(k,) elements of these regions nearest to places, and (k, 4) weights of their nodes."""
        hosts = np.zeros(len(places), np.int64)
        weights = np.zeros((len(places), 4))
        count = min(NEAREST, len(self._mesh.points))
        _, near_nodes = self._nodes.query(places, k=count)
        # a tree names one row too many where a distance is larger than a number can be
        near_nodes = near_nodes.reshape(len(places), count).clip(0, len(self._mesh.points) - 1)
        for region in np.unique(regions):
            inside = np.flatnonzero(self._mesh.region == region)
            if not len(inside):
                inside = np.arange(len(self._mesh.elements))
            tree = cKDTree(self._centres[inside])
            for row in np.flatnonzero(regions == region):
                _, near = tree.query(places[row], k=min(NEAREST, len(inside)))
                beside = self._beside(near_nodes[row])
                beside = beside[self._mesh.region[beside] == region]
                near = np.atleast_1d(near).clip(0, len(inside) - 1)
                candidates = np.union1d(inside[near], beside)
                hosts[row], weights[row] = self._best(places[row], candidates)
        return hosts, weights

    def _beside(self, nodes: Ids) -> Ids:
        around = [self._around[self._start[n] : self._start[n + 1]] for n in nodes]
        return np.concatenate(around)

    def _best(self, place: Floats, candidates: Ids) -> tuple[int, Floats]:
        elements = self._mesh.elements[candidates].astype(np.int64)
        quad = elements[:, 3] != NO_NODE
        owner = np.r_[np.arange(len(candidates)), np.flatnonzero(quad)]
        picks = np.where(
            np.r_[np.zeros(len(candidates), bool), np.ones(int(quad.sum()), bool)][:, None],
            [0, 2, 3],
            [0, 1, 2],
        )
        corners = self._mesh.points[np.take_along_axis(elements[owner], picks, axis=1)]
        inside, distance = _nearest_on_trias(place, corners)
        best = int(np.argmin(distance))
        weights = np.zeros(4)
        weights[picks[best]] = inside[best]
        return int(candidates[owner[best]]), weights


def _nearest_on_trias(place: Floats, corners: Floats) -> tuple[Floats, Floats]:
    """Nearest points of trias (k, 3, 3) to a place, as barycentric weights, and their distances."""
    best = np.zeros((len(corners), 3))
    least = np.full(len(corners), np.inf)

    def offer(weights: Floats, valid: Bools) -> None:
        distance = np.linalg.norm((weights[:, :, None] * corners).sum(axis=1) - place, axis=1)
        better = valid & (distance < least)
        best[better], least[better] = weights[better], distance[better]

    every = np.ones(len(corners), bool)
    for i in range(3):
        j = (i + 1) % 3
        a, way = corners[:, i], corners[:, j] - corners[:, i]
        square = (way * way).sum(axis=1)
        along = ((place - a) * way).sum(axis=1) / np.where(square > 0.0, square, 1.0)
        weights = np.zeros((len(corners), 3))
        weights[:, j] = along.clip(0.0, 1.0)
        weights[:, i] = 1.0 - weights[:, j]
        offer(weights, every)
    a, u, v = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    w = place - a
    uu, uv, vv = (u * u).sum(axis=1), (u * v).sum(axis=1), (v * v).sum(axis=1)
    wu, wv = (w * u).sum(axis=1), (w * v).sum(axis=1)
    scale = uu * vv - uv * uv
    safe = np.where(scale > 0.0, scale, 1.0)
    s, t = (vv * wu - uv * wv) / safe, (uu * wv - uv * wu) / safe
    flat = np.stack([1.0 - s - t, s, t], axis=1)
    offer(flat, (scale > 0.0) & (flat >= 0.0).all(axis=1))
    return best, least


def _rows(known: Ids, ids: Ids) -> Ids:
    """(n,) where each of ``ids`` is in ``known``, -1 where it is NEW."""
    order = np.argsort(known)
    places = np.minimum(np.searchsorted(known, ids, sorter=order), max(len(known) - 1, 0))
    rows: Ids = np.where(ids == NEW, -1, order[places])
    return rows
