"""Zones of a raw surface: parts within its features that can be flattened."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from meshops.mesh import Bools, Ints
from meshops.methods.flatten import FlatPatch
from meshops.patch import Patch, extract
from meshops.remesher import RemeshError
from meshops.topology import Topology, element_normals

NEEDLE = 1e-4
"""Height of a tria over its longest edge below which its normal says nothing."""

WIDEST = (50.0, 35.0)
"""Degrees from a first normal to others within a part of a zone that turns too far as a whole; the
second for parts that still do. No two normals are farther apart then than a patch may be steep."""

SCRAP = 0.02
"""Share of a zone's elements up to which a part is a chance remnant along the widest angle."""


@dataclass(frozen=True, eq=False)
class Zone:
    """Elements that can be flattened together; the topology is cut along the zone's edges."""

    rows: Ints
    topology: Topology


def flat_zones(raw: Topology) -> list[Zone]:
    """Divide a surface along its features, and what turns too far into parts by its normals."""
    mesh = raw.mesh
    smooth_edges = raw.crossable | _needle_edges(raw)
    everywhere = np.ones(len(mesh.elements), bool)
    whole = replace(raw, crossable=smooth_edges)
    label = whole.graph.label_components(everywhere)
    count = int(label.max()) + 1
    for widest in WIDEST:
        for zone in range(count):
            rows = np.nonzero(label == zone)[0].astype(np.int32)
            if flattened(extract(whole, rows)) is None:
                part = _parts_by_normal(whole, rows, widest)
                label[rows] = np.where(part == 0, zone, count + part - 1)
                count += int(part.max())
    left, right = raw.edge_elements.T
    # a feature that ends inside a zone is no part of its outline
    inside = (raw.uses == 2) & (label[left] == label[right])
    cut = replace(raw, crossable=inside)
    order = np.argsort(label, kind="stable").astype(np.int32)
    return [Zone(rows, cut) for rows in np.split(order, np.cumsum(np.bincount(label))[:-1])]


def _needle_edges(raw: Topology) -> Bools:
    """(E,) bool: longest edges of trias without height, whose normal is chance."""
    mesh = raw.mesh
    a, b, c = mesh.points[mesh.elements[:, :3]].transpose(1, 0, 2)
    sides = np.stack([np.linalg.norm(v, axis=1) for v in (b - a, c - b, a - c)], axis=1)
    longest = sides.max(axis=1)
    needle = np.linalg.norm(np.cross(b - a, c - a), axis=1) <= NEEDLE * longest**2
    edges = raw.element_edges[needle, sides[needle].argmax(axis=1)]
    found = np.zeros(len(raw.edges), bool)
    found[edges[raw.uses[edges] == 2]] = True
    return found


def _parts_by_normal(whole: Topology, rows: Ints, widest: float) -> Ints:
    """(m,) part of each element of a zone: those around a first one that face nearly its way."""
    mesh = whole.mesh
    normals = element_normals(mesh)
    part = np.full(len(mesh.elements), -1, np.int32)
    least = np.cos(np.radians(widest))
    count = 0
    for first in rows:
        if part[first] >= 0:
            continue
        left = np.zeros(len(mesh.elements), bool)
        left[rows] = part[rows] < 0
        facing = normals @ normals[first]
        left &= (facing >= least) | (np.linalg.norm(normals, axis=1) == 0.0)
        left[first] = True
        near = whole.graph.label_components(left)
        part[near == near[first]] = count
        count += 1
    _join_scraps(whole, part, count)
    compact: Ints = np.unique(part[rows], return_inverse=True)[1].astype(np.int32)
    return compact


def _join_scraps(whole: Topology, part: Ints, count: int) -> None:
    """Give parts of a few elements to the neighbour that most of their edges touch, in place."""
    few = SCRAP * np.count_nonzero(part >= 0)
    pairs = whole.edge_elements[whole.crossable]
    for scrap in range(count):
        if np.count_nonzero(part == scrap) > few:
            continue
        left, right = part[pairs].T
        beside = np.concatenate([right[left == scrap], left[right == scrap]])
        beside = beside[(beside >= 0) & (beside != scrap)]
        if len(beside):
            part[part == scrap] = np.bincount(beside).argmax()


def flattened(patch: Patch) -> FlatPatch | None:
    """Flatten a patch of trias; None where that fails."""
    try:
        return FlatPatch.of(patch.points, np.ascontiguousarray(patch.elements[:, :3]), patch.border)
    except RemeshError:
        return None
