"""Restoring: nodes that have moved go home where the change does not need that they moved."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from meshops._core import unit_normals
from meshops.criteria import SLACK
from meshops.guard.correspondence import Change
from meshops.guard.faults import Appraisal, appraise
from meshops.mesh import NO_NODE, Bools, Ints, ShellMesh
from meshops.workpiece import Setting

WARNING = 0.8
"""Penalty of the warn level: an element that is sound may come as near to failing as that."""

FACING = 0.5
"""Cosine up to which the normal of an element may turn when its nodes go home."""


def restored(before: ShellMesh, change: Change, setting: Setting) -> Change:
    """Send nodes home as far as no element gets a fault by that, or is worse than a warning.

    All go home at first; then those of the elements that are worse by that go back to where the
    change has them, until no element is worse: one whose nodes are all back is as it was.
    """
    moved = change.moved(before)[: change.first_new]
    moved &= _used(change.elements, len(change.points))[: change.first_new]
    if not moved.any():
        return change
    is_node = change.elements != NO_NODE
    movable = np.zeros(len(change.points), bool)
    movable[: change.first_new] = moved
    rows = np.nonzero((movable[change.elements] & is_node).any(axis=1))[0]
    elements, is_node = change.elements[rows], is_node[rows]
    wanted = appraise(change.points, elements, setting)
    normals = unit_normals(change.points, elements)
    away = np.zeros(len(change.points), bool)
    points = change.points.copy()
    points[: change.first_new] = before.points
    while True:
        now = points.copy()
        now[away] = change.points[away]
        worse = _worse(appraise(now, elements, setting), wanted)
        worse |= np.einsum("ij,ij->i", unit_normals(now, elements), normals) < FACING
        if not worse.any():
            return replace(change, points=now)
        away |= _nodes(elements[worse], is_node[worse], len(away)) & movable


def _worse(now: Appraisal, wanted: Appraisal) -> Bools:
    worse: Bools = now.penalty > np.maximum(wanted.penalty, WARNING) + SLACK
    worse |= (now.shape > wanted.shape + SLACK).any(axis=1)
    worse |= (now.size > wanted.size + SLACK).any(axis=1)
    return worse


def _used(elements: Ints, count: int) -> Bools:
    return _nodes(elements, elements != NO_NODE, count)


def _nodes(elements: Ints, is_node: Bools, count: int) -> Bools:
    nodes = np.zeros(count, bool)
    nodes[elements[is_node]] = True
    return nodes
