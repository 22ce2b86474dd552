"""What each connected place of change has gained and lost."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops.harm.changes import Changes
from meshops.harm.edges import corners_of
from meshops.harm.limits import SHAPE, Failures
from meshops.harm.shapes import Shapes
from meshops.mesh import NO_NODE, Bools, Floats, Ids, ShellMesh

SLACK = 1e-4
"""Fall of a scaled Jacobian, or rise of a severity, that is rounding of coordinates."""


def _limit(criterion: str) -> str:
    """Name the limit that a criterion is: one angle is too small in a quad and in a tria alike."""
    return criterion.removesuffix(" quad").removesuffix(" tria")


LIMITS = tuple(dict.fromkeys(_limit(name) for name in SHAPE))
"""Limits of shape."""


@dataclass(frozen=True, eq=False)
class Judged:
    """A mesh with what has been measured of its elements and nodes.

    Attributes
    ----------
    mesh : ShellMesh
    shapes : Shapes
    failures : Failures
    irregular : (N,) bool
        Inner nodes at which not just four elements meet.
    """

    mesh: ShellMesh
    shapes: Shapes
    failures: Failures
    irregular: Bools


@dataclass(frozen=True)
class Places:
    """How many places of change break a rule, and an example of each.

    Attributes
    ----------
    count : int
        Places in all.
    new_faults : int
        Places where a new element breaks a limit of shape by more than any that it replaces.
    unpaid_trias : int
        Places with more new trias than faults of shape that went.
    spoiled : int
        Places without a fault of shape, a tria or an irregular node less, and of lower quality.
    examples : tuple of (x, y, z) or None
        One place for each of the three.
    """

    count: int
    new_faults: int
    unpaid_trias: int
    spoiled: int
    examples: tuple[tuple[float, float, float] | None, ...]


def judge_places(before: Judged, after: Judged, changes: Changes) -> Places:
    """Judge every place of change by itself."""
    count = 1 + max(changes.place_before.max(initial=-1), changes.place_after.max(initial=-1))
    old, new = (
        _Sums.of(judged, place, int(count))
        for judged, place in ((before, changes.place_before), (after, changes.place_after))
    )
    new_faults = (new.faults > old.faults) | (new.severity > old.severity + SLACK).any(axis=1)
    unpaid = new.trias - old.trias > np.maximum(old.faults - new.faults, 0)
    nothing = (
        (new.faults >= old.faults) & (new.trias >= old.trias) & (new.irregular >= old.irregular)
    )
    lower = (new.least < old.least - SLACK) | (new.mean < old.mean - SLACK)
    spoiled = nothing & lower & (new.elements > 0)
    broken = (new_faults, unpaid, spoiled)
    return Places(
        count=int(count),
        new_faults=int(np.count_nonzero(new_faults)),
        unpaid_trias=int(np.count_nonzero(unpaid)),
        spoiled=int(np.count_nonzero(spoiled)),
        examples=tuple(_example(after.mesh, changes.place_after, rule) for rule in broken),
    )


@dataclass(frozen=True, eq=False)
class _Sums:
    """Sums of P places, (P,) each; `severity` is the (P, L) worst by each limit of shape."""

    elements: Ids
    faults: Ids
    trias: Ids
    irregular: Ids
    severity: Floats
    least: Floats
    mean: Floats

    @classmethod
    def of(cls, judged: Judged, place: Ids, count: int) -> _Sums:
        rows = np.flatnonzero(place >= 0)
        at, mesh = place[rows], judged.mesh
        severity = np.zeros((count, len(LIMITS)))
        for name in SHAPE:
            if name in judged.failures.severity:
                column = severity[:, LIMITS.index(_limit(name))]
                np.maximum.at(column, at, judged.failures.severity[name][rows])
        quality = judged.shapes.scaled_jacobian[rows]
        least = np.full(count, np.inf)
        np.minimum.at(least, at, quality)
        elements = np.bincount(at, minlength=count)
        mean = np.bincount(at, quality, count) / np.maximum(elements, 1)
        owner = np.repeat(at, 4)
        nodes = corners_of(mesh)[rows].ravel()
        bad = judged.irregular[nodes]
        pairs = np.unique(np.column_stack([owner[bad], nodes[bad]]), axis=0)
        return cls(
            elements=elements,
            faults=np.bincount(at[judged.failures.shape[rows]], minlength=count),
            trias=np.bincount(at[mesh.is_tria[rows]], minlength=count),
            irregular=np.bincount(pairs[:, 0], minlength=count),
            severity=severity,
            least=least,
            mean=mean,
        )


def _example(mesh: ShellMesh, place: Ids, rule: Bools) -> tuple[float, float, float] | None:
    broken = np.flatnonzero(rule)
    rows = np.flatnonzero(place == broken[0]) if len(broken) else broken
    if not len(rows):
        return None
    corners = mesh.elements[rows[0]]
    x, y, z = mesh.points[corners[corners != NO_NODE]].mean(axis=0).tolist()
    return x, y, z
